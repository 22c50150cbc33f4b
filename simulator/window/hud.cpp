// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/hud.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include "base/error.h"
#include "window/hud_parts.h"

namespace trephine::window {

using namespace hud;

namespace {

constexpr float letter_px = 13;
constexpr const char* typeface = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";  // of fonts-dejavu-core
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

void choice_buttons(const char* name, Player& player, Screen& screen, const std::string& held) {
  const Action& action = action_of(name);
  bool first = true;
  for (const std::string& choice : action.choices(player)) {
    const std::string label = translated_name(screen.language, choice);
    if (!std::exchange(first, false)) flow_on(label);
    if (choice == held) ImGui::PushStyleColor(ImGuiCol_Button, ImVec4(0.1f, 0.45f, 0.65f, 1));
    if (button((label + "##" + name + choice).c_str())) screen.answer = act(action, player, screen, choice).fault;
    if (choice == held) ImGui::PopStyleColor();
  }
}

void action_button(const char* name, Player& player, Screen& screen, bool flows) {
  const Action& action = action_of(name);
  const std::string keys = keys_text(action, screen.language);
  const std::string label = action.label.of(screen.language) + (keys.empty() ? "" : " (" + keys + ")");
  if (flows) flow_on(label);
  if (!button(label.c_str())) return;
  const std::string words = action.keys.empty() ? "" : action.keys.front().words;
  const Reply reply = act(action, player, screen, words);
  screen.answer = reply.told.empty() ? reply.fault : texts::Note{texts::NoteId::verbatim, {reply.told}};
}

void action_box(const char* name, bool on, Player& player, Screen& screen) {
  const Action& action = action_of(name);
  if (ImGui::Checkbox(action.label.of(screen.language), &on))
    screen.answer = act(action, player, screen, on ? "on" : "off").fault;
}

}  // namespace hud

Hud::Hud(GlfwWindow& window, double scale, texts::Language language) : scale_(scale), language_(language) {
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // no file beside the user's
  ImGui::StyleColorsDark();
  ImGui::GetStyle().Colors[ImGuiCol_WindowBg].w = 0.78f;
  ImGui::GetStyle().WindowRounding = 4;
  ImGui::GetStyle().ScaleAllSizes(float(scale));
  ImFontConfig font;
  font.SizePixels = std::round(letter_px * float(scale));
  if (std::filesystem::exists(typeface))
    ImGui::GetIO().Fonts->AddFontFromFileTTF(typeface, font.SizePixels, &font);
  else
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

void Hud::keys_list(const Player& player) {
  if (!ImGui::CollapsingHeader(say(Text::keys))) return;
  ImGui::PushTextWrapPos(0);
  ImGui::TextUnformatted(keys_help(player, language_).c_str());
  ImGui::PopTextWrapPos();
}

void Hud::patient_panel(Player& player, Screen& screen) {
  // As high as what it shows: a cut adds to it. Where its place is too low for that it is scrolled.
  const Place& at = layout_.work;
  ImGui::SetNextWindowPos({at.x, at.y}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSizeConstraints({at.width, 0}, {at.width, at.height});
  ImGui::Begin(player.view().manifest().case_token.c_str(), nullptr,
               ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::PushItemWidth(ImGui::GetFontSize() * 14);
  ImGui::TextColored(sky, "%s", say(Text::anatomies));
  render::Stage& stage = player.view().stage();
  for (std::size_t n = 0; n < stage.scene().surfaces.size(); ++n) {
    float opacity = float(stage.state.opacity[n]);
    if (ImGui::SliderFloat(stage.scene().surfaces[n].name.c_str(), &opacity, 0, 1, "%.2f"))
      player.view().set_opacity(stage.scene().surfaces[n].name, opacity);
  }
  ImGui::TextColored(sky, "%s", say(Text::view));
  choice_buttons("view", player, screen);
  action_box("places", !stage.state.markers.empty(), player, screen);
  action_box("dust", stage.view().dust, player, screen);
  if (stage.loaded().has_ct()) action_box("slices", !stage.state.ct_planes.empty(), player, screen);
  ImGui::TextColored(sky, "%s", say(Text::cut_away));
  choice_buttons("cut", player, screen);
  if (stage.state.cut) {
    float moved = 0;
    if (ImGui::SliderFloat(say(Text::move_plane), &moved, -5, 5, "%.1f")) player.view().move_cut(moved);
    ImGui::Checkbox(say(Text::shows_ct), &stage.state.cut_shows_ct);
  }
  if (!action_of("cast").choices(player).empty()) {
    ImGui::TextColored(sky, "%s", say(Text::cast));
    choice_buttons("cast", player, screen);
    action_box("editor", screen.editor_shown, player, screen);
  }
  if (player.live()) {
    ImGui::TextColored(sky, "%s", say(Text::tool));
    choice_buttons("tool", player, screen, player.tool());
  }
  keys_list(player);
  ImGui::PopItemWidth();
  ImGui::End();
}

void Hud::status_panel(const Player& player, const Screen& screen, const PictureTimes& times) {
  const CaseView& view = player.view();
  const Place& at = layout_.status;
  ImGui::SetNextWindowPos({at.x, at.y}, ImGuiCond_Always);
  ImGui::SetNextWindowSizeConstraints({at.width, 0}, {at.width, at.height});
  ImGui::Begin("##status", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoResize |
                   ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoFocusOnAppearing);
  const haptics::ServoFrame& f = view.frame();
  const bool working = player.in_lesson();
  if (!working) line(say(Text::time), fmt::format("{:.2f} s", f.time_s));
  line(say(Text::tool),
       translated_name(language_, player.tool()) +
           (player.live() && !player.in_lesson() && player.live()->holds_burr()
                ? fmt::format(" {:g} mm", player.live()->burr_mm())
                : "") +
           (f.buttons & haptics::Drilling::pedal ? fmt::format(" [{}]", say(Text::pedal)) : ""),
       f.buttons & haptics::Drilling::pedal ? orange : white);
  if (!working) {  // a surgeon is not told where the tip is
    line(say(Text::inside), f.inside ? view.shape_name(f.inside) : say(Text::nothing));
    line(say(Text::depth), fmt::format("{:.1f} mm", view.depth_mm()));
  }
  if (view.target_mm() >= 0 && !working) line(say(Text::to_target), fmt::format("{:.1f} mm", view.target_mm()));
  if (const auto behind = view.behind_mm())
    line(say(Text::behind_target), fmt::format("{:.1f} mm", *behind), std::abs(*behind) > 5 ? orange : white);
  if (player.live() && player.live()->ink_mm() > 0)
    line(say(Text::last_trace), fmt::format("{:.0f}", player.live()->ink_mm()), sky);
  if (view.traces()) line(say(Text::trace), fmt::format("{:.0f} mm", view.trace_mm()));
  const double force =
      std::sqrt(f.force_n[0] * f.force_n[0] + f.force_n[1] * f.force_n[1] + f.force_n[2] * f.force_n[2]);
  line(say(Text::force),
       fmt::format("{:.2f} N{}", force, f.touched && !working ? ", " + view.shape_name(f.touched) : ""),
       force > 1 ? orange : white);
  const std::vector<float> forces(view.forces().begin(), view.forces().end());
  ImGui::PlotLines("##forces", forces.data(), int(forces.size()), 0, nullptr, 0, 3.5f,
                   {ImGui::GetContentRegionAvail().x, ImGui::GetFontSize() * 3});
  if (!working) show_times(player, times);
  if (f.faults != 0)
    ImGui::TextColored(vermilion, "%s: %s", say(Text::lost_device), haptics::fault_names(f.faults).c_str());
  const std::string under = has_mouse() || working ? "" : view.under(screen.cursor);
  if (!working) line(say(Text::under_cursor), under.empty() ? "-" : under);
  ImGui::PushTextWrapPos(0);
  if (screen.answer) ImGui::TextColored(orange, "%s", texts::text_of(*screen.answer, language_).c_str());
  ImGui::PopTextWrapPos();
  for (const TimedNote& note : player.notes.since(notes_seen_))
    note_lines_.push_back(clock_text(note.at_s) + "  " + texts::text_of(note.note, language_));
  while (note_lines_.size() > player.notes.kept().size()) note_lines_.pop_front();
  note_list(player.notes, false, screen.cursor.height);
  if (ImGui::CollapsingHeader(say(Text::log))) {
    if (working) show_times(player, times);
    note_list(player.notes, true, screen.cursor.height);
  }
  ImGui::End();
}

void Hud::show_times(const Player& player, const PictureTimes& times) {
  line(say(Text::picture), fmt::format("{:.1f} ms, {:.0f}/s", times.ms, times.per_s));
  if (!times.reduced.empty()) {
    ImGui::PushTextWrapPos(0);
    ImGui::TextColored(orange, "%s: %s", say(Text::reduced), times.reduced.c_str());
    ImGui::PopTextWrapPos();
  }
  if (player.live())
    line(say(Text::servo), fmt::format("{:.0f} Hz, {} {:.1f} ms", player.live()->servo_hz(), say(Text::late),
                                       player.live()->late_us() / 1000));
}

// The newest first, and as bright as it is new; the others are reached by scrolling. However large the letters are, the
// list keeps within the window. `log`: what tells how the program does, in place of what the user should know.
void Hud::note_list(const Notes& all, bool log, int height) {
  const std::deque<TimedNote>& notes = all.kept();
  std::vector<std::size_t> listed;
  for (std::size_t n = notes.size(); n-- > 0;)
    if (texts::is_for_log(notes[n].note.id) == log) listed.push_back(n);
  if (listed.empty()) return;
  if (!log) {
    ImGui::Separator();
    ImGui::TextColored(sky, "%s (%d)", say(Text::notes), int(listed.size()));
  }
  const float letter = ImGui::GetTextLineHeightWithSpacing(), across = ImGui::GetContentRegionAvail().x;
  const float left = float(height) - 8 - ImGui::GetCursorScreenPos().y - ImGui::GetStyle().WindowPadding.y;
  const float most = std::clamp(left, 2 * letter, lines_of_notes * letter);
  float high = 0;
  for (const std::size_t n : listed)
    high += ImGui::CalcTextSize(note_lines_[n].c_str(), nullptr, false, across).y + ImGui::GetStyle().ItemSpacing.y;
  ImGui::BeginChild(log ? "##log" : "##notes", {0, std::min(high, most)});
  const double now_s = all.now_s();
  ImGui::PushTextWrapPos(0);
  for (const std::size_t n : listed) {
    const float share = float(freshness(notes[n], now_s));
    ImGui::TextColored({share, share, share, 1}, "%s", note_lines_[n].c_str());
  }
  ImGui::PopTextWrapPos();
  ImGui::EndChild();
}

void Hud::playback_panel(ShownRecording& shown) {
  const session::Playback& p = shown.playback();
  const Place& place = layout_.time;
  ImGui::SetNextWindowPos({place.x, place.y}, ImGuiCond_Always);
  ImGui::SetNextWindowSize({place.width, place.height}, ImGuiCond_Always);
  ImGui::Begin(say(Text::playback), nullptr, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove);
  if (ImGui::Button(say(shown.paused ? Text::go_on : Text::pause))) shown.paused = !shown.paused;
  ImGui::SameLine();
  float speed = float(shown.speed);
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 8);
  if (ImGui::SliderFloat(say(Text::speed), &speed, -4, 8, "%.1f")) shown.speed = speed;
  ImGui::SameLine();
  float at = float(p.time_s());
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderFloat("##time", &at, float(p.begin_s()), float(p.end_s()), "%.2f s")) shown.go_to(at);
  ImGui::End();
}

void Hud::draw(Player& player, Screen& screen, const PictureTimes& times) {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  if (screen.mirror != render::Mirror::none) {
    ImGuiIO& io = ImGui::GetIO();
    double x = double(io.MousePos.x), y = double(io.MousePos.y);
    render::mirror_place(screen.mirror, int(io.DisplaySize.x), int(io.DisplaySize.y), x, y);
    if (ImGui::IsMousePosValid(&io.MousePos)) io.MousePos = {float(x), float(y)};
  }
  metal_ = screen.metal;
  ImGui::NewFrame();
  const bool has_shots = player.shots() && !player.shots()->shots().empty();
  layout_ =
      Layout(float(screen.cursor.width), float(screen.cursor.height), ImGui::GetFontSize(),
             player.xrays() && player.live(), player.lesson() && player.shown(), has_shots, player.shown() != nullptr);
  const Place& free = layout_.patient;
  const bool beside = screen.panels_shown || (player.xrays() && player.live());  // of the fluoroscope's monitor
  player.view().set_room(screen.panels_shown ? free.x : 0, beside ? free.x + free.width : screen.cursor.width,
                         screen.cursor.width, screen.cursor.height);
  inset_letters(player, screen.cursor.width, screen.cursor.height);
  if (screen.panels_shown) {
    if (player.in_lesson())
      lesson_panel(player, screen);
    else
      patient_panel(player, screen);
    if (player.lesson() && player.shown()) score_panel(*player.lesson());
    status_panel(player, screen, times);
    if (player.shown()) playback_panel(*player.shown());
    if (screen.editor_shown && !player.in_lesson()) transfer_panel(player, screen);
  }
  if (player.xrays() && player.live()) xray_panel(player, screen);
  if (has_shots) shot_panel(player);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace trephine::window
