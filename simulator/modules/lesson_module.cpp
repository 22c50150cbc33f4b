// SPDX-License-Identifier: GPL-3.0-or-later
#include "modules/lesson_module.h"

#include "base/error.h"
#include "base/text.h"

namespace trephine {

const LessonModule& lesson_module(const std::string& name) {
  for (const LessonModule& m : module_types())
    if (m.name == name) return m;
  throw Error(ExitCode::bad_input, "", "lesson", printable(name) + " is not known");
}

std::vector<std::string> module_names() {
  std::vector<std::string> names;
  for (const LessonModule& m : module_types()) names.push_back(m.name);
  return names;
}

}  // namespace trephine
