// SPDX-License-Identifier: GPL-3.0-or-later
// The editor of the transfer function by which rays see a volume. What is seen follows it at once.
#include <fmt/format.h>

#include "window/hud.h"
#include "window/hud_parts.h"

namespace trephine::window {

using namespace hud;

void Hud::transfer_panel(Player& player, Screen& screen) {
  render::Stage& stage = player.view().stage();
  const grid::Grid<std::int16_t>* voxels = stage.cast_source().voxels();
  if (!voxels) return;
  if (const std::pair of{voxels, player.stages()}; of != counted_) {
    histogram_ = cast::HuHistogram(*voxels);
    counted_ = of;
  }
  const Place& at = layout_.transfer;
  ImGui::SetNextWindowPos({at.x, at.y}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({at.width, at.height}, ImGuiCond_FirstUseEver);
  const std::string title = action_of("editor").label.of(language_) + std::string("###transfer");
  ImGui::Begin(title.c_str(), &screen.editor_shown, ImGuiWindowFlags_NoFocusOnAppearing);
  choice_buttons("transfer", player, screen);
  const std::vector<voxel::TransferFunction>& functions = stage.cast_source().functions();
  if (functions.size() == 1) {
    const voxel::TransferFunction f = functions.front();
    const float letter = ImGui::GetTextLineHeightWithSpacing(), below = 3.4f * letter;
    const ImVec2 room = ImGui::GetContentRegionAvail();
    auto made = diagram_.draw(f, histogram_, std::max(room.x, 8 * letter), std::max(room.y - below, 4 * letter));
    if (auto other = diagram_.draw_point(f, say(Text::opacity), say(Text::colour)); other && !made) made = other;
    float from = float(f.touched_from_opacity);
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 6);
    if (ImGui::SliderFloat(say(Text::felt_from_opacity), &from, 0.01f, 1, "%.2f") && !made) {
      made = f;
      made->touched_from_opacity = double(from);
    }
    const auto felt = voxel::touched_hu(f);
    ImGui::SameLine();
    ImGui::TextColored(felt ? white : orange, "%s",
                       felt ? fmt::format("{} {} HU", say(Text::felt_from), (*felt)[0]).c_str() : say(Text::not_felt));
    action_button("write_transfer", player, screen, true);
    if (made) stage.cast(*made);
  } else {
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(texts::text_of({texts::NoteId::several_functions, {}}, language_).c_str());
    ImGui::PopTextWrapPos();
  }
  ImGui::End();
}

}  // namespace trephine::window
