// SPDX-License-Identifier: GPL-3.0-or-later
// A transfer function as an editor changes it, its file, and the histogram beneath it.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "base/error.h"
#include "cast/transfer_edit.h"
#include "cast_phantoms.h"
#include "scratch_folder.h"
#include "voxel/transfer_points.h"

namespace trephine::casting {
namespace {

voxel::TransferFunction preset(const char* name) { return voxel::transfer_from_text(name, "--transfer"); }

std::vector<double> hu_of(const voxel::TransferFunction& f) {
  std::vector<double> all;
  for (const voxel::TransferPoint& p : f.points) all.push_back(p.hu);
  return all;
}

void expect_same(const voxel::TransferFunction& a, const voxel::TransferFunction& b) {
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t n = 0; n < a.points.size(); ++n) {
    EXPECT_EQ(a.points[n].hu, b.points[n].hu);
    EXPECT_EQ(a.points[n].opacity, b.points[n].opacity);
    EXPECT_EQ(a.points[n].colour_rgb, b.points[n].colour_rgb);
    EXPECT_EQ(a.points[n].stiffness_n_per_mm, b.points[n].stiffness_n_per_mm);
  }
  EXPECT_EQ(a.touched_from_opacity, b.touched_from_opacity);
}

std::string refusal_of(const std::filesystem::path& file, ExitCode code) {
  try {
    cast::read_transfer_file(file);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), code);
    EXPECT_EQ(e.file(), file.string());
    return e.field() + " " + e.what();
  }
  return "";
}

}  // namespace

TEST(TransferEdit, APointIsHeldByItsNeighbours) {
  const voxel::TransferFunction bone = preset("bone");  // 150, 300, 1200
  EXPECT_EQ(hu_of(cast::with_moved(bone, 1, 420.4, 0.6)), (std::vector<double>{150, 420, 1200}));
  EXPECT_EQ(cast::with_moved(bone, 1, 420.4, 0.6).points[1].opacity, 0.6);
  EXPECT_EQ(hu_of(cast::with_moved(bone, 1, 5000, 2)), (std::vector<double>{150, 1200, 1200}));
  EXPECT_EQ(cast::with_moved(bone, 1, 5000, 2).points[1].opacity, 1);
  EXPECT_EQ(hu_of(cast::with_moved(bone, 0, 800, 0.7)), (std::vector<double>{300, 300, 1200}));
  EXPECT_EQ(cast::with_moved(bone, 0, 800, 0.7).points[0].opacity, 0) << "air would be seen";
  // A third point does not come to a step.
  const voxel::TransferFunction step = cast::with_moved(bone, 1, 5000, 1);
  EXPECT_EQ(hu_of(cast::with_moved(step, 0, 5000, 0)), (std::vector<double>{1199, 1200, 1200}));
  EXPECT_EQ(hu_of(cast::with_moved(bone, 2, 9000, 1)), (std::vector<double>{150, 300, 3071}));
}

TEST(TransferEdit, PointsComeAndGo) {
  const voxel::TransferFunction bone = preset("bone");
  const auto added = cast::with_added(bone, 225.2, 0.1);
  ASSERT_TRUE(added);
  EXPECT_EQ(added->point, 1u);
  EXPECT_EQ(hu_of(added->function), (std::vector<double>{150, 225, 300, 1200}));
  EXPECT_EQ(added->function.points[1].opacity, 0.1);
  EXPECT_EQ(added->function.points[1].colour_rgb, voxel::at_hu(bone, 225).colour_rgb);
  expect_same(cast::with_removed(added->function, 1), bone);
  const auto before = cast::with_added(bone, -700, 0.8);
  ASSERT_TRUE(before);
  EXPECT_EQ(before->function.points[0].opacity, 0) << "air would be seen";
  EXPECT_EQ(cast::with_removed(bone, 0).points[0].opacity, 0);
  EXPECT_EQ(cast::with_removed(cast::with_removed(bone, 0), 0).points.size(), 2u);
  const auto step = cast::with_added(bone, 300, 0.2);
  ASSERT_TRUE(step);
  EXPECT_FALSE(cast::with_added(step->function, 300, 0.2)) << "three at one place";
  voxel::TransferFunction full = bone;
  for (int n = 0; full.points.size() < voxel::max_transfer_points; ++n)
    full = cast::with_added(full, 400 + n, 0.99)->function;
  EXPECT_FALSE(cast::with_added(full, 2000, 0.5));
  // With stiffness: the added point has that of its place.
  voxel::TransferFunction felt = bone;
  for (std::size_t n = 0; n < 3; ++n) felt.points[n].stiffness_n_per_mm = double(n + 1);
  EXPECT_NEAR(cast::with_added(felt, 225, 0.5)->function.points[1].stiffness_n_per_mm, 1.5, 1e-12);
}

// Whatever a user does, what remains is a function that can be seen by, and that its file holds to the last bit.
TEST(TransferEdit, AnythingThatIsDoneLeavesAFunctionThatItsFileKeeps) {
  ScratchFolder folder;
  std::mt19937_64 rng(7);
  const auto some = [&](double low, double high) { return low + (high - low) * double(rng() >> 11) * 0x1p-53; };
  voxel::TransferFunction f = preset("vessels");
  std::size_t most = 0, least = 99;
  for (int n = 0; n < 4000; ++n) {
    const std::size_t point = rng() % f.points.size();
    const double hu = some(-1300, 3400), opacity = some(-0.2, 1.2);
    const bool grows = n / 500 % 2 == 0;
    switch (rng() % 8) {
      case 0:
        f = cast::with_removed(f, point);
        break;
      case 1:
      case 2:
        if (!grows)
          f = cast::with_removed(f, point);
        else if (const auto added = cast::with_added(f, hu, opacity))
          f = added->function;
        break;
      case 3:
        f = cast::with_colour(f, point, {some(-0.1, 1.1), some(0, 1), some(0, 1)});
        break;
      default:
        f = cast::with_moved(f, point, hu, opacity);
    }
    ASSERT_EQ(voxel::fault_of_points(f.points), "") << "after step " << n;
    most = std::max(most, f.points.size());
    least = std::min(least, f.points.size());
    if (n % 40 == 0) {
      const auto file = folder.write("a.yaml", cast::transfer_file_text(f));
      expect_same(cast::transfer_of(file.string(), "--transfer"), f);
    }
  }
  EXPECT_GT(most, 12u);
  EXPECT_LT(least, 5u);
}

TEST(TransferEdit, WhatIsNoSuchFileIsRefused) {
  ScratchFolder folder;
  const std::string good = cast::transfer_file_text(preset("bone"));
  EXPECT_EQ(refusal_of(folder.write("good.yaml", good), ExitCode::ok), "");
  expect_same(cast::read_transfer_file(folder.write("preset.yaml", R"({"preset": "skin"})")), preset("skin"));
  // Two ranges are no shape that is touched, and may be seen.
  const std::string two =
      R"({"points": [{"hu": 0, "opacity": 0, "colour_rgb": [1, 1, 1]}, {"hu": 10, "opacity": 1, "colour_rgb": [1, 1, 1]},
      {"hu": 20, "opacity": 0, "colour_rgb": [1, 1, 1]}, {"hu": 30, "opacity": 1, "colour_rgb": [1, 1, 1]}]})";
  EXPECT_EQ(cast::read_transfer_file(folder.write("two.yaml", two)).points.size(), 4u);
  EXPECT_NE(refusal_of(folder.path() / "none.yaml", ExitCode::no_input), "");
  EXPECT_NE(refusal_of(folder.write("block.yaml", "points:\n  - {hu: 1}\n"), ExitCode::bad_input), "");
  EXPECT_NE(refusal_of(folder.write("both.yaml", R"({"preset": "skin", )" + good.substr(1)), ExitCode::bad_input), "");
  EXPECT_NE(refusal_of(folder.write("no.yaml", R"({"preset": "skins"})"), ExitCode::bad_input), "");
  EXPECT_NE(refusal_of(folder.write("one.yaml", R"({"points": []})"), ExitCode::bad_input).find("points: 0"),
            std::string::npos);
}

TEST(TransferEdit, TheHistogramCountsEachVoxelOnce) {
  const grid::Grid<std::int16_t> v = ball(lattice(40, 0.9), 12, 150);
  const cast::HuHistogram h(v);
  std::vector<std::uint64_t> counts(cast::HuHistogram::bins, 0);
  for (const std::int16_t hu : v.voxels) ++counts[std::size_t(hu + 1024) / 16];
  EXPECT_EQ(h.counts, counts);
  EXPECT_EQ(h.height(0), 1) << "air is most of it";
  EXPECT_GT(h.height(100), 0);
  EXPECT_LT(h.height(100), 0.9);
  EXPECT_EQ(h.height(cast::HuHistogram::bins - 1), 0);
  grid::Grid<std::int16_t> beyond = v;
  std::fill(beyond.voxels.begin(), beyond.voxels.end(), std::int16_t(-30000));
  beyond.voxels[0] = 32000;
  EXPECT_EQ(cast::HuHistogram(beyond).counts.front(), beyond.count() - 1);
  EXPECT_EQ(cast::HuHistogram(beyond).counts.back(), 1u);
}

// By another function no voxel is read again, and the same bricks are left out.
TEST(TransferEdit, BricksFollowTheFunction) {
  const grid::Grid<std::int16_t> v = ball(lattice(45, 0.9), 9, 120);
  const cast::CastTable bone({ramp(300, 500)}), skin({ramp(-600, -300)});
  cast::CastBricks bricks(v, bone);
  const cast::CastBricks before = bricks, other(v, skin);
  EXPECT_NE(before.clear, other.clear);
  bricks.look(skin);
  EXPECT_EQ(bricks.clear, other.clear);
  bricks.look(bone);
  EXPECT_EQ(bricks.clear, before.clear);
}

}  // namespace trephine::casting
