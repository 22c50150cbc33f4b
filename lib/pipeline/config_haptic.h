// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <vector>

#include "pipeline/config.h"
#include "pipeline/yaml_document.h"

namespace trephine {

/// Parts of read_case_config: what a scene and a case say of burr holes and of the haptic volume. Each adds its faults
/// and goes on.

/// A file of materials by name (configs/materials.yaml).
std::vector<CaseMaterial> read_materials(const std::filesystem::path& file, ConfigFaults& faults);

/// The scene's `haptic`. Needs the recipe.
void read_haptic_scene(const std::filesystem::path& file, const YamlNode& node,
                       const std::vector<CaseMaterial>& materials, CaseConfig& out, ConfigFaults& faults);

/// The scene's `burr_holes`: {skull: {}, skin: {widen_mm: 5}}. Needs the recipe.
void read_drilled(const std::filesystem::path& file, const YamlNode& node, CaseConfig& out, ConfigFaults& faults);

/// The case's `burr_holes`: a list of maps.
void read_burr_holes(const std::filesystem::path& file, const YamlNode& node, CaseConfig& out, ConfigFaults& faults);

/// What can only be judged when everything is set: contradictions of a hole's parameters, a scene that drills where the
/// case says nothing, and what of the case's the scene does not want (which is dropped).
void check_burr_holes(const std::filesystem::path& file, const YamlNode& tree, CaseConfig& out, ConfigFaults& faults);

}  // namespace trephine
