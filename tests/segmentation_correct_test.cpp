// SPDX-License-Identifier: GPL-3.0-or-later
// A correction by hand: only what was painted changes, also of a segmentation that was made anew.
#include "segmentation/correct.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/error.h"
#include "report_of.h"

namespace trephine {
namespace {

grid::Lattice raster(std::array<int, 3> size, Vec3 origin, double spacing = 1) {
  grid::Lattice l;
  l.size = size;
  l.spacing_mm = {spacing, spacing, 1.5 * spacing};
  l.origin_mm = origin;
  l.direction.column = {Vec3{0.8, 0.6, 0}, Vec3{-0.6, 0.8, 0}, Vec3{0, 0, 1}};
  return l;
}

const grid::Lattice scan = raster({60, 50, 40}, {-30, 10, 200});
constexpr double radius = 17.03;  // no voxel lies on it

Vec3 middle() { return scan.to_world_mm({30, 25, 20}); }

/// HU above a threshold: 40 HU for each mm within the ball.
grid::Field ball(const grid::Lattice& l, double radius_mm) {
  grid::Field f(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        f.at(i, j, k) = float(40 * (radius_mm - norm(l.to_world_mm({double(i), double(j), double(k)}) - middle())));
  return f;
}

grid::Lattice part_of_scan(std::array<int, 3> begin, std::array<int, 3> end) {
  grid::Lattice l = scan;
  l.origin_mm = scan.to_world_mm({double(begin[0]), double(begin[1]), double(begin[2])});
  for (std::size_t a = 0; a < 3; ++a) l.size[a] = end[a] - begin[a];
  return l;
}

grid::LabelFile labels_of(const grid::Field& f, int value = 3) {
  grid::Mask m(static_cast<const grid::Lattice&>(f));
  for (std::size_t i = 0; i < m.voxels.size(); ++i) m.voxels[i] = f.voxels[i] > 0 ? std::uint8_t(value) : 0;
  grid::LabelFile out;
  out.lattice = m;
  out.samples = m;
  out.format = "NRRD";
  return out;
}

/// Paints the scan's voxels [begin, end) of a map that may cover a part of the scan.
void paint(grid::LabelFile& map, std::array<int, 3> begin, std::array<int, 3> end, int value) {
  grid::Mask& m = std::get<grid::Mask>(map.samples);
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j)
      for (int i = begin[0]; i < end[0]; ++i) {
        const Vec3 q = m.to_index(scan.to_world_mm({double(i), double(j), double(k)}));
        ASSERT_TRUE(m.contains(int(std::lround(q.x)), int(std::lround(q.y)), int(std::lround(q.z))));
        m.at(int(std::lround(q.x)), int(std::lround(q.y)), int(std::lround(q.z))) = std::uint8_t(value);
      }
}

constexpr std::array<int, 3> bump_begin{44, 23, 18}, bump_end{50, 28, 22};  // on the ball's side, 3 voxels out of it
constexpr std::array<int, 3> pit_begin{28, 23, 8}, pit_end{33, 27, 14};     // into its lower side

bool within(std::array<int, 3> at, std::array<int, 3> begin, std::array<int, 3> end, int margin = 0) {
  for (std::size_t a = 0; a < 3; ++a)
    if (at[a] < begin[a] - margin || at[a] >= end[a] + margin) return false;
  return true;
}

grid::LabelFile painted_correction(const grid::Field& field) {
  const grid::LabelFile before = labels_of(field);
  grid::LabelFile after = before;
  paint(after, bump_begin, bump_end, 3);
  paint(after, pit_begin, pit_end, 0);
  return segmentation::correction_between(before, after, "3", "3").value;
}

std::int64_t count(const Report& r, const char* name) { return std::get<std::int64_t>(*r.find(name)); }
double number(const Report& r, const char* name) { return std::get<double>(*r.find(name)); }

TEST(Correct, OnlyWhatWasPaintedChanges) {
  const grid::Field field = ball(scan, radius);
  const grid::LabelFile correction = grid::decode_labels(grid::encode_labels(painted_correction(field)));
  Report report;
  const grid::Field out = value_of(report, segmentation::corrected(field, scan, correction));
  ASSERT_EQ(out.size, field.size);
  std::int64_t plus = 0, minus = 0, kept = 0;
  for (int k = 0; k < scan.size[2]; ++k)
    for (int j = 0; j < scan.size[1]; ++j)
      for (int i = 0; i < scan.size[0]; ++i) {
        const bool was = field.at(i, j, k) > 0, bump = within({i, j, k}, bump_begin, bump_end),
                   pit = within({i, j, k}, pit_begin, pit_end), is = (was || bump) && !pit;
        ASSERT_EQ(out.at(i, j, k) > 0, is) << i << " " << j << " " << k;
        ASSERT_NE(out.at(i, j, k), 0);
        plus += is && !was;
        minus += was && !is;
        if (within({i, j, k}, bump_begin, bump_end, 4) || within({i, j, k}, pit_begin, pit_end, 4)) continue;
        ASSERT_EQ(out.at(i, j, k), field.at(i, j, k)) << i << " " << j << " " << k;
        ++kept;
      }
  EXPECT_GT(kept, std::int64_t(scan.count()) * 9 / 10);
  EXPECT_EQ(count(report, "added_voxels_count"), plus);
  EXPECT_EQ(count(report, "removed_voxels_count"), minus);
  EXPECT_GT(plus, 20);
  EXPECT_GT(minus, 20);
  EXPECT_NEAR(number(report, "added_ml"), double(plus) * 1.5 / 1000, 1e-12);
  EXPECT_EQ(number(report, "already_ratio"), 0);
  EXPECT_FALSE(std::get<bool>(*report.find("resampled")));
  EXPECT_TRUE(report.warnings.empty());
  // Beside the surface what is new changes as much from voxel to voxel as what was there: up to 40 HU.
  float most = 0;
  for (std::size_t i = 0; i < out.voxels.size(); ++i)
    if (out.voxels[i] != field.voxels[i]) most = std::max(most, std::abs(out.voxels[i]));
  EXPECT_GT(most, 15);
  EXPECT_LT(most, 200);
}

TEST(Correct, SurvivesAnotherSegmentation) {
  const grid::LabelFile correction = painted_correction(ball(scan, radius));
  const grid::Field other = ball(scan, 16.2);  // another threshold
  Report report;
  const grid::Field out = value_of(report, segmentation::corrected(other, scan, correction));
  for (int k = 0; k < scan.size[2]; ++k)
    for (int j = 0; j < scan.size[1]; ++j)
      for (int i = 0; i < scan.size[0]; ++i) {
        // The difference, not the painted shape: voxels that were inside before painting are no part of it.
        const bool was_17 = radius - norm(scan.to_world_mm({double(i), double(j), double(k)}) - middle()) > 0;
        const bool plus = within({i, j, k}, bump_begin, bump_end) && !was_17,
                   minus = within({i, j, k}, pit_begin, pit_end) && was_17;
        ASSERT_EQ(out.at(i, j, k) > 0, (other.at(i, j, k) > 0 || plus) && !minus);
      }
  EXPECT_GT(number(report, "already_ratio"), 0);  // a part of the pit's rim is outside already
  // Applied again it changes nothing, and says so.
  Report again;
  EXPECT_EQ(value_of(again, segmentation::corrected(out, scan, correction)), out);
  EXPECT_EQ(number(again, "already_ratio"), 1);
  EXPECT_EQ(again.warnings.size(), 1u);
}

TEST(Correct, FieldsGrowToWhatWasAdded) {
  // As segmentations are: cropped to the shape and three voxels around it.
  const grid::Field all = ball(scan, radius);
  const grid::Lattice part = part_of_scan({10, 5, 6}, {48, 45, 34});
  const grid::Field field = ball(part, radius);
  const grid::LabelFile before = labels_of(field);
  grid::LabelFile after = labels_of(all);  // an editor saves the whole scan's voxels
  paint(after, {44, 23, 18}, {57, 27, 22}, 3);
  Report report;
  const grid::LabelFile correction = value_of(report, segmentation::correction_between(before, after, "3", ""));
  EXPECT_EQ(count(report, "removed_voxels_count"), 0);
  Report applied;
  const grid::Field out = value_of(applied, segmentation::corrected(field, scan, correction));
  EXPECT_GT(out.size[0], field.size[0]);
  const grid::Box place = grid::place_in(out, scan);
  for (int k = place.begin[2]; k < place.end[2]; ++k)
    for (int j = place.begin[1]; j < place.end[1]; ++j)
      for (int i = place.begin[0]; i < place.end[0]; ++i)
        ASSERT_EQ(out.at(i - place.begin[0], j - place.begin[1], k - place.begin[2]) > 0,
                  all.at(i, j, k) > 0 || within({i, j, k}, {44, 23, 18}, {57, 27, 22}));
  EXPECT_EQ(count(applied, "added_voxels_count"), count(report, "added_voxels_count"));
}

TEST(Correct, OtherVoxelsTakeTheNearest) {
  const grid::LabelFile correction = painted_correction(ball(scan, radius));
  const grid::Lattice coarse = raster({38, 32, 26}, scan.origin_mm, 1.6);
  const grid::Field field = ball(coarse, radius);
  Report report;
  const grid::Field out = value_of(report, segmentation::corrected(field, coarse, correction));
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_TRUE(std::get<bool>(*report.find("resampled")));
  // Of the bump, what lay outside of the ball: sampled by a few dozen voxels.
  std::int64_t outside = 0;
  const grid::Field fine = ball(scan, radius);
  for (int k = bump_begin[2]; k < bump_end[2]; ++k)
    for (int j = bump_begin[1]; j < bump_end[1]; ++j)
      for (int i = bump_begin[0]; i < bump_end[0]; ++i) outside += fine.at(i, j, k) <= 0;
  const double painted_ml = double(outside) * 1.5 / 1000;
  EXPECT_GT(number(report, "added_ml"), 0.6 * painted_ml);
  EXPECT_LT(number(report, "added_ml"), 1.5 * painted_ml);
  const Vec3 bump = scan.to_world_mm({48, 25, 20}), q = coarse.to_index(bump);
  EXPECT_LT(field.at(int(std::lround(q.x)), int(std::lround(q.y)), int(std::lround(q.z))), 0);
  EXPECT_GT(out.at(int(std::lround(q.x)), int(std::lround(q.y)), int(std::lround(q.z))), 0);
}

std::string refused(const std::function<void()>& f, int code = 65) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(int(e.code()), code);
    return e.field() + ": " + e.what();
  }
  return "";
}

TEST(Correct, WhatIsNoCorrectionIsRefused) {
  const grid::Field field = ball(scan, radius);
  const grid::LabelFile before = labels_of(field);
  EXPECT_EQ(refused([&] { segmentation::correction_between(before, before, "3", "3"); }),
            "after: nothing of the label is different");
  EXPECT_EQ(refused([&] { segmentation::correction_between(before, before, "4", "3"); }).substr(0, 8), "before: ");
  EXPECT_EQ(refused([&] {
              segmentation::correction_between(before, labels_of(ball(scan, radius), 5), "3", "4");
            }).substr(0, 7),
            "after: ");
  grid::LabelFile moved = before;
  moved.lattice.origin_mm.x += 0.4;
  std::get<grid::Mask>(moved.samples).origin_mm.x += 0.4;
  EXPECT_NE(
      refused([&] { segmentation::correction_between(before, moved, "3", "3"); }).find("do not lie on those of before"),
      std::string::npos);
  EXPECT_NE(refused([&] { segmentation::corrected(field, scan, before); }).find("is no correction"), std::string::npos);
  grid::LabelFile far = painted_correction(field);
  far.lattice.origin_mm.x += 500;
  std::get<grid::Mask>(far.samples).origin_mm.x += 500;
  EXPECT_NE(
      refused([&] { segmentation::corrected(field, scan, far); }).find("no voxel of the correction lies in the scan"),
      std::string::npos);
}

TEST(Correct, AnotherOrderOfAxesIsTheSameRaster) {
  const grid::Field field = ball(scan, radius);
  const grid::LabelFile before = labels_of(field);
  grid::LabelFile after = before;
  paint(after, bump_begin, bump_end, 3);
  // The painted map with its first axis reversed.
  const grid::Mask& m = std::get<grid::Mask>(after.samples);
  grid::Lattice l = m;
  l.origin_mm = m.to_world_mm({m.size[0] - 1.0, 0, 0});
  l.direction.column[0] = -l.direction.column[0];
  grid::Mask flipped(l);
  for (int k = 0; k < m.size[2]; ++k)
    for (int j = 0; j < m.size[1]; ++j)
      for (int i = 0; i < m.size[0]; ++i) flipped.at(m.size[0] - 1 - i, j, k) = m.at(i, j, k);
  grid::LabelFile other = after;
  other.lattice = l;
  other.samples = flipped;
  const auto one = segmentation::correction_between(before, after, "3", "3");
  const auto two = segmentation::correction_between(before, other, "3", "3");
  EXPECT_EQ(std::get<grid::Mask>(one.value.samples), std::get<grid::Mask>(two.value.samples));
  EXPECT_GT(two.result.added_voxels_count, 0u);
}

}  // namespace
}  // namespace trephine
