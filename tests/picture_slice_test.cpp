// SPDX-License-Identifier: GPL-3.0-or-later
// Slices of a volume with the outlines of surfaces: which side is where, and where the outlines lie.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "picture/palette.h"
#include "picture/slice.h"
#include "picture_shapes.h"

namespace trephine {
namespace {

using namespace picture_test;

grid::Grid<std::int16_t> block_volume(const Mat3& direction) {
  grid::Lattice l;
  l.size = {60, 70, 50};
  l.spacing_mm = {1.5, 1.25, 2};
  l.direction = direction;
  // The same box of the world, whatever the direction of the axes.
  l.origin_mm = Vec3{5, -7, 12} - direction * Vec3{59 * 0.75, 69 * 0.625, 49.0};
  grid::Grid<std::int16_t> g(l, -1000);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)}) - Vec3{5, -7, 12};
        if (p.x > 20 && std::abs(p.y) < 15 && std::abs(p.z) < 15)
          g.at(i, j, k) = 1000;  // patient's left
        else if (p.y < -25 && std::abs(p.x) < 12 && std::abs(p.z) < 12)
          g.at(i, j, k) = 1000;  // nose
        else if (p.z > 30 && std::abs(p.x) < 12 && std::abs(p.y) < 12)
          g.at(i, j, k) = 1000;  // top
      }
  return g;
}

struct Centroid {
  double x = 0, y = 0, count = 0;
};

Centroid bright(const picture::Image& i) {
  Centroid c;
  for (int y = 0; y < i.height; ++y)
    for (int x = 0; x < i.width; ++x)
      if (i.at(x, y)[0] > 200) c.x += x, c.y += y, c.count += 1;
  c.x /= c.count * i.width;
  c.y /= c.count * i.height;
  return c;
}

TEST(Slice, RadiologicalConvention) {
  Mat3 mirrored;
  mirrored.column[0] = {-1, 0, 0};
  mirrored.column[2] = {0, 0, -1};
  Mat3 left_handed;
  left_handed.column[1] = {0, -1, 0};
  for (const Mat3& direction : {Mat3(), mirrored, left_handed}) {
    const grid::HuVolume v = block_volume(direction);
    picture::SliceParams p;
    p.marks = false;
    p.plane = picture::SlicePlane::axial;
    p.position_mm = 12;
    // Left block right of the middle, nose above it.
    Centroid c = bright(picture::slice_overlay(v, p, {}));
    EXPECT_GT(c.x, 0.6);
    EXPECT_LT(c.y, 0.45);
    p.plane = picture::SlicePlane::coronal;
    p.position_mm = -7;
    c = bright(picture::slice_overlay(v, p, {}));
    EXPECT_GT(c.x, 0.6);
    EXPECT_LT(c.y, 0.45);
    p.plane = picture::SlicePlane::sagittal;
    p.position_mm = 5;
    c = bright(picture::slice_overlay(v, p, {}));
    EXPECT_LT(c.x, 0.4);
    EXPECT_LT(c.y, 0.45);
  }
}

TEST(Slice, TheCutOfASphereIsACircle) {
  const grid::HuVolume v = grid::Grid<std::int16_t>(block_volume(Mat3()), -1000);
  const surface::TriMesh s = sphere(30, {5, -7, 12}, 200);
  picture::SliceParams p;
  p.marks = false;
  p.fill_opacity = 0;
  const int normal[] = {2, 1, 0};
  const Vec3 center{5, -7, 12};
  for (int n = 0; n < 3; ++n) {
    p.plane = static_cast<picture::SlicePlane>(n);
    p.position_mm = center[normal[n]] + 18;  // radius 24
    const picture::SliceGeometry g = picture::slice_geometry(grid::lattice_of(v), p);
    const picture::Image i = picture::slice_overlay(v, p, {{&s, {1, 0, 0}, "sphere"}});
    Vec3 c = center;
    c[normal[n]] = p.position_mm;
    double sum = 0, weight = 0;
    for (int y = 0; y < i.height; ++y)
      for (int x = 0; x < i.width; ++x) {
        const double w = i.at(x, y)[0] / 255.0;  // the volume is black air
        const double r = norm(g.to_world_mm(x + 0.5, y + 0.5) - c);
        if (w > 0.05) {
          EXPECT_NEAR(r / g.mm_per_px, 24 / g.mm_per_px, 1.6);
          sum += w * r;
          weight += w;
        }
      }
    ASSERT_GT(weight, 500);
    EXPECT_NEAR(sum / weight / g.mm_per_px, 24 / g.mm_per_px, 0.1);
  }
}

TEST(Slice, FillCoversTheCrossSection) {
  const grid::HuVolume v = grid::Grid<std::int16_t>(block_volume(Mat3()), -1000);
  const surface::TriMesh s = sphere(30, {5, -7, 12}, 200);
  picture::SliceParams p;
  p.marks = false;
  p.line_width_px = 0.01;
  p.fill_opacity = 1;
  p.position_mm = 12;
  const picture::SliceGeometry g = picture::slice_geometry(grid::lattice_of(v), p);
  const picture::Image i = picture::slice_overlay(v, p, {{&s, {1, 1, 1}, ""}});
  double area = 0;
  for (std::size_t n = 0; n < i.rgb.size(); n += 3) area += i.rgb[n] / 255.0;
  EXPECT_NEAR(area * g.mm_per_px * g.mm_per_px / (pi * 900), 1, 0.005);
}

// What goes on beyond the picture was open there, and a row that met an odd number of lines was filled across all else.
TEST(Slice, FillEndsWhereTheShapeLeavesThePicture) {
  const grid::HuVolume v = grid::Grid<std::int16_t>(block_volume(Mat3()), -1000);
  const grid::Lattice& l = grid::lattice_of(v);
  const Vec3 middle{5, -7, 12};
  grid::Lattice wide = l;  // reaches beyond the picture on all sides
  for (int a = 0; a < 3; ++a) wide.size[std::size_t(a)] += 20;
  wide.origin_mm = wide.origin_mm - l.direction * Vec3{10 * l.spacing_mm.x, 10 * l.spacing_mm.y, 10 * l.spacing_mm.z};
  grid::Field field(wide, -1.f);
  for (int k = 0; k < wide.size[2]; ++k)
    for (int j = 0; j < wide.size[1]; ++j)
      for (int i = 0; i < wide.size[0]; ++i) {
        const Vec3 p = wide.to_world_mm({double(i), double(j), double(k)}) - middle;
        if (p.x < -20 || norm(p - Vec3{20, 0, 0}) < 8) field.at(i, j, k) = 1;
      }
  picture::SliceParams p;
  p.marks = false;
  p.line_width_px = 0.01;
  p.fill_opacity = 1;
  p.position_mm = middle.z;
  const picture::SliceGeometry g = picture::slice_geometry(l, p);
  const picture::Image i = picture::slice_overlay(v, p, {{nullptr, {1, 1, 1}, "", &field}});
  for (int y = 4; y + 4 < g.height; ++y)
    for (int x = 4; x + 4 < g.width; ++x) {
      const Vec3 at = g.to_world_mm(x + 0.5, y + 0.5) - middle;
      const bool inside = at.x < -24 || norm(Vec3{at.x - 20, at.y, 0}) < 5;
      const bool outside = at.x > -16 && norm(Vec3{at.x - 20, at.y, 0}) > 11;
      if (!inside && !outside) continue;
      ASSERT_NEAR(i.at(x, y)[0], inside ? 255 : 0, 5) << at.x << " " << at.y;
    }
}

TEST(Slice, MarksOfALowPictureStandBelowIt) {
  grid::Lattice l;
  l.size = {200, 30, 20};
  const grid::HuVolume v = grid::Grid<std::int16_t>(l, 40);
  const surface::TriMesh s = sphere(3, {100, 15, 10}, 50);
  picture::SliceParams p;
  p.plane = picture::SlicePlane::coronal;
  p.position_mm = 15;
  const picture::SliceGeometry g = picture::slice_geometry(grid::lattice_of(v), p);
  const std::vector<picture::OverlayShape> named{
      {&s, {1, 0, 0}, "skin"}, {&s, {0, 1, 0}, "bone"}, {&s, {0, 0, 1}, "vein"}};
  const picture::Image low = picture::slice_overlay(v, p, named);
  EXPECT_GT(low.width, g.width + 60);  // the legend stands beside it
  EXPECT_GT(low.height, g.height + 60);
  // Between the letters at its edges the picture shows nothing but the volume and the shapes.
  picture::SliceParams plain = p;
  plain.marks = false;
  const picture::Image bare = picture::slice_overlay(v, plain, named);
  ASSERT_EQ(bare.height, g.height);
  for (int y = 0; y < g.height; ++y)
    for (int x = 40; x < g.width / 2 - 30; ++x)
      ASSERT_TRUE(std::equal(low.at(x, y), low.at(x, y) + 3, bare.at(x, y))) << x << " " << y;
  p.plane = picture::SlicePlane::axial;
  p.position_mm = 10;
  l.size = {200, 150, 20};
  const grid::HuVolume high = grid::Grid<std::int16_t>(l, 40);
  EXPECT_EQ(picture::slice_overlay(high, p, named).height, picture::slice_geometry(l, p).height);
}

TEST(Slice, ANoteStandsAboveThePositionAndNowhereElse) {
  picture::SliceParams p;
  p.plane = picture::SlicePlane::coronal;
  p.position_mm = -7;
  const grid::HuVolume volume = block_volume(Mat3());
  const picture::Image without = picture::slice_overlay(volume, p, {});
  p.note = "through the middle of a ball";
  const picture::Image with = picture::slice_overlay(volume, p, {});
  ASSERT_EQ(with.height, without.height);
  int first = with.height, last = -1;
  for (int y = 0; y < with.height; ++y)
    for (int x = 0; x < with.width; ++x)
      if (!std::equal(with.at(x, y), with.at(x, y) + 3, without.at(x, y)))
        first = std::min(first, y), last = std::max(last, y);
  EXPECT_GT(first, 0.8 * with.height);
  EXPECT_GT(last - first, 5);
  EXPECT_LT(last, 0.96 * with.height);
}

TEST(Slice, WindowAndOutside) {
  grid::Lattice l;
  l.size = {11, 11, 11};
  grid::Grid<float> g(l);
  for (int k = 0; k < 11; ++k)
    for (int j = 0; j < 11; ++j)
      for (int i = 0; i < 11; ++i) g.at(i, j, k) = float(i) * 20;  // 0 to 200 HU along x
  picture::SliceParams p;
  p.marks = false;
  p.position_mm = 5;
  p.window_center_hu = 100;
  p.window_width_hu = 200;
  p.longer_side_px = 110;
  const grid::HuVolume v = g;
  const picture::Image i = picture::slice_overlay(v, p, {});
  ASSERT_EQ(i.width, 110);
  // Pixel x's centre lies at (x + 0.5) / 10 - 0.5 voxels.
  for (int x = 5; x < 105; ++x) EXPECT_NEAR(i.at(x, 55)[0], ((x + 0.5) / 10 - 0.5) / 10 * 255, 1);
  p.position_mm = 20;
  EXPECT_THROW(picture::slice_overlay(v, p, {}), Error);
  EXPECT_EQ(picture::slice_range_mm(l, picture::SlicePlane::axial), (std::array<double, 2>{-0.5, 10.5}));
}

TEST(Slice, SameBytesWhateverTheThreads) {
  const grid::HuVolume v = block_volume(Mat3());
  const surface::TriMesh s = sphere(30, {5, -7, 12});
  picture::SliceParams p;
  p.position_mm = 20;
  set_thread_count(1);
  const std::string one = picture::encode_png(picture::slice_overlay(v, p, {{&s, {1, 0.5, 0}, "sphere"}}));
  set_thread_count(2);
  EXPECT_EQ(picture::encode_png(picture::slice_overlay(v, p, {{&s, {1, 0.5, 0}, "sphere"}})), one);
}

}  // namespace

// What a dichromat sees of a colour (Vienot, Brettel and Mollon, "Digital video colourmaps for checking the legibility
// of displays by dichromats", 1999), with values taken as linear ones.
using Eye = std::array<std::array<double, 3>, 3>;
picture::Rgb seen_by(const Eye& m, const picture::Rgb& c) {
  picture::Rgb out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) out[i] += m[i][j] * std::pow(c[j], 2.2);
  for (double& v : out) v = std::pow(std::clamp(v, 0.0, 1.0), 1 / 2.2);
  return out;
}

TEST(LineColours, AreToldApartByEveryEyeAndKeepTheSurfacesHue) {
  constexpr Eye protan = {{{0.11238, 0.88762, 0}, {0.11238, 0.88762, 0}, {0.00401, -0.00401, 1}}},
                deutan = {{{0.29275, 0.70725, 0}, {0.29275, 0.70725, 0}, {-0.02234, 0.02234, 1}}},
                usual = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  // The anatomies of a head as the shipped recipe colours them: brain and skin, two blues and two reds are close there.
  const std::vector<picture::Rgb> head = {{0.87, 0.68, 0.56}, {0.85, 0.62, 0.62}, {0.25, 0.50, 0.90},
                                          {0.78, 0.62, 0.82}, {0.75, 0.75, 0.75}, {0.20, 0.30, 0.75},
                                          {0.10, 0.70, 0.75}, {0.85, 0.45, 0.20}, {0.93, 0.89, 0.78}};
  const std::vector<picture::Rgb> lines = picture::line_colours(head);
  ASSERT_EQ(lines.size(), head.size());
  for (const Eye& eye : {protan, deutan, usual})
    for (std::size_t a = 0; a < lines.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) {
        double d = 0;
        const picture::Rgb p = seen_by(eye, lines[a]), q = seen_by(eye, lines[b]);
        for (std::size_t i = 0; i < 3; ++i) d += (p[i] - q[i]) * (p[i] - q[i]);
        EXPECT_GT(std::sqrt(d), 0.12) << a << " and " << b;
      }
  EXPECT_GT(lines[2][2], lines[2][0]);  // ventricles stay blue, the skin stays warm
  EXPECT_GT(lines[0][0], lines[0][2]);
  // More than there are: the first ones again, and the same list gives the same colours.
  std::vector<picture::Rgb> more = head;
  more.push_back(head[0]);
  EXPECT_EQ(picture::line_colours(more).back(), lines[0]);
}

}  // namespace trephine
