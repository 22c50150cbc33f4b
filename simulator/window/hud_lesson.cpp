// SPDX-License-Identifier: GPL-3.0-or-later
// The panels of a lesson: what is to be done and was done, and the scores at its end.
#include <fmt/format.h>
#include <imgui.h>

#include <utility>

#include "lessons/lesson_guide.h"
#include "window/hud.h"
#include "window/hud_parts.h"

namespace trephine::window {

using namespace hud;

void Hud::lesson_panel(Player& player, Screen& screen) {
  const LessonController& lesson = *player.lesson();
  const Place& at = layout_.work;
  ImGui::SetNextWindowPos({at.x, at.y}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSizeConstraints({at.width, 0}, {at.width, at.height});
  ImGui::Begin(say(Text::lesson), nullptr, ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_AlwaysAutoResize);
  if (lesson.judging()) {
    ImGui::TextColored(sky, "%s", say(Text::judging));
    ImGui::End();
    return;
  }
  ImGui::TextColored(sky, "%s", player.view().stage().loaded().manifest.case_token.c_str());
  const lessons::LessonTask& task = lesson.task();
  if (!task.aim.empty()) {
    ImGui::TextWrapped("%s", lessons::aim_of(task, language_).c_str());
    ImGui::PushStyleColor(ImGuiCol_Text, grey);
    ImGui::TextWrapped("%s", lessons::indication_of(task, language_).c_str());
    ImGui::PopStyleColor();
  }
  if (const int open = lesson.questions().open(lesson.facts()); open >= 0) {
    const lessons::QuestionText& text = lesson.questions().text(open);
    const std::vector<std::string>& choices = lesson.questions().asked()[std::size_t(open)].choices;
    ImGui::Separator();
    ImGui::PushTextWrapPos(0);
    ImGui::TextColored(orange, "%s", text.question.of(language_).c_str());
    for (std::size_t n = 0; n < text.choices.size(); ++n) {
      if (button(fmt::format("{}##answer", n + 1).c_str()))
        screen.answer = act(action_of("answer"), player, screen, choices[n]).fault;
      ImGui::SameLine();
      ImGui::TextUnformatted(text.choices[n].of(language_).c_str());
    }
    ImGui::PopTextWrapPos();
    ImGui::Separator();
  }
  for (std::size_t n = 0; n < lesson.steps().size(); ++n) {
    const lessons::LessonGuide& step = lesson.steps()[n].guide;
    const bool now = n == lesson.step();
    ImGui::TextColored(now                 ? orange
                       : n < lesson.step() ? grey
                                           : white,
                       "%s %d. %s", now ? ">" : " ", int(n) + 1, translated(language_, step.text).c_str());
    if (!now || step.why.empty()) continue;  // the reason and the sign of what is to be done now
    ImGui::Indent();
    ImGui::TextWrapped("%s", translated(language_, step.why).c_str());
    ImGui::PushStyleColor(ImGuiCol_Text, sky);
    ImGui::TextWrapped("%s: %s", say(Text::sign), translated(language_, step.sign).c_str());
    ImGui::PopStyleColor();
    ImGui::Unindent();
  }
  if (lesson.paused()) ImGui::TextColored(vermilion, "%s", say(Text::paused));
  ImGui::Separator();
  line(say(Text::time), fmt::format("{:.1f} s", lesson.facts().procedure_s()));
  for (const lessons::LessonStatus& s : lesson.status())
    line(translated(language_, s.label).c_str(), translated(language_, s.value), sky);
  choice_buttons("tool", player, screen, player.tool());
  bool flows = false;
  for (const LessonStep& step : lesson.steps())
    if (step.command != haptics::belt_command::none && step.command != haptics::belt_command::finish)
      action_button(haptics::belt_command::names[step.command], player, screen, std::exchange(flows, true));
  action_button("pause", player, screen, flows);
  action_button("back", player, screen, false);
  action_button("next", player, screen, true);
  const Action& finish = action_of("finish");
  ImGui::TextColored(grey, "%s (%s)", finish.label.of(language_), keys_text(finish, language_).c_str());
  keys_list(player);
  ImGui::End();
}

void Hud::score_panel(const LessonController& lesson) {
  const lessons::ScoredLesson* scored = lesson.scored();
  if (!scored) return;
  const lessons::ScoreSum sum = lessons::sum_of(scored->score);
  const Place& at = layout_.scores;
  ImGui::SetNextWindowPos({at.x, at.y}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({at.width, at.height}, ImGuiCond_FirstUseEver);
  ImGui::Begin(fmt::format("{}###scores", say(Text::lesson)).c_str(), nullptr, ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::TextColored(sky, "%s: %d / %d", say(Text::points), sum.points, sum.most);
  ImGui::PushTextWrapPos(0);
  const bool failed = scored->score.outcome() == lessons::LessonOutcome::failed;
  ImGui::TextColored(failed ? vermilion : white, "%s", lessons::headline_of(scored->score, language_).c_str());
  for (const lessons::ScoreRow& row : scored->score.rows) {
    ImGui::TextColored(row.score && *row.score < 3 ? orange : white, "%s  %s",
                       row.score ? std::to_string(*row.score).c_str() : "-", translated(language_, row.title).c_str());
    ImGui::TextColored(grey, "     %s%s%s", row.score ? "" : say(Text::not_judged), row.score ? "" : ": ",
                       translated(language_, row.why).c_str());
    for (const lessons::Advice& a : scored->score.advice)
      if (a.row == row.name) ImGui::TextColored(sky, "     %s", a.of(language_).c_str());
  }
  if (const std::string page = lesson.lesson().report.page.string(); !page.empty())
    ImGui::TextColored(sky, "%s: %s", say(Text::report), page.c_str());
  ImGui::TextUnformatted(say(Text::review_help));
  ImGui::PopTextWrapPos();
  ImGui::End();
}

}  // namespace trephine::window
