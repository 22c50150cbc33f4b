// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

#include "cases/case.h"

namespace trephine::detail {

/// The parts of case_json.cpp; for the sources of this room only.

/// Throws Error 70 naming the field where the manifest contradicts itself or a number is out of its range.
void check_manifest(const CaseManifest& manifest);

/// The manifest as a JSON object, without version and checksum.
std::string manifest_text(const CaseManifest& manifest);

/// Reads that object; unknown keys are ignored. Throws Error 65 naming the field.
CaseManifest read_manifest(std::string_view json);

}  // namespace trephine::detail
