// SPDX-License-Identifier: GPL-3.0-or-later
// A ball, labelled on grids of all kinds, comes back where it was.
#include <gtest/gtest.h>

#include <functional>

#include "base/error.h"
#include "base/parallel.h"
#include "report_of.h"
#include "segmentation/labels.h"
#include "segmentation_labels_writers.h"

namespace trephine {
namespace {

const Vec3 centre{14, -21, 33};
constexpr double radius = 18.03;  // no voxel's centre lies on it

Mat3 turned(double a, double b) {
  Mat3 m;
  m.column[0] = {std::cos(a), std::sin(a), 0};
  m.column[1] = {-std::sin(a) * std::cos(b), std::cos(a) * std::cos(b), std::sin(b)};
  m.column[2] = cross(m.column[0], m.column[1]);
  return m;
}

grid::Lattice around(Vec3 middle, Vec3 spacing, double half_mm, Mat3 direction = {}) {
  grid::Lattice l;
  l.spacing_mm = spacing;
  l.direction = direction;
  for (int a = 0; a < 3; ++a) l.size[a] = int(2 * half_mm / spacing[a]) + 1;
  l.origin_mm = middle;
  l.origin_mm =
      middle - (l.to_world_mm({(l.size[0] - 1) / 2.0, (l.size[1] - 1) / 2.0, (l.size[2] - 1) / 2.0}) - middle);
  return l;
}

TestLabels ball(const grid::Lattice& l, Vec3 at = centre, int value = 3) {
  TestLabels t{l, 1, {}};
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        t.values.push_back(norm(l.to_world_mm({double(i), double(j), double(k)}) - at) < radius ? value : 0);
  return t;
}

/// A body of 30 HU in air.
grid::HuVolume body(const grid::Lattice& l, double body_radius = 45) {
  grid::Grid<std::int16_t> v(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        v.at(i, j, k) = norm(l.to_world_mm({double(i), double(j), double(k)}) - centre) < body_radius ? 30 : -1000;
  return v;
}

struct Surface {
  double most = 0, mean = 0;
  Vec3 centroid;
};

/// Of the field's crossings, distances to the ball; the centroid of what is inside, by its share of each voxel.
Surface surface_of(const grid::Field& f, Vec3 at = centre) {
  Surface s;
  double n = 0, weight = 0;
  for (int k = 0; k < f.size[2]; ++k)
    for (int j = 0; j < f.size[1]; ++j)
      for (int i = 0; i < f.size[0]; ++i) {
        const int here[3] = {i, j, k};
        const double share = std::clamp(0.5 + f.at(i, j, k) / 0.8, 0.0, 1.0);
        s.centroid += f.to_world_mm({double(i), double(j), double(k)}) * share;
        weight += share;
        for (int a = 0; a < 3; ++a) {
          int q[3] = {here[0], here[1], here[2]};
          if (++q[a] >= f.size[a]) continue;
          const double u = f.at(i, j, k), v = f.at(q[0], q[1], q[2]);
          if ((u > 0) == (v > 0)) continue;
          Vec3 p{double(i), double(j), double(k)};
          p[a] += u / (u - v);
          const double off = norm(f.to_world_mm(p) - at) - radius;
          s.most = std::max(s.most, std::abs(off));
          s.mean += off;
          n += 1;
        }
      }
  s.mean /= n;
  s.centroid = s.centroid / weight;
  return s;
}

/// What the field's surface holds, counted on a raster of a sixth of a voxel.
double held_ml(const grid::Field& f) {
  std::size_t in = 0;
  for (int k = 0; k < 6 * (f.size[2] - 1); ++k)
    for (int j = 0; j < 6 * (f.size[1] - 1); ++j)
      for (int i = 0; i < 6 * (f.size[0] - 1); ++i) {
        double v = 0;
        for (int c = 0; c < 8; ++c) {
          const int at[3] = {i / 6 + (c & 1), j / 6 + (c >> 1 & 1), k / 6 + (c >> 2)};
          const double t[3] = {(i % 6 + 0.5) / 6, (j % 6 + 0.5) / 6, (k % 6 + 0.5) / 6};
          double w = 1;
          for (int a = 0; a < 3; ++a) w *= c >> a & 1 ? t[a] : 1 - t[a];
          v += w * f.at(at[0], at[1], at[2]);
        }
        in += v > 0;
      }
  return double(in) * f.voxel_volume_mm3() / 216 / 1000;
}

grid::Field taken(const grid::HuVolume& volume, const std::string& bytes, Report& report,
                  segmentation::LabelParams params = {}) {
  if (params.label.empty()) params.label = "3";
  return value_of(report, segmentation::label_field(volume, grid::decode_labels(bytes), params));
}

bool flag(const Report& r, const char* name) { return std::get<bool>(*r.find(name)); }

TEST(LabelField, OnTheVolumesOwnVoxels) {
  const grid::Lattice l = around(centre, {0.7, 0.7, 1.0}, 60);
  const grid::HuVolume volume = body(l);
  const TestLabels t = ball(l);
  NiftiStyle zip;
  zip.gzip = true;
  for (const std::string& bytes : {nrrd_bytes(t, {}), nrrd_bytes(t, {}, true), nifti_bytes(t, zip)}) {
    Report report;
    const grid::Field f = taken(volume, bytes, report);
    EXPECT_FALSE(flag(report, "resampled"));
    EXPECT_TRUE(report.warnings.empty());
    // No voxel changed sides.
    const grid::Box at = grid::place_in(f, l);
    std::size_t inside = 0, wanted = 0;
    for (int k = 0; k < f.size[2]; ++k)
      for (int j = 0; j < f.size[1]; ++j)
        for (int i = 0; i < f.size[0]; ++i) {
          const bool is = t.values[l.index(i + at.begin[0], j + at.begin[1], k + at.begin[2])] != 0;
          ASSERT_EQ(f.at(i, j, k) > 0, is);
          inside += is;
        }
    for (const int v : t.values) wanted += v != 0;
    EXPECT_EQ(inside, wanted);
    const Surface s = surface_of(f);
    EXPECT_LT(s.most, 0.5 * norm(l.spacing_mm));
    EXPECT_LT(std::abs(s.mean), 0.05);
    EXPECT_LT(norm(s.centroid - centre), 0.05);
  }
}

TEST(LabelField, FlippedAndSwappedAxesAreTheSameRaster) {
  const grid::Lattice l = around(centre, {0.8, 0.8, 1.2}, 60);
  grid::Lattice other = l;  // a part of it, x and z run backwards, y and z swapped
  const std::array<int, 3> begin{40, 30, 20}, count{70, 90, 60};
  other.size = {count[0], count[2], count[1]};
  other.spacing_mm = {0.8, 1.2, 0.8};
  other.direction.column = {Vec3{-1, 0, 0}, Vec3{0, 0, -1}, Vec3{0, 1, 0}};
  other.origin_mm = l.to_world_mm({double(begin[0] + count[0] - 1), double(begin[1]), double(begin[2] + count[2] - 1)});
  const grid::HuVolume volume = body(l);
  Report a, b;
  const grid::Field straight = taken(volume, nrrd_bytes(ball(l), {}), a);
  for (const Form form : {Form::sform, Form::qform}) {
    NiftiStyle s;
    s.form = form;
    const grid::Field flipped = taken(volume, nifti_bytes(ball(other), s), b);
    EXPECT_FALSE(flag(b, "resampled"));
    EXPECT_EQ(straight, flipped);
  }
}

TEST(LabelField, OtherGridsAreResampled) {
  const grid::Lattice l = around(centre, {0.6, 0.6, 1.0}, 55);
  const grid::HuVolume volume = body(l);
  const grid::Lattice grids[] = {around(centre + Vec3{0.3, 0.2, 0.1}, {0.6, 0.6, 1.0}, 30),  // off by half a voxel
                                 around(centre, {0.5, 0.5, 0.5}, 30, turned(0.4, 0.25)),     // oblique
                                 around(centre, {1.5, 1.5, 1.5}, 30),                        // as TotalSegmentator's
                                 around(centre + Vec3{1, 1, 1}, {0.45, 0.45, 3.0}, 33, turned(-0.2, 0.1))};
  for (const grid::Lattice& g : grids) {
    SCOPED_TRACE(to_text(g.spacing_mm.x) + " " + to_text(g.spacing_mm.z));
    for (const bool nifti : {false, true}) {
      Report report;
      const grid::Field f = taken(volume, nifti ? nifti_bytes(ball(g), {}) : nrrd_bytes(ball(g), {}), report);
      EXPECT_TRUE(flag(report, "resampled"));
      const Surface s = surface_of(f);
      // What the labels themselves are off by (half a diagonal of their voxels), hardly more.
      EXPECT_LT(s.most, 0.5 * norm(g.spacing_mm) + 0.1);
      EXPECT_LT(std::abs(s.mean), 0.2 * std::cbrt(g.voxel_volume_mm3()));
      EXPECT_LT(norm(s.centroid - centre), 0.05);
    }
  }
}

TEST(LabelField, ResamplingKeepsTheVolume) {
  // Two plates and a rod, thin as horns and slits are, on grids that are coarser, shifted, mirrored or turned.
  const auto shape = [](Vec3 p) {
    const Vec3 q = p - centre;
    const bool plate = std::abs(q.x) < 1.2 && std::abs(q.y) < 14 && std::abs(q.z) < 12;
    const bool slant = std::abs(q.x + 0.6 * q.y - 9) < 1.6 && std::abs(q.y) < 10 && std::abs(q.z) < 10;
    const bool rod = std::hypot(q.x + 10, q.z - 4) < 1.9 && std::abs(q.y) < 15;
    return plate || slant || rod;
  };
  const grid::Lattice l = around(centre, {0.94, 0.94, 2.0}, 60);
  const grid::HuVolume volume = body(l);
  grid::Lattice mirrored = around(centre + Vec3{0.4, -0.3, 0.8}, {0.94, 0.94, 2.0}, 30);
  mirrored.origin_mm.x += (mirrored.size[0] - 1) * mirrored.spacing_mm.x;
  mirrored.direction.column[0] = {-1, 0, 0};
  mirrored.origin_mm.y += (mirrored.size[1] - 1) * mirrored.spacing_mm.y;
  mirrored.direction.column[1] = {0, -1, 0};
  for (const grid::Lattice& g : {mirrored, around(centre, {1.88, 1.88, 2.0}, 30), around(centre, {0.5, 0.5, 0.6}, 30),
                                 around(centre, {1.5, 1.5, 1.5}, 30, turned(0.4, 0.25))}) {
    SCOPED_TRACE(to_text(g.spacing_mm.x) + " " + to_text(g.spacing_mm.z));
    TestLabels t{g, 1, {}};
    for (int k = 0; k < g.size[2]; ++k)
      for (int j = 0; j < g.size[1]; ++j)
        for (int i = 0; i < g.size[0]; ++i)
          t.values.push_back(shape(g.to_world_mm({double(i), double(j), double(k)})) ? 3 : 0);
    Report report;
    const grid::Field f = taken(volume, nifti_bytes(t, {}), report);
    EXPECT_TRUE(flag(report, "resampled"));
    const auto figure = [&](const char* name) { return std::get<double>(*report.find(name)); };
    EXPECT_NEAR(figure("volume_ml") / figure("label_ml"), 1, 0.005);
    EXPECT_NEAR(held_ml(f) / figure("label_ml"), 1, 0.02);
    EXPECT_NEAR(figure("volume_change_ratio"), figure("volume_ml") / figure("label_ml") - 1, 1e-9);
    EXPECT_TRUE(report.warnings.empty());
  }
  // A leaf of a tenth of a voxel, between the volume's: what is gone is said, with the figures.
  const grid::Lattice fine = around(centre, {0.1, 0.1, 0.5}, 8);
  TestLabels leaf{fine, 1, std::vector<int>(fine.count(), 0)};
  for (int k = 0; k < fine.size[2]; ++k)
    for (int j = 0; j < fine.size[1]; ++j) leaf.values[fine.index(fine.size[0] / 2, j, k)] = 3;
  for (int k = 0; k < 6; ++k)  // and a bead, so that something is left
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 20; ++i) leaf.values[fine.index(i, j, k)] = 3;
  Report report;
  taken(volume, nrrd_bytes(leaf, {}), report);
  EXPECT_GT(std::abs(std::get<double>(*report.find("volume_change_ratio"))), 0.02);
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_NE(report.warnings.back().find(" ml, in its file "), std::string::npos);
}

TEST(LabelField, WhereTheVolumeCutsTheLabel) {
  grid::Lattice l = around(centre, {0.8, 0.8, 1}, 55);
  l.size[2] = 56;  // ends at the ball's middle
  const grid::HuVolume volume = body(l);
  const grid::Lattice whole = around(centre, {0.8, 0.8, 1}, 55);
  for (const grid::Lattice& g : {whole, around(centre, {1.1, 1.1, 1.1}, 30)}) {
    Report report;
    const grid::Field f = taken(volume, nrrd_bytes(ball(g), {}), report);
    EXPECT_NEAR(std::get<double>(*report.find("outside_ratio")), 0.48, 0.04);
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_NE(report.warnings[0].find("outside of the volume"), std::string::npos);
    // It goes on up to the volume's last slice.
    EXPECT_EQ(grid::place_in(f, l).end[2], l.size[2]);
    const Vec3 q = f.to_index({centre.x, centre.y, l.to_world_mm({0, 0, l.size[2] - 1.0}).z});
    EXPECT_GT(f.at(int(std::lround(q.x)), int(std::lround(q.y)), f.size[2] - 1), 0);
  }
}

TEST(LabelField, AVoxelOnTheVolumesVeryEdge) {
  // The label's first voxels lie half a voxel outside of the volume's first ones: index -0.5, which rounds to -1.
  const grid::Lattice l = around(centre, {1, 1, 1}, 30);
  grid::Lattice g = l;
  g.origin_mm = l.origin_mm - Vec3{0.5, 0.5, 0.5};
  TestLabels t{g, 1, std::vector<int>(g.count(), 3)};
  Report report;
  const grid::Field f = taken(grid::Grid<std::int16_t>(l, 30), nrrd_bytes(t, {}), report);
  EXPECT_TRUE(flag(report, "resampled"));
  EXPECT_EQ(f.size, l.size);
}

std::string refused(const grid::HuVolume& volume, const std::string& bytes, segmentation::LabelParams params = {}) {
  Report report;
  try {
    taken(volume, bytes, report, params);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    return e.what();
  }
  return "taken";
}

TEST(LabelField, RefusesWhatLiesElsewhere) {
  const grid::Lattice l = around(centre, {1, 1, 1}, 50);
  const grid::HuVolume volume = body(l, 40);
  // Wholly outside.
  EXPECT_NE(refused(volume, nrrd_bytes(ball(around({300, 0, 0}, {1, 1, 1}, 25), {300, 0, 0}), {})).find("100 %"),
            std::string::npos);
  // RAS taken for LPS: it says so.
  grid::Lattice mirrored = around(centre, {1, 1, 1}, 25);
  const TestLabels right = ball(mirrored);
  TestLabels wrong = right;
  wrong.lattice.origin_mm.x = -wrong.lattice.origin_mm.x;
  wrong.lattice.origin_mm.y = -wrong.lattice.origin_mm.y;
  wrong.lattice.direction.column[0] = {-1, 0, 0};
  wrong.lattice.direction.column[1] = {0, -1, 0};
  EXPECT_NE(refused(volume, nifti_bytes(wrong, {})).find("negated"), std::string::npos);
  EXPECT_EQ(refused(volume, nifti_bytes(right, {})), "taken");
  // In air, within the volume.
  const Vec3 corner = centre + Vec3{30, 30, 30};
  const std::string air = nrrd_bytes(ball(around(corner, {1, 1, 1}, 19), corner), {});
  const grid::HuVolume small_body = body(around(centre, {1, 1, 1}, 60), 20);
  EXPECT_NE(refused(small_body, air).find("air"), std::string::npos);
  segmentation::LabelParams anyway;
  anyway.max_air_ratio = 1;
  EXPECT_EQ(refused(small_body, air, anyway), "taken");
  // Empty: a segment without a voxel.
  TestLabels none = right;
  std::fill(none.values.begin(), none.values.end(), 0);
  segmentation::LabelParams named;
  named.label = "brain";
  EXPECT_NE(refused(volume, nrrd_bytes(none, {"Segment0_ID:=s", "Segment0_Name:=brain"}), named).find("not one voxel"),
            std::string::npos);
}

TEST(LabelField, WarnsWhereItsGridCutsIt) {
  const grid::Lattice l = around(centre, {1, 1, 1}, 50);
  grid::Lattice cut = around(centre, {1, 1, 1}, 25);
  cut.size[0] = 26;
  Report report;
  taken(body(l),
        nrrd_bytes(ball(cut),
                   {"Segment0_ID:=s", "Segment0_Name:=a", "Segment0_LabelValue:=3", "Segment0_Extent:=0 50 0 50 0 50"}),
        report);
  ASSERT_EQ(report.warnings.size(), 2u);
  EXPECT_NE(report.warnings[0].find("cropped"), std::string::npos);
  EXPECT_NE(report.warnings[1].find("edge of its own grid"), std::string::npos);
}

TEST(LabelField, TheSameBitsWithOneThread) {
  const grid::HuVolume volume = body(around(centre, {1, 1, 1}, 50));
  for (const std::string& bytes : {nrrd_bytes(ball(around(centre, {1, 1, 1}, 25)), {}),
                                   nrrd_bytes(ball(around(centre, {0.9, 0.8, 1.3}, 25, turned(0.1, 0.2))), {})}) {
    Report many, one;
    const grid::Field a = taken(volume, bytes, many);
    set_thread_count(1);
    const grid::Field b = taken(volume, bytes, one);
    set_thread_count(0);
    EXPECT_EQ(a, b);
    EXPECT_EQ(many.figures, one.figures);
  }
}

// Smoothing takes a third of a rod of two voxels: its surface is moved between voxels until it holds what it held.
TEST(LabelField, ThinLabelsOnTheVolumesVoxelsKeepTheirVolume) {
  const grid::Lattice l = around(centre, {2.5, 2.5, 2.5}, 30);
  const grid::HuVolume volume = body(l);
  for (const int width : {2, 3}) {
    SCOPED_TRACE(width);
    TestLabels rod{l, 1, std::vector<int>(l.count(), 0)};
    for (int k = 4; k < l.size[2] - 4; ++k)
      for (int j = 0; j < width; ++j)
        for (int i = 0; i < width; ++i) rod.values[l.index(l.size[0] / 2 + i, l.size[1] / 2 + j, k)] = 3;
    Report report;
    const grid::Field f = taken(volume, nrrd_bytes(rod, {}), report);
    const auto figure = [&](const char* name) { return std::get<double>(*report.find(name)); };
    EXPECT_FALSE(flag(report, "resampled"));
    EXPECT_GT(figure("balanced_ratio"), 1);
    EXPECT_NEAR(figure("volume_ml") / figure("label_ml"), 1, 0.01);
    EXPECT_NEAR(held_ml(f) / figure("label_ml"), 1, 0.12);  // 0.65 without
    EXPECT_TRUE(report.warnings.empty());
    std::size_t inside = 0;
    for (const float v : f.voxels) inside += v > 0;
    EXPECT_EQ(inside, std::size_t(std::get<std::int64_t>(*report.find("label_voxels_count"))));
  }
}

}  // namespace
}  // namespace trephine
