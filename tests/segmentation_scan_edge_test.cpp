// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a skin is a body's, or the edge of the field of view.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "report_of.h"
#include "segmentation/segment.h"

namespace trephine {
namespace {

/// A body of 40 HU with an elliptical cross-section in air, scanned with a field of view of that diameter about the
/// middle; beyond the circle is `padding`.
grid::HuVolume scanned(double half_width_mm, double half_depth_mm, double field_mm, std::int16_t padding, bool round) {
  grid::Grid<std::int16_t> g;
  g.size = {120, 120, 20};
  g.spacing_mm = {field_mm / 120, field_mm / 120, 2};
  g.origin_mm = {-0.5 * 119 * g.spacing_mm.x, -0.5 * 119 * g.spacing_mm.y, 0};
  g.voxels.resize(g.count());
  for (int k = 0; k < 20; ++k)
    for (int j = 0; j < 120; ++j)
      for (int i = 0; i < 120; ++i) {
        const Vec3 p = g.to_world_mm({double(i), double(j), double(k)});
        const bool beyond = round && std::hypot(p.x, p.y) > field_mm / 2;
        const bool body = std::hypot(p.x / half_width_mm, p.y / half_depth_mm) < 1;
        g.at(i, j, k) = beyond ? padding : body ? 40 : -1000;
      }
  return g;
}

segmentation::SegmentParams skin() {
  segmentation::SegmentParams p;
  p.lower_hu = -475;
  p.smoothing_sigma_mm = 1.5;
  p.open_mm = 3;
  p.components = segmentation::SegmentComponents::largest;
  p.max_scan_edge_ratio = 0.5;
  return p;
}

double ratio_of(const grid::HuVolume& v, double limit) {
  segmentation::SegmentParams p = skin();
  p.max_scan_edge_ratio = limit;
  Report report;
  value_of(report, segmentation::segment(v, {}, p));
  return std::get<double>(*report.find("scan_edge_ratio"));
}

TEST(ScanEdge, AFieldOfViewWithinTheBodyHasNoSkin) {
  for (const std::int16_t padding : {-2000, -1024}) {  // undeclared; made air
    const grid::HuVolume volume = scanned(170, 110, 140, padding, true);
    try {
      segmentation::segment(volume, {}, skin());
      FAIL() << "not refused";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::quality);
      EXPECT_EQ(e.field(), "max_scan_edge_ratio");
    }
    EXPECT_GT(ratio_of(volume, 1), 0.99);
  }
  // A square field that the body fills: the whole rim is the volume's side.
  EXPECT_THROW(segmentation::segment(scanned(400, 400, 140, -1024, false), {}, skin()), Error);
}

TEST(ScanEdge, ABodyWithinTheFieldHasAllOfItAndOneCutAtTheSidesMost) {
  EXPECT_EQ(ratio_of(scanned(150, 100, 400, -1024, true), 0.5), 0);
  // An arm's breadth cut off on either side: of an ellipse of half axes 220 and 100 mm what lies beyond x = 190 mm.
  const double cut = ratio_of(scanned(220, 100, 380, -1024, false), 0.5);
  const double expected = 2 * 2 * 100 * std::sqrt(1 - 190.0 * 190 / (220.0 * 220));
  const double staircase = 4 * 190 + 4 * 100;  // a rim of voxels' faces is as long as its box
  EXPECT_GT(cut, expected / staircase - 0.02);
  EXPECT_LT(cut, expected / staircase + 0.13);  // skin that leaves the field there runs beside its circle for a while
}

TEST(ScanEdge, WhereItIsNotRefusedItIsStillTold) {
  segmentation::SegmentParams p = skin();
  p.max_scan_edge_ratio = 1;
  Report report, whole;
  EXPECT_NO_THROW(value_of(report, segmentation::segment(scanned(170, 110, 140, -1024, true), {}, p)));
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("100 % of its rim"), std::string::npos) << report.warnings[0];
  EXPECT_NO_THROW(value_of(whole, segmentation::segment(scanned(150, 100, 400, -1024, true), {}, p)));
  EXPECT_TRUE(whole.warnings.empty());
  EXPECT_EQ(whole.find("scan_edge_ratio"), nullptr);
}

// The value that the refusal names lets the shape pass, and it is told what it is.
TEST(ScanEdge, TheRemedyWorks) {
  const grid::HuVolume scan = scanned(170, 110, 140, -2000, true);
  Report after;
  std::vector<Setting> settings;
  try {
    segmentation::segment(scan, {}, skin());
  } catch (const Error& e) {
    settings = e.message().settings();
  }
  ASSERT_EQ(settings.size(), 1u);
  EXPECT_EQ(settings[0].parameter, "max_scan_edge_ratio");
  segmentation::SegmentParams p = skin();
  p.max_scan_edge_ratio = parse_number(settings[0].value).value();
  EXPECT_NO_THROW(value_of(after, segmentation::segment(scan, {}, p)));
  EXPECT_EQ(after.warnings.size(), 1u);
}

}  // namespace
}  // namespace trephine
