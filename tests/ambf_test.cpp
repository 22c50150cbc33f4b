// SPDX-License-Identifier: GPL-3.0-or-later
// What other programs show of a haptic volume, what is left of it once they removed voxels, and where it stands.
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "ambf/adf.h"
#include "ambf/read_pictures.h"
#include "base/error.h"
#include "scratch_folder.h"
#include "voxel/decode.h"
#include "voxel/drilled.h"

namespace trephine {
namespace {

/// Turned about each axis; its third axis is against the other two's normal where `left_handed`.
grid::Lattice turned_lattice(bool left_handed) {
  grid::Lattice l;
  l.size = {5, 4, 3};
  l.spacing_mm = {0.5, 0.75, 1.25};
  l.origin_mm = {-11.25, 40.5, 300};
  const Vec3 x = normalized({0.7, 0.5, -0.4}), z = normalized(cross(x, {0.2, 0.9, 0.3}));
  l.direction.column = {x, cross(z, x), left_handed ? -z : z};
  return l;
}

voxel::HapticVolume volume_of(const grid::Lattice& l) {
  voxel::HapticVolume v;
  v.voxels = grid::Grid<std::int16_t>(l);
  v.shapes = {voxel::occupancy_shape("skull", 1), voxel::occupancy_shape("brain", 2)};
  return v;
}

cases::LoadedCase case_of(const voxel::HapticVolume& v) {
  cases::LoadedCase c;
  c.manifest.case_token = "case";
  c.haptic = v;
  for (const voxel::HapticShape& s : v.shapes) {
    cases::CaseShape shape;
    shape.name = s.name;
    shape.number = s.number;
    shape.cuttable = s.number == 1;
    shape.material.colour_rgb = {1, 0.5, 0.2};
    c.manifest.haptic.shapes.push_back(shape);
  }
  return c;
}

std::string file_of(const std::vector<meshio::ExportFile>& files, const std::string& name) {
  for (const meshio::ExportFile& f : files)
    if (f.name == name) return f.bytes;
  ADD_FAILURE() << "no " << name;
  return "";
}

TEST(Ambf, ShowsTheShapeOfMostOfAVoxelThatIsHalfFull) {
  grid::Lattice l;
  l.size = {6, 1, 1};
  auto v = volume_of(l);
  // Whole; less than half, beside nothing that fills the rest; half; a little skull, and the rest brain; bare.
  v.voxels.voxels = {1255, 1300 + 100, 1300 + 128, 1100, 2255, 0};
  EXPECT_EQ(voxel::shown_shapes(v).voxels, (std::vector<std::uint8_t>{1, 0, 1, 2, 2, 0}));
}

TEST(Ambf, RemovesWholeVoxelsAndWhatNothingHoldsBesideThem) {
  grid::Lattice l;
  l.size = {7, 1, 1};
  auto v = volume_of(l);
  v.voxels.voxels = {1400, 1255, 1255, 1200, 2255, 1255, 1400};
  grid::Mask removed(l);
  removed.voxels = {0, 1, 0, 0, 0, 0, 0};
  // The remainder beside the hole goes; what stands beside it is bare there, and has what it had elsewhere.
  EXPECT_EQ(voxel::drilled_volume(v, removed).voxels.voxels,
            (std::vector<std::int16_t>{0, 0, 1255 + 300, 1200, 2255, 1255, 1400}));
  removed.voxels = {0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(voxel::drilled_volume(v, removed).voxels.voxels, v.voxels.voxels);
  // What was the brain's of a voxel of skull is nobody's once the brain there is removed.
  removed.voxels = {0, 0, 0, 0, 1, 0, 0};
  const auto now = voxel::drilled_volume(v, removed);
  EXPECT_EQ(now.voxels.voxels[3], 1200 + 300);
  EXPECT_EQ(voxel::HapticDecoder(now).occupancy(2, 3, 0, 0), 0);
  EXPECT_THROW(voxel::drilled_volume(v, grid::Mask(turned_lattice(false))), Error);
}

TEST(Ambf, RemovesFromHuAsCuttingDoes) {
  grid::Lattice l;
  l.size = {3, 1, 1};
  voxel::HapticVolume v;
  v.encoding = voxel::HapticEncoding::hu;
  v.voxels = grid::Grid<std::int16_t>(l);
  v.voxels.voxels = {900, 300, -1000};
  v.shapes = {{"skull", 1, 300, 2000}};
  EXPECT_EQ(voxel::shown_shapes(v).voxels, (std::vector<std::uint8_t>{1, 1, 0}));
  grid::Mask removed(l);
  removed.voxels = {1, 0, 0};
  EXPECT_EQ(voxel::drilled_volume(v, removed).voxels.voxels, (std::vector<std::int16_t>{-1024, 300, -1000}));
}

// Two windows beside each other, as of a raw CT: air below both is neither.
TEST(Ambf, AirBelowTwoWindowsOfHuIsNotShown) {
  grid::Lattice l;
  l.size = {4, 1, 1};
  voxel::HapticVolume v;
  v.encoding = voxel::HapticEncoding::hu;
  v.voxels = grid::Grid<std::int16_t>(l);
  v.voxels.voxels = {-500, -300, 40, 900};
  v.shapes = {{"soft", 1, -200, 226}, {"bone", 2, 227, 3000}};
  EXPECT_EQ(voxel::shown_shapes(v).voxels, (std::vector<std::uint8_t>{0, 0, 1, 2}));
}

// By the rules of AMBF and CHAI3D, from the file's own words: where the middle of a voxel lies in the patient.
TEST(Ambf, StandsWhereTheCaseDoesOnAxesOfAnyDirection) {
  for (const bool left_handed : {false, true}) {
    auto v = volume_of(turned_lattice(left_handed));
    const auto& l = v.voxels;
    v.voxels.at(4, 3, 2) = 1255;
    v.voxels.at(0, 0, 0) = 2255;
    const cases::LoadedCase loaded = case_of(v);
    const auto files = ambf::encode_adf(loaded, {}, "a test");
    const std::string text = file_of(files, "volume.yaml");
    const std::regex place(
        "VOLUME mastoidectomy_volume:[^$]*?position: \\{x: (.*), y: (.*), z: (.*)\\}\n"
        "    orientation: \\{r: (.*), p: (.*), y: (.*)\\}\n  scale: 1.0\n"
        "  dimensions: \\{x: (.*), y: (.*), z: (.*)\\}\n");
    std::smatch m;
    ASSERT_TRUE(std::regex_search(text, m, place)) << text;
    const auto at = [&](int n) { return std::stod(m[std::size_t(n)]); };
    const auto turn = [](Vec3 p, int axis, double by) {
      const int a = (axis + 1) % 3, b = (axis + 2) % 3;
      Vec3 q = p;
      q[a] = std::cos(by) * p[a] - std::sin(by) * p[b];
      q[b] = std::sin(by) * p[a] + std::cos(by) * p[b];
      return q;
    };
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 5; ++i) {
          const int picture = left_handed ? 2 - k : k;
          Vec3 p{((i + 0.5) / 5 - 0.5) * at(7), ((j + 0.5) / 4 - 0.5) * at(8), ((picture + 0.5) / 3 - 0.5) * at(9)};
          p = turn(turn(turn(p, 0, at(4)), 1, at(5)), 2, at(6)) + Vec3{at(1), at(2), at(3)};
          EXPECT_LT(norm(p * 1000 - l.to_world_mm({double(i), double(j), double(k)})), 1e-9) << i << j << k;
        }
    // The stack is in that order, and comes back with what was removed.
    const ScratchFolder scratch;
    for (const bool drilled : {false, true}) {
      auto saved = v;
      if (drilled) saved.voxels.at(4, 3, 2) = 0;
      for (const auto& f : ambf::encode_adf(case_of(saved), {}, "a test"))
        if (f.name.rfind("volume/", 0) == 0) scratch.write(f.name.substr(7), f.bytes);
      const grid::Mask shown = voxel::shown_shapes(v);
      const auto now = ambf::read_stack(scratch.path(), shown, ambf::palette_of(loaded.manifest));
      EXPECT_EQ(now.at(4, 3, 2), drilled ? 0 : 1);
      EXPECT_EQ(now.at(0, 0, 0), 1);
      const auto labels = ambf::drilled_labels(v, shown, now);
      // The picture and the pixel that show that voxel, by CHAI3D's count of rows.
      ambf::read_pictures({scratch.path() / (left_handed ? "plane000.png" : "plane002.png")}, 5, 4,
                          [&](std::size_t, const std::uint8_t* pixels) {
                            EXPECT_EQ(pixels[(0 * 5 + 4) * 4 + 3], drilled ? 0 : 255);
                            EXPECT_EQ(pixels[(3 * 5 + 0) * 4 + 3], 0);
                          });
      EXPECT_EQ(labels.shapes[0].removed, drilled ? 1U : 0U);
      EXPECT_EQ(labels.shapes[1].removed, 0U);
      EXPECT_EQ(grid::decode_labels(grid::encode_labels(labels.labels)).lattice.direction, l.direction);
    }
  }
}

TEST(Ambf, RefusesWhatNobodyCanDrill) {
  const auto refused = [](const cases::LoadedCase& c, const std::string& what) {
    try {
      ambf::encode_adf(c, {}, "a test");
      ADD_FAILURE() << what;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      EXPECT_NE(std::string(e.what()).find(what), std::string::npos) << e.what();
    }
  };
  refused({}, "no haptic volume");
  grid::Lattice l;
  l.size = {2049, 1, 1};
  refused(case_of(volume_of(l)), "2049 voxels");
}

}  // namespace
}  // namespace trephine
