// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/lesson_script.h"

#include <algorithm>

#include "base/error.h"
#include "base/write_file.h"
#include "json/declared_json.h"
#include "lessons/lesson_type.h"

namespace trephine::lessons {

std::vector<StepChoice> with_common_steps(std::vector<StepChoice> own) {
  std::vector<StepChoice> all = {script_step<TakeStep>("take", "Changes the tool.")};
  all.insert(all.end(), own.begin(), own.end());
  for (const StepChoice& s :
       {script_step<WithdrawStep>("withdraw", "Draws the tool back."),
        script_step<WaitStep>("wait", "Stays where it is."),
        script_step<AnswerStep>("answer", "Answers a question of the rubric."),
        script_step("pause", "Stops the lesson's clock."), script_step("resume", "Lets the lesson go on."),
        script_step("finish", "Ends the lesson with the tool where it is."),
        script_step("lose_device", "The device is gone, as when its cable is pulled.")})
    all.push_back(s);
  return all;
}

bool LessonScript::answers() const {
  return std::any_of(steps.begin(), steps.end(), [](const auto& step) { return step.first == "answer"; });
}

std::vector<std::string> LessonScript::modules() { return lesson_names(); }

std::vector<StepChoice> LessonScript::steps_of_all() {
  std::vector<StepChoice> all;
  for (const LessonType& m : lesson_types())
    for (const StepChoice& s : m.steps)
      if (std::none_of(all.begin(), all.end(), [&](const StepChoice& k) { return k.name == s.name; })) all.push_back(s);
  return all;
}

LessonScript parse_lesson_script(const std::string& json) {
  LessonScript script;
  json::read_declared_json(json, parameters_of<LessonScript>(), &script);
  const LessonType& module = lesson_type(script.module);
  for (std::size_t n = 0; n < script.steps.size(); ++n) {
    const std::string& name = script.steps[n].first;
    if (std::none_of(module.steps.begin(), module.steps.end(), [&](const StepChoice& s) { return s.name == name; }))
      throw Error(ExitCode::bad_input, "", "steps[" + std::to_string(n) + "]",
                  name + ", no step of the lesson " + module.name);
  }
  return script;
}

LessonScript read_lesson_script(const std::filesystem::path& file) {
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, 1 << 20);
    return parse_lesson_script({bytes.begin(), bytes.end()});
  });
}

}  // namespace trephine::lessons
