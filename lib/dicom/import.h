// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"

namespace trephine::dicom {

enum class SeriesRule { only, best };
enum class GapPolicy { refuse, interpolate };
enum class ModalityPolicy { ct, any };
enum class UnitPolicy { hu, any };
enum class VolumeValues { unsaid, hu, any };
constexpr double largest_max_gap_mm = 50;

struct ImportParams {
  std::string
      series;  ///< a token as list_series gives it, or its part before the first '-'; empty: as series_rule says
  SeriesRule series_rule = SeriesRule::only;
  ModalityPolicy modality = ModalityPolicy::ct;
  UnitPolicy units = UnitPolicy::hu;
  VolumeValues volume_values = VolumeValues::unsaid;
  GapPolicy gaps = GapPolicy::refuse;
  double max_gap_mm = 8;
  double offset_hu = 0;
  std::string axes;                ///< empty: as the file says
  std::string orientation_reason;  ///< empty: a head that lies otherwise than said is refused by a case
  double clamp_low_hu = -1e6;
  double clamp_high_hu = 1e6;
  std::string burned_in_reason;     ///< empty: pixels that are said to hold text are refused
  std::string same_patient_reason;  ///< empty: slices that say they are of several patients are refused

  template <class V>
  static void describe(V& v) {
    using P = ImportParams;
    v.text(&P::series, "series", "Token of the series to read, where a folder holds several (s1, s2, ...).");
    v.choice(&P::series_rule, "series_rule", {{"only", SeriesRule::only}, {"best", SeriesRule::best}},
             "Which series is read where none is named: the only usable one, or the one that the list proposes (axial, "
             "long, original, of a soft kernel, thin).");
    v.choice(&P::modality, "modality", {{"ct", ModalityPolicy::ct}, {"any", ModalityPolicy::any}},
             "Modalities that are read: CT only, or any that has slices with a geometry.");
    v.choice(
        &P::units, "units", {{"hu", UnitPolicy::hu}, {"any", UnitPolicy::any}},
        "Units that a CT's RescaleType may name: Hounsfield units or none at all, or any, which are then taken for "
        "Hounsfield units.");
    v.choice(
        &P::volume_values, "volume_values",
        {{"unsaid", VolumeValues::unsaid}, {"hu", VolumeValues::hu}, {"any", VolumeValues::any}},
        "What the values of a volume file are that is no DICOM (NIfTI, MetaImage, NRRD, ...) and cannot say it: HU "
        "of a CT, which is checked as far as it can be, or any (MR), which are taken as they are.");
    v.choice(&P::gaps, "gaps", {{"refuse", GapPolicy::refuse}, {"interpolate", GapPolicy::interpolate}},
             "What to do where a slice is missing.");
    v.number(&P::max_gap_mm, "max_gap_mm", Range{0.1, largest_max_gap_mm},
             "Largest step between slices that is accepted.");
    v.number(&P::offset_hu, "offset_hu", Range{-10000, 10000},
             "Added to every value: -1024 for a CT that was stored without this offset (0 to about 3000).");
    v.text(&P::axes, "axes",
           "Sides of the patient to which columns, rows and slices rise, in three letters such as LPS, against what "
           "the files say: for images that were mirrored or turned.");
    v.text(&P::orientation_reason, "orientation_reason",
           "Why a head may be used that lies otherwise in the picture than the scan says. The reason is recorded.");
    v.number(&P::clamp_low_hu, "clamp_low_hu", Range{-1e6, 1e6}, "Values below this are raised to it and counted.");
    v.number(&P::clamp_high_hu, "clamp_high_hu", Range{-1e6, 1e6},
             "Values above this (metal) are lowered to it and counted.");
    v.text(&P::burned_in_reason, "burned_in_reason",
           "Why slices may be used whose tag BurnedInAnnotation says that their pixels hold text, which may be a "
           "name. The reason is recorded.");
    v.text(&P::same_patient_reason, "same_patient_reason",
           "Why slices are of one patient although they contradict each other in who it is (PatientID, PatientName, "
           "PatientBirthDate, PatientSex, ...). The reason is recorded.");
  }
};

/// What may be told to anybody about a series: no free text, no name, date, ID or UID.
struct SeriesSummary {
  std::string
      token;  ///< "s1-512x512x108": a number by content (modality, slices, matrix, spacing, ...) and the size. It is
              ///< the same for the same files whatever their names, order and folder, and is not derived from a UID
  std::string modality;
  std::array<int, 3> size{0, 0, 0};  ///< columns, rows and slices as stored
  Vec3 spacing_mm;                   ///< x, y, and the median step along the normal
  double slice_thickness_mm = 0;     ///< 0: unknown
  std::string kernel;                ///< name of a known kernel, else "other", or empty
  std::string image_type;            ///< known words only, joined by '/'
  std::string contrast;              ///< "yes" or "no" by the tag; empty: the scan does not say it, and may show it
  std::string transfer_syntax;       ///< name
  std::string orientation;  ///< "axial HFS": plane of the slices (oblique: at least 30 degrees off), patient's position
  double tilt_deg = 0;      ///< positive where the slices shift towards rising rows as they rise along the normal
  double smallest_step_mm = 0, largest_gap_mm = 0;
  int missing_slices = 0, duplicates = 0;  ///< steps over missing slices; files at a position that another file has
  bool usable = false;
  bool proposed = false;      ///< series_rule best would take it
  std::string rectified_for;  ///< what import corrects by resampling: "tilt", "uneven spacing", ...; empty: nothing
  std::string verdict;        ///< "usable", "usable, rectified: tilt", or "refused: FIELD: why", as import would say it

  Report seen;  ///< what its picture shows, by whoever looked at it; list_series does not

  const char* contrast_text() const;  ///< "yes", "no" or "not told"
  std::string line() const;           ///< "s1-512x512x108: CT, 0.479 x 0.479 x 1.5 mm, kernel H40s, ..."
};

/// Of a DICOM series: its stack of slices.
struct StackFigures {
  double slice_thickness_mm = 0, smallest_step_mm = 0, largest_gap_mm = 0, tilt_deg = 0;
  bool resampled = false;
  std::optional<std::string> resampled_for;
  std::int64_t missing_slices_interpolated_count = 0;
  std::size_t duplicates_dropped_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = StackFigures;
    v.number(&P::slice_thickness_mm, "slice_thickness_mm", Range{}, "Thickness of the slices, by their tag.");
    v.number(&P::smallest_step_mm, "smallest_step_mm", Range{}, "Smallest distance of slices.");
    v.number(&P::largest_gap_mm, "largest_gap_mm", Range{}, "Largest distance of slices.");
    v.number(&P::tilt_deg, "tilt_deg", Range{}, "Tilt of the gantry, by the positions.");
    v.flag(&P::resampled, "resampled", "Whether the volume is resampled.");
    v.text(&P::resampled_for, "resampled_for", "What it is resampled for.");
    v.integer(&P::missing_slices_interpolated_count, "missing_slices_interpolated_count", Range{}, "Missing slices.");
    v.integer(&P::duplicates_dropped_count, "duplicates_dropped_count", Range{}, "Slices dropped as duplicates.");
  }
};

/// Of a DICOM series: what its tags say.
struct TagFigures {
  std::string kernel, image_type, patient_position, contrast, transfer_syntax;
  std::optional<double> tilt_by_tag_deg;
  template <class V>
  static void describe(V& v) {
    using P = TagFigures;
    v.text(&P::kernel, "kernel", "Kernel of the reconstruction.");
    v.text(&P::image_type, "image_type", "Type of the images.");
    v.text(&P::patient_position, "patient_position", "The patient's position, as HFS.");
    v.text(&P::contrast, "contrast", "Contrast medium: yes, no, or not told.");
    v.text(&P::transfer_syntax, "transfer_syntax", "How the pixels are stored.");
    v.number(&P::tilt_by_tag_deg, "tilt_by_tag_deg", "Tilt of the gantry, by its tag.");
  }
};

/// What is printed of a scan that was read; of a volume file without what only DICOM says.
struct ImportFigures {
  std::string modality;  ///< "CT", "MR", ...; of a volume file "CT" or "any"
  std::optional<std::string> format;
  std::size_t slices_count = 0;
  std::array<int, 3> size{0, 0, 0};
  double spacing_x_mm = 0, spacing_y_mm = 0, spacing_z_mm = 0;
  std::optional<StackFigures> stack;
  std::int64_t padding_voxels_count = 0, clamped_voxels_count = 0;
  std::optional<std::int64_t> below_air_voxels_count;
  double hu_min = 0, hu_max = 0;
  std::string sample_type;
  std::optional<TagFigures> tags;
  std::optional<double> offset_hu;  ///< what whoever reads it says otherwise than the files, here and below
  std::optional<std::string> axes, orientation_reason, burned_in_reason, same_patient_reason;
  template <class V>
  static void describe(V& v) {
    using P = ImportFigures;
    v.text(&P::modality, "modality", "Modality.");
    v.text(&P::format, "format", "Format of a volume file.");
    v.integer(&P::slices_count, "slices_count", Range{}, "Slices.");
    v.extent(&P::size, "size", "Columns, rows and slices of the volume.");
    v.number(&P::spacing_x_mm, "spacing_x_mm", Range{}, "Distance of columns.");
    v.number(&P::spacing_y_mm, "spacing_y_mm", Range{}, "Distance of rows.");
    v.number(&P::spacing_z_mm, "spacing_z_mm", Range{}, "Distance of slices.");
    v.all_of(&P::stack);
    v.integer(&P::padding_voxels_count, "padding_voxels_count", Range{}, "Voxels of padding.");
    v.integer(&P::clamped_voxels_count, "clamped_voxels_count", Range{}, "Voxels whose value was clamped.");
    v.integer(&P::below_air_voxels_count, "below_air_voxels_count", "Voxels below -1024 HU that are no padding.");
    v.number(&P::hu_min, "hu_min", Range{}, "Smallest value.");
    v.number(&P::hu_max, "hu_max", Range{}, "Largest value.");
    v.text(&P::sample_type, "sample_type", "int16 or float32.");
    v.all_of(&P::tags);
    v.number(&P::offset_hu, "offset_hu", "What was added to every value.");
    v.text(&P::axes, "axes", "To which sides of the patient columns, rows and slices rise, as was said.");
    v.text(&P::orientation_reason, "orientation_reason", "Why the orientation is right as it is.");
    v.text(&P::burned_in_reason, "burned_in_reason", "Why pixels that may hold text may be used.");
    v.text(&P::same_patient_reason, "same_patient_reason", "Why all slices are of one patient.");
  }
};

/// Other content of the folder: skipped files, other series. It is not for case.json.
struct FolderFigures {
  std::int64_t files_count = 0;
  std::optional<std::int64_t> other_series_count, other_series_slices_count;  ///< beside the series that was chosen
  std::optional<std::int64_t> series_of_other_patients_count;                 ///< than the proposed one's, in a list
  std::int64_t localizers_count = 0, images_without_geometry_count = 0, skipped_not_dicom_count = 0,
               skipped_broken_count = 0, skipped_hidden_count = 0;
  std::optional<std::int64_t> skipped_links_count;
  std::optional<std::string> patient_said_by;
  template <class V>
  static void describe(V& v) {
    using P = FolderFigures;
    v.integer(&P::files_count, "files_count", Range{}, "Files.");
    v.integer(&P::other_series_count, "other_series_count", "Other series.");
    v.integer(&P::other_series_slices_count, "other_series_slices_count", "Their slices.");
    v.integer(&P::series_of_other_patients_count, "series_of_other_patients_count", "Than that of the proposed one.");
    v.integer(&P::localizers_count, "localizers_count", Range{}, "Localizers.");
    v.integer(&P::images_without_geometry_count, "images_without_geometry_count", Range{}, "Images without geometry.");
    v.integer(&P::skipped_not_dicom_count, "skipped_not_dicom_count", Range{}, "Files that are no DICOM.");
    v.integer(&P::skipped_broken_count, "skipped_broken_count", Range{}, "DICOM files that are broken.");
    v.integer(&P::skipped_hidden_count, "skipped_hidden_count", Range{}, "Hidden files.");
    v.integer(&P::skipped_links_count, "skipped_links_count", "Symbolic links.");
    v.text(&P::patient_said_by, "patient_said_by", "Attributes by which the series says who the patient is.");
  }
};
using FolderRest = Outcome<std::monostate, FolderFigures>;

struct ImportResult {
  grid::HuVolume volume;  ///< patient LPS; direction right-handed; slices ascend along the normal
  ImportFigures figures;  ///< of the series alone, as the warnings: equal series give equal ones
  Warnings warnings;
  FolderRest folder;
  Report report() const {
    return printed(figures_of(figures), warnings);
  }                          ///< figures and warnings as they are printed
  std::string input_sha256;  ///< hash_of_series_input of what was read
};

/// Reads one series of a folder (searched five levels deep), of a ZIP archive, or of one file, into HU.
///
/// Geometry and HU come from raw tags that this room reads and checks itself; slices are ordered by their positions
/// along the normal. The volume is the stored one, with exact HU, where the positions form an upright uniform stack:
/// steps within 1 um of uniform, and a drift across the stack below 20 um. Otherwise it is resampled from the true
/// positions onto an upright uniform grid: for gantry tilt, jitter, changing steps, and gaps where they are allowed.
/// Resampling works first within the slice (tilt), by Lagrange's polynomial through eight samples, and then along the
/// normal, by cubic Hermite interpolation with three-point tangents. Each is limited to the range of the four samples
/// around the place, so that it adds no over- or undershoot. The grid covers all slices; voxels that no slice covers
/// are air. The step is that of the stack's finest regular part, and the phase that of the longest regular run.
///
/// Padding (by its tag) becomes air, -1000 HU. The volume is int16 where slope and intercept of every slice are
/// integers and all values fit (resampled values are rounded to whole HU), else float32.
///
/// A ZIP archive is uncompressed in a bounded child into shared memory, and nothing of it to disk: this needs as much
/// memory as its images have bytes, in addition to the volume.
///
/// Slices that have one SeriesInstanceUID but not one study or frame of reference, or that are of acquisitions or
/// kernels within each other, are several series. What changes within a series is warned of or refused by the rules of
/// dicom/attributes.h; slices of several patients are refused (dicom/identity.h) unless a reason is given.
///
/// Where the path is a volume file (itk/volume_file.h) that file is read instead; volume_values must say what it holds.
///
/// Throws Error 81 where the pixels are said to hold text (BurnedInAnnotation) and no reason is given for using them;
/// 66 (folder missing or unreadable), 64 (several series and no choice: lists them), 65 (bad data: file
/// and tag), 70 (the decoding child died), Cancelled. File names in errors are relative to `folder_or_file`.
ImportResult import_series(const std::filesystem::path& folder_or_file, const ImportParams& params,
                           const Progress& progress = {});

/// SHA-256 of everything that the import of that series depends on (tags of geometry and HU, pixel bytes as stored),
/// without decoding. File names, order, folder, names, IDs, dates and UIDs do not count, nor do params except for the
/// choice of the series. `folder`, where given, becomes ImportResult::folder. Throws as import_series does up to the
/// decoding.
std::string hash_of_series_input(const std::filesystem::path& folder_or_file, const ImportParams& params,
                                 const Progress& progress = {}, FolderRest* folder = nullptr);

/// One series as it is to be read: where it is, and by which parameters it is chosen.
struct SeriesChoice {
  std::filesystem::path folder_or_file;
  ImportParams params;
};

/// Everything that a folder holds.
struct SeriesList {
  std::vector<SeriesSummary> series;  ///< the usable ones first
  FolderRest folder;
};

/// The series found, with the verdict that import_series would give for each if it were chosen. Nothing is decoded: of
/// a compressed stream only its own header, end and RLE counts are checked. Damage within the stream, and different
/// compressed files at one position, are found only by the import. Throws Error 66; 65 for an archive that cannot be
/// read.
SeriesList list_series(const std::filesystem::path& folder_or_file, const ImportParams& params = {},
                       const Progress& progress = {});

/// A table for a terminal, one line for each series, with the other content of the folder; and the same as JSON.
std::string list_text(const SeriesList& list);
std::string list_json(const SeriesList& list);

}  // namespace trephine::dicom
