// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
#include "grid/grid.h"

namespace trephine {

enum class GapPolicy { refuse, interpolate };
enum class ModalityPolicy { ct, any };

struct ImportParams {
  std::string series;  ///< a token as list_series gives it, or its part before the first '-'; empty: the only one
  ModalityPolicy modality = ModalityPolicy::ct;
  GapPolicy gaps = GapPolicy::refuse;
  double max_gap_mm = 8;
  double clamp_low_hu = -1e6;
  double clamp_high_hu = 1e6;

  template <class V>
  static void describe(V& v) {
    using P = ImportParams;
    v.text(&P::series, "series", "Token of the series to read, where a folder holds several (s1, s2, ...).");
    v.choice(&P::modality, "modality", {{"ct", ModalityPolicy::ct}, {"any", ModalityPolicy::any}},
             "Which modalities are read: CT only, or any that has slices with a geometry.");
    v.choice(&P::gaps, "gaps", {{"refuse", GapPolicy::refuse}, {"interpolate", GapPolicy::interpolate}},
             "What to do where a slice is missing.");
    v.number(&P::max_gap_mm, "max_gap_mm", Range{0.1, 50}, "Largest step between slices that is read at all.");
    v.number(&P::clamp_low_hu, "clamp_low_hu", Range{-1e6, 1e6}, "Values below it are raised to it and counted.");
    v.number(&P::clamp_high_hu, "clamp_high_hu", Range{-1e6, 1e6},
             "Values above it (metal) are cut to it and counted.");
  }
};

/// What may be said of a series to anybody: no free text, no name, date, ID or UID.
struct SeriesSummary {
  std::string token;  ///< "s1-512x512x108": ordinal by content (modality, slices, matrix, spacing, ...) and size. The
                      ///< same for the same files whatever their names, order and folder; not derived from any UID
  std::string modality;
  std::array<int, 3> size{0, 0, 0};  ///< columns, rows, slices as stored
  Vec3 spacing_mm;                   ///< x, y, and the median step along the normal
  double slice_thickness_mm = 0;     ///< 0: unknown
  std::string kernel;                ///< a known kernel's name, else "other", or empty
  std::string image_type;            ///< known words only, joined by '/'
  bool contrast = false;
  std::string transfer_syntax;  ///< name
  std::string orientation;  ///< "axial HFS": plane of the slices (oblique: 30 degrees or more off), how the patient lay
  double tilt_deg = 0;      ///< positive where the slices shift towards rising rows while rising along the normal
  double smallest_step_mm = 0, largest_gap_mm = 0;
  int missing_slices = 0, duplicates = 0;  ///< steps over missing slices; files at a position that another has
  bool usable = false;
  std::string rectified_for;  ///< what import mends by resampling: "tilt", "uneven spacing", ...; empty: nothing
  std::string verdict;        ///< "usable", "usable, rectified: tilt", or "refused: FIELD: why", as import says it

  std::string line() const;  ///< "s1-512x512x108: CT, 0.479 x 0.479 x 1.5 mm, kernel H40s, ..."
};

struct ImportResult {
  HuVolume volume;           ///< patient LPS; direction right-handed; slices ascend along the normal
  Report report;             ///< of the series alone: equal for equal series
  Report folder;             ///< what else lay in the folder (files skipped, other series): not for case.json
  std::string input_sha256;  ///< hash_of_series_input of what was read
};

/// Reads one series of a folder (searched five levels deep), of a ZIP archive, or of one file, into HU.
///
/// Geometry and HU come from raw tags that this module reads and checks itself; slices are ordered by their positions
/// along the normal. The volume is the stored one, HU exact, where the positions form an upright uniform stack: steps
/// within 1 um of uniform, drift across the stack below 20 um. Otherwise it is resampled onto an upright uniform grid
/// from the true positions: gantry tilt, jitter, changing steps, and gaps where allowed. Resampling is first within the
/// slice (tilt), by Lagrange's polynomial through eight samples, then along the normal, by cubic Hermite interpolation
/// with three-point tangents, each limited to the range of the four samples about the place, so that it adds no over-
/// or undershoot; the grid covers all slices, and what no slice covers is air. The step is that of the stack's finest
/// regular part, its phase that of the longest regular run.
///
/// Padding (by its tag) becomes air, -1000 HU. int16 where slope and intercept of every slice are integers and all
/// values fit (resampled values are rounded to whole HU), else float32.
///
/// A ZIP archive is uncompressed in a bounded child into shared memory, nothing of it to disk: it needs as much memory
/// as its images have bytes, beside the volume.
///
/// Throws Error 66 (folder missing or unreadable), 64 (several series and no choice: lists them), 65 (bad data: file
/// and tag), 70 (the decoding child died), Cancelled. File names in errors are relative to `folder_or_file`.
ImportResult import_series(const std::filesystem::path& folder_or_file, const ImportParams& params,
                           const Progress& progress = {});

/// SHA-256 of what the import of that series depends on (tags of geometry and HU, pixel bytes as stored), without
/// decoding. Not of file names, order, folder, names, IDs, dates or UIDs; nor of params, but for the choice of the
/// series. `folder`, where given, becomes ImportResult::folder. Throws as import_series does up to the decoding.
std::string hash_of_series_input(const std::filesystem::path& folder_or_file, const ImportParams& params,
                                 const Progress& progress = {}, Report* folder = nullptr);

/// All that a folder holds.
struct SeriesList {
  std::vector<SeriesSummary> series;  ///< the usable ones first
  Report folder;                      ///< what else lay there
};

/// The series found, with the verdict that import_series would give of each when it is chosen. Nothing is decoded: of a
/// compressed stream only its own header, end and RLE counts are looked at, so that damage within it shows on import
/// only, as does whether compressed files at one position differ. Throws 66; 65 of an archive that is not read.
SeriesList list_series(const std::filesystem::path& folder_or_file, const ImportParams& params = {},
                       const Progress& progress = {});

/// A table for a terminal, a line a series, and what else lay in the folder; the same as JSON.
std::string list_text(const SeriesList& list);
std::string list_json(const SeriesList& list);

}  // namespace trephine
