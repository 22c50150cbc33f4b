// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "cli/command.h"
#include "meshio/export_mesh.h"

namespace trephine::tools {

/// The formats of a case's DICOM objects, which the command `export` takes beside those of meshio.
struct DicomFormats {
  bool seg = false, stl = false, ct = false, rtss = false;
  bool any() const { return seg || stl || ct || rtss; }
  bool on_slices() const { return seg || rtss; }
  /// Takes the name of one; false where it is none.
  bool take(const std::string& name);
};
const std::vector<std::string>& dicom_format_names();
/// What they are, for the command's help.
extern const char* dicom_formats_help;

struct DicomParams {
  bool source_uids = false;
  template <class V>
  static void describe(V& v) {
    v.flag(
        &DicomParams::source_uids, "source_uids",
        "dicom-seg, dicom-rtss: refer to the images of --series by their own UIDs, instead of to a dicom-ct written "
        "beside them. UIDs identify the patient's study: who has access to the archive finds the patient by them, so "
        "such objects must go nowhere else. It does not go with dicom-ct and dicom-stl.");
  }
};

/// The folder within --out that holds the images of dicom-ct.
constexpr const char* dicom_ct_folder = "dicom-ct";
struct DicomExport {
  std::vector<meshio::ExportFile> objects, images;
  std::string table;  ///< a line for each object
};
/// The objects of the case that `parsed` names; nothing is written. Where `name` is empty they have the case's. Throws
/// Error 64 where the flags do not fit together; 65 where --series is another scan, or the case holds no CT that is
/// needed; as load_case.
DicomExport export_dicom(const cli::ParsedCommand& parsed, const DicomFormats& formats, const std::string& name,
                         Report& report, const Progress& progress);
/// Throws Error 64 where the flags do not fit together.
void check_dicom(const cli::ParsedCommand& parsed, const DicomFormats& formats);
/// Writes them below the folder, and removes images of an earlier, longer series there.
void write_dicom(const std::filesystem::path& out, const DicomExport& made);

}  // namespace trephine::tools
