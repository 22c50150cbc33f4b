// SPDX-License-Identifier: GPL-3.0-or-later
#include "modules/lesson_script.h"

#include "base/error.h"
#include "base/write_file.h"
#include "lesson/declared_json.h"

namespace trephine {

std::vector<StepChoice> LessonScript::lesson_steps() {
  const ParameterSet* none = &parameters_of<NothingDeclared>();
  return {{"take", "Changes the tool.", &parameters_of<TakeStep>()},
          {"trace", "Draws a line on the skin with the pedal down.", &parameters_of<TraceStep>()},
          {"erase", "Takes the lines away.", none},
          {"incise", "Cuts the skin around the last point of the marker.", none},
          {"drill", "Drills a hole with the pedal down.", &parameters_of<DrillStep>()},
          {"insert", "Moves the tool on a straight line into the head.", &parameters_of<InsertStep>()},
          {"withdraw", "Draws the tool back.", &parameters_of<WithdrawStep>()},
          {"wait", "Stays where it is.", &parameters_of<WaitStep>()},
          {"pause", "Stops the lesson's clock.", none},
          {"resume", "Lets the lesson go on.", none},
          {"finish", "Ends the lesson with the tool where it is.", none},
          {"lose_device", "The device is gone, as when its cable is pulled.", none}};
}

LessonScript parse_lesson_script(const std::string& json) {
  LessonScript script;
  read_declared_json(json, parameters_of<LessonScript>(), &script);
  return script;
}

LessonScript read_lesson_script(const std::filesystem::path& file) {
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, 1 << 20);
    return parse_lesson_script({bytes.begin(), bytes.end()});
  });
}

}  // namespace trephine
