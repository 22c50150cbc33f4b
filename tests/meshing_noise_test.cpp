// SPDX-License-Identifier: GPL-3.0-or-later
// Random small volumes through contour, decimate and smooth (M4): valid at each step, or 80, which is counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

#include "base/error.h"
#include "meshing/contour.h"
#include "meshing/decimate.h"
#include "meshing/smooth.h"
#include "meshing/validity.h"
#include "meshing_shapes.h"
#include "report_of.h"

namespace trephine {
namespace {

using namespace shapes;

struct Counts {
  int volumes = 0, refused = 0, invalid = 0, turned = 0;
  std::map<std::string, int> reasons;
};

/// Pieces that look inwards: cavities. Decimation and smoothing must not turn a piece inside out.
int inward_pieces(const surface::TriMesh& m) {
  std::vector<int> of;
  std::vector<double> volume(surface::label_components(m, of));
  for (std::size_t t = 0; t < of.size(); ++t) {
    const auto& v = m.triangles[t];
    volume[of[t]] += dot(m.points_mm[v[0]], cross(m.points_mm[v[1]], m.points_mm[v[2]]));
  }
  return int(std::count_if(volume.begin(), volume.end(), [](double v) { return v < 0; }));
}

/// Up to 40 % of the voxels are inside; binary or not; single voxels to sponges.
void one_volume(std::uint64_t seed, Counts& counts) {
  Random random(seed * 77 + 5);
  const double fill = random() < 0.1 ? 0.02 : random(0.02, 0.4);
  const grid::Field f = noise(5 + int(6 * random()), seed, fill, random() < 0.5);
  ++counts.volumes;
  try {
    const auto check = [&](const surface::TriMesh& m, const char* step) {
      const meshing::Validity v = meshing::check_validity(m);
      if (v.valid() && v.float32) return;
      ++counts.invalid;
      ADD_FAILURE() << "volume " << seed << " after " << step << ": " << v.text();
    };
    const surface::TriMesh whole = contoured(f);
    check(whole, "contour");
    meshing::DecimateParams less;
    less.keep_ratio = random(0.02, 0.6);
    less.max_deviation_mm = random() < 0.5 ? 0 : random(0.05, 1);
    Report report;
    const surface::TriMesh fewer = value_of(report, meshing::decimate(whole, less));
    check(fewer, "decimate");
    counts.turned += inward_pieces(fewer) != inward_pieces(whole);
    meshing::SmoothParams smoother;
    smoother.method = random() < 0.34  ? meshing::SmoothMethod::laplacian
                      : random() < 0.5 ? meshing::SmoothMethod::feature
                                       : meshing::SmoothMethod::windowed_sinc;
    smoother.iterations_count = 1 + std::int64_t(30 * random());
    smoother.pass_band_ratio = random(0.02, 1.5);
    smoother.max_displacement_mm = random(0.02, 1);
    const surface::TriMesh smoothed = value_of(report, meshing::smooth(fewer, smoother));
    check(smoothed, "smooth");
    counts.turned += inward_pieces(smoothed) != inward_pieces(fewer);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality) << "volume " << seed << ": " << e.what();
    if (std::string(e.what()).find("voxels are inside") != std::string::npos) {  // none, or in one slice: M3
      --counts.volumes;
      return;
    }
    ++counts.refused;
    std::printf("volume %d refused: %s\n", int(seed), e.what());
    ++counts.reasons[e.field() + ": " + e.what()];
  }
}

Counts volumes(std::uint64_t from, std::uint64_t to) {
  Counts counts;
  for (std::uint64_t seed = from; seed < to; ++seed) one_volume(seed, counts);
  std::printf("%d volumes: %d invalid, %d with a piece turned inside out, %d refused", counts.volumes, counts.invalid,
              counts.turned, counts.refused);
  for (const auto& [field, n] : counts.reasons) std::printf(", %d %s", n, field.c_str());
  std::printf("\n");
  return counts;
}

TEST(Noise, ThroughContourDecimateSmooth) {
  const Counts c = volumes(0, 200);
  EXPECT_LE(c.refused, c.volumes / 100);
  EXPECT_EQ(c.turned, 0);
}

class LongNoise : public testing::TestWithParam<int> {};

TEST_P(LongNoise, ThroughContourDecimateSmooth) {  // 10,000 in all
  const auto from = std::uint64_t(1000 + 1000 * GetParam());
  const Counts c = volumes(from, from + 1000);
  EXPECT_LE(c.refused, c.volumes / 100);
  EXPECT_EQ(c.turned, 0);
}
INSTANTIATE_TEST_SUITE_P(, LongNoise, testing::Range(0, 10));

}  // namespace
}  // namespace trephine
