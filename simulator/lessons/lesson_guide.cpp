// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/lesson_guide.h"

#include <fmt/format.h>

#include "base/joined.h"
#include "lessons/report_pictures.h"

namespace trephine::lessons {
namespace {

constexpr texts::Wording task_word{{"Task", "Aufgabe"}}, why_word{{"Why", "Warum"}}, sign_word{{"Sign", "Zeichen"}},
    steps_word{{"What was to be done, why, and how one sees that it is right",
                "Was zu tun war, warum, und woran man sieht, dass es richtig ist"}},
    tools_word{{"Tools", "Instrumente"}};

}  // namespace

const std::string& aim_of(const LessonTask& task, texts::Language language) {
  return language == texts::Language::german && !task.german_aim.empty() ? task.german_aim : task.aim;
}

const std::string& indication_of(const LessonTask& task, texts::Language language) {
  return language == texts::Language::german && !task.german_indication.empty() ? task.german_indication
                                                                                : task.indication;
}

std::vector<LessonGuide> guide_of(const LessonType& type, const LessonFacts& facts) {
  std::vector<LessonGuide> steps;
  if (type.guide) steps = type.guide(facts);
  if (!steps.empty()) return steps;
  for (const haptics::BeltToolParams& t : type.tools()) {
    steps.emplace_back();
    steps.back().text = steps.back().tool = t.name;
  }
  steps.emplace_back();
  steps.back().text = "Finish the lesson";
  steps.back().command = "finish";
  return steps;
}

bool is_for_tool(const LessonGuide& step, const std::string& tool) {
  if (step.tool.empty()) return false;
  if (step.tool.back() != '*') return step.tool == tool;
  return tool.compare(0, step.tool.size() - 1, step.tool, 0, step.tool.size() - 1) == 0;
}

LessonBriefing briefing_of(const LessonType& type, const cases::LoadedCase& loaded, const std::string& task) {
  type.require(loaded.manifest);
  LessonBriefing out;
  out.task = task_or_usual(type, loaded.manifest, task);
  out.steps = guide_of(type, type.begin(loaded.manifest, loaded.haptic, loaded.haptic)->facts());
  return out;
}

std::string briefing_text(const LessonType& type, const LessonBriefing& b, texts::Language language) {
  std::string text;
  if (!b.task.name.empty())
    text += fmt::format("{} {}: {}\n  {}\n", task_word.of(language), b.task.name, aim_of(b.task, language),
                        indication_of(b.task, language));
  text += fmt::format("{}: {}\n", tools_word.of(language), joined(type.tools(), ", ", &haptics::BeltToolParams::name));
  for (std::size_t n = 0; n < b.steps.size(); ++n) {
    text += fmt::format("{}. {}\n", n + 1, lesson_words(language, b.steps[n].text));
    for (const auto& [word, said] :
         {std::pair<const texts::Wording&, const std::string&>{why_word, b.steps[n].why}, {sign_word, b.steps[n].sign}})
      if (!said.empty()) text += fmt::format("   {}: {}\n", word.of(language), lesson_words(language, said));
  }
  return text;
}

std::string steps_html(const std::vector<LessonGuide>& steps, texts::Language language) {
  std::string out = fmt::format("<details><summary>{}</summary><ol>\n", steps_word.of(language));
  const auto said = [&](const std::string& text) { return detail::escaped(lesson_words(language, text)); };
  for (const LessonGuide& s : steps)
    out += fmt::format("<li><b>{}</b><br>{}<br><span class=\"faint\">{}</span>\n", said(s.text), said(s.why),
                       said(s.sign));
  return out + "</ol></details>\n";
}

}  // namespace trephine::lessons
