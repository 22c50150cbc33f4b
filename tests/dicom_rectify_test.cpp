// SPDX-License-Identifier: GPL-3.0-or-later
// Gantry tilt from phantom to surface: marks where they are, the skull as good as from an untilted scan, and the
// plastic skull that was really scanned with and without tilt.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "dicom/catalogue.h"
#include "dicom/hu.h"
#include "dicom/import.h"
#include "meshing/contour.h"
#include "metrics/deviation.h"
#include "phantom/phantom.h"
#include "scratch_folder.h"
#include "segmentation/segment.h"
#include "surface/point_to_mesh.h"

namespace trephine {
namespace {

dicom::ImportResult scanned(const phantom::ScanParams& p) {
  const ScratchFolder folder;
  const phantom::Head head{phantom::HeadParams{}};
  phantom::SeriesParams raw;
  raw.encoding = phantom::Encoding::none;
  phantom::write_series(folder.path(), phantom::scan(head, p), p, raw, "tilt");
  return dicom::import_series(folder.path(), {});
}

double number(const Report& r, const char* name) { return std::get<double>(*r.find(name)); }

void expect_marks(double tilt_deg) {
  phantom::ScanParams p;
  p.contents = phantom::Contents::fiducials;
  p.columns_count = p.rows_count = 160;
  p.field_of_view_mm = 200;
  p.slices_count = 100;
  p.slice_step_mm = p.slice_thickness_mm = 2;
  p.noise_hu = 0;
  p.tilt_deg = tilt_deg;
  const dicom::ImportResult r = scanned(p);
  EXPECT_NEAR(std::abs(number(r.report(), "tilt_deg")), std::abs(tilt_deg), 0.01);
  const auto& g = std::get<grid::Grid<std::int16_t>>(r.volume);
  for (const phantom::Fiducial& mark : phantom::fiducials_of(p)) {
    Vec3 sum;
    double weight = 0;
    const Vec3 middle = g.to_index(mark.centre_mm);
    const double reach = 4.5 * mark.sigma_mm;
    const auto from = [&](int axis) { return std::max(0, int(middle[axis] - reach / g.spacing_mm[axis] - 20)); };
    const auto to = [&](int axis) {
      return std::min(g.size[axis], int(middle[axis] + reach / g.spacing_mm[axis] + 20));
    };
    for (int k = from(2); k < to(2); ++k)
      for (int j = from(1); j < to(1); ++j)
        for (int i = from(0); i < to(0); ++i) {
          const Vec3 d = g.to_world_mm({double(i), double(j), double(k)}) - mark.centre_mm;
          if (norm(d) > reach) continue;
          sum += d * (g.at(i, j, k) + 1000.0);
          weight += g.at(i, j, k) + 1000.0;
        }
    EXPECT_LT(norm(sum / weight), 0.1) << "tilt " << tilt_deg;
  }
}

/// RMS of the skull against the analytic one, where a scan of any tilt has seen it.
double skull_rms(double tilt_deg, int matrix, double step_mm) {
  phantom::ScanParams p;
  p.columns_count = p.rows_count = matrix;
  p.field_of_view_mm = 240;
  p.slice_step_mm = p.slice_thickness_mm = step_mm;
  p.slices_count = static_cast<int>(130 / step_mm);
  p.tilt_deg = tilt_deg;
  const dicom::ImportResult r = scanned(p);
  segmentation::SegmentParams bone;
  bone.lower_hu = 226;
  bone.seed_lower_hu = 400;
  bone.edge = segmentation::SegmentEdge::half_maximum;
  bone.components = segmentation::SegmentComponents::largest;
  bone.fill = segmentation::SegmentFill::cavities;
  bone.fill_close_mm = 2;
  bone.fill_max_ml = 100;
  const surface::TriMesh mesh = meshing::contour(segmentation::segment(r.volume, {}, bone).value, {}).value;
  const phantom::Head head{phantom::HeadParams{}};
  const auto seen = [](Vec3 at) { return at.z >= 26 && at.z <= 58; };  // by every tilt; above the base's thin plates
  const surface::TriMesh truth =
      phantom::truth_mesh(head, phantom::Anatomy::skull, surface::Bounds{{-120, -130, 20}, {120, 110, 64}}, 2);
  metrics::DeviationParams few;
  few.sample_count = 20000;
  const metrics::Deviation d = metrics::measure_deviation_to_truth(
      mesh, [&](Vec3 at) { return head.signed_distance_mm(phantom::Anatomy::skull, at); }, truth, few, seen);
  std::printf("tilt %+5.1f: skull RMS %.4f mm, p99 %.3f mm, bias %+.3f mm\n", tilt_deg, d.both.rms_mm, d.both.p99_mm,
              d.both.bias_mm);
  return d.both.rms_mm;
}

TEST(LongRectifyPhantom, MarksAndSkull) {
  expect_marks(18.5);
  const double upright = skull_rms(0, 240, 1.5), tilted = skull_rms(18.5, 240, 1.5);
  EXPECT_LT(tilted, 1.1 * upright);
}

TEST(LongRectifyPhantom, EveryTilt) {
  for (const double tilt : {0.0, 10.0, -10.0, 18.5, -18.5, 25.0, -25.0}) expect_marks(tilt);
  const double upright = skull_rms(0, 320, 1);
  for (const double tilt : {-10.0, 10.0, -18.5, 18.5, -25.0, 25.0})
    EXPECT_LT(skull_rms(tilt, 320, 1), 1.1 * upright) << tilt;
}

std::filesystem::path data(const std::string& name) {
  const char *own = std::getenv("TREPHINE_DATA"), *home = std::getenv("HOME");
  return std::filesystem::path(own ? own : std::string(home ? home : "") + "/.cache/trephine-data") / name;
}

/// As readers do that know no tilt: the slices stacked square, the slanted step taken for the spacing.
grid::HuVolume stacked_square(const std::filesystem::path& folder) {
  dicom::Catalogue catalogue = dicom::scan(folder, dicom::ModalityPolicy::ct, {});
  const dicom::Series& s = dicom::choose(catalogue, {});
  const dicom::StackGeometry g = dicom::analyse_stack(s.stack, dicom::GapPolicy::refuse, 8);
  const auto slice = [&](std::size_t k) { return static_cast<std::size_t>(g.levels[k].front()); };
  grid::Lattice l;
  l.size = {s.stack.columns, s.stack.rows, static_cast<int>(g.levels.size())};
  l.direction.column = {s.stack.u, s.stack.v, s.stack.normal()};
  const Vec3 first = s.stack.positions_mm[slice(0)];
  l.origin_mm = first;
  l.spacing_mm = {s.stack.dx_mm, s.stack.dy_mm, norm(s.stack.positions_mm[slice(1)] - first)};
  grid::Grid<std::int16_t> volume(l);
  std::vector<dicom::FrameRef> frames;
  for (std::size_t k = 0; k < g.levels.size(); ++k) frames.push_back(s.slices[slice(k)]);
  dicom::HuMapper<std::int16_t> mapper;
  dicom::HuCounts counts;
  dicom::read_frames(frames, [&](std::size_t k, const std::uint8_t* stored) {
    mapper.apply(dicom::hu_rule(*frames[k].header, frames[k].header->frames[0], -1024, 1e6), stored,
                 std::size_t(l.size[0]) * std::size_t(l.size[1]), volume.voxels.data() + volume.index(0, 0, int(k)),
                 counts);
  });
  return volume;
}

surface::TriMesh plastic_skull(const grid::HuVolume& volume) {
  segmentation::SegmentParams p;
  p.lower_hu = 500;
  p.edge = segmentation::SegmentEdge::half_maximum;
  p.components = segmentation::SegmentComponents::largest;
  return meshing::contour(segmentation::segment(volume, {}, p).value, {}).value;
}

struct Motion {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  Vec3 operator()(Vec3 p) const {
    const Eigen::Vector3d q = rotation * Eigen::Vector3d(p.x, p.y, p.z) + shift;
    return {q.x(), q.y(), q.z()};
  }
};

/// The distances that the nearest `share` of the points have to the surface, ascending.
std::vector<double> nearest_share(std::vector<double> distances, double share) {
  std::sort(distances.begin(), distances.end());
  distances.resize(static_cast<std::size_t>(share * static_cast<double>(distances.size())));
  return distances;
}

/// Trimmed iterated closest points (Chetverikov et al. 2002), rotation by Kabsch: the motion that carries the points
/// onto the surface.
Motion registered(const std::vector<Vec3>& points, const surface::PointToMesh& surface, Motion m, double share,
                  int rounds) {
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::pair<double, std::size_t>> order;
    std::vector<Vec3> moved, target;
    for (const Vec3& p : points) {
      moved.push_back(m(p));
      target.push_back(surface.closest_mm(moved.back()));
      order.emplace_back(norm(moved.back() - target.back()), order.size());
    }
    std::sort(order.begin(), order.end());
    order.resize(static_cast<std::size_t>(share * static_cast<double>(order.size())));
    Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = a;
    const auto eigen = [](Vec3 v) { return Eigen::Vector3d(v.x, v.y, v.z); };
    for (const auto& [d, i] : order) a += eigen(moved[i]), b += eigen(target[i]);
    a /= static_cast<double>(order.size());
    b /= static_cast<double>(order.size());
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
    for (const auto& [d, i] : order) h += (eigen(moved[i]) - a) * (eigen(target[i]) - b).transpose();
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(h, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d sign(1, 1, (svd.matrixV() * svd.matrixU().transpose()).determinant());
    const Eigen::Matrix3d turn = svd.matrixV() * sign.asDiagonal() * svd.matrixU().transpose();
    m.shift = turn * (m.shift - a) + b;
    m.rotation = turn * m.rotation;
  }
  return m;
}

struct Fit {
  double rms_mm, median_mm, p90_mm;
};

/// How far the tilted scan's skull is from the untilted one's after the best rigid motion.
Fit fit(const grid::HuVolume& tilted, const surface::TriMesh& reference) {
  constexpr double share = 0.8;  // the scans do not cover the same part
  const surface::TriMesh mesh = plastic_skull(tilted);
  const std::vector<Vec3> coarse = metrics::points_on_surface(mesh, 2000),
                          fine = metrics::points_on_surface(mesh, 20000);
  const surface::PointToMesh surface(reference);
  Vec3 a, b;
  for (const Vec3& p : coarse) a += p / 2000;
  for (const Vec3& p : metrics::points_on_surface(reference, 4000)) b += p / 4000;
  Motion start;
  start.shift = Eigen::Vector3d(b.x - a.x, b.y - a.y, b.z - a.z);
  const Motion m = registered(coarse, surface, start, share, 80);
  std::vector<Vec3> moved;
  for (const Vec3& p : fine) moved.push_back(m(p));
  const auto d = nearest_share(surface.distances_mm(moved), share);
  double square = 0;
  for (const double v : d) square += v * v;
  return {std::sqrt(square / static_cast<double>(d.size())), d[d.size() / 2], d[d.size() * 9 / 10]};
}

TEST(RectifyRealScan, TiltedPlasticSkullLiesOnItsUntiltedTwin) {
  const auto tilted = data("phantom_tilt_Philips"), upright = data("phantom_untilted_Philips");
  if (!std::filesystem::exists(tilted) || !std::filesystem::exists(upright))
    GTEST_SKIP() << "no real data at " << tilted;
  const surface::TriMesh reference = plastic_skull(dicom::import_series(upright, {}).volume);
  const Fit with = fit(dicom::import_series(tilted, {}).volume, reference),
            without = fit(stacked_square(tilted), reference);
  std::printf("rectified: RMS %.3f mm, median %.3f, p90 %.3f; stacked square: RMS %.3f, median %.3f, p90 %.3f\n",
              with.rms_mm, with.median_mm, with.p90_mm, without.rms_mm, without.median_mm, without.p90_mm);
  EXPECT_LT(with.rms_mm, 0.5);
  EXPECT_GT(without.rms_mm, 3 * with.rms_mm);
}

}  // namespace
}  // namespace trephine
