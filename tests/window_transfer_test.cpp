// SPDX-License-Identifier: GPL-3.0-or-later
// The diagram of a transfer function, worked by a mouse: ImGui without a window.
#include <gtest/gtest.h>
#include <imgui.h>

#include <cmath>

#include "window/layout.h"
#include "window/transfer_diagram.h"

using namespace trephine;

namespace {

class Diagram : public ::testing::Test {
 protected:
  static constexpr float left = 20, top = 30, width = 420, height = 200;

  void SetUp() override {
    ImGui::CreateContext();
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.DisplaySize = {600, 400};
    unsigned char* pixels = nullptr;
    int w = 0, h = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &w, &h);
    turn();
    turn();
  }
  void TearDown() override { ImGui::DestroyContext(); }

  // A picture, 1/60 s after the last one.
  void turn() {
    ImGuiIO& io = ImGui::GetIO();
    io.DeltaTime = 1 / 60.f;
    ImGui::NewFrame();
    ImGui::SetNextWindowPos({0, 0});
    ImGui::SetNextWindowSize({600, 400});
    ImGui::Begin("panel", nullptr, ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove);
    ImGui::SetCursorScreenPos({left, top});
    if (auto made = diagram.draw(f, histogram, width, height)) {
      f = *made;
      ++changes;
    }
    ImGui::End();
    ImGui::Render();
  }
  void press(int button, bool down) {
    ImGui::GetIO().MouseDown[button] = down;
    turn();
  }
  void to(ImVec2 at) {
    ImGui::GetIO().MousePos = at;
    turn();
  }
  void click(int button, ImVec2 at) {
    to(at);
    press(button, true);
    press(button, false);
    for (int n = 0; n < 60; ++n) turn();  // the next one is no double click
  }
  void drag(ImVec2 from, ImVec2 way) {
    to(from);
    press(0, true);
    for (int n = 1; n <= 10; ++n) to({from.x + way.x * float(n) / 10, from.y + way.y * float(n) / 10});
    press(0, false);
    to({590, 390});
  }
  // Where a place of the diagram is, by the margin of a point's radius and a pixel.
  static ImVec2 at(double hu, double opacity) {
    const float margin = 0.4f * ImGui::GetFontSize() + 1;
    return {left + margin + float((hu + 1024) / 4095) * (width - 2 * margin),
            top + margin + float(1 - opacity) * (height - 2 * margin)};
  }
  static double hu_per_px() { return 4095 / double(width - 2 * (0.4f * ImGui::GetFontSize() + 1)); }
  static double opacity_per_px() { return 1 / double(height - 2 * (0.4f * ImGui::GetFontSize() + 1)); }

  window::TransferDiagram diagram;
  voxel::TransferFunction f = voxel::transfer_from_text("bone", "--transfer");  // 150: 0, 300: 0.97, 1200: 1
  cast::HuHistogram histogram;
  int changes = 0;
};

}  // namespace

TEST_F(Diagram, APointFollowsTheMouse) {
  const voxel::TransferFunction before = f;
  drag(at(1200, 1), {60, 80});
  EXPECT_GT(changes, 3) << "while it is dragged";
  EXPECT_NEAR(f.points[2].hu, 1200 + 60 * hu_per_px(), hu_per_px());
  EXPECT_NEAR(f.points[2].opacity, 1 - 80 * opacity_per_px(), opacity_per_px());
  EXPECT_EQ(diagram.selected(), 2u);
  for (std::size_t n = 0; n < 2; ++n) EXPECT_EQ(f.points[n].hu, before.points[n].hu) << n;
  // Held by its neighbour, and by the diagram's ends.
  drag(at(f.points[2].hu, f.points[2].opacity), {-300, 500});
  EXPECT_EQ(f.points[2].hu, 300);
  EXPECT_EQ(f.points[2].opacity, 0);
}

TEST_F(Diagram, AClickSelectsAndChangesNothing) {
  click(0, at(300, 0.97));
  EXPECT_EQ(diagram.selected(), 1u);
  click(0, {at(150, 0).x + 2, at(150, 0).y - 1});
  EXPECT_EQ(diagram.selected(), 0u);
  click(0, at(2500, 0.3));
  EXPECT_EQ(diagram.selected(), 0u) << "nothing is there";
  drag(at(2500, 0.3), {40, 40});
  EXPECT_EQ(changes, 0);
}

TEST_F(Diagram, PointsAreAddedAndRemoved) {
  const ImVec2 free = at(2000, 0.4);
  to(free);
  for (const bool down : {true, false, true, false}) press(0, down);
  ASSERT_EQ(f.points.size(), 4u);
  EXPECT_NEAR(f.points[3].hu, 2000, hu_per_px());
  EXPECT_NEAR(f.points[3].opacity, 0.4, opacity_per_px());
  EXPECT_EQ(diagram.selected(), 3u);
  click(1, at(300, 0.97));
  ASSERT_EQ(f.points.size(), 3u);
  EXPECT_EQ(f.points[1].hu, 1200);
  click(1, at(2500, 0.9));
  EXPECT_EQ(f.points.size(), 3u) << "nothing is there";
}

TEST_F(Diagram, TheHistogramIsDrawn) {
  // The corners of what was drawn over these HU at full height.
  const auto at_the_top = [&](double hu) {
    int n = 0;
    const ImDrawData& data = *ImGui::GetDrawData();
    for (int list = 0; list < data.CmdListsCount; ++list)
      for (const ImDrawVert& v : data.CmdLists[list]->VtxBuffer)
        n += std::abs(v.pos.x - at(hu, 1).x) < 1 && std::abs(v.pos.y - at(hu, 1).y) < 1;
    return n;
  };
  grid::Lattice lattice;
  lattice.size = {4, 4, 4};
  grid::Grid<std::int16_t> v(lattice, 2000);  // a bin from 2,000 on
  turn();
  EXPECT_EQ(at_the_top(2000), 0);
  histogram = cast::HuHistogram(v);
  turn();
  EXPECT_GE(at_the_top(2000), 1);
  EXPECT_EQ(at_the_top(1700), 0);
}

// In a window of any size the editor's place lies within it.
TEST(Layout, TheEditorIsInTheWindow) {
  for (const float letter : {13.f, 26.f})
    for (const auto& [w, h] : {std::pair<float, float>{480, 360}, {1024, 600}, {1920, 1080}})
      for (const bool time : {false, true}) {
        const window::Layout l(w, h, letter, false, false, false, time);
        EXPECT_GE(l.transfer.x, 0);
        EXPECT_GE(l.transfer.y, 0);
        EXPECT_LE(l.transfer.x + l.transfer.width, w + 0.01f);
        EXPECT_LE(l.transfer.y + l.transfer.height, h);
        EXPECT_FALSE(time && l.transfer.overlaps(l.time));
        EXPECT_GE(l.transfer.width, std::min(w - 16, 30 * letter) - 0.01f);
      }
}
