// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/lesson_type.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/error_text.h"
#include "base/joined.h"
#include "base/text.h"

namespace trephine::lessons {

const LessonType& lesson_type(const std::string& name) {
  for (const LessonType& m : lesson_types())
    if (m.name == name) return m;
  throw Error(ExitCode::bad_input, "", "lesson", printable(name) + " is not known");
}

std::string lesson_title(const std::string& name, texts::Language language) {
  for (const LessonType& m : lesson_types())
    if (m.name == name && language == texts::Language::german) return m.german_title;
  std::string title = name;
  std::replace(title.begin(), title.end(), '_', ' ');
  return title;
}

LessonTask task_of(const LessonType& type, const cases::CaseManifest& manifest, const std::string& name) {
  const std::vector<LessonTask> tasks = type.tasks(manifest);
  for (const LessonTask& t : tasks)
    if (t.name == name) return t;
  throw Error(ExitCode::bad_input, "", "task",
              printable(name) + " is no task of " + type.name + " in this case; it has " +
                  (tasks.empty() ? "none" : joined(tasks, ", ", &LessonTask::name)));
}

std::vector<LessonTask> offered_tasks(const LessonType& type, const cases::CaseManifest& manifest) {
  std::vector<LessonTask> all = type.tasks(manifest);
  all.erase(std::remove_if(all.begin(), all.end(), [](const LessonTask& t) { return !t.is_offered; }), all.end());
  return all;
}

LessonTask task_or_usual(const LessonType& type, const cases::CaseManifest& manifest, const std::string& name) {
  if (!name.empty()) return task_of(type, manifest, name);
  const std::vector<LessonTask> all = offered_tasks(type, manifest);
  return all.empty() ? LessonTask{} : all.front();
}

std::string class_fault(const LessonType& type, const std::string& patient_class) {
  const std::vector<std::string>& known = type.classes;
  if (known.empty()) return "";
  if (patient_class.empty()) return "has no class";
  if (std::find(known.begin(), known.end(), patient_class) == known.end())
    return "its class is " + printable(patient_class);
  return "";
}

std::string doubt_words(double confidence) {
  return fmt::format("confidence {:.2f}, below {:g}", confidence, sure_confidence);
}

LessonUse use_of(const LessonType& type, const cases::CaseManifest& manifest) {
  LessonUse out;
  try {
    if (manifest.haptic.file.empty()) throw Error(ExitCode::bad_input, "", "", "the case has no haptic volume");
    type.require(manifest);
    const std::string of_class = class_fault(type, class_of(manifest));
    for (const LessonTask& task : offered_tasks(type, manifest)) {
      out.tasks.push_back(task.name);
      const std::string doubt = task.doubt + (task.doubt.empty() || of_class.empty() ? "" : "; ") + of_class;
      if (!doubt.empty()) out.doubtful.emplace_back(task.name, doubt);
    }
    if (out.tasks.empty()) out.why_not = "the case holds no task of it";
  } catch (const Error& e) {
    out.why_not = error_text(e);
  }
  return out;
}

std::string class_of(const cases::CaseManifest& manifest) {
  for (const auto& [name, value] : manifest.figures)
    if (const std::string* text = std::get_if<std::string>(&value); text && name == "class") return *text;
  return "";
}

std::vector<std::string> lesson_names() {
  std::vector<std::string> names;
  for (const LessonType& m : lesson_types()) names.push_back(m.name);
  return names;
}

}  // namespace trephine::lessons
