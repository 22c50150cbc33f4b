// SPDX-License-Identifier: GPL-3.0-or-later
// What a person does to a shape beside painting: snakes, cuts and smoothing, and the list in which they are kept.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/error.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/result.h"
#include "base/temporary_folder.h"
#include "base/write_file.h"
#include "grid/labels.h"
#include "segmentation/correct.h"
#include "segmentation/edit_list.h"
#include "segmentation/hand_edits.h"

namespace trephine::segmentation {
namespace {

constexpr Vec3 middle{10, -5, 20}, blob{19, -5, 20};

grid::Lattice raster() {
  grid::Lattice l;
  l.size = {60, 50, 40};
  l.spacing_mm = {0.8, 0.8, 1};
  l.origin_mm = {-14, -25, 0};
  return l;
}

template <class F>
void for_all(const grid::Lattice& l, F&& f) {
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) f(l.index(i, j, k), l.to_world_mm({double(i), double(j), double(k)}));
}

/// Brain of 30 HU with a ball of fluid (6 mm, 5 HU) and a second one (4 mm) that overlaps it.
grid::HuVolume scan() {
  grid::Grid<std::int16_t> v(raster(), 30);
  for_all(v, [&](std::size_t n, Vec3 at) {
    if (norm(at - middle) < 6 || norm(at - blob) < 4) v.voxels[n] = 5;
  });
  return v;
}

/// Of which the segmentation found the first alone.
grid::Field found(double radius_mm = 6) {
  grid::Field f(raster());
  for_all(f, [&](std::size_t n, Vec3 at) { f.voxels[n] = float(radius_mm - norm(at - middle)); });
  return f;
}

SnakeEdit snake() {
  SnakeEdit edit;
  edit.seed_mm = {blob.x + 1, blob.y, blob.z};
  edit.seed_radius_mm = 1.5;
  edit.within_mm = 8;
  edit.lower_hu = -30;
  edit.upper_hu = 18;
  edit.smoothing_sigma_mm = 0;
  edit.steps_count = 30;
  return edit;
}

double volume_ml(const grid::Field& f) {
  double n = 0;
  for (const float v : f.voxels) n += v > 0;
  return n * f.voxel_volume_mm3() / 1000;
}

bool inside(const grid::Field& f, Vec3 at) {
  const Vec3 q = f.to_index(at);
  return f.at(int(std::lround(q.x)), int(std::lround(q.y)), int(std::lround(q.z))) > 0;
}

TEST(HandEdits, ASnakeAddsWhatHasItsHuWithinItsBall) {
  const grid::HuVolume volume = scan();
  const grid::Field before = found();
  const auto grown = edited(before, volume, snake());
  const grid::Field& after = grown.value;
  EXPECT_FALSE(inside(before, {21.5, -5, 20}));
  EXPECT_TRUE(inside(after, {21.5, -5, 20})) << "the second ball is filled";
  EXPECT_FALSE(inside(after, {24.5, -5, 20})) << "and nothing of the brain beside it";
  const double ball = 4.0 / 3 * M_PI * 64 / 1000;
  EXPECT_GT(grown.result.added_ml, 0.6 * ball);
  EXPECT_LT(grown.result.added_ml, 1.05 * ball);
  EXPECT_TRUE(grown.warnings.empty());
  SnakeEdit back = snake();
  back.removes = true;
  const grid::Field without = edited(after, volume, back).value;
  EXPECT_FALSE(inside(without, {21.5, -5, 20}));
  EXPECT_TRUE(inside(without, {6, -5, 20}));
}

TEST(HandEdits, ASnakeStepByStepIsTheSnakeAtOnce) {
  const grid::HuVolume volume = scan();
  EditSnake slow(volume, snake());
  std::vector<double> ml;
  for (int step = 0; step < 30; ++step) {
    slow.advance();
    ml.push_back(slow.volume_ml());
  }
  EXPECT_EQ(slow.steps(), 30);
  EXPECT_GT(ml[8], ml[0]) << "it is seen to grow";
  EXPECT_LT(slow.change_mm(), 0.05) << "and to come to rest";
  set_thread_count(1);
  EditSnake alone(volume, snake());
  for (int step = 0; step < 30; ++step) alone.advance();
  set_thread_count(0);
  EXPECT_EQ(alone.surface().voxels, slow.surface().voxels);
  // While it still moves: a step more or less would be seen.
  SnakeEdit early = snake();
  early.steps_count = 4;
  EditSnake four(volume, early);
  for (int step = 0; step < 4; ++step) four.advance();
  const grid::Field field = found();
  const grid::Field once = edited(field, volume, early).value;
  const grid::Field same = corrected(field, grid::lattice_of(volume), correction_of(four.mask())).value;
  EXPECT_EQ(once.voxels, same.voxels);
}

TEST(HandEdits, ASnakeThatLeaksIsHeldByItsBall) {
  SnakeEdit edit = snake();
  edit.upper_hu = 200;
  edit.within_mm = 5;
  EditSnake leaking(scan(), edit);
  for (int step = 0; step < 60; ++step) leaking.advance();
  const double ball = 4.0 / 3 * M_PI * 125 / 1000;
  EXPECT_NEAR(leaking.volume_ml(), ball, 0.1 * ball);
}

TEST(HandEdits, ASnakeIsRefusedWhereItCannotBegin) {
  std::string said;
  const auto code = [&said](SnakeEdit edit) {
    try {
      EditSnake made(scan(), edit);
      for (int step = 0; step < 100; ++step) made.advance();
    } catch (const Error& e) {
      said = e.what();
      return int(e.code());
    }
    return 0;
  };
  EXPECT_EQ(code(snake()), 0);
  SnakeEdit edit = snake();
  edit.seed_mm = {10, 8, 20};  // in the brain
  EXPECT_EQ(code(edit), 80);
  EXPECT_NE(said.find("30 to 30 HU"), std::string::npos) << said;
  edit.seed_mm = {500, 0, 0};
  EXPECT_EQ(code(edit), 80);
  edit = snake();
  edit.curvature = 10;  // holds nothing of that size
  EXPECT_EQ(code(edit), 80);
}

TEST(HandEdits, ACutTakesOneSideWithinItsBall) {
  const grid::Field before = found();
  CutEdit edit;
  edit.point_mm = {13, -5, 20};
  edit.normal = {1, 0, 0};
  const auto cut = edited(before, scan(), edit);
  const grid::Field& after = cut.value;
  EXPECT_FALSE(inside(after, {14.6, -5, 20}));
  EXPECT_TRUE(inside(after, {11.4, -5, 20}));
  const double h = 3, cap = M_PI * h * h * (18 - h) / 3 / 1000;
  EXPECT_NEAR(cut.result.removed_ml, cap, 0.2 * cap);
  EXPECT_EQ(cut.result.added_ml, 0);
  edit.normal = {-1, 0, 0};
  edit.within_mm = 4;
  const grid::Field other = edited(before, scan(), edit).value;
  EXPECT_TRUE(inside(other, {14.6, -5, 20})) << "the other side";
  EXPECT_FALSE(inside(other, {11, -5, 20}));
  EXPECT_TRUE(inside(other, {5.5, -5, 20})) << "beyond the ball nothing goes";
  edit.point_mm = {-10, -5, 20};
  const auto none = edited(before, scan(), edit);
  EXPECT_EQ(none.value.voxels, before.voxels);
  EXPECT_EQ(none.warnings.size(), 1u) << "and it is told";
}

TEST(HandEdits, SmoothingTakesASpikeAndNothingBeyondTheBall) {
  grid::Field spiky = found();
  for_all(spiky, [&](std::size_t n, Vec3 at) {
    if (at.x > 10 && at.x < 22 && std::abs(at.y + 5) < 0.5 && std::abs(at.z - 20) < 0.6) spiky.voxels[n] = 1;
    if (at.x < 10 && at.x > 0 && std::abs(at.y + 5) < 0.5 && std::abs(at.z - 20) < 0.6) spiky.voxels[n] = 1;
  });
  SmoothEdit edit;
  edit.point_mm = {18, -5, 20};
  edit.within_mm = 5;
  const grid::Field after = edited(spiky, scan(), edit).value;
  EXPECT_TRUE(inside(spiky, {20, -5.2, 20}));
  EXPECT_FALSE(inside(after, {20, -5.2, 20}));
  EXPECT_TRUE(inside(after, {1.6, -5.2, 20})) << "the other spike lies beyond the ball";
  EXPECT_NEAR(volume_ml(after), volume_ml(spiky), 0.04) << "the spike, and no more";
}

class EditLists : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
  EditList list() {
    EditList out;
    out.edits.emplace_back("snake", AnyParams::make(snake()));
    CutEdit cut;
    cut.point_mm = {13, -5, 20};
    cut.normal = {-1, 0, 0};
    cut.within_mm = 100;
    out.edits.emplace_back("cut", AnyParams::make(cut));
    return out;
  }
  std::string refused(const std::string& text) {
    const auto file = folder_.path() / "list.json";
    std::ofstream(file) << text;
    try {
      read_edit_list(file);
    } catch (const Error& e) {
      EXPECT_EQ(int(e.code()), 65);
      return e.line("");
    }
    return "";
  }
};

TEST_F(EditLists, KeepTheOrderAndTheirValues) {
  const auto file = folder_.path() / "list.json";
  write_file(file, encode_edit_list(list()));
  EXPECT_TRUE(is_edit_list(file));
  const EditList read = read_edit_list(file);
  EXPECT_EQ(encode_edit_list(read), encode_edit_list(list()));
  const auto made = apply_edits(found(), scan(), read, folder_.path());
  const grid::Field& both = made.value;
  EXPECT_FALSE(inside(both, {6, -5, 20})) << "cut";
  EXPECT_TRUE(inside(both, {21.5, -5, 20})) << "added before";
  EXPECT_EQ(made.result.edits_count, 2u);
  EditList turned = read;
  std::swap(turned.edits[0], turned.edits[1]);
  EXPECT_NE(encode_edit_list(turned), encode_edit_list(read));
}

TEST_F(EditLists, APatchIsThatOfTheListOrRefused) {
  grid::Mask painted(raster());
  const Vec3 at = painted.to_index(blob);
  painted.at(int(at.x), int(at.y), int(at.z)) = 1;
  painted.at(int(at.x) + 1, int(at.y), int(at.z)) = 1;
  const std::string bytes = grid::encode_labels(correction_of(painted));
  write_file(folder_.path() / "a.nrrd", bytes);
  PatchEdit patch{"a.nrrd", sha256_of_bytes(bytes)};
  EditList one;
  one.edits.emplace_back("patch", AnyParams::make(patch));
  const auto by_list = apply_edits(found(), scan(), one, folder_.path());
  EXPECT_EQ(by_list.value.voxels,
            corrected(found(), raster(), grid::read_labels(folder_.path() / "a.nrrd")).value.voxels);
  EXPECT_GT(by_list.result.added_ml, 0);
  for (const PatchEdit& bad : {PatchEdit{"a.nrrd", std::string(64, '0')}, PatchEdit{"../a.nrrd", patch.sha256},
                               PatchEdit{".a", patch.sha256}}) {
    EditList wrong;
    wrong.edits.emplace_back("patch", AnyParams::make(bad));
    try {
      apply_edits(found(), scan(), wrong, folder_.path());
      ADD_FAILURE() << bad.file;
    } catch (const Error& e) {
      EXPECT_EQ(int(e.code()), 65) << bad.file;
    }
  }
}

TEST_F(EditLists, SayWhatIsWrongInThem) {
  EXPECT_NE(refused("[]"), "");
  EXPECT_NE(refused(R"({"trephine_edits": 2, "edits": []})"), "");
  EXPECT_NE(refused(R"({"trephine_edits": 1, "edits": [{"melt": {}}]})").find("no such step"), std::string::npos);
  EXPECT_NE(refused(R"({"trephine_edits": 1, "edits": [{"snake": {}}]})").find("seed_mm"), std::string::npos);
  EXPECT_NE(refused(R"({"trephine_edits": 1, "edits": [{"snake": {"seed_mm": [0, 0, 0], "upper_hu": -50}}]})")
                .find("lower_hu"),
            std::string::npos);
  EXPECT_NE(refused(R"({"trephine_edits": 1, "edits": [{"cut": {"point_mm": [0, 0, 0], "normal": [0, 0, 0]}}]})")
                .find("direction"),
            std::string::npos);
  EXPECT_EQ(refused(R"({"trephine_edits": 1, "edits": [{"cut": {"point_mm": [0, 0, 0], "normal": [0, 0, 1]}}]})"), "");
}

}  // namespace
}  // namespace trephine::segmentation
