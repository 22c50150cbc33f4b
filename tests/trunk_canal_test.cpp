// SPDX-License-Identifier: GPL-3.0-or-later
// The spinal canal of an analytic spine: vertebral bodies, arches that are closed for half of each vertebra's height,
// open discs and foramina, a canal of known middle and radius that leans and swings.
#include <gtest/gtest.h>

#include "base/error.h"
#include "report_of.h"
#include "segmentation/segment.h"
#include "trunk/canal.h"
#include "trunk_samples.h"

namespace trephine {
namespace {

using namespace bodies;

struct Spine {
  double period_mm = 30, body_mm = 22, arch_mm = 14;  ///< the rest is disc, and foramina
  double lean = 0.3;                                  ///< mm backwards a mm up

  Vec3 middle(double z) const { return {3 * std::sin(z / 25), lean * z + 2 * std::sin(z / 18), z}; }
  double radius(double z) const { return 9 + 1.2 * std::sin(z / 14); }
  double canal_mm(Vec3 p) const {  // positive inside, in the slice
    const Vec3 m = middle(p.z);
    return radius(p.z) - std::hypot(p.x - m.x, p.y - m.y);
  }
  bool bone(Vec3 p) const {
    if (canal_mm(p) > 0) return false;
    const Vec3 m = middle(p.z);
    const double x = p.x - m.x, y = p.y - m.y, r = std::hypot(x, y);
    const double at = std::abs(std::remainder(p.z, period_mm));
    const bool body = at < body_mm / 2 && std::hypot(x, y + radius(p.z) + 13) < 20;
    const bool arch = at < arch_mm / 2 && r < radius(p.z) + 5;
    const bool process = at < arch_mm / 2 && y > radius(p.z) && y < radius(p.z) + 25 && std::abs(x) < 3;
    return body || arch || process;
  }
  float hu(Vec3 p) const { return bone(p) ? 500.f : canal_mm(p) > 0 ? 20.f : 50.f; }
};

grid::Lattice raster(Vec3 spacing_mm) {
  const auto n = [](double mm, double step) { return int(std::lround(mm / step)); };
  return lattice(n(90, spacing_mm.x), n(120, spacing_mm.y), n(120, spacing_mm.z), spacing_mm, {-45, -75, -60});
}

struct Trial {
  const char* name;
  Vec3 spacing_mm;
  double noise_hu, smoothing_mm, mean_mm, p95_mm, volume_percent;
};
void PrintTo(const Trial& t, std::ostream* os) { *os << t.name; }

class Canals : public testing::TestWithParam<Trial> {};

TEST_P(Canals, LieWithinTheirBoundOfTheTruth) {
  const Trial t = GetParam();
  const Spine spine;
  const grid::HuVolume volume =
      scanned(drawn(raster(t.spacing_mm), [&](Vec3 p) { return spine.hu(p); }), 0.6, t.noise_hu);
  segmentation::SegmentParams p;
  p.lower_hu = 250;
  p.seed_lower_hu = 350;
  p.edge = segmentation::SegmentEdge::half_maximum;
  p.min_component_ml = 0.5;
  p.smoothing_sigma_mm = t.smoothing_mm;
  Report report;
  const grid::Field bone = segmentation::segment(volume, {}, p).value;
  const grid::Field canal = value_of(report, trunk::find_canal(volume, bone, {}));
  // Not the ends: how far it is made there depends on where the scan cuts.
  const auto counts = [](Vec3 q) { return q.z > -37 && q.z < 37; };
  grid::Field drawn_truth(grid::lattice_of(volume));
  for (int k = 0; k < drawn_truth.size[2]; ++k)
    for (int j = 0; j < drawn_truth.size[1]; ++j)
      for (int i = 0; i < drawn_truth.size[0]; ++i)
        drawn_truth.at(i, j, k) = float(spine.canal_mm(drawn_truth.to_world_mm({double(i), double(j), double(k)})));
  const Distances d = surface_distance(
      canal, drawn_truth, [&](Vec3 q) { return spine.canal_mm(q); }, counts);
  double truth = 0;
  for (double z = -37; z < 37; z += 0.1) truth += 0.1 * M_PI * std::pow(spine.radius(z + 0.05), 2);
  const double percent = 100 * (volume_mm3(canal, counts) / truth - 1);
  std::printf("%s: mean %.3f p95 %.3f max %.3f mm, volume %+.2f %%\n", t.name, d.mean, d.p95, d.max, percent);
  EXPECT_LT(d.mean, t.mean_mm);
  EXPECT_LT(d.p95, t.p95_mm);
  EXPECT_LT(std::abs(percent), t.volume_percent);
  const double area = std::get<double>(*report.find("area_median_mm2"));
  EXPECT_NEAR(area, M_PI * 81, 22);
  EXPECT_GT(std::get<double>(*report.find("length_mm")), 95);
  EXPECT_TRUE(report.warnings.empty()) << report.warnings.front();
}

std::string name_of(const testing::TestParamInfo<Trial>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Noise, Canals,
                         testing::Values(Trial{"loud", {0.6, 0.6, 1}, 60, 0.7, 0.25, 0.8, 3},
                                         Trial{"thick", {0.5, 0.5, 3}, 20, 0, 0.25, 0.8, 3}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(LongNoise, Canals,
                         testing::Values(Trial{"quiet", {0.6, 0.6, 1}, 10, 0, 0.2, 0.7, 3},
                                         Trial{"usual", {0.6, 0.6, 1}, 30, 0, 0.25, 0.8, 3}),
                         name_of);

TEST(Canal, IsTheSameWhateverTheThreadCountAndLeavesBoneAlone) {
  const Spine spine;
  const grid::HuVolume volume = scanned(drawn(raster({1, 1, 2}), [&](Vec3 p) { return spine.hu(p); }), 0.6, 20);
  segmentation::SegmentParams p;
  p.lower_hu = 250;
  const grid::Field bone = segmentation::segment(volume, {}, p).value;
  const int before = thread_count();
  set_thread_count(1);
  const grid::Field one = trunk::find_canal(volume, bone, {}).value;
  set_thread_count(4);
  const grid::Field four = trunk::find_canal(volume, bone, {}).value;
  set_thread_count(before);
  EXPECT_TRUE(one == four);
  const grid::Box at = grid::place_in(one, bone);
  for (int k = 0; k < one.size[2]; ++k)
    for (int j = 0; j < one.size[1]; ++j)
      for (int i = 0; i < one.size[0]; ++i)
        ASSERT_FALSE(one.at(i, j, k) > 0 && bone.at(i + at.begin[0], j + at.begin[1], k + at.begin[2]) > 0);
}

ExitCode code_of(const grid::HuVolume& volume, const grid::Field& bone, std::string& what) {
  try {
    trunk::find_canal(volume, bone, {});
  } catch (const Error& e) {
    what = e.field() + ": " + e.what();
    return e.code();
  }
  return ExitCode::ok;
}

TEST(Canal, OfWhatIsNoSpineIsRefused) {
  const grid::Lattice l = lattice(60, 60, 60, {1, 1, 1}, {0, 0, 0});
  const grid::HuVolume volume = grid::Grid<std::int16_t>(l, 40);
  std::string what;
  EXPECT_EQ(code_of(volume, grid::Field(l, -1.f), what), ExitCode::quality);
  EXPECT_NE(what.find("empty"), std::string::npos) << what;
  EXPECT_EQ(code_of(volume, grid::Field(l, 1.f), what), ExitCode::quality) << "all bone";
  grid::Field ball(l, -1.f);
  for (int k = 0; k < 60; ++k)
    for (int j = 0; j < 60; ++j)
      for (int i = 0; i < 60; ++i) ball.at(i, j, k) = float(20 - norm(Vec3{i - 30., j - 30., k - 30.})) + 0.01f;
  EXPECT_EQ(code_of(volume, ball, what), ExitCode::quality);
  EXPECT_NE(what.find("min_length_mm"), std::string::npos) << what;
  grid::Field elsewhere = ball;
  elsewhere.origin_mm = {0.4, 0, 0};
  EXPECT_EQ(code_of(volume, elsewhere, what), ExitCode::bad_input);
}

TEST(Canal, ATubeOfAirIsNone) {
  const Spine spine;
  const auto scan = [&](float content_hu) {
    return scanned(drawn(raster({1, 1, 1}), [&](Vec3 p) { return spine.canal_mm(p) > 0 ? content_hu : spine.hu(p); }),
                   0.6, 10);
  };
  segmentation::SegmentParams p;
  p.lower_hu = 250;
  const auto canal_of = [&](const grid::HuVolume& v) {
    return trunk::find_canal(v, segmentation::segment(v, {}, p).value, {}).value;
  };
  EXPECT_NO_THROW(canal_of(scan(-100)));
  try {
    canal_of(scan(-1000));
    FAIL() << "an airway is a canal";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::quality);
    EXPECT_NE(std::string(e.what()).find("which is air"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace trephine
