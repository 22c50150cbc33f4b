// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "dicom/import.h"

namespace trephine::dicom {

/// Throws Error 65 where a CT's values are plainly HU without their offset of -1024: hardly any lies at the HU of air
/// and lung, many lie about 0, where air then is, and more about 1050, where soft tissue then is, than between. Padding
/// and what no slice covers (-1000 exactly) do not count.
void require_offset(const grid::HuVolume& volume, const std::string& field);

/// "int16" or "float32".
std::string sample_type_of(const grid::HuVolume& volume);

/// What whoever reads it says otherwise than the files: applies `axes`, and records it and the reasons given.
void say_otherwise(ImportResult& result, const ImportParams& params);

}  // namespace trephine::dicom
