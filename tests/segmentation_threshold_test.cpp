// SPDX-License-Identifier: GPL-3.0-or-later
// Segment by threshold: where the surface lies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "base/error.h"
#include "field_deviation.h"
#include "report_of.h"
#include "segmentation_samples.h"

namespace trephine {
namespace {

using namespace segment_test;

/// A ball of radius R convolved with a Gaussian, 0 to 1 (closed form).
double blurred_ball(double r, double R, double sigma) {
  r = std::max(r, 1e-9);
  const double a = std::sqrt(2.0) * sigma;
  return 0.5 * (std::erf((R - r) / a) + std::erf((R + r) / a)) -
         sigma / (r * std::sqrt(2 * M_PI)) *
             (std::exp(-(R - r) * (R - r) / (a * a)) - std::exp(-(R + r) * (R + r) / (a * a)));
}

TEST(SegmentThreshold, ABlurredSphereLiesWherePartialVolumeSays) {
  const double R = 9.3, sigma = 0.5;
  const Vec3 centre{0.13, -0.21, 0.37};
  const auto hu = [&](Vec3 p) { return -1000 + 1040 * blurred_ball(norm(p - centre), R, sigma); };
  segmentation::SegmentParams p;
  p.lower_hu = -480;
  // Where a ball's blurred image is at half its height: within it by sigma^2 / R.
  const double radius = R - sigma * sigma / R;
  const auto d = field_deviation(run(rounded(sampled(lattice(60, 60, 32), hu)), p),
                                 [&](Vec3 x) { return norm(x - centre) - radius; });
  EXPECT_LT(std::abs(d.mean), 0.01);  // a twentieth of the smaller voxel side
  EXPECT_LT(d.rms, 0.05);
  EXPECT_LT(d.max, 0.15);
}

TEST(SegmentThreshold, HalfMaximumUndoesTheBiasOfALowThresholdAndKeepsThinBone) {
  const double sigma = 0.5;
  // A table of bone 1400 HU, 4 mm thick, in soft tissue of 40 HU.
  const auto thick = [&](Vec3 p) {
    return 40 + 1360 * (blurred_ball(norm(p), 14, sigma) - blurred_ball(norm(p), 10, sigma));
  };
  segmentation::SegmentParams p;
  p.lower_hu = 226;
  const grid::HuVolume volume = rounded(sampled(lattice(76, 76, 38), thick));
  const auto off = [](Vec3 x) { return std::abs(norm(x) - 12) - 2; };
  const auto fixed = field_deviation(run(volume, p), off);
  p.edge = segmentation::SegmentEdge::half_maximum;
  const auto half = field_deviation(run(volume, p), off);
  EXPECT_GT(fixed.mean, 0.3) << "what the half maximum is for";
  EXPECT_LT(std::abs(half.mean), 0.05);
  EXPECT_LT(half.rms, 0.08);

  // A lamella of 0.5 mm: thinner than the blur, its peak half of the bone's.
  const auto thin = [&](Vec3 x) {
    return 40 + 1360 * (blurred_ball(norm(x), 12.25, sigma) - blurred_ball(norm(x), 11.75, sigma));
  };
  const grid::Field lamella = run(rounded(sampled(lattice(76, 76, 38), thin)), p);
  for (double t = 0; t < 6.2; t += 0.1) EXPECT_TRUE(holds(lamella, {12 * std::cos(t), 12 * std::sin(t), 0.5})) << t;
}

TEST(SegmentThreshold, TablesThinnerThanTheSlicesKeepTheirPlace) {
  // A vault 7 mm thick: tables of 1.8 mm and 1400 HU, 550 HU between them.
  const double sigma = 0.42, outer = 34, inner = 27, table = 1.8, fine = 0.01;
  std::vector<float> hu;
  for (double r = 0; r < 80; r += fine)
    hu.push_back(float(40 + 1360 * blurred_ball(r, outer, sigma) - 850 * blurred_ball(r, outer - table, sigma) +
                       850 * blurred_ball(r, inner + table, sigma) - 1360 * blurred_ball(r, inner, sigma)));
  segmentation::SegmentParams p;
  p.lower_hu = 226;
  p.edge = segmentation::SegmentEdge::half_maximum;
  for (const double thick : {1.0, 2.0, 3.0}) {
    grid::Lattice l = lattice(148, 148, int(40 / thick), {0.5, 0.5, thick});
    l.origin_mm.z = 0;
    const auto slice = [&](Vec3 x) {  // the mean over its thickness
      constexpr int parts = 10;
      double sum = 0;
      for (int n = 0; n < parts; ++n)
        sum += hu[std::size_t(norm(x + Vec3{0, 0, thick * ((n + 0.5) / parts - 0.5)}) / fine)];
      return sum / parts;
    };
    const grid::Field bone = run(rounded(sampled(l, slice)), p);
    double off[2] = {0, 0};
    int count[2] = {0, 0};
    for_crossings(bone, [&](Vec3 x) {
      const double r = norm(x);
      if (x.z < 0.85 * r) return;  // where the tables lie in the slices
      const int side = r > 0.5 * (inner + outer);
      off[side] += side ? r - outer : inner - r;
      ++count[side];
    });
    ASSERT_GT(std::min(count[0], count[1]), 1000);
    EXPECT_LT(std::abs(off[0] / count[0] + off[1] / count[1]), 0.2)
        << thick << " mm: " << off[0] / count[0] << " inside, " << off[1] / count[1] << " outside";
  }
}

TEST(SegmentThreshold, FilledBoneKeepsItsOuterSurface) {
  const double sigma = 0.4;
  // Two tables of 1.8 mm around 400 HU, a cell of air inside, all of it filled: one solid with one surface.
  const auto hu = [&](Vec3 p) {
    const double r = norm(p);
    const double cell = blurred_ball(norm(p - Vec3{4, 0, 0}), 2.5, sigma);
    return 40 + 1360 * blurred_ball(r, 13, sigma) - 1000 * blurred_ball(r, 11.2, sigma) - 1300 * cell;
  };
  segmentation::SegmentParams p;
  p.lower_hu = 226;
  p.edge = segmentation::SegmentEdge::half_maximum;
  p.fill = segmentation::SegmentFill::cavities;
  p.fill_close_mm = 2;
  const auto d =
      field_deviation(run(rounded(sampled(lattice(70, 70, 36), hu)), p), [&](Vec3 x) { return norm(x) - 13; });
  EXPECT_LT(std::abs(d.mean), 0.08);
  EXPECT_LT(d.max, 0.4) << "no crossing inside";
}

// A shell of bone with a hole through it: what is narrower than asked is closed and said, what is wider keeps its
// walls.
TEST(SegmentThreshold, ClosingOutletsKeepsTheWallsOfWiderHoles) {
  for (const double diameter : {3.0, 5.0, 6.0, 8.0}) {
    const grid::Grid<float> shell = sampled(lattice(76, 76, 76, {0.5, 0.5, 0.5}), [&](Vec3 p) {
      const double r = norm(p), bone = blurred_ball(r, 17, 0.4) - blurred_ball(r, 12, 0.4);
      const double across = std::hypot(p.x, p.y) - diameter / 2;
      return 40 + 1160 * bone * (p.z > 0 ? std::clamp(0.5 + across, 0.0, 1.0) : 1.0);
    });
    segmentation::SegmentParams p;
    p.lower_hu = 620;
    p.fill = segmentation::SegmentFill::cavities;
    const grid::Field open = run(shell, p);
    p.fill_close_mm = 2;
    Report report;
    const grid::Field filled = value_of(report, segmentation::segment(grid::HuVolume(shell), {}, p));
    const double by_closing_ml = std::get<double>(*report.find("filled_by_closing_ml"));
    if (diameter < 4) {
      EXPECT_TRUE(holds(filled, {0, 0, 13})) << "the outermost 2 mm stay, as a dimple";
      EXPECT_GT(by_closing_ml, 6) << "what the shell encloses is 7 ml";
    } else {
      EXPECT_TRUE(filled == open) << diameter;
      EXPECT_EQ(by_closing_ml, 0) << diameter;
    }
  }
}

TEST(SegmentThreshold, ACutThroughMaterialIsNoStaircase) {
  // A mask whose plane is oblique to the lattice cuts a block of one HU.
  const grid::Lattice l = lattice(50, 50, 25);
  const grid::Grid<float> block = sampled(l, [](Vec3 p) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 9.2 ? 300.0 : 0.0;
  });
  const Vec3 normal = normalized({1, 0.4, 0.25});
  const grid::Field half = sampled(l, [&](Vec3 p) { return dot(p, normal) < 0 ? 1.0 : -1.0; });
  segmentation::SegmentParams p;
  p.lower_hu = 150;
  segmentation::SegmentMasks masks;
  masks.within = &half;
  const grid::Field f = run(block, p, masks);
  double rms = 0;
  int n = 0;
  for_crossings(f, [&](Vec3 x) {
    if (std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}) > 6) return;
    rms += std::pow(dot(x, normal), 2);
    ++n;
  });
  ASSERT_GT(n, 100);
  EXPECT_LT(std::sqrt(rms / n), 0.12);  // a bare staircase has 0.2 and more
  EXPECT_FALSE(holds(f, {5, 0, 0}));
  EXPECT_TRUE(holds(f, {-5, 0, 0}));
  masks.within = nullptr;
  masks.without = &half;
  EXPECT_TRUE(holds(run(block, p, masks), {5, 0, 0}));
}

// Where the field ends within a chest, the lung that it cuts open lies outside of the skin.
TEST(SegmentThreshold, ABodyThatTheFieldCutsOpenIsWhyNothingLiesInIt) {
  const auto said = [](int columns, double lung_mm, double upper_hu = -450) {
    grid::Lattice l = lattice(columns, 60, 30, {2, 2, 3});
    l.origin_mm.x = -59;
    const grid::Grid<float> chest = sampled(l, [&](Vec3 p) {
      return std::abs(p.x) > 50 || std::abs(p.y) > 50 ? -1000.0 : norm(p - Vec3{0, 0, p.z}) < lung_mm ? -800.0 : 40.0;
    });
    const grid::Field skin = sampled(l, [&](Vec3 p) {
      return std::abs(p.x) < 50 && std::abs(p.y) < 50 && norm(p - Vec3{0, 0, p.z}) > lung_mm ? 1.0 : -1.0;
    });
    segmentation::SegmentParams lung;
    lung.lower_hu = upper_hu - 650;
    lung.upper_hu = upper_hu;
    segmentation::SegmentMasks masks;
    masks.within = &skin;
    try {
      segmentation::segment(grid::HuVolume(chest), masks, lung);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::quality);
      return std::string(e.what());
    }
    return std::string("found");
  };
  const std::string half = said(30, 30), whole = said(60, 0), wrong_hu = said(30, 30, 3000);
  EXPECT_NE(half.find("are cut by the sides of the field of view"), std::string::npos) << half;
  EXPECT_NE(half.find("field of view shows all of the body"), std::string::npos) << half;
  EXPECT_EQ(half.find("lower_hu`"), std::string::npos) << half;
  EXPECT_NE(whole.find("the mask is empty"), std::string::npos) << whole;
  EXPECT_NE(wrong_hu.find("the mask is empty"), std::string::npos) << wrong_hu;
}

TEST(SegmentThreshold, GrowMovesTheSurfaceByMillimetres) {
  const auto hu = [&](Vec3 p) { return 1000 * blurred_ball(norm(p), 8, 0.5); };
  segmentation::SegmentParams p;
  p.lower_hu = 500;
  const grid::HuVolume volume = sampled(lattice(64, 64, 32), hu);
  for (double grow : {-2.0, 1.5, 3.0}) {
    p.grow_mm = grow;
    const auto d = field_deviation(run(volume, p), [&](Vec3 x) { return norm(x) - 8 - grow; });
    EXPECT_LT(std::abs(d.mean), 0.1) << grow;
    EXPECT_LT(d.max, 0.25) << grow;
  }
}

TEST(SegmentThreshold, SmoothingTakesNoiseAway) {
  unsigned state = 5;
  const auto hu = [&](Vec3 p) {
    double noise = 0;
    for (int n = 0; n < 12; ++n) {
      state = state * 1664525u + 1013904223u;
      noise += (state >> 8) / double(1u << 24) - 0.5;
    }
    return (norm(p) < 8 ? 30.0 : 8.0) + 12 * noise;
  };
  segmentation::SegmentParams p;
  p.lower_hu = 19;
  p.components = segmentation::SegmentComponents::largest;
  p.smoothing_sigma_mm = 1;
  const auto d = field_deviation(run(sampled(lattice(60, 60, 30), hu), p), [](Vec3 x) { return norm(x) - 8; });
  EXPECT_LT(std::abs(d.mean), 0.15);
  EXPECT_LT(d.rms, 0.4);
}

// A kernel that enhances edges: the skin's rim is as bright as bone. What bone lies at the skin stays.
TEST(SegmentThreshold, TheSkinsBrightRimIsNoBone) {
  const auto skin_mm = [](Vec3 p) { return 34 - norm(p); };
  const auto is_bone = [&](Vec3 p) {
    const double deep = skin_mm(p);
    return (deep > 6 && deep < 9) || (p.x > 0 && std::hypot(p.y, p.z) < 5 && deep > 0.5 && deep < 9);
  };
  const auto hu = [&](Vec3 p) {
    return skin_mm(p) < 0 ? -1000.0 : is_bone(p) ? 1200.0 : skin_mm(p) < 1.2 ? 420.0 : 40.0;
  };
  const grid::Lattice l = lattice(104, 104, 74, {0.7, 0.7, 1.0});
  const grid::HuVolume volume = rounded(sampled(l, hu));
  grid::Field skin(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        skin.at(i, j, k) = float(skin_mm(l.to_world_mm({double(i), double(j), double(k)})) + 1e-4);
  segmentation::SegmentParams p;
  p.lower_hu = 226;
  p.seed_lower_hu = 400;
  Report report;
  const grid::Field bone = value_of(report, segmentation::segment(volume, {&skin, nullptr}, p));
  const auto inside = [&](Vec3 at) {
    const Vec3 i = bone.to_index(at);
    const int x = int(std::lround(i.x)), y = int(std::lround(i.y)), z = int(std::lround(i.z));
    return bone.contains(x, y, z) && bone.at(x, y, z) > 0;
  };
  EXPECT_FALSE(inside({0, 33.4, 0}));
  EXPECT_FALSE(inside({-33.4, 0, 0}));
  EXPECT_TRUE(inside({0, 26.5, 0}));
  EXPECT_TRUE(inside({32.8, 0, 0})) << "bone that reaches the skin";
  ASSERT_TRUE(report.find("bright_rim_ml"));
  ASSERT_EQ(report.warnings.size(), 1u);
}

// A vessel full of contrast medium beside bone is as bright as bone, and as even as the soft tissue about it.
TEST(SegmentThreshold, BloodInWhatIsTakenForBoneIsSaid) {
  const grid::Lattice l = lattice(80, 60, 50, {0.8, 0.8, 1.0});
  for (const bool vessel : {false, true}) {
    const auto hu = [&](Vec3 p) {
      const double trabeculae = 90 * std::sin(2.1 * p.x) * std::sin(1.9 * p.y) * std::sin(2.3 * p.z);
      const double to_bone = norm(p - Vec3{-12, 0, 0}), to_axis = std::hypot(p.x - 8, p.y);
      if (to_bone < 11) return to_bone > 9 ? 700 : 330 + trabeculae;
      return vessel && to_axis < 9.5 ? 320.0 : 40.0;
    };
    grid::HuVolume volume = rounded(sampled(l, hu));
    std::mt19937 rng(7);
    std::normal_distribution<double> noise(0, 12);
    std::visit(
        [&](auto& grid) {
          for (auto& v : grid.voxels) v = std::decay_t<decltype(v)>(std::lround(v + noise(rng)));
        },
        volume);
    segmentation::SegmentParams p;
    p.lower_hu = 200;
    p.seed_lower_hu = 350;
    const auto made = segmentation::segment(volume, {}, p);
    ASSERT_TRUE(made.result.even_ml.has_value());
    std::printf("  vessel %d: %.2f ml\n", int(vessel), *made.result.even_ml);
    EXPECT_EQ(*made.result.even_ml > 1, vessel);
    ASSERT_EQ(made.warnings.size(), vessel ? 1u : 0u);
    if (vessel) {
      EXPECT_EQ(made.warnings[0].id, "even_as_blood");
      EXPECT_NEAR(std::get<double>(made.warnings[0].values.at(1).second), 320, 5);
    }
  }
}

}  // namespace
}  // namespace trephine
