// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "grid/grid.h"
#include "itk/transform.h"
#include "phantom/head.h"

namespace trephine::phantom {

enum class Plane { axial, sagittal, coronal };
enum class Position { head_first_supine, head_first_prone, feet_first_supine, feet_first_prone };
enum class Contents { head, head_with_fiducials, fiducials };

/// Parameters of the scanner: which planes it samples, and how.
struct ScanParams {
  int columns_count = 512, rows_count = 512, slices_count = 192;
  double pixel_mm = 0.47, field_of_view_mm = 0;
  double slice_step_mm = 1.0, upper_step_mm = 0, slice_thickness_mm = 1.0, jitter_mm = 0;
  double subvoxel_mm = 0.5;
  std::array<double, 3> centre_mm{0, -10, 42};
  double tilt_deg = 0;
  Plane plane = Plane::axial;
  std::array<double, 3> rotation_deg{0, 0, 0};
  std::array<double, 3> head_turn_deg{0, 0, 0}, head_shift_mm{0, 0, 0};
  Position position = Position::head_first_supine;
  double kernel_mm = 1.0, noise_hu = 12, cupping_hu = 15, streak_hu = 150;
  bool table = true, round_field = false;
  Contents contents = Contents::head;
  double fiducial_sigma_mm = 3, fiducial_spread_mm = 60, fiducial_hu = 900;

  template <class V>
  static void describe(V& v) {
    using P = ScanParams;
    v.integer(&P::columns_count, "columns_count", Range{8, 2048}, "Pixels in a row.");
    v.integer(&P::rows_count, "rows_count", Range{8, 2048}, "Rows of a slice.");
    v.integer(&P::slices_count, "slices_count", Range{1, 4096}, "Slices.");
    v.number(&P::pixel_mm, "pixel_mm", Range{0.05, 10}, "Distance of pixels in a slice.");
    v.number(&P::field_of_view_mm, "field_of_view_mm", Range{0, 2000},
             "Width of a row; where it is not 0, it sets the distance of the pixels.");
    v.number(&P::slice_step_mm, "slice_step_mm", Range{0.05, 20}, "Table feed from slice to slice.");
    v.number(&P::upper_step_mm, "upper_step_mm", Range{0, 20},
             "Table feed in the second half of the slices; 0: the same.");
    v.number(&P::slice_thickness_mm, "slice_thickness_mm", Range{0.05, 20}, "Thickness over which a slice averages.");
    v.number(&P::subvoxel_mm, "subvoxel_mm", Range{0.1, 20},
             "A voxel with an edge in it is the average over pieces of at most this size, each with its edges as a "
             "ramp. Larger ones take less time and show edges less exactly.")
        .is_later();
    v.number(&P::jitter_mm, "jitter_mm", Range{0, 5},
             "Each slice lies off its place by up to this much along the feed; its position in the file says so.");
    v.numbers(&P::centre_mm, "centre_mm", Range{-500, 500},
              "Centre of the scanned block: left, back and up from the midpoint between the ear canals.");
    v.number(&P::tilt_deg, "tilt_deg", Range{-45, 45},
             "Gantry tilt: slices lean about their rows, while the table moves straight on.");
    v.choice(&P::plane, "plane", {{"axial", Plane::axial}, {"sagittal", Plane::sagittal}, {"coronal", Plane::coronal}},
             "Plane of the slices.");
    v.numbers(&P::rotation_deg, "rotation_deg", Range{-180, 180}, "Oblique slices: turned about x, then y, then z.");
    v.numbers(
         &P::head_turn_deg, "head_turn_deg", Range{-180, 180},
         "How the head or spine lies in the scanner, as on another day: turned about x, then y, then z through its "
         "middle. The truth keeps the body's own frame, and says how it lies.")
        .is_later();
    v.numbers(&P::head_shift_mm, "head_shift_mm", Range{-200, 200}, "And shifted by that.").is_later();
    v.choice(&P::position, "position",
             {{"head_first_supine", Position::head_first_supine},
              {"head_first_prone", Position::head_first_prone},
              {"feet_first_supine", Position::feet_first_supine},
              {"feet_first_prone", Position::feet_first_prone}},
             "How the patient lies.");
    v.number(&P::kernel_mm, "kernel_mm", Range{0, 5},
             "Full width at half maximum of the reconstruction kernel, Gaussian, in the slice.");
    v.number(&P::noise_hu, "noise_hu", Range{0, 500}, "Standard deviation of the noise, correlated by the kernel.");
    v.number(&P::cupping_hu, "cupping_hu", Range{0, 200},
             "Depth of the dip in HU that beam hardening causes in the middle of the head; clinical level only.");
    v.number(&P::streak_hu, "streak_hu", Range{0, 3000},
             "Height of the streaks beside metal: a head's filling at clinical level, a spine's screws.");
    v.flag(&P::table, "table", "Head holder and its foam under the head.");
    v.flag(&P::round_field, "round_field", "Pixels outside the largest circle that fits into the slice are padding.");
    v.choice(&P::contents, "contents",
             {{"head", Contents::head},
              {"head_with_fiducials", Contents::head_with_fiducials},
              {"fiducials", Contents::fiducials}},
             "What is scanned: the head, the head with twelve Gaussian marks added to it, or the marks alone in air.");
    v.number(&P::fiducial_sigma_mm, "fiducial_sigma_mm", Range{0.2, 50}, "Standard deviation of a mark.");
    v.number(&P::fiducial_spread_mm, "fiducial_spread_mm", Range{1, 500},
             "Distance of the outermost marks from the block's middle, along an axis.");
    v.number(&P::fiducial_hu, "fiducial_hu", Range{1, 3000},
             "Height of a mark above what it lies in; the left one is higher by half.");
  }
};

/// One slice's plane: centre of its first pixel, direction of rows (i grows) and of columns (j grows), LPS.
struct SlicePose {
  Vec3 origin_mm, row, column;
};

/// What the scanner made. Slices in the order of acquisition; not a Grid, as slices may be tilted or uneven.
struct Scan {
  int columns = 0, rows = 0;
  double pixel_mm = 1;
  std::vector<SlicePose> slices;
  std::vector<std::int16_t> hu;  ///< i fastest, then j, then slice; padding_hu where padding
  bool padded = false;

  Vec3 position_mm(double i, double j, int k) const {
    const SlicePose& s = slices[k];
    return s.origin_mm + s.row * (i * pixel_mm) + s.column * (j * pixel_mm);
  }
};
constexpr std::int16_t padding_hu = -2000;

struct Fiducial {
  Vec3 centre_mm;
  double sigma_mm, height_hu;
};
/// Twelve marks around `centre_mm`, no two alike in position; the first is the left marker (x grows to the left),
/// higher than the others and without a counterpart on the right.
std::vector<Fiducial> fiducials_of(const ScanParams& params);

/// Of a slice's rows and columns.
double pixel_spacing_mm(const ScanParams& params);

/// The planes alone, in the scanner's frame.
std::vector<SlicePose> slice_poses(const ScanParams& params);

/// From a place of the head, in its own frame, to the same place in the scanner's.
itk::LinearMap head_pose(const ScanParams& params);
bool has_pose(const ScanParams& params);  ///< the head lies otherwise than in its own frame

/// The lattice of the scan where it is one: no tilt, jitter or change of step. Throws Error 64 elsewhere.
grid::Lattice lattice_of(const Scan& scan);
/// Whether it is one, in the head's own frame.
bool has_lattice(const ScanParams& params);

/// A reconstruction kernel: a Gaussian in the slice, and edge enhancement (HardParams).
struct Kernel {
  double width_mm = 1.0, sharpen_ratio = 0;
};

/// Scans the head. Tissue is averaged over each voxel (pieces of at most subvoxel_mm, edges ramped within them), then
/// blurred by the kernel, then artefacts, marks and noise are added. Reproducible: the same bytes for the same
/// parameters, whatever the thread count. Throws Cancelled.
Scan scan(const Head& head, const ScanParams& params, const Progress& progress = {});

/// The same scan reconstructed with another kernel than `params.kernel_mm`: the same rays with the same noise, as far
/// as the kernel lets it through. Level hard.
Scan scan(const Head& head, const ScanParams& params, const Kernel& kernel, const Progress& progress = {});

}  // namespace trephine::phantom
