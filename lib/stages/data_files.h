// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "stages/stage.h"

namespace trephine::stages {

/// Stage data as files that keep every value: volumes, fields and haptic volumes as .nrrd, surfaces as .vtp with double
/// points, cutters as .json.
DataKind kind_of(const StageData& data);
/// What a volume, field, surface or haptic volume takes, about; 0 for the small kinds.
double bytes_in_memory(const StageData& data);
const char* file_extension(DataKind kind);
/// Writes through the checked writer (base/write_file.h). Throws Error 73 and 74, and 64 where the extension is not
/// that of the kind.
void save_data(const std::filesystem::path& file, const StageData& data);
/// Throws Error 66 and 65. A mask file becomes a field where a field is wanted. Landmarks may also come from a file of
/// 3D Slicer (.mrk.json, .fcsv).
/// Volumes of strangers are read in a bounded child; what the stage cache holds is its own, and was compared by hash.
enum class DataOf { stranger, cache };
StageData load_data(const std::filesystem::path& file, DataKind kind, DataOf whose = DataOf::stranger);
/// Loads a CT volume where the file says that it is one (content HU) or holds whole numbers of 16 bits; else a field.
StageData load_field_or_volume(const std::filesystem::path& file);

/// Writes a report as JSON (an object of its figures in their order, and "warnings"), and as aligned lines for a
/// person.
std::string report_json(const Report& report);
std::string report_text(const Report& report);

/// Result and warnings of a stage as JSON, for caches; its data are not in it. Reading throws Error 65 where it is not
/// that of the stage.
std::string outcome_json(const StageOutcome& outcome);
StageOutcome parse_outcome_json(const std::string& json, const StageType& type);

}  // namespace trephine::stages
