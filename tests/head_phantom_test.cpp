// SPDX-License-Identifier: GPL-3.0-or-later
// The recipe's four anatomies on the analytic head, against its signed distances.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/parallel.h"
#include "head/brain.h"
#include "head/ventricles.h"
#include "head_recipe.h"
#include "phantom/head.h"
#include "phantom/scan.h"
#include "segmentation/segment.h"

namespace trephine {
namespace {

using phantom::Anatomy;
using phantom::Head;

struct Scene {
  Head head;
  grid::Grid<std::int16_t> volume;
};

Scene scanned(const phantom::HeadParams& who, const phantom::ScanParams& how) {
  Scene s{Head(who), {}};
  s.volume = phantom::volume_of(phantom::scan(s.head, how));
  return s;
}

double dice(const Head& head, Anatomy anatomy, const grid::Field& field, const grid::Lattice& l) {
  const grid::Box at = grid::place_in(field, l);
  std::vector<std::size_t> both(l.size[2]), sum(l.size[2]);
  parallel_for(0, l.size[2], 1, [&](std::int64_t k0, std::int64_t) {
    const int k = int(k0);
    for (int j = 0; j < l.size[1]; j += 2)
      for (int i = 0; i < l.size[0]; i += 2) {
        const int a = i - at.begin[0], b = j - at.begin[1], c = k - at.begin[2];
        const bool found = field.contains(a, b, c) && field.at(a, b, c) > 0;
        const bool is = head.implicit_mm(anatomy, l.to_world_mm({double(i), double(j), double(k)})) < 0;
        both[k] += found && is;
        sum[k] += std::size_t(found) + is;
      }
  });
  double b = 0, s = 0;
  for (int k = 0; k < l.size[2]; ++k) b += double(both[k]), s += double(sum[k]);
  return 2 * b / s;
}

struct Deviation {
  double mean = 0, rms = 0, p99 = 0;
};

/// Of one in `every` crossings of the field along the lattice's edges, 2.5 mm off the scan's ends.
Deviation deviation(const Head& head, Anatomy anatomy, const grid::Field& field, const grid::Lattice& l, int every) {
  const double lowest = l.to_world_mm({0, 0, 0}).z + 2.5, highest = l.to_world_mm({0, 0, l.size[2] - 1.0}).z - 2.5;
  std::vector<std::vector<double>> slices(field.size[2]);
  parallel_for(0, field.size[2], 1, [&](std::int64_t k0, std::int64_t) {
    const int k = int(k0);
    int n = 0;
    for (int j = 0; j < field.size[1]; ++j)
      for (int i = 0; i < field.size[0]; ++i)
        for (int a = 0; a < 3; ++a) {
          const int q[3] = {i + (a == 0), j + (a == 1), k + (a == 2)};
          if (!field.contains(q[0], q[1], q[2])) continue;
          const double u = field.at(i, j, k), v = field.at(q[0], q[1], q[2]);
          if ((u > 0) == (v > 0) || ++n % every) continue;
          Vec3 p{double(i), double(j), double(k)};
          p[a] += u / (u - v);
          p = field.to_world_mm(p);
          if (p.z > lowest && p.z < highest) slices[k].push_back(head.signed_distance_mm(anatomy, p));
        }
  });
  std::vector<double> size;
  Deviation d;
  for (const auto& s : slices)
    for (double e : s) {
      d.mean += e;
      d.rms += e * e;
      size.push_back(std::abs(e));
    }
  d.mean /= double(size.size());
  d.rms = std::sqrt(d.rms / double(size.size()));
  std::nth_element(size.begin(), size.begin() + std::ptrdiff_t(size.size() * 99 / 100), size.end());
  d.p99 = size[size.size() * 99 / 100];
  return d;
}

TEST(SegmentPhantom, ClinicalScanOfHalfTheResolution) {
  phantom::HeadParams who;
  who.level = phantom::Level::clinical;  // sulci, cupping of 15 HU, a filling
  phantom::ScanParams how;
  how.columns_count = how.rows_count = 256;
  how.pixel_mm = 0.94;
  how.slices_count = 96;
  how.slice_step_mm = how.slice_thickness_mm = 2;
  how.noise_hu = 8;
  const Scene s = scanned(who, how);
  const head_recipe::Fields f = head_recipe::fields_of(s.volume);
  EXPECT_GT(dice(s.head, Anatomy::brain, f.brain, s.volume), 0.968) << "sulci are outside";
  EXPECT_GT(dice(s.head, Anatomy::ventricles, f.ventricles, s.volume), 0.91);
  EXPECT_LT(std::abs(deviation(s.head, Anatomy::ventricles, f.ventricles, s.volume, 2).mean), 0.15);
  EXPECT_LT(std::abs(deviation(s.head, Anatomy::skull, f.skull, s.volume, 20).mean), 0.15);
}

TEST(LongSegmentPhantom, CoarseScan) {
  phantom::ScanParams how;
  how.columns_count = how.rows_count = 256;
  how.pixel_mm = 0.94;
  how.slices_count = 96;
  how.slice_step_mm = how.slice_thickness_mm = 2;
  how.noise_hu = 5;
  const Scene s = scanned({}, how);
  const head_recipe::Fields f = head_recipe::fields_of(s.volume);
  EXPECT_LT(deviation(s.head, Anatomy::skin, f.skin, s.volume, 4).rms, 0.25);
  EXPECT_LT(deviation(s.head, Anatomy::skull, f.skull, s.volume, 4).rms, 0.4);
  EXPECT_GT(dice(s.head, Anatomy::brain, f.brain, s.volume), 0.96);
  EXPECT_GT(dice(s.head, Anatomy::ventricles, f.ventricles, s.volume), 0.88);
}

TEST(LongSegmentPhantom, FullScan) {
  const Scene s = scanned({}, {});  // 512 x 512 x 192, 0.47 x 0.47 x 1.0 mm, noise 12 HU, simple level
  const head_recipe::Fields f = head_recipe::fields_of(s.volume);
  const auto skin = deviation(s.head, Anatomy::skin, f.skin, s.volume, 10);
  EXPECT_LT(skin.rms, 0.1);
  EXPECT_LT(skin.p99, 0.3);
  const auto skull = deviation(s.head, Anatomy::skull, f.skull, s.volume, 10);
  EXPECT_LT(std::abs(skull.mean), 0.06);
  EXPECT_LT(skull.rms, 0.15);
  EXPECT_LT(skull.p99, 0.6);
  EXPECT_GT(dice(s.head, Anatomy::brain, f.brain, s.volume), 0.98);
  EXPECT_GT(dice(s.head, Anatomy::ventricles, f.ventricles, s.volume), 0.93);
}

TEST(LongSegmentPhantom, OtherVentricles) {
  struct Case {
    phantom::Variant variant;
    int seed;
    double least;
  };
  for (const Case& c : {Case{phantom::Variant::hydrocephalic, 3, 0.95}, Case{phantom::Variant::shifted, 4, 0.92},
                        Case{phantom::Variant::small, 5, 0.85}}) {
    phantom::HeadParams who;
    who.variant = c.variant;
    who.seed = c.seed;
    const Scene s = scanned(who, {});
    const head_recipe::Fields f = head_recipe::fields_of(s.volume);
    EXPECT_GT(dice(s.head, Anatomy::brain, f.brain, s.volume), 0.97) << int(c.variant);
    EXPECT_GT(dice(s.head, Anatomy::ventricles, f.ventricles, s.volume), c.least) << int(c.variant);
  }
}

}  // namespace
}  // namespace trephine
