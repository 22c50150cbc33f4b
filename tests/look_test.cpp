// SPDX-License-Identifier: GPL-3.0-or-later
// How a head lies in a scan, by its picture; and where the scan cuts it.
#include "look/look.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

#include "base/error.h"
#include "base/parallel.h"
#include "grid/axes.h"
#include "phantom_heads.h"

namespace trephine {
namespace {

using Volume = grid::Grid<std::int16_t>;
using look::Seen;

/// A hard head on its table, on coarse voxels.
const Volume& head() {
  static const Volume v = [] {
    phantom::ScanParams how = phantom_heads::scan_of(150, 100, 10, 200, 270);
    how.subvoxel_mm = 1.8;
    return phantom::volume_of(phantom::scan(phantom_heads::head_of(phantom::Level::hard, 7), how));
  }();
  return v;
}

/// The head with some of its axes reversed.
Volume reversed(bool x, bool y, bool z) {
  Volume out(head());
  for (int k = 0; k < out.size[2]; ++k)
    for (int j = 0; j < out.size[1]; ++j)
      for (int i = 0; i < out.size[0]; ++i)
        out.at(i, j, k) =
            head().at(x ? out.size[0] - 1 - i : i, y ? out.size[1] - 1 - j : j, z ? out.size[2] - 1 - k : k);
  return out;
}

TEST(Look, AHeadThatLiesAsSaidIsNotDoubted) {
  const look::ScanLook seen = look::look_at(head(), "HFS");
  EXPECT_EQ(seen.head, Seen::as_said);
  EXPECT_TRUE(seen.sayings.empty()) << seen.sayings[0];
  EXPECT_NO_THROW(look::require_orientation(seen, ""));
}

TEST(Look, TurnedAndMirroredHeadsAreSeenAndTheRemediesWork) {
  struct Case {
    bool x, y, z;
    const char *mirrored, *turned;
  };
  for (const Case& c : {Case{false, false, true, "LPI", "RPI"}, Case{true, false, true, "LPI", "RPI"},
                        Case{false, true, false, "LAS", "RAS"}, Case{true, true, false, "LAS", "RAS"},
                        Case{false, true, true, "RAI", "LAI"}}) {
    const Volume stored = reversed(c.x, c.y, c.z);
    const look::ScanLook seen = look::look_at(stored, "");
    ASSERT_EQ(seen.head, Seen::otherwise) << c.mirrored;
    EXPECT_EQ(seen.axes_if_mirrored, c.mirrored);
    EXPECT_EQ(seen.axes_if_turned, c.turned);
    std::string what;
    try {
      look::require_orientation(seen, "");
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      what = e.what();
    }
    for (const char* key : {"--axes ", "--orientation-reason "}) EXPECT_NE(what.find(key), std::string::npos) << what;
    EXPECT_NO_THROW(look::require_orientation(seen, "looked at"));
    for (const std::string& axes : {seen.axes_if_mirrored, seen.axes_if_turned})
      EXPECT_EQ(look::look_at(grid::with_axes(stored, axes), "").head, Seen::as_said) << axes;
  }
}

TEST(Look, AHeadOnItsSideIsSeenAndTheRemediesWork) {
  Volume mirrored(head()), turned(head());
  std::swap(mirrored.size[0], mirrored.size[1]);
  turned.size = mirrored.size;
  for (int k = 0; k < mirrored.size[2]; ++k)
    for (int j = 0; j < mirrored.size[1]; ++j)
      for (int i = 0; i < mirrored.size[0]; ++i) {
        mirrored.at(i, j, k) = head().at(j, i, k);
        turned.at(i, j, k) = head().at(j, head().size[1] - 1 - i, k);
      }
  for (const bool is_mirrored : {true, false}) {
    const Volume& stored = is_mirrored ? mirrored : turned;
    const look::ScanLook seen = look::look_at(stored, "");
    ASSERT_EQ(seen.head, Seen::otherwise);
    for (const std::string& axes : {seen.axes_if_mirrored, seen.axes_if_turned})
      EXPECT_EQ(look::look_at(grid::with_axes(stored, axes), "").head, Seen::as_said) << axes;
    // The columns of the one rise to the back and its rows to the left; of the other the columns rise to the front.
    EXPECT_EQ(is_mirrored ? seen.axes_if_mirrored : seen.axes_if_turned, is_mirrored ? "PLS" : "ALS");
  }
}

// Nothing in a head says which side is left.
TEST(Look, AHeadMirroredFromLeftToRightCannotBeTold) {
  EXPECT_EQ(look::look_at(reversed(true, false, false), "").head, Seen::as_said);
}

TEST(Look, SidesThatTheFieldCutsAreSaid) {
  grid::Box box = grid::whole_box(head());
  box.end[0] -= 60;
  const look::ScanLook seen = look::look_at(grid::crop(head(), box), "HFS");
  ASSERT_EQ(seen.sayings.size(), 1u);
  EXPECT_NE(seen.sayings[0].find("cuts the body"), std::string::npos) << seen.sayings[0];
  EXPECT_NE(seen.sayings[0].find("left"), std::string::npos) << seen.sayings[0];
  EXPECT_TRUE(
      std::any_of(seen.ends.begin(), seen.ends.end(), [](const std::string& e) { return e.rfind("left ", 0) == 0; }));
}

TEST(Look, SlicesThatWereNotMeasuredAreSaid) {
  const std::size_t slice = std::size_t(head().size[0]) * std::size_t(head().size[1]);
  const auto at = [&](Volume& v, int k) { return v.voxels.begin() + std::ptrdiff_t(std::size_t(k) * slice); };
  EXPECT_FALSE(look::blank_slices(head()));
  Volume repeated = head(), empty = head();
  for (int k = 41; k < 50; ++k) std::copy_n(at(repeated, 40), slice, at(repeated, k));
  std::fill(at(empty, 30), at(empty, 33), std::int16_t(-1024));
  std::fill(at(empty, head().size[2] - 5), empty.voxels.end(), std::int16_t(-1024));  // beyond the scan
  for (const auto& [volume, count, first, last] : {std::tuple{&repeated, 9, 41, 49}, {&empty, 3, 30, 32}}) {
    const auto blank = look::blank_slices(*volume);
    ASSERT_TRUE(blank);
    EXPECT_EQ(blank->count, count);
    EXPECT_NEAR(blank->from_mm, head().to_world_mm({0, 0, double(first)}).z, 1e-9);
    EXPECT_NEAR(blank->to_mm, head().to_world_mm({0, 0, double(last)}).z, 1e-9);
    const look::ScanLook seen = look::look_at(*volume, "HFS");
    EXPECT_EQ(look::figures_of(seen).blank_slices_count, count);
    const Warnings said = look::warnings_of(seen);
    EXPECT_TRUE(std::any_of(said.begin(), said.end(), [](const Warning& w) { return w.id == "blank_slices"; }));
  }
  // Each slice four times, as a program writes slices of 5 mm at a quarter of their distance.
  Volume fourfold = head();
  for (int k = 0; k < fourfold.size[2]; ++k) std::copy_n(at(fourfold, k - k % 4), slice, at(fourfold, k));
  ASSERT_TRUE(look::blank_slices(fourfold));
  EXPECT_GT(look::blank_slices(fourfold)->count, 0.7 * fourfold.size[2]);
  // Without noise neighbours may be alike.
  for (std::int16_t& v : fourfold.voxels) v = v > -500 ? 40 : -1000;
  EXPECT_FALSE(look::blank_slices(fourfold));
}

TEST(Look, TheSameWithOneAndFourThreads) {
  set_thread_count(1);
  const look::ScanLook one = look::look_at(head(), "HFP");
  set_thread_count(4);
  const look::ScanLook four = look::look_at(head(), "HFP");
  set_thread_count(0);
  EXPECT_EQ(one.ends, four.ends);
  EXPECT_EQ(one.sayings, four.sayings);
}

}  // namespace
}  // namespace trephine
