// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "stages/stage.h"

namespace trephine {

/// Stage data as files, value for value: volumes, fields and haptic volumes .nrrd, surfaces .vtp with double points,
/// cutters .json.
DataKind kind_of(const StageData& data);
const char* file_extension(DataKind kind);
/// Through the checked writer; throws 73 and 74. The extension must be the kind's (64).
void save_data(const std::filesystem::path& file, const StageData& data);
/// Throws 66 and 65. A mask file given for a field becomes one. Landmarks may also be a file of 3D Slicer's (.mrk.json,
/// .fcsv).
StageData load_data(const std::filesystem::path& file, DataKind kind);
/// A CT volume where the file says that it is one (content HU), or holds whole numbers of 16 bits; else a field.
StageData load_field_or_volume(const std::filesystem::path& file);

/// A report as JSON (an object of its figures in their order, and "warnings"), and as aligned lines for a person.
std::string report_json(const Report& report);
std::string report_text(const Report& report);
/// Reads report_json's output back. Throws 65.
Report parse_report_json(const std::string& json);

}  // namespace trephine
