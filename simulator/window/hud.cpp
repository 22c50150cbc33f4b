// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/hud.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "window/hud_parts.h"

namespace trephine {

using namespace hud;

namespace {

constexpr float letter_px = 13;
constexpr float lines_of_notes = 7;

}  // namespace

namespace hud {
void line(const char* what, const std::string& value, const ImVec4& colour) {
  ImGui::TextColored(grey, "%s", what);
  ImGui::SameLine(ImGui::GetFontSize() * 10);
  ImGui::PushTextWrapPos(0);
  ImGui::TextColored(colour, "%s", value.c_str());
  ImGui::PopTextWrapPos();
}

// ImGui's small button ends where the letters' feet begin.
bool button(const char* label) {
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {ImGui::GetStyle().FramePadding.x, ImGui::GetFontSize() * 0.1f});
  const bool pressed = ImGui::Button(label);
  ImGui::PopStyleVar();
  return pressed;
}

void flow_on(const std::string& label) {
  const float across = ImGui::CalcTextSize(label.c_str()).x + 2 * ImGui::GetStyle().FramePadding.x;
  const float end = ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + across;
  if (end <= ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x) ImGui::SameLine();
}

bool name_button(Language language, const std::string& name) {
  return button((translated_name(language, name) + "##" + name).c_str());
}

void tool_buttons(Language language, Player& player, int a_line) {
  int on_line = 0;
  for (const std::string& name : player.tools()) {
    if (on_line++ % a_line != 0) ImGui::SameLine();
    const bool held = player.tool() == name;
    if (held) ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0.1f, 0.45f, 0.65f, 1));
    if (name_button(language, name)) player.take_tool(name);
    if (held) ImGui::PopStyleColor();
  }
}

}  // namespace hud

Hud::Hud(GlfwWindow& window, double scale, Language language) : scale_(scale), language_(language) {
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // no file beside the user's
  ImGui::StyleColorsDark();
  ImGui::GetStyle().Colors[ImGuiCol_WindowBg].w = 0.78f;
  ImGui::GetStyle().WindowRounding = 4;
  ImGui::GetStyle().ScaleAllSizes(float(scale));
  ImFontConfig font;
  font.SizePixels = std::round(letter_px * float(scale));
  ImGui::GetIO().Fonts->AddFontDefault(&font);
  if (!ImGui_ImplGlfw_InitForOpenGL(window.handle(), true) || !ImGui_ImplOpenGL3_Init("#version 430 core"))
    throw Error(ExitCode::io, "", "OpenGL", "the panels cannot be drawn");
}

Hud::~Hud() {
  if (texture_ != 0) glDeleteTextures(1, &texture_);
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

bool Hud::has_mouse() const { return ImGui::GetIO().WantCaptureMouse; }
bool Hud::has_keys() const { return ImGui::GetIO().WantTextInput; }

void Hud::patient_panel(Player& player, int height) {
  ImGui::SetNextWindowPos({8, 8}, ImGuiCond_FirstUseEver);
  // As high as what it shows: a cut adds to it. Where the window is too low for that it is scrolled.
  const float across = ImGui::GetFontSize() * 23.5f;
  ImGui::SetNextWindowSizeConstraints({across, 0}, {across, std::max(ImGui::GetFontSize() * 4, float(height) - 16)});
  ImGui::Begin(player.patient().felt.loaded.manifest.case_token.c_str(), nullptr,
               ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::PushItemWidth(ImGui::GetFontSize() * 14);
  ImGui::TextColored(sky, "%s", say(Text::anatomies));
  Stage& stage = player.stage();
  for (std::size_t n = 0; n < stage.scene().surfaces.size(); ++n) {
    float opacity = float(stage.state.opacity[n]);
    if (ImGui::SliderFloat(stage.scene().surfaces[n].name.c_str(), &opacity, 0, 1, "%.2f"))
      player.set_opacity(stage.scene().surfaces[n].name, opacity);
  }
  ImGui::TextColored(sky, "%s", say(Text::view));
  int on_line = 0;
  for (const auto& [name, value] : view_presets()) {
    if (on_line++ % 4 != 0) ImGui::SameLine();
    if (name_button(language_, name)) player.set_view(name);
  }
  bool places = !stage.state.markers.empty();
  if (ImGui::Checkbox(say(Text::places), &places)) player.set_places(places);
  if (stage.loaded().has_ct()) {
    bool slices = !stage.state.ct_planes.empty();
    if (ImGui::Checkbox(say(Text::ct_slices), &slices)) player.set_ct_slices(slices);
  }
  ImGui::TextColored(sky, "%s", say(Text::cut_away));
  for (const char* how : {"none", "tool", "axial", "coronal", "sagittal"}) {
    if (how[0] != 'n') flow_on(translated_name(language_, how));
    if (name_button(language_, how)) player.cut(how);
  }
  if (stage.state.cut) {
    float moved = 0;
    if (ImGui::SliderFloat(say(Text::move_plane), &moved, -5, 5, "%.1f")) player.move_cut(moved);
    ImGui::Checkbox(say(Text::shows_ct), &stage.state.cut_shows_ct);
  }
  if (player.live()) {
    ImGui::TextColored(sky, "%s", say(Text::tool));
    on_line = 0;
    tool_buttons(language_, player, 3);
  }
  if (ImGui::CollapsingHeader(say(Text::keys))) ImGui::TextUnformatted(say(Text::keys_help));
  ImGui::PopItemWidth();
  ImGui::End();
}

void Hud::status_panel(Player& player, const Controls& controls, const PictureTimes& times, int width, int height) {
  ImGui::SetNextWindowPos({float(width) - 8, 8}, ImGuiCond_Always, {1, 0});
  // With large letters it leaves the other half to the other panel.
  ImGui::SetNextWindowSize({std::min(ImGui::GetFontSize() * 27, 0.5f * float(width) - 12), 0}, ImGuiCond_Always);
  ImGui::Begin("##status", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoFocusOnAppearing);
  const ServoFrame& f = player.frame();
  const bool working = player.desk() && player.live();
  if (!working) line(say(Text::time), fmt::format("{:.2f} s", f.time_s));
  line(say(Text::tool),
       translated_name(language_, player.tool()) +
           (f.buttons & Drilling::pedal ? fmt::format(" [{}]", say(Text::pedal)) : ""),
       f.buttons & Drilling::pedal ? orange : ImVec4(1, 1, 1, 1));
  // In a lesson nothing is told that a surgeon would not see.
  if (!working) line(say(Text::inside), f.inside ? player.shape_name(f.inside) : say(Text::nothing));
  if (!working) line(say(Text::depth), fmt::format("{:.1f} mm", player.depth_mm()));
  if (player.target_mm() >= 0 && !working) line(say(Text::to_target), fmt::format("{:.1f} mm", player.target_mm()));
  if (!player.desk() && player.ink_mm() > 0) line(say(Text::last_trace), fmt::format("{:.0f}", player.ink_mm()), sky);
  if (player.trace_on()) line(say(Text::trace), fmt::format("{:.0f} mm", player.trace_mm()));
  const double force =
      std::sqrt(f.force_n[0] * f.force_n[0] + f.force_n[1] * f.force_n[1] + f.force_n[2] * f.force_n[2]);
  line(say(Text::force), fmt::format("{:.2f} N{}", force, f.touched ? ", " + player.shape_name(f.touched) : ""),
       force > 1 ? orange : ImVec4(1, 1, 1, 1));
  const std::vector<float> forces(player.forces().begin(), player.forces().end());
  ImGui::PlotLines("##forces", forces.data(), int(forces.size()), 0, nullptr, 0, 3.5f,
                   {ImGui::GetContentRegionAvail().x, ImGui::GetFontSize() * 3});
  line(say(Text::picture), fmt::format("{:.1f} ms, {:.0f}/s", times.ms, times.per_s));
  if (!times.reduced.empty()) {
    ImGui::PushTextWrapPos(0);
    ImGui::TextColored(orange, "%s: %s", say(Text::reduced), times.reduced.c_str());
    ImGui::PopTextWrapPos();
  }
  if (player.live())
    line(say(Text::servo),
         fmt::format("{:.0f} Hz, {} {:.1f} ms", player.servo_hz(), say(Text::late), player.late_us() / 1000));
  if (f.faults != 0) ImGui::TextColored(vermilion, "%s: %s", say(Text::lost_device), fault_names(f.faults).c_str());
  const std::string under =
      has_mouse() || working ? "" : player.under(controls.cursor_x, controls.cursor_y, width, height);
  if (!working) line(say(Text::under_cursor), under.empty() ? "-" : under);
  ImGui::PushTextWrapPos(0);
  if (!controls.said.empty()) ImGui::TextColored(orange, "%s", translated_note(language_, controls.said).c_str());
  ImGui::PopTextWrapPos();
  note_list(player, height);
  ImGui::End();
}

// The newest first, and as bright as it is new; the others are reached by scrolling. However large the letters are, the
// list keeps within the window.
void Hud::note_list(const Player& player, int height) {
  const std::deque<Note>& notes = player.notes().kept();
  if (notes.empty()) return;
  ImGui::Separator();
  ImGui::TextColored(sky, "%s (%d)", say(Text::notes), int(player.notes().count()));
  for (const Note& note : player.notes().since(notes_seen_))
    note_lines_.push_back(clock_text(note.at_s) + "  " + translated_note(language_, note.text));
  while (note_lines_.size() > notes.size()) note_lines_.pop_front();
  const float letter = ImGui::GetTextLineHeightWithSpacing(), across = ImGui::GetContentRegionAvail().x;
  const float left = float(height) - 8 - ImGui::GetCursorScreenPos().y - ImGui::GetStyle().WindowPadding.y;
  const float most = std::clamp(left, 2 * letter, lines_of_notes * letter);
  float high = 0;
  for (std::size_t n = notes.size(); n-- > 0 && high < most;)
    high += ImGui::CalcTextSize(note_lines_[n].c_str(), nullptr, false, across).y + ImGui::GetStyle().ItemSpacing.y;
  ImGui::BeginChild("##notes", {0, std::min(high, most)});
  const double now_s = player.now_s();
  ImGui::PushTextWrapPos(0);
  for (std::size_t n = notes.size(); n-- > 0;) {
    const float share = float(freshness(notes[n], now_s));
    ImGui::TextColored({share, share, share, 1}, "%s", note_lines_[n].c_str());
  }
  ImGui::PopTextWrapPos();
  ImGui::EndChild();
}

void Hud::playback_panel(Player& player, int width, int height) {
  const Playback& p = *player.playback();
  ImGui::SetNextWindowPos({float(width) / 2, float(height) - 8}, ImGuiCond_Always, {0.5f, 1});
  ImGui::SetNextWindowSize({float(width) * 0.7f, 0}, ImGuiCond_Always);
  ImGui::Begin(say(Text::playback), nullptr, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove);
  if (ImGui::Button(say(player.paused() ? Text::go_on : Text::pause))) player.pause(!player.paused());
  ImGui::SameLine();
  float speed = float(player.speed);
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 8);
  if (ImGui::SliderFloat(say(Text::speed), &speed, -4, 8, "%.1f")) player.speed = speed;
  ImGui::SameLine();
  float at = float(p.time_s());
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderFloat("##time", &at, float(p.begin_s()), float(p.end_s()), "%.2f s")) player.go_to(at);
  ImGui::End();
}

void Hud::draw(Player& player, Controls& controls, const PictureTimes& times, int width, int height) {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  if (controls.panels_shown) {
    if (player.desk() && player.live())
      lesson_panel(player, controls);
    else
      patient_panel(player, height);
    if (player.desk() && player.playback()) score_panel(player, width, height);
    status_panel(player, controls, times, width, height);
    if (player.playback()) playback_panel(player, width, height);
  }
  if (player.has_xray()) xray_panel(player, controls, width, height);
  if (!player.shots_taken().empty()) shot_panel(player, width, height);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace trephine
