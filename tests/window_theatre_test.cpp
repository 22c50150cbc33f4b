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
  constexpr double ml_per_s = 0.07;  // a drop each 0.7 s
  const auto drops = [&](double time_s) {
    return scene::drops_of({tip, axis, down, 1.25, 160}, ml_per_s * time_s, ml_per_s, scene::csf_rgb);
  };
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

// The pressure falls along its exact curve, dp/dt = -k p (p - h), and what comes stops where the tube's end is too
// high.
TEST(Theatre, CsfFlowsAsItsPressureDrives) {
  const scene::CsfPressure of;
  const double resistance = 8 * 0.8e-3 * 0.350 / (M_PI * std::pow(0.65e-3, 4)) / 133.322 * 1e-6;  // mmHg s / ml
  const double k = std::log(10.0) / (of.pvi_ml * resistance);
  for (const double height_mm : {0.0, 100.0, 250.0}) {
    scene::CsfDrain drain(of);
    const double rest = 1007 * 9.81 * 1e-3 * height_mm / 133.322;
    EXPECT_NEAR(drain.ml_per_s(height_mm), (25 - rest) / resistance, 1e-9);
    for (int s = 1; s <= 120; ++s) {
      drain.step(height_mm, 1);
      const double exact = rest > 0 ? rest / (1 - (1 - rest / 25) * std::exp(-k * rest * s)) : 25 / (1 + k * 25 * s);
      ASSERT_NEAR(drain.pressure_mmhg(), exact, 0.02) << height_mm << " mm, " << s << " s";
    }
    EXPECT_NEAR(drain.drained_ml(), of.pvi_ml * std::log10(25 / drain.pressure_mmhg()), 1e-9);
  }
  scene::CsfDrain high;
  high.step(400, 60);
  EXPECT_EQ(high.drained_ml(), 0);
  EXPECT_TRUE(scene::drops_of({{}, {0, 0, 1}, {0, 1, 0}}, 0, high.ml_per_s(400), scene::csf_rgb).empty());
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
  const auto reds = [&](const std::optional<std::array<float, 3>>& inside_rgb) {
    int n = 0;
    for (const scene::SolidVertex& v : scene::solid_of(haptics::own_tool(p), inside_rgb).vertices)
      n += std::equal(scene::venous_rgb.begin(), scene::venous_rgb.end(), v.colour_rgb);
    return n;
  };
  EXPECT_EQ(reds({}), 0);
  EXPECT_EQ(reds(scene::arterial_rgb), 0);
  EXPECT_GT(reds(scene::venous_rgb), 0);
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
  EXPECT_EQ(fluoro::shown_grey(picture, fluoro::MetalShown::bright, true),
            (std::vector<std::uint8_t>{200, 0, 10, 255}));
}
