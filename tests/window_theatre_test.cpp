// SPDX-License-Identifier: GPL-3.0-or-later
// What a theatre's field shows beside the patient, as plain data: drops of CSF, instruments, and the mirrored place.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluoro/fluoroscope.h"
#include "haptics/tool.h"
#include "render/mirror.h"
#include "scene/camera.h"
#include "scene/fluid.h"
#include "scene/tool_solid.h"
#include "window/layout.h"

using namespace trephine;

TEST(Theatre, CsfMovesOutAlongTheTubeAndDripsFromItsEnd) {
  const Vec3 tip{1, 2, 3}, axis{0, 0, 1}, down{0, 1, 0};
  const auto drops = [&](double time_s) { return scene::csf_drops(tip, axis, down, 1.25, 160, time_s); };
  const std::vector<scene::Marker> first = drops(0.1), later = drops(0.2);
  ASSERT_GT(first.size(), 5u);
  EXPECT_EQ(first.size(), drops(0.1).size());
  for (std::size_t n = 0; n + 1 < first.size(); ++n) {
    EXPECT_EQ(first[n].position_mm.x, 1);
    EXPECT_GT(later[n].position_mm.z, first[n].position_mm.z) << "outwards";
    EXPECT_GT(first[n].radius_mm, 1.25) << "seen on the tube";
    EXPECT_LE(first[n].position_mm.z, 163);
  }
  // The last one swells at the end, and then falls ever faster.
  EXPECT_GT(later.back().radius_mm, first.back().radius_mm);
  EXPECT_NEAR(later.back().position_mm.z, 163, 1e-9);
  const double a = drops(0.50).back().position_mm.y, b = drops(0.55).back().position_mm.y,
               c = drops(0.60).back().position_mm.y;
  EXPECT_GT(b, a);
  EXPECT_GT(c - b, b - a);
}

TEST(Theatre, InstrumentsEndWhereTheySay) {
  haptics::ToolParams p;
  p.tool = "catheter";
  EXPECT_NEAR(scene::tail_mm(haptics::own_tool(p)), 160, 1e-3);
  for (const char* name : {"needle", "jamshidi", "screw"}) {
    p.tool = name;
    const haptics::ToolParams tool = haptics::own_tool(p);
    const scene::Solid solid = scene::solid_of(tool);
    EXPECT_GT(scene::tail_mm(tool), tool.tool_length_mm + 15) << name << " has something to be held by";
    double widest = 0;  // of what is felt
    for (const scene::SolidVertex& v : solid.vertices)
      if (v.position_mm[2] < tool.tool_length_mm - 1e-3)
        widest = std::max(widest, double(std::hypot(v.position_mm[0], v.position_mm[1])));
    EXPECT_NEAR(widest, 0.5 * tool.tool_diameter_mm, 1e-3) << name << " is as wide as it is felt";
  }
  p.tool = "needle";
  const auto reds = [&](bool blood) {
    int n = 0;
    for (const scene::SolidVertex& v : scene::solid_of(haptics::own_tool(p), blood).vertices)
      n += std::equal(scene::blood_rgb.begin(), scene::blood_rgb.end(), v.colour_rgb);
    return n;
  };
  EXPECT_EQ(reds(false), 0);
  EXPECT_GT(reds(true), 0);
}

TEST(Theatre, AMirroredPlaceIsMirroredBack) {
  for (const render::Mirror how : {render::Mirror::none, render::Mirror::left_right, render::Mirror::up_down}) {
    double x = 30, y = 50;
    render::mirror_place(how, 640, 480, x, y);
    EXPECT_EQ(x, how == render::Mirror::left_right ? 610 : 30);
    EXPECT_EQ(y, how == render::Mirror::up_down ? 430 : 50);
    render::mirror_place(how, 640, 480, x, y);
    EXPECT_EQ(x, 30);
    EXPECT_EQ(y, 50);
  }
}

// Between the panels of a lesson in a small window the drapes' opening is seen whole, as large as it can be.
TEST(Theatre, TheFieldFitsBetweenThePanels) {
  constexpr int width = 1024, height = 600;
  constexpr double radius_mm = 100;
  const window::Place room = window::Layout(width, height, 13, true, false, false, false).patient;
  const double middle_px = room.x + 0.5 * room.width;
  const surface::Bounds bounds{{-200, -100, -150}, {200, 100, 150}};
  scene::OrbitCamera camera;
  camera.look(scene::ViewPreset::back, bounds, {}, {});
  camera.show({10, 40, -20}, radius_mm);
  camera.aside_ratio = middle_px / width - 0.5;
  camera.zoom(height / double(room.width));
  const scene::EyeView eye = camera.eye(width, height, bounds);
  const Vec3 middle = eye.project({10, 40, -20}, width, height);
  EXPECT_NEAR(middle.x, middle_px, 1e-6);
  EXPECT_NEAR(middle.y, 0.5 * height, 1e-6);
  for (const int side : {-1, 1}) {
    const double edge = eye.project(Vec3{10, 40, -20} + camera.right() * (side * radius_mm), width, height).x;
    EXPECT_NEAR(edge, side < 0 ? room.x : room.x + room.width, 0.5);
  }
  const Vec3 ray = eye.ray(middle.x, middle.y, width, height);  // what is picked there lies there
  EXPECT_NEAR(dot(ray, camera.toward), -1, 1e-9);
}

TEST(Theatre, TheMonitorIsOfUsefulSizeAndDarkByChoice) {
  // The picture lies within borders of 8 pixels.
  EXPECT_GE(window::Layout(1024, 600, 13, true, false, false, false).xray.width - 16, 1024 / 3.0);
  EXPECT_GE(window::Layout(1920, 1080, 13, true, false, false, false).xray.width, 700);
  const fluoro::FluoroPicture picture{2, {0, 200, 255, 10}};
  EXPECT_EQ(fluoro::shown_grey(picture, fluoro::MetalShown::bright), picture.grey);
  EXPECT_EQ(fluoro::shown_grey(picture, fluoro::MetalShown::dark), (std::vector<std::uint8_t>{255, 55, 0, 245}));
}
