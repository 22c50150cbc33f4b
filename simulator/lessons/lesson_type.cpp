// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/lesson_type.h"

#include "base/error.h"
#include "base/text.h"

namespace trephine::lessons {

const LessonType& lesson_type(const std::string& name) {
  for (const LessonType& m : lesson_types())
    if (m.name == name) return m;
  throw Error(ExitCode::bad_input, "", "lesson", printable(name) + " is not known");
}

LessonTask task_of(const LessonType& type, const cases::CaseManifest& manifest, const std::string& name) {
  std::string known;
  for (const LessonTask& t : type.tasks(manifest)) {
    if (t.name == name) return t;
    known += (known.empty() ? "" : ", ") + t.name;
  }
  throw Error(
      ExitCode::bad_input, "", "task",
      printable(name) + " is no task of " + type.name + " in this case; it has " + (known.empty() ? "none" : known));
}

std::vector<std::string> lesson_names() {
  std::vector<std::string> names;
  for (const LessonType& m : lesson_types()) names.push_back(m.name);
  return names;
}

}  // namespace trephine::lessons
