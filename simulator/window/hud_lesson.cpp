// SPDX-License-Identifier: GPL-3.0-or-later
// The panels of a lesson: what is to be done and was done, and the scores at its end.
#include <fmt/format.h>
#include <imgui.h>

#include "window/hud.h"
#include "window/hud_parts.h"

namespace trephine {

using namespace hud;

void Hud::lesson_panel(Player& player, Controls& controls) {
  const LessonDesk& desk = *player.desk();
  const LessonFacts& f = desk.facts();
  ImGui::SetNextWindowPos({8, 8}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({ImGui::GetFontSize() * 22, 0}, ImGuiCond_FirstUseEver);
  ImGui::Begin(say(Text::lesson), nullptr, ImGuiWindowFlags_NoFocusOnAppearing);
  if (desk.judging()) {
    ImGui::TextColored(sky, "%s", say(Text::judging));
    ImGui::End();
    return;
  }
  if (!desk.task().aim.empty()) ImGui::TextWrapped("%s", desk.task().aim.c_str());
  for (std::size_t n = 0; n < desk.steps().size(); ++n)
    ImGui::TextColored(n == desk.step()  ? orange
                       : n < desk.step() ? grey
                                         : ImVec4(1, 1, 1, 1),
                       "%s %d. %s", n == desk.step() ? ">" : " ", int(n) + 1,
                       translated(language_, desk.steps()[n].text).c_str());
  if (desk.paused()) ImGui::TextColored(vermilion, "%s", say(Text::paused));
  ImGui::Separator();
  line(say(Text::time), fmt::format("{:.1f} s", f.procedure_s()));
  for (const LessonStatus& s : desk.status())
    line(translated(language_, s.label).c_str(), translated(language_, s.value), sky);
  tool_buttons(language_, player, 3);
  const auto command = [&](Text text, const char* name, bool on_line) {
    if (on_line) ImGui::SameLine();
    if (button(say(text))) controls.said = player.lesson_command(name);
  };
  bool on_line = false;
  for (const LessonStep& step : desk.steps()) {
    if (step.command == belt_command::none || step.command == belt_command::finish) continue;
    const Text text = step.command == belt_command::erase    ? Text::erase
                      : step.command == belt_command::incise ? Text::incise_key
                                                             : Text::aspirate_key;
    command(text, belt_command::names[step.command], on_line);
    on_line = true;
  }
  command(Text::pause_key, desk.paused() ? "resume" : "pause", on_line);
  command(Text::back, "back", false);
  command(Text::next, "next", true);
  ImGui::TextColored(grey, "%s", say(Text::finish_key));
  if (ImGui::CollapsingHeader(say(Text::keys))) ImGui::TextUnformatted(say(Text::keys_help));
  ImGui::End();
}

void Hud::score_panel(const Player& player, int width, int height) {
  const ScoredLesson* scored = player.desk()->scored();
  if (!scored) return;
  const ScoreSum sum = sum_of(scored->score);
  // Above the recording's panel, beside the anatomies.
  ImGui::SetNextWindowPos({float(width) - 8, float(height) - 5 * ImGui::GetFontSize()}, ImGuiCond_FirstUseEver, {1, 1});
  ImGui::SetNextWindowSize({ImGui::GetFontSize() * 30, 0}, ImGuiCond_FirstUseEver);
  ImGui::Begin(fmt::format("{}###scores", say(Text::lesson)).c_str(), nullptr, ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::TextColored(sky, "%s: %d / %d", say(Text::points), sum.points, sum.most);
  ImGui::PushTextWrapPos(0);
  const bool failed = scored->score.outcome() == LessonOutcome::failed;
  ImGui::TextColored(failed ? vermilion : ImVec4(1, 1, 1, 1), "%s", headline_of(scored->score).c_str());
  for (const ScoreRow& row : scored->score.rows) {
    ImGui::TextColored(row.score && *row.score < 3 ? orange : ImVec4(1, 1, 1, 1), "%s  %s",
                       row.score ? std::to_string(*row.score).c_str() : "-", row.title.c_str());
    ImGui::TextColored(grey, "     %s%s%s", row.score ? "" : say(Text::not_judged), row.score ? "" : ": ",
                       row.why.c_str());
  }
  if (const std::string page = player.desk()->lesson().report.page.string(); !page.empty())
    ImGui::TextColored(sky, "%s: %s", say(Text::report), page.c_str());
  ImGui::TextUnformatted(say(Text::review_help));
  ImGui::PopTextWrapPos();
  ImGui::End();
}

}  // namespace trephine
