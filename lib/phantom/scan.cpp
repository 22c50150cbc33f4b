// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/scan.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/degree.h"
#include "base/error.h"
#include "base/parallel.h"
#include "phantom/random.h"
#include "phantom/slice_image.h"

namespace trephine::phantom {
namespace {

constexpr double fwhm_per_sigma = 2.3548200450309493;

Vec3 turned(Vec3 v, Vec3 axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

/// Directions of rows, columns and table feed.
struct Axes {
  Vec3 row, column, feed;
};
Axes axes_of(const ScanParams& p) {
  Axes a;
  switch (p.plane) {
    case Plane::axial:
      a = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
      break;
    case Plane::sagittal:
      a = {{0, 1, 0}, {0, 0, -1}, {-1, 0, 0}};
      break;
    case Plane::coronal:
      a = {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
      break;
  }
  // The patient turns, the scanner does not: the images turn about the patient.
  const auto flip = [](Vec3 v, int axis) {
    return Vec3{axis == 0 ? v.x : -v.x, axis == 1 ? v.y : -v.y, axis == 2 ? v.z : -v.z};
  };
  const int about = p.position == Position::head_first_prone    ? 2
                    : p.position == Position::feet_first_supine ? 1
                    : p.position == Position::feet_first_prone  ? 0
                                                                : -1;
  for (Vec3* v : {&a.row, &a.column, &a.feed}) {
    if (about >= 0) *v = flip(*v, about);
    if (p.rotation_deg != std::array<double, 3>{0, 0, 0}) {
      *v = turned(*v, {1, 0, 0}, p.rotation_deg[0] * degree);
      *v = turned(*v, {0, 1, 0}, p.rotation_deg[1] * degree);
      *v = normalized(turned(*v, {0, 0, 1}, p.rotation_deg[2] * degree));
    }
  }
  if (p.tilt_deg != 0) a.column = normalized(turned(a.column, a.row, p.tilt_deg * degree));
  return a;
}

/// Head holder: a shell of carbon fibre on a cylinder along z, foam between it and the head.
double holder_hu(Vec3 p, bool prone, double width) {
  const double y = prone ? -p.y - 8 : p.y + 2, radius = prone ? 119 : 107;
  const double r = std::sqrt(p.x * p.x + y * y);
  const double upper_edge = 34 - y;
  const auto cover = [&](double f) { return std::min(1.0, std::max(0.0, 0.5 - f / width)); };
  const double foam = std::max({r - radius, upper_edge, 84 - r});
  const double shell = std::max(std::fabs(r - radius - 1.5) - 1.5, upper_edge);
  double hu = -1000;
  hu += (-945 - hu) * cover(foam);
  hu += (-180 - hu) * cover(shell);
  return hu;
}
/// Distance to the holder's edges (a lower bound).
double holder_clearance(Vec3 p, bool prone) {
  const double y = prone ? -p.y - 8 : p.y + 2, radius = prone ? 119 : 107;
  const double r = std::sqrt(p.x * p.x + y * y);
  return std::min({std::fabs(r - radius), std::fabs(r - radius - 3), std::fabs(34 - y), std::fabs(r - 84)});
}

/// Fills one slice with the average over each voxel. Blocks wholly within one tissue are found by the distance to its
/// edges.
class Exposure {
 public:
  Exposure(const Head& head, const ScanParams& params, const SlicePose& pose, SliceImage& out)
      : head_(head),
        pose_(pose),
        to_head_(itk::inverse(head_pose(params))),
        lies_otherwise_(has_pose(params)),
        out_(out),
        pixel_(pixel_spacing_mm(params)),
        thickness_(params.slice_thickness_mm),
        table_(params.table && !head.params().hard.couch && !head.params().hard.board),
        prone_(params.position == Position::head_first_prone || params.position == Position::feet_first_prone) {
    normal_ = normalized(cross(pose.row, pose.column));
    in_plane_ = std::max(1, static_cast<int>(std::ceil(pixel_ / params.subvoxel_mm - 1e-9)));
    across_ = std::max(1, static_cast<int>(std::ceil(thickness_ / params.subvoxel_mm - 1e-9)));
    width_ = 0.5 * (pixel_ / in_plane_ + thickness_ / across_);
  }

  void block(int i, int j, int ni, int nj) {
    const double hi = 0.5 * ni * pixel_, hj = 0.5 * nj * pixel_;
    const double radius = std::sqrt(hi * hi + hj * hj + 0.25 * thickness_ * thickness_);
    const Vec3 middle = at(i + 0.5 * (ni - 1), j + 0.5 * (nj - 1), 0);
    double clearance = 0;
    const double hu = hu_at(middle, clearance);
    if (clearance > radius) {
      for (int y = j; y < j + nj; ++y)
        for (int x = i; x < i + ni; ++x) out_.at(x, y) = static_cast<float>(hu);
    } else if (ni == 1 && nj == 1) {
      out_.at(i, j) = static_cast<float>(voxel(i, j));
    } else {
      const int li = (ni + 1) / 2, lj = (nj + 1) / 2;
      block(i, j, li, lj);
      if (ni > li) block(i + li, j, ni - li, lj);
      if (nj > lj) block(i, j + lj, li, nj - lj);
      if (ni > li && nj > lj) block(i + li, j + lj, ni - li, nj - lj);
    }
  }

 private:
  Vec3 at(double i, double j, double depth) const {
    return pose_.origin_mm + pose_.row * (i * pixel_) + pose_.column * (j * pixel_) + normal_ * depth;
  }
  double hu_at(Vec3 p, double& clearance) const {
    const Head::Sample s = head_.sample(lies_otherwise_ ? to_head_(p) : p, width_);
    clearance = s.clearance_mm;
    if (!table_ || s.air_share <= 0) return s.hu;
    clearance = std::min(clearance, holder_clearance(p, prone_) - 0.5 * width_);
    return s.hu + s.air_share * (holder_hu(p, prone_, width_) + 1000);
  }
  double voxel(int i, int j) const {
    double sum = 0, unused = 0;
    for (int c = 0; c < across_; ++c)
      for (int b = 0; b < in_plane_; ++b)
        for (int a = 0; a < in_plane_; ++a)
          sum += hu_at(at(i + (a + 0.5) / in_plane_ - 0.5, j + (b + 0.5) / in_plane_ - 0.5,
                          ((c + 0.5) / across_ - 0.5) * thickness_),
                       unused);
    return sum / (across_ * in_plane_ * in_plane_);
  }

  const Head& head_;
  const SlicePose& pose_;
  const itk::LinearMap to_head_;
  const bool lies_otherwise_;
  SliceImage& out_;
  double pixel_, thickness_, width_ = 0;
  bool table_, prone_;
  int in_plane_ = 1, across_ = 1;
  Vec3 normal_;
};

/// Marks, averaged over the slice's thickness in closed form and widened by the kernel.
void add_fiducials(SliceImage& image, const std::vector<Fiducial>& marks, const ScanParams& p, const SlicePose& pose) {
  const double pixel = pixel_spacing_mm(p), kernel = p.kernel_mm / fwhm_per_sigma;
  const Vec3 normal = normalized(cross(pose.row, pose.column));
  for (const Fiducial& f : marks) {
    const Vec3 d = f.centre_mm - pose.origin_mm;
    const double depth = dot(d, normal), half = 0.5 * p.slice_thickness_mm, s = f.sigma_mm * std::sqrt(2.0);
    const double across = f.sigma_mm * std::sqrt(1.5707963267948966) / p.slice_thickness_mm *
                          (std::erf((depth + half) / s) - std::erf((depth - half) / s));
    const double wide = std::sqrt(f.sigma_mm * f.sigma_mm + kernel * kernel), reach = 6 * wide / pixel;
    const double height = f.height_hu * across * (f.sigma_mm * f.sigma_mm) / (wide * wide);
    if (height < 1e-3) continue;
    const double ci = dot(d, pose.row) / pixel, cj = dot(d, pose.column) / pixel;
    for (int j = std::max(0, static_cast<int>(cj - reach)); j < std::min<double>(p.rows_count, cj + reach); ++j)
      for (int i = std::max(0, static_cast<int>(ci - reach)); i < std::min<double>(p.columns_count, ci + reach); ++i) {
        const double x = (i - ci) * pixel, y = (j - cj) * pixel;
        image.at(i, j) += static_cast<float>(height * std::exp(-(x * x + y * y) / (2 * wide * wide)));
      }
  }
}

}  // namespace

std::vector<Fiducial> fiducials_of(const ScanParams& params) {
  // Within a cube of half side 1: the left marker first, and no mirror image of it.
  static const Vec3 places[12] = {{1.0, 0.1, 0.2},   {-0.85, -0.55, -0.8}, {-0.7, 0.8, -0.35}, {0.35, -0.95, -0.6},
                                  {0.05, 0.9, 0.75}, {-0.9, -0.2, 0.85},   {0.75, 0.7, -0.75}, {0.0, -0.15, 0.0},
                                  {0.65, -0.6, 0.9}, {-0.25, -0.85, 0.4},  {0.1, 0.25, -0.95}, {-0.45, 0.35, 0.3}};
  std::vector<Fiducial> out;
  for (int i = 0; i < 12; ++i)
    out.push_back(
        {Vec3{params.centre_mm[0], params.centre_mm[1], params.centre_mm[2]} + places[i] * params.fiducial_spread_mm,
         params.fiducial_sigma_mm, params.fiducial_hu * (i == 0 ? 1.5 : 1.0)});
  return out;
}

double pixel_spacing_mm(const ScanParams& p) {
  return p.field_of_view_mm > 0 ? p.field_of_view_mm / p.columns_count : p.pixel_mm;
}

std::vector<SlicePose> slice_poses(const ScanParams& p) {
  const Axes a = axes_of(p);
  const double pixel = pixel_spacing_mm(p);
  const int half = p.slices_count / 2;
  std::vector<double> along(p.slices_count, 0.0);
  for (int k = 1; k < p.slices_count; ++k)
    along[k] = along[k - 1] + (p.upper_step_mm > 0 && k >= half ? p.upper_step_mm : p.slice_step_mm);
  const double middle = 0.5 * along.back();
  std::vector<SlicePose> poses;
  const Vec3 centre{p.centre_mm[0], p.centre_mm[1], p.centre_mm[2]};
  for (int k = 0; k < p.slices_count; ++k) {
    const double feed = along[k] - middle + p.jitter_mm * (p.jitter_mm > 0 ? uniform(77, 3, k) : 0.0);
    poses.push_back({centre + a.feed * feed - a.row * (0.5 * (p.columns_count - 1) * pixel) -
                         a.column * (0.5 * (p.rows_count - 1) * pixel),
                     a.row, a.column});
  }
  return poses;
}

itk::LinearMap head_pose(const ScanParams& p) {
  return itk::rigid_map({p.head_turn_deg[0], p.head_turn_deg[1], p.head_turn_deg[2]},
                        {p.head_shift_mm[0], p.head_shift_mm[1], p.head_shift_mm[2]}, {0, -10, 35});
}

bool has_pose(const ScanParams& p) {
  const std::array<double, 3> none{0, 0, 0};
  return p.head_turn_deg != none || p.head_shift_mm != none;
}

bool has_lattice(const ScanParams& p) {
  return !has_pose(p) && p.tilt_deg == 0 && p.jitter_mm == 0 &&
         (p.upper_step_mm == 0 || p.upper_step_mm == p.slice_step_mm);
}

grid::Lattice lattice_of(const Scan& s) {
  grid::Lattice l;
  const int n = static_cast<int>(s.slices.size());
  l.size = {s.columns, s.rows, n};
  l.origin_mm = s.slices.front().origin_mm;
  const Vec3 row = s.slices.front().row, column = s.slices.front().column, normal = cross(row, column);
  const double step = n > 1 ? dot(s.slices.back().origin_mm - s.slices.front().origin_mm, normal) / (n - 1) : 1;
  for (int k = 0; k < n; ++k)
    if (norm(s.slices[k].origin_mm - (l.origin_mm + normal * (step * k))) > 1e-6)
      throw Error(ExitCode::usage, "", "lattice", "the scan's slices are tilted or uneven: they are no lattice");
  l.spacing_mm = {s.pixel_mm, s.pixel_mm, std::fabs(step)};
  l.direction.column = {row, column, step < 0 ? -normal : normal};
  return l;
}

Scan scan(const Head& head, const ScanParams& params, const Progress& progress) {
  return scan(head, params, {params.kernel_mm, head.params().hard.sharpen_ratio}, progress);
}

Scan scan(const Head& head, const ScanParams& params, const Kernel& kernel, const Progress& progress) {
  Scan out;
  out.columns = params.columns_count, out.rows = params.rows_count;
  out.pixel_mm = pixel_spacing_mm(params);
  out.slices = slice_poses(params);
  out.padded = params.round_field;
  const std::size_t per_slice = static_cast<std::size_t>(out.columns) * out.rows;
  out.hu.resize(per_slice * out.slices.size());
  const bool clinical = head.params().level != Level::simple, hard = head.params().level == Level::hard;
  const std::vector<Fiducial> marks =
      params.contents == Contents::head ? std::vector<Fiducial>{} : fiducials_of(params);
  std::vector<Vec3> metal_mm = head.metal_mm();
  if (has_pose(params))
    for (Vec3& p : metal_mm) p = head_pose(params)(p);
  const double sigma_px = kernel.width_mm / fwhm_per_sigma / out.pixel_mm;
  const double first_sigma_px = params.kernel_mm / fwhm_per_sigma / out.pixel_mm;
  const double slices_in_one = params.slice_thickness_mm / params.slice_step_mm;
  std::atomic<int> done{0};

  parallel_for(0, params.slices_count, 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = static_cast<int>(from); k < to; ++k) {
      progress.check();
      const SlicePose& pose = out.slices[k];
      SliceImage image(out.columns, out.rows, -1000);
      if (params.contents != Contents::fiducials) {
        Exposure exposure(head, params, pose, image);
        constexpr int tile = 32;
        for (int j = 0; j < out.rows; j += tile)
          for (int i = 0; i < out.columns; i += tile)
            exposure.block(i, j, std::min(tile, out.columns - i), std::min(tile, out.rows - j));
        blur(image, sigma_px);
        if (hard) sharpen(image, sigma_px, kernel.sharpen_ratio);
        if (clinical) {
          add_cupping(image, pose, out.pixel_mm, params.cupping_hu);
          for (std::size_t m = 0; m < metal_mm.size(); ++m)
            add_streaks(image, pose, out.pixel_mm, metal_mm[m], params.streak_hu,
                        static_cast<std::uint64_t>(head.params().seed) + m);
        }
      }
      add_fiducials(image, marks, params, pose);
      const auto seed = static_cast<std::uint64_t>(head.params().seed);
      if (hard)
        add_shared_noise(image, first_sigma_px, sigma_px, kernel.sharpen_ratio, params.noise_hu, slices_in_one, seed,
                         k);
      else
        add_noise(image, sigma_px, params.noise_hu, seed, static_cast<std::uint64_t>(k));
      quantize(image, params.round_field, &out.hu[per_slice * k]);
      progress.report((++done) / static_cast<double>(params.slices_count));
    }
  });
  return out;
}

}  // namespace trephine::phantom
