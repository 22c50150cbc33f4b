// SPDX-License-Identifier: GPL-3.0-or-later
// What the slices in a corner need to be read: the patient's sides, and a bar of known length.
#include <fmt/format.h>
#include <imgui.h>

#include "window/hud.h"

namespace trephine::window {
namespace {

constexpr double bar_mm = 20;
struct Sides {
  const char *left, *right, *top, *bottom;
};
// By the axis of the plane, as Renderer::draw_inset lays them.
constexpr Sides sides[] = {{"P", "A", "S", "I"}, {"R", "L", "S", "I"}, {"R", "L", "A", "P"}};

}  // namespace

void Hud::inset_letters(const Player& player, int width, int height) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();  // over the picture, under the panels
  const ImU32 white = IM_COL32(255, 255, 255, 255), black = IM_COL32(0, 0, 0, 200);
  const float letter = ImGui::GetFontSize();
  const auto text = [&](float x, float y, const char* said) {
    const ImVec2 size = ImGui::CalcTextSize(said);
    draw.AddText({x - size.x / 2 + 1, y - size.y / 2 + 1}, black, said);
    draw.AddText({x - size.x / 2, y - size.y / 2}, white, said);
  };
  for (const render::Inset& at : player.view().stage().insets(width, height)) {
    const float x = float(at.x), y = float(at.y), size = float(at.size);
    const Sides& s = sides[at.axis];
    text(x + 0.6f * letter, y + size / 2, s.left);
    text(x + size - 0.6f * letter, y + size / 2, s.right);
    text(x + size / 2, y + 0.6f * letter, s.top);
    text(x + size / 2, y + size - 0.6f * letter, s.bottom);
    const float bar = float(bar_mm / (2 * at.half_mm)) * size, low = y + size - 5;
    draw.AddLine({x + 5, low}, {x + 5 + bar, low}, white, 2);
    const std::string length = fmt::format("{:.0f} mm", bar_mm);
    text(x + 5 + ImGui::CalcTextSize(length.c_str()).x / 2, low - 0.7f * letter, length.c_str());
  }
}

}  // namespace trephine::window
