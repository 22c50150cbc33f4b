// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/lessons_served.h"

#include <algorithm>

#include "base/error.h"
#include "base/text.h"

namespace trephine::lessons {
namespace {

// A lesson that is exercised by classes takes no case of another class, or of none.
std::string class_fault(const LessonType& type, const cases::CaseManifest& manifest) {
  if (type.classes.empty()) return "";
  std::string patient_class;
  for (const auto& [name, value] : manifest.figures)
    if (const auto* text = std::get_if<std::string>(&value); text && name == "class") patient_class = *text;
  if (patient_class.empty()) return "the case has no class, so `exercise` leaves it out";
  if (std::find(type.classes.begin(), type.classes.end(), patient_class) != type.classes.end()) return "";
  return "its class is " + printable(patient_class) + ", so `exercise` leaves it out";
}

}  // namespace

std::vector<LessonService> lessons_served(const cases::CaseManifest& manifest) {
  std::vector<LessonService> all;
  for (const LessonType& type : lesson_types()) {
    LessonService& s = all.emplace_back();
    s.lesson = type.name;
    s.summary = type.summary;
    try {
      if (manifest.haptic.file.empty()) throw Error(ExitCode::bad_input, "", "", "the case has no haptic volume");
      type.require(manifest);
      for (const LessonTask& t : type.tasks(manifest)) s.tasks.push_back(t.name);
      if (s.tasks.empty()) s.why_not = "the case holds no place that it could ask for";
    } catch (const Error& e) {
      s.why_not = e.what();
    }
    if (s.why_not.empty()) s.why_not = class_fault(type, manifest);
  }
  return all;
}

}  // namespace trephine::lessons
