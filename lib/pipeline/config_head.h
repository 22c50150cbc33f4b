// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "pipeline/config.h"
#include "pipeline/yaml_document.h"

namespace trephine {

/// Parts of read_case_config: what a recipe, a scene and a case say of a head as a whole. Each adds its faults and goes
/// on.

/// ": here ventricles.labels": what a recipe's fault adds that wants data of that kind and names another stage of an
/// anatomy which has one; else "".
std::string hint_of_source(const std::string& source, DataKind kind, const std::vector<RecipeAnatomy>& anatomies);

/// The case's `landmarks`: {nasion: [x, y, z]}.
void read_given_landmarks(const std::filesystem::path& file, const YamlNode& node, CaseConfig& out,
                          ConfigFaults& faults);

/// Points of 3D Slicer's (.mrk.json, .fcsv) or landmarks of ours (.json). Those of a name that is known already are
/// replaced where `wins`, else they are a fault (78). Throws 66 and 65. Returns the names.
std::vector<std::string> read_landmarks_file(const std::filesystem::path& file, bool wins, CaseConfig& out);

/// Drops those of the names that the case has no use for: a point's label may be anything, a patient's name too.
void drop_unused_landmarks(const std::vector<std::string>& names, CaseConfig& out);

/// The recipe's stages of the whole head, each the stage's parameters and the fields that its ports take:
/// `landmarks: {skin: skin.segment, skull: skull.segment}`. Needs the recipe's anatomies.
void read_head_step(const std::filesystem::path& file, const std::string& stage, const YamlNode& node, CaseConfig& out,
                    ConfigFaults& faults);

/// The scene's `face`: {policy: keep, reason: ...}, {policy: deface}. Needs the recipe.
void read_face_policy(const std::filesystem::path& file, const YamlNode& node, CaseConfig& out, ConfigFaults& faults);

/// The nearest name that can be found, where this one is neither found nor given: what a fault says of it; else "".
std::string fault_of_landmark(const std::string& name, const CaseConfig& config);

/// The scene's `landmarks`: {kocher_right: 0.5}, a confidence each. Needs the recipe.
void read_scene_landmarks(const std::filesystem::path& file, const YamlNode& node, CaseConfig& out,
                          ConfigFaults& faults);

}  // namespace trephine
