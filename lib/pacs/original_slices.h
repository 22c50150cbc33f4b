// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "dicom/import.h"
#include "pacs/slices.h"

namespace trephine::pacs {

/// What a scan's files say that leads back to the patient's study.
struct SourceUids {
  std::string study_uid, frame_uid;
};
struct OriginalSlices {
  SliceSet slices;    ///< without images, unless the UIDs were asked for
  SourceUids source;  ///< empty, unless asked for
};

/// Whether the source's own UIDs are read, which are identifiers of the patient's study.
enum class OwnUids { left, read };

/// The slices of the scan that a case was made of, as they are stored: no resampling, of slices at one place the first.
/// `params` are those by which the case chose its series; where they choose another one here, the folder is searched
/// for the one whose content has the hash. Throws Error 65, field "series", where none has, where the scan is no DICOM,
/// or where `params` turn its axes, and what list_series throws.
OriginalSlices original_slices(const std::filesystem::path& folder_or_file, dicom::ImportParams params,
                               const std::string& input_sha256, OwnUids uids, const Progress& progress = {});

}  // namespace trephine::pacs
