// SPDX-License-Identifier: GPL-3.0-or-later
// Rendered surfaces, PNG, sheets and text.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/pi.h"
#include "base/png.h"
#include "picture/render.h"
#include "picture_shapes.h"

namespace trephine {
namespace {

using namespace picture_test;

struct Colour {
  int r, g, b;
};
Colour colour_at(const picture::Image& i, double x, double y) {
  const auto* p = i.at(static_cast<int>(x), static_cast<int>(y));
  return {p[0], p[1], p[2]};
}
bool is_red(Colour c) { return c.r > c.b + 40 && c.r > c.g + 40; }
bool is_blue(Colour c) { return c.b > c.r + 40 && c.b > c.g + 40; }
bool is_warning(Colour c) { return c.r > c.g + 60 && c.b > c.g + 60; }

picture::RenderParams plain(picture::View view = picture::View::front) {
  picture::RenderParams p;
  p.view = view;
  p.width = p.height = 300;
  p.marks = p.occlusion = false;
  p.field_of_view_deg = 0;
  p.background_top = p.background_bottom = {1, 1, 1};
  return p;
}
constexpr picture::Rgb red{0.8, 0.05, 0.05}, blue{0.05, 0.05, 0.8};

std::size_t covered(const picture::Image& i) {
  std::size_t n = 0;
  for (std::size_t p = 0; p < i.rgb.size(); p += 3) n += i.rgb[p] + i.rgb[p + 1] + i.rgb[p + 2] < 3 * 255;
  return n;
}

TEST(Render, SilhouetteOfASphereHasItsArea) {
  const surface::TriMesh s = sphere(50, {1000, -2000, 30});
  for (const picture::View v :
       {picture::View::front, picture::View::top, picture::View::right, picture::View::oblique_left}) {
    const picture::Image i = picture::render_surfaces({{&s, red, 1}}, plain(v));
    const double radius_px = 300 * 0.94 / 2;
    EXPECT_NEAR(covered(i) / (pi * radius_px * radius_px), 1, 0.01);
  }
}

TEST(Render, PerspectiveSphereFillsTheFrame) {
  const surface::TriMesh s = sphere(50, {});
  picture::RenderParams p = plain();
  p.field_of_view_deg = 40;
  const double radius_px = 300 * 0.94 / 2;
  EXPECT_NEAR(covered(picture::render_surfaces({{&s, red, 1}}, p)) / (pi * radius_px * radius_px), 1, 0.01);
}

TEST(Render, TheNearerSurfaceIsSeen) {
  // Anterior is -y.
  const surface::TriMesh near = sphere(10, {0, -60, 0}), far = sphere(50, {0, 0, 0});
  for (const double angle : {0.0, 25.0}) {
    picture::RenderParams p = plain();
    p.field_of_view_deg = angle;
    p.frame = surface::Bounds{{-60, -60, -60}, {60, 60, 60}};
    const std::vector<picture::SurfaceView> both{{&far, blue, 1}, {&near, red, 1}};
    EXPECT_TRUE(is_red(colour_at(picture::render_surfaces(both, p), 150, 150)));
    p.view = picture::View::back;
    EXPECT_TRUE(is_blue(colour_at(picture::render_surfaces(both, p), 150, 150)));
  }
}

TEST(Render, ViewsShowTheSideTheyName) {
  // A mark on the patient's left, anterior and superior side each.
  const surface::TriMesh body = sphere(50, {}), mark = sphere(8, {50, 0, 0}), nose = sphere(8, {0, -50, 0});
  const std::vector<picture::SurfaceView> left_marked{{&body, blue, 1}, {&mark, red, 1}},
      nosed{{&body, blue, 1}, {&nose, red, 1}};
  picture::RenderParams p = plain();
  p.frame = surface::Bounds{{-60, -60, -60}, {60, 60, 60}};
  const auto mean_x = [&](const std::vector<picture::SurfaceView>& s, picture::View v) {
    p.view = v;
    const picture::Image i = picture::render_surfaces(s, p);
    double sum = 0, n = 0;
    for (int y = 0; y < i.height; ++y)
      for (int x = 0; x < i.width; ++x)
        if (is_red(colour_at(i, x, y))) sum += x, n += 1;
    return n > 0 ? sum / n : -1;
  };
  EXPECT_GT(mean_x(left_marked, picture::View::front), 200);  // facing us: the left is on our right
  EXPECT_LT(mean_x(left_marked, picture::View::back), 100);
  EXPECT_NEAR(mean_x(left_marked, picture::View::left), 150, 3);
  EXPECT_EQ(mean_x(left_marked, picture::View::right), -1);
  EXPECT_LT(mean_x(left_marked, picture::View::top), 100);  // nose up, seen from above
  EXPECT_GT(mean_x(left_marked, picture::View::bottom), 200);
  EXPECT_LT(mean_x(nosed, picture::View::left), 100);
  EXPECT_GT(mean_x(nosed, picture::View::right), 200);
  EXPECT_NEAR(mean_x(nosed, picture::View::front), 150, 3);
}

TEST(Render, InnerSidesWarn) {
  surface::TriMesh s = sphere(50, {});
  const auto warnings = [](const picture::Image& i) {
    std::size_t n = 0;
    for (int y = 0; y < i.height; ++y)
      for (int x = 0; x < i.width; ++x) n += is_warning(colour_at(i, x, y));
    return n;
  };
  const std::vector<picture::SurfaceView> one{{&s, {0.8, 0.8, 0.8}, 1}};
  EXPECT_EQ(warnings(picture::render_surfaces(one, plain())), 0u);
  // Where the front (-y) is open the inside of the back is seen.
  auto& t = s.triangles;
  t.erase(std::remove_if(t.begin(), t.end(),
                         [&](const auto& v) {
                           return s.points_mm[v[0]].y < -40 && s.points_mm[v[1]].y < -40 && s.points_mm[v[2]].y < -40;
                         }),
          t.end());
  EXPECT_GT(warnings(picture::render_surfaces(one, plain())), 500u);
}

// Small triangles are drawn four samples at a time, large ones sample by sample.
TEST(Render, SmallTrianglesLookLikeLargeOnes) {
  const auto sheet = [](int parts) {  // a square that is bent along its diagonal
    surface::TriMesh m;
    for (int j = 0; j <= parts; ++j)
      for (int i = 0; i <= parts; ++i) {
        const double x = 100.0 * i / parts, z = 100.0 * j / parts;
        m.points_mm.push_back({x, 0.3 * std::min(x, z), z});
        m.normals.push_back({0, -1, 0});
      }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (parts + 1) + i); };
    for (int j = 0; j < parts; ++j)
      for (int i = 0; i < parts; ++i) {
        m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    return m;
  };
  const surface::TriMesh large = sheet(1), small = sheet(50), ball = sphere(20, {70, 20, 30});
  for (const picture::View view : {picture::View::front, picture::View::oblique_left})
    for (const int samples : {1, 2, 3})
      for (const double opacity : {1.0, 0.6}) {
        picture::RenderParams p = plain(view);
        p.width = 301;  // rows do not end with four samples
        p.field_of_view_deg = 20;
        p.supersampling = samples;
        const auto drawn = [&](const surface::TriMesh& m) {
          return picture::render_surfaces({{&m, red, opacity}, {&ball, blue, 1}}, p);
        };
        const picture::Image a = drawn(large), b = drawn(small);
        EXPECT_GT(covered(a), 20000u);
        std::size_t differ = 0;  // where the ball meets the sheet the nearer one may be another at a sample
        for (std::size_t i = 0; i < a.rgb.size(); ++i) differ += std::abs(a.rgb[i] - b.rgb[i]) > 1;
        EXPECT_LE(differ, 60u) << samples;
      }
}

TEST(Render, GlassShowsWhatLiesBehind) {
  const surface::TriMesh shell = sphere(50, {}), core = sphere(20, {});
  picture::RenderParams p = plain();
  const auto red_at_centre = [&](double opacity) {
    const Colour c =
        colour_at(picture::render_surfaces({{&shell, {0.8, 0.8, 0.8}, opacity}, {&core, red, 1}}, p), 150, 150);
    return c.r - c.g;
  };
  EXPECT_GT(red_at_centre(0.1), red_at_centre(0.5));
  EXPECT_GT(red_at_centre(0.5), red_at_centre(0.9));
  EXPECT_NEAR(red_at_centre(1), 0, 3);
}

TEST(Render, CutsLookSolid) {
  const surface::TriMesh shell = sphere(50, {}), core = sphere(20, {});
  for (const double angle : {0.0, 20.0}) {
    picture::RenderParams p = plain();
    p.field_of_view_deg = angle;
    p.clip = picture::ClipPlane{{0, 10, 0}, {0, -1, 0}};  // the front goes, down to 10 mm behind the centre
    const picture::Image i = picture::render_surfaces({{&shell, {0.7, 0.7, 0.7}, 1}, {&core, red, 1}}, p);
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
  const surface::TriMesh a = sphere(50, {}), b = sphere(30, {30, -30, 10});
  for (const int samples : {1, 2, 3, 4}) {
    picture::RenderParams p;
    p.width = 161;
    p.height = 97;
    p.supersampling = samples;
    p.title = "both";
    const std::vector<picture::SurfaceView> both{{&a, red, 0.5}, {&b, blue, 1}};
    set_thread_count(1);
    const std::string one = picture::encode_png(picture::render_surfaces(both, p));
    set_thread_count(2);
    EXPECT_EQ(picture::encode_png(picture::render_surfaces(both, p)), one);
  }
}

TEST(Render, DamagedMeshesAndNothing) {
  surface::TriMesh s = sphere(50, {});
  const picture::Image empty = picture::render_surfaces({}, plain());
  EXPECT_EQ(covered(empty), 0u);
  s.points_mm[3].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(picture::render_surfaces({{&s, red, 1}}, plain()), Error);
  s = sphere(50, {});
  s.triangles[0][1] = 1000000;
  EXPECT_THROW(picture::render_surfaces({{&s, red, 1}}, plain()), Error);
}

TEST(Png, RoundTripAndDamage) {
  picture::Image i(37, 23);
  for (std::size_t n = 0; n < i.rgb.size(); ++n) i.rgb[n] = static_cast<std::uint8_t>(n * 7 % 251);
  const std::string png = picture::encode_png(i);
  const picture::Image back = picture::decode_png(png);
  EXPECT_EQ(back.width, 37);
  EXPECT_EQ(back.height, 23);
  EXPECT_EQ(back.rgb, i.rgb);
  EXPECT_EQ(picture::encode_png(i), png);
  EXPECT_EQ(png.find("tEXt"), std::string::npos);
  EXPECT_EQ(png.find("tIME"), std::string::npos);
  for (const std::size_t n : {std::size_t{0}, std::size_t{20}, png.size() / 2})
    EXPECT_THROW(picture::decode_png(std::string_view(png).substr(0, n)), Error);
  // A header that claims 60,000 x 60,000 pixels takes no memory.
  std::string huge = png;
  huge[18] = static_cast<char>(0xea);
  huge[22] = static_cast<char>(0xea);
  EXPECT_THROW(picture::decode_png(huge), Error);
  EXPECT_THROW(picture::encode_png(picture::Image()), Error);
}

TEST(Png, ARowAtATimeGivesTheSameBytes) {
  picture::Image whole(37, 23, {0.2, 0.4, 0.6});
  for (std::size_t k = 0; k < whole.rgb.size(); ++k) whole.rgb[k] = static_cast<std::uint8_t>(k * 7 + k / 111);
  PngRows rows(37, 23, 3);
  const std::size_t cut = std::size_t{37} * 3 * 5;
  picture::Image top(37, 5), rest(37, 18);
  std::copy(whole.rgb.begin(), whole.rgb.begin() + static_cast<std::ptrdiff_t>(cut), top.rgb.begin());
  std::copy(whole.rgb.begin() + static_cast<std::ptrdiff_t>(cut), whole.rgb.end(), rest.rgb.begin());
  rows.add(top.rgb);
  EXPECT_THROW(rows.add(whole.rgb), Error);  // more rows than there are
  EXPECT_THROW(PngRows(37, 23, 3).take(), Error);
  rows.add(rest.rgb);
  EXPECT_EQ(rows.take(), picture::encode_png(whole));
}

TEST(Sheet, CellsInRows) {
  const picture::Image sheet = picture::contact_sheet(
      {picture::Image(10, 8, {1, 0, 0}), picture::Image(6, 8, {0, 1, 0}), picture::Image(10, 4, {0, 0, 1})}, 2,
      {1, 1, 1}, 2);
  EXPECT_EQ(sheet.width, 2 * 12 + 2);
  EXPECT_EQ(sheet.height, 2 * 10 + 2);
  EXPECT_EQ(sheet.at(7, 6)[0], 255);
  EXPECT_EQ(sheet.at(7, 6)[1], 0);
  EXPECT_EQ(sheet.at(19, 6)[1], 255);
  EXPECT_EQ(sheet.at(19, 6)[0], 0);
  EXPECT_EQ(sheet.at(7, 16)[2], 255);
  EXPECT_EQ(sheet.at(7, 16)[0], 0);
  EXPECT_EQ(picture::contact_sheet({}, 3).width, 8);
}

TEST(Text, DrawsWithinItsWidthAndOverEdges) {
  picture::Image i(200, 40, {1, 1, 1});
  const std::string text = "Ag 12.5 mm (%) \x01";
  picture::draw_text(i, 10, 10, text, 14, {0, 0, 0}, {1, 1, 1});
  int first = 200, last = 0;
  for (int y = 0; y < i.height; ++y)
    for (int x = 0; x < i.width; ++x)
      if (i.at(x, y)[0] < 128) first = std::min(first, x), last = std::max(last, x);
  EXPECT_NEAR(first, 10, 2);
  EXPECT_GT(last, 10 + picture::text_width(text, 14) - 10);
  EXPECT_LE(last, 10 + picture::text_width(text, 14));
  for (const double at : {-50.0, -5.0, 195.0, 500.0}) picture::draw_text(i, at, at, text, 14, {0, 0, 0}, {1, 1, 1});
}

}  // namespace
}  // namespace trephine
