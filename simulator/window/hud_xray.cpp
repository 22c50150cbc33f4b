// SPDX-License-Identifier: GPL-3.0-or-later
// The panel of a C-arm: the picture, where the arm stands, and how long X-rays were on.
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "window/hud.h"
#include "window/hud_parts.h"

namespace trephine::window {

using namespace hud;

namespace {

// The picture as the texture that is bound: one channel, shown as grey.
void upload(const fluoro::FluoroPicture& picture, fluoro::MetalShown how, bool flipped) {
  const std::vector<std::uint8_t> grey = fluoro::shown_grey(picture, how, flipped);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_R8, picture.size, picture.size, 0, GL_RED, GL_UNSIGNED_BYTE, grey.data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  const GLint grey_of_red[] = {GL_RED, GL_RED, GL_RED, GL_ONE};
  glTexParameteriv(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_RGBA, grey_of_red);
}

}  // namespace

void Hud::xray_picture(const XrayPictures& pictures, float edge) {
  const fluoro::MadeFluoro* seen = pictures.last();
  if (!seen) {  // a monitor that shows nothing yet
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::GetWindowDrawList()->AddRectFilled(at, {at.x + edge, at.y + edge}, IM_COL32(0, 0, 0, 255));
    return ImGui::Dummy({edge, edge});
  }
  if (texture_ == 0) glGenTextures(1, &texture_);
  if (const auto now = std::pair(pictures.made(), pictures.flipped); in_texture_ != now) {
    GLint before = 0;
    glGetIntegerv(GL_TEXTURE_BINDING_2D, &before);
    glBindTexture(GL_TEXTURE_2D, texture_);
    upload(seen->picture, metal_, pictures.flipped);
    glBindTexture(GL_TEXTURE_2D, GLuint(before));
    in_texture_ = now;
  }
  ImGui::Image(reinterpret_cast<ImTextureID>(std::intptr_t(texture_)), {edge, edge});
  const auto letters = fluoro::CArm(seen->arm, seen->picture.size).side_letters();
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  const float letter = ImGui::GetFontSize();
  for (const bool right : {false, true}) {
    const ImVec2 at{right ? high.x - letter : low.x + 0.4f * letter, low.y + 0.3f * letter};
    ImGui::GetWindowDrawList()->AddText({at.x + 1, at.y + 1}, IM_COL32(0, 0, 0, 255),
                                        letters[right != pictures.flipped]);
    ImGui::GetWindowDrawList()->AddText(at, IM_COL32(255, 200, 60, 255), letters[right != pictures.flipped]);
  }
}

// What X-rays had shown last at the moment that a review shows, with the way to the shots before and after it.
void Hud::shot_panel(Player& player) {
  const std::vector<lessons::LessonShot>& shots = player.shots()->shots();
  const int shown = player.shots()->shown(), count = int(shots.size());
  const float letter = ImGui::GetFontSize();
  const Place& at = layout_.shots;
  ImGui::SetNextWindowPos({at.x, at.y}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({at.width, at.height}, ImGuiCond_FirstUseEver);
  ImGui::Begin(fmt::format("{}###shots", say(Text::fluoroscopy)).c_str(), nullptr,
               ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
  ImGui::TextColored(sky, "%s %d / %d", say(Text::shots), shown + 1, count);
  if (shown >= 0) {
    const lessons::LessonShot& s = shots[std::size_t(shown)];
    ImGui::SameLine();
    ImGui::TextUnformatted(fmt::format(" {:.1f} s, {:.1f} s", s.begin_s, s.end_s - s.begin_s).c_str());
    ImGui::TextColored(grey, "%s %.0f, %s %.0f", say(Text::arm_turned), s.seen.orbit_deg, say(Text::arm_tilted),
                       s.seen.tilt_deg);
  }
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float edge = std::max(32.f, std::min(room.x, room.y - 2 * letter));
  if (shown >= 0)
    xray_picture(*player.xrays(), edge);
  else
    ImGui::Dummy({edge, edge});
  for (const int by : {-1, 1}) {
    if (by > 0) ImGui::SameLine();
    const int to = shown + by;
    if (button(by < 0 ? " < " : " > ") && to >= 0 && to < count) player.shown()->go_to(shots[std::size_t(to)].end_s);
  }
  ImGui::End();
}

void Hud::xray_panel(Player& player, Screen& screen) {
  const lessons::LessonXray x = player.lesson()->xray();
  const float letter = ImGui::GetFontSize();
  const Place& at = layout_.xray;
  ImGui::SetNextWindowPos({at.x, at.y}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({at.width, at.height}, ImGuiCond_FirstUseEver);
  ImGui::Begin(fmt::format("{}###xray", say(Text::fluoroscopy)).c_str(), nullptr,
               ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
  const std::string pose = x.now.view == "free" ? "" : translated_name(language_, x.now.view);
  ImGui::TextColored(sky, "%s%s%s %.0f, %s %.0f", pose.c_str(), pose.empty() ? "" : "  ", say(Text::arm_turned),
                     x.now.orbit_deg, say(Text::arm_tilted), x.now.tilt_deg);
  ImGui::TextColored(x.on ? vermilion : grey, "%s",
                     say(x.on                ? Text::xrays_on
                         : x.shots_count > 0 ? Text::picture_held
                                             : Text::no_xray));
  const fluoro::MadeFluoro* seen = player.xrays()->last();
  if (seen && (seen->arm.orbit_deg != x.now.orbit_deg || seen->arm.tilt_deg != x.now.tilt_deg)) {  // it moved since
    ImGui::SameLine();
    ImGui::TextColored(orange, "(%.0f, %.0f)", seen->arm.orbit_deg, seen->arm.tilt_deg);
  }
  ImGui::SameLine();
  ImGui::TextUnformatted(fmt::format(" {:.1f} s, {}: {}", x.exposure_s, say(Text::shots), x.shots_count).c_str());
  const ImVec2 room = ImGui::GetContentRegionAvail();
  xray_picture(*player.xrays(), std::max(32.f, std::min(room.x, room.y - 2.2f * letter)));
  choice_buttons("arm", player, screen, x.now.view);
  ImGui::SameLine();
  action_box("flip", player.xrays()->flipped, player, screen);
  ImGui::End();
}

}  // namespace trephine::window
