// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "picture/render.h"
#include "picture/slice.h"

namespace trephine {
namespace {

constexpr double pi = 3.14159265358979323846;

TriMesh sphere(double radius, Vec3 center, int rings = 64) {
  TriMesh m;
  m.origin_mm = center;
  const int sectors = 2 * rings;
  m.points_mm.push_back({0, 0, radius});
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      const double a = pi * i / rings, b = 2 * pi * j / sectors;
      m.points_mm.push_back(Vec3{std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)} * radius);
    }
  m.points_mm.push_back({0, 0, -radius});
  const auto at = [&](int i, int j) { return std::uint32_t(1 + (i - 1) * sectors + j % sectors); };
  const auto last = std::uint32_t(m.points_mm.size() - 1);
  for (int j = 0; j < sectors; ++j) {
    m.triangles.push_back({0, at(1, j), at(1, j + 1)});
    m.triangles.push_back({last, at(rings - 1, j + 1), at(rings - 1, j)});
    for (int i = 1; i + 1 < rings; ++i) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return m;
}

struct Colour {
  int r, g, b;
};
Colour colour_at(const Image& i, double x, double y) {
  const auto* p = i.at(static_cast<int>(x), static_cast<int>(y));
  return {p[0], p[1], p[2]};
}
bool is_red(Colour c) { return c.r > c.b + 40 && c.r > c.g + 40; }
bool is_blue(Colour c) { return c.b > c.r + 40 && c.b > c.g + 40; }
bool is_warning(Colour c) { return c.r > c.g + 60 && c.b > c.g + 60; }

RenderParams plain(View view = View::front) {
  RenderParams p;
  p.view = view;
  p.width = p.height = 300;
  p.marks = p.occlusion = false;
  p.field_of_view_deg = 0;
  p.background_top = p.background_bottom = {1, 1, 1};
  return p;
}
constexpr Rgb red{0.8, 0.05, 0.05}, blue{0.05, 0.05, 0.8};

std::size_t covered(const Image& i) {
  std::size_t n = 0;
  for (std::size_t p = 0; p < i.rgb.size(); p += 3) n += i.rgb[p] + i.rgb[p + 1] + i.rgb[p + 2] < 3 * 255;
  return n;
}

TEST(Render, SilhouetteOfASphereHasItsArea) {
  const TriMesh s = sphere(50, {1000, -2000, 30});
  for (const View v : {View::front, View::top, View::right, View::oblique_left}) {
    const Image i = render_surfaces({{&s, red, 1}}, plain(v));
    const double radius_px = 300 * 0.94 / 2;
    EXPECT_NEAR(covered(i) / (pi * radius_px * radius_px), 1, 0.01);
  }
}

TEST(Render, PerspectiveSphereFillsTheFrame) {
  const TriMesh s = sphere(50, {});
  RenderParams p = plain();
  p.field_of_view_deg = 40;
  const double radius_px = 300 * 0.94 / 2;
  EXPECT_NEAR(covered(render_surfaces({{&s, red, 1}}, p)) / (pi * radius_px * radius_px), 1, 0.01);
}

TEST(Render, TheNearerSurfaceIsSeen) {
  // Anterior is -y.
  const TriMesh near = sphere(10, {0, -60, 0}), far = sphere(50, {0, 0, 0});
  for (const double angle : {0.0, 25.0}) {
    RenderParams p = plain();
    p.field_of_view_deg = angle;
    p.frame = Bounds{{-60, -60, -60}, {60, 60, 60}};
    const std::vector<SurfaceView> both{{&far, blue, 1}, {&near, red, 1}};
    EXPECT_TRUE(is_red(colour_at(render_surfaces(both, p), 150, 150)));
    p.view = View::back;
    EXPECT_TRUE(is_blue(colour_at(render_surfaces(both, p), 150, 150)));
  }
}

TEST(Render, ViewsShowTheSideTheyName) {
  // A mark on the patient's left, anterior and superior side each.
  const TriMesh body = sphere(50, {}), mark = sphere(8, {50, 0, 0}), nose = sphere(8, {0, -50, 0});
  const std::vector<SurfaceView> left_marked{{&body, blue, 1}, {&mark, red, 1}},
      nosed{{&body, blue, 1}, {&nose, red, 1}};
  RenderParams p = plain();
  p.frame = Bounds{{-60, -60, -60}, {60, 60, 60}};
  const auto mean_x = [&](const std::vector<SurfaceView>& s, View v) {
    p.view = v;
    const Image i = render_surfaces(s, p);
    double sum = 0, n = 0;
    for (int y = 0; y < i.height; ++y)
      for (int x = 0; x < i.width; ++x)
        if (is_red(colour_at(i, x, y))) sum += x, n += 1;
    return n > 0 ? sum / n : -1;
  };
  EXPECT_GT(mean_x(left_marked, View::front), 200);  // facing us: the left is on our right
  EXPECT_LT(mean_x(left_marked, View::back), 100);
  EXPECT_NEAR(mean_x(left_marked, View::left), 150, 3);
  EXPECT_EQ(mean_x(left_marked, View::right), -1);
  EXPECT_LT(mean_x(left_marked, View::top), 100);  // nose up, seen from above
  EXPECT_GT(mean_x(left_marked, View::bottom), 200);
  EXPECT_LT(mean_x(nosed, View::left), 100);
  EXPECT_GT(mean_x(nosed, View::right), 200);
  EXPECT_NEAR(mean_x(nosed, View::front), 150, 3);
}

TEST(Render, InnerSidesWarn) {
  TriMesh s = sphere(50, {});
  const auto warnings = [](const Image& i) {
    std::size_t n = 0;
    for (int y = 0; y < i.height; ++y)
      for (int x = 0; x < i.width; ++x) n += is_warning(colour_at(i, x, y));
    return n;
  };
  const std::vector<SurfaceView> one{{&s, {0.8, 0.8, 0.8}, 1}};
  EXPECT_EQ(warnings(render_surfaces(one, plain())), 0u);
  // Where the front (-y) is open the inside of the back is seen.
  auto& t = s.triangles;
  t.erase(std::remove_if(t.begin(), t.end(),
                         [&](const auto& v) {
                           return s.points_mm[v[0]].y < -40 && s.points_mm[v[1]].y < -40 && s.points_mm[v[2]].y < -40;
                         }),
          t.end());
  EXPECT_GT(warnings(render_surfaces(one, plain())), 500u);
}

TEST(Render, GlassShowsWhatLiesBehind) {
  const TriMesh shell = sphere(50, {}), core = sphere(20, {});
  RenderParams p = plain();
  const auto red_at_centre = [&](double opacity) {
    const Colour c = colour_at(render_surfaces({{&shell, {0.8, 0.8, 0.8}, opacity}, {&core, red, 1}}, p), 150, 150);
    return c.r - c.g;
  };
  EXPECT_GT(red_at_centre(0.1), red_at_centre(0.5));
  EXPECT_GT(red_at_centre(0.5), red_at_centre(0.9));
  EXPECT_NEAR(red_at_centre(1), 0, 3);
}

TEST(Render, CutsLookSolid) {
  const TriMesh shell = sphere(50, {}), core = sphere(20, {});
  for (const double angle : {0.0, 20.0}) {
    RenderParams p = plain();
    p.field_of_view_deg = angle;
    p.clip = ClipPlane{{0, 10, 0}, {0, -1, 0}};  // the front goes, down to 10 mm behind the centre
    const Image i = render_surfaces({{&shell, {0.7, 0.7, 0.7}, 1}, {&core, red, 1}}, p);
    std::size_t red_px = 0;
    for (int y = 0; y < i.height; ++y)
      for (int x = 0; x < i.width; ++x) {
        EXPECT_FALSE(is_warning(colour_at(i, x, y)));
        red_px += is_red(colour_at(i, x, y));
      }
    if (angle == 0) {
      const double px_per_mm = 300 * 0.94 / 100, r = std::sqrt(20.0 * 20 - 10 * 10) * px_per_mm;
      EXPECT_NEAR(red_px / (pi * r * r), 1, 0.02);
    }
    EXPECT_TRUE(is_red(colour_at(i, 150, 150)));
    const Colour shell_cap = colour_at(i, 150 + 90, 150);
    EXPECT_NEAR(shell_cap.r, shell_cap.g, 3);
    EXPECT_LT(shell_cap.r, 250);
  }
}

TEST(Render, SameBytesWhateverTheThreads) {
  const TriMesh a = sphere(50, {}), b = sphere(30, {30, -30, 10});
  for (const int samples : {1, 2, 3, 4}) {
    RenderParams p;
    p.width = 161;
    p.height = 97;
    p.supersampling = samples;
    p.title = "both";
    const std::vector<SurfaceView> both{{&a, red, 0.5}, {&b, blue, 1}};
    set_thread_count(1);
    const std::string one = encode_png(render_surfaces(both, p));
    set_thread_count(2);
    EXPECT_EQ(encode_png(render_surfaces(both, p)), one);
  }
}

TEST(Render, DamagedMeshesAndNothing) {
  TriMesh s = sphere(50, {});
  const Image empty = render_surfaces({}, plain());
  EXPECT_EQ(covered(empty), 0u);
  s.points_mm[3].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(render_surfaces({{&s, red, 1}}, plain()), Error);
  s = sphere(50, {});
  s.triangles[0][1] = 1000000;
  EXPECT_THROW(render_surfaces({{&s, red, 1}}, plain()), Error);
}

Grid<std::int16_t> block_volume(const Mat3& direction) {
  Lattice l;
  l.size = {60, 70, 50};
  l.spacing_mm = {1.5, 1.25, 2};
  l.direction = direction;
  // The same box of the world, whatever the direction of the axes.
  l.origin_mm = Vec3{5, -7, 12} - direction * Vec3{59 * 0.75, 69 * 0.625, 49.0};
  Grid<std::int16_t> g(l, -1000);
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
Centroid bright(const Image& i) {
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
    const HuVolume v = block_volume(direction);
    SliceParams p;
    p.marks = false;
    p.plane = SlicePlane::axial;
    p.position_mm = 12;
    // Left block right of the middle, nose above it.
    Centroid c = bright(slice_overlay(v, p, {}));
    EXPECT_GT(c.x, 0.6);
    EXPECT_LT(c.y, 0.45);
    p.plane = SlicePlane::coronal;
    p.position_mm = -7;
    c = bright(slice_overlay(v, p, {}));
    EXPECT_GT(c.x, 0.6);
    EXPECT_LT(c.y, 0.45);
    p.plane = SlicePlane::sagittal;
    p.position_mm = 5;
    c = bright(slice_overlay(v, p, {}));
    EXPECT_LT(c.x, 0.4);
    EXPECT_LT(c.y, 0.45);
  }
}

TEST(Slice, TheCutOfASphereIsACircle) {
  const HuVolume v = Grid<std::int16_t>(block_volume(Mat3()), -1000);
  const TriMesh s = sphere(30, {5, -7, 12}, 200);
  SliceParams p;
  p.marks = false;
  p.fill_opacity = 0;
  const int normal[] = {2, 1, 0};
  const Vec3 center{5, -7, 12};
  for (int n = 0; n < 3; ++n) {
    p.plane = static_cast<SlicePlane>(n);
    p.position_mm = center[normal[n]] + 18;  // radius 24
    const SliceGeometry g = slice_geometry(lattice_of(v), p);
    const Image i = slice_overlay(v, p, {{&s, {1, 0, 0}, "sphere"}});
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
  const HuVolume v = Grid<std::int16_t>(block_volume(Mat3()), -1000);
  const TriMesh s = sphere(30, {5, -7, 12}, 200);
  SliceParams p;
  p.marks = false;
  p.line_width_px = 0.01;
  p.fill_opacity = 1;
  p.position_mm = 12;
  const SliceGeometry g = slice_geometry(lattice_of(v), p);
  const Image i = slice_overlay(v, p, {{&s, {1, 1, 1}, ""}});
  double area = 0;
  for (std::size_t n = 0; n < i.rgb.size(); n += 3) area += i.rgb[n] / 255.0;
  EXPECT_NEAR(area * g.mm_per_px * g.mm_per_px / (pi * 900), 1, 0.005);
}

TEST(Slice, MarksOfALowPictureStandBelowIt) {
  Lattice l;
  l.size = {200, 30, 20};
  const HuVolume v = Grid<std::int16_t>(l, 40);
  const TriMesh s = sphere(3, {100, 15, 10}, 50);
  SliceParams p;
  p.plane = SlicePlane::coronal;
  p.position_mm = 15;
  const SliceGeometry g = slice_geometry(lattice_of(v), p);
  const std::vector<OverlayShape> named{{&s, {1, 0, 0}, "skin"}, {&s, {0, 1, 0}, "bone"}, {&s, {0, 0, 1}, "vein"}};
  const Image low = slice_overlay(v, p, named);
  EXPECT_EQ(low.width, g.width);
  EXPECT_GT(low.height, g.height + 60);
  // Between the letters at its edges the picture shows nothing but the volume and the shapes.
  SliceParams plain = p;
  plain.marks = false;
  const Image bare = slice_overlay(v, plain, named);
  ASSERT_EQ(bare.height, g.height);
  for (int y = 0; y < g.height; ++y)
    for (int x = 40; x < g.width / 2 - 30; ++x)
      ASSERT_TRUE(std::equal(low.at(x, y), low.at(x, y) + 3, bare.at(x, y))) << x << " " << y;
  p.plane = SlicePlane::axial;
  p.position_mm = 10;
  l.size = {200, 150, 20};
  const HuVolume high = Grid<std::int16_t>(l, 40);
  EXPECT_EQ(slice_overlay(high, p, named).height, slice_geometry(l, p).height);
}

TEST(Slice, WindowAndOutside) {
  Lattice l;
  l.size = {11, 11, 11};
  Grid<float> g(l);
  for (int k = 0; k < 11; ++k)
    for (int j = 0; j < 11; ++j)
      for (int i = 0; i < 11; ++i) g.at(i, j, k) = float(i) * 20;  // 0 to 200 HU along x
  SliceParams p;
  p.marks = false;
  p.position_mm = 5;
  p.window_center_hu = 100;
  p.window_width_hu = 200;
  p.longer_side_px = 110;
  const HuVolume v = g;
  const Image i = slice_overlay(v, p, {});
  ASSERT_EQ(i.width, 110);
  // Pixel x's centre lies at (x + 0.5) / 10 - 0.5 voxels.
  for (int x = 5; x < 105; ++x) EXPECT_NEAR(i.at(x, 55)[0], ((x + 0.5) / 10 - 0.5) / 10 * 255, 1);
  p.position_mm = 20;
  EXPECT_THROW(slice_overlay(v, p, {}), Error);
  EXPECT_EQ(slice_range_mm(l, SlicePlane::axial), (std::array<double, 2>{-0.5, 10.5}));
}

TEST(Slice, SameBytesWhateverTheThreads) {
  const HuVolume v = block_volume(Mat3());
  const TriMesh s = sphere(30, {5, -7, 12});
  SliceParams p;
  p.position_mm = 20;
  set_thread_count(1);
  const std::string one = encode_png(slice_overlay(v, p, {{&s, {1, 0.5, 0}, "sphere"}}));
  set_thread_count(2);
  EXPECT_EQ(encode_png(slice_overlay(v, p, {{&s, {1, 0.5, 0}, "sphere"}})), one);
}

TEST(Png, RoundTripAndDamage) {
  Image i(37, 23);
  for (std::size_t n = 0; n < i.rgb.size(); ++n) i.rgb[n] = static_cast<std::uint8_t>(n * 7 % 251);
  const std::string png = encode_png(i);
  const Image back = decode_png(png);
  EXPECT_EQ(back.width, 37);
  EXPECT_EQ(back.height, 23);
  EXPECT_EQ(back.rgb, i.rgb);
  EXPECT_EQ(encode_png(i), png);
  EXPECT_EQ(png.find("tEXt"), std::string::npos);
  EXPECT_EQ(png.find("tIME"), std::string::npos);
  for (const std::size_t n : {std::size_t{0}, std::size_t{20}, png.size() / 2})
    EXPECT_THROW(decode_png(std::string_view(png).substr(0, n)), Error);
  // A header that claims 60,000 x 60,000 pixels takes no memory.
  std::string huge = png;
  huge[18] = static_cast<char>(0xea);
  huge[22] = static_cast<char>(0xea);
  EXPECT_THROW(decode_png(huge), Error);
  EXPECT_THROW(encode_png(Image()), Error);
}

TEST(Sheet, CellsInRows) {
  const Image sheet =
      contact_sheet({Image(10, 8, {1, 0, 0}), Image(6, 8, {0, 1, 0}), Image(10, 4, {0, 0, 1})}, 2, {1, 1, 1}, 2);
  EXPECT_EQ(sheet.width, 2 * 12 + 2);
  EXPECT_EQ(sheet.height, 2 * 10 + 2);
  EXPECT_EQ(sheet.at(7, 6)[0], 255);
  EXPECT_EQ(sheet.at(7, 6)[1], 0);
  EXPECT_EQ(sheet.at(19, 6)[1], 255);
  EXPECT_EQ(sheet.at(19, 6)[0], 0);
  EXPECT_EQ(sheet.at(7, 16)[2], 255);
  EXPECT_EQ(sheet.at(7, 16)[0], 0);
  EXPECT_EQ(contact_sheet({}, 3).width, 8);
}

TEST(Text, DrawsWithinItsWidthAndOverEdges) {
  Image i(200, 40, {1, 1, 1});
  const std::string text = "Ag 12.5 mm (%) \x01";
  draw_text(i, 10, 10, text, 14, {0, 0, 0}, {1, 1, 1});
  int first = 200, last = 0;
  for (int y = 0; y < i.height; ++y)
    for (int x = 0; x < i.width; ++x)
      if (i.at(x, y)[0] < 128) first = std::min(first, x), last = std::max(last, x);
  EXPECT_NEAR(first, 10, 2);
  EXPECT_GT(last, 10 + text_width(text, 14) - 10);
  EXPECT_LE(last, 10 + text_width(text, 14));
  for (const double at : {-50.0, -5.0, 195.0, 500.0}) draw_text(i, at, at, text, 14, {0, 0, 0}, {1, 1, 1});
}

}  // namespace
}  // namespace trephine
