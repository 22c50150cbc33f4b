// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "lessons/lesson_type.h"

namespace trephine::lessons {

/// What a case is good for as one lesson: what may be asked for in it, or why it cannot be done there.
struct LessonService {
  std::string lesson, summary;
  std::vector<std::string> tasks;  ///< as --task has them; the first is the usual one
  std::string why_not;             ///< empty: the case serves
};

/// Of every lesson that the program knows, by what case.json says: nothing else of the case is read, so a lesson may
/// still refuse a volume that it finds nothing in. Never throws for a case that a lesson cannot use.
std::vector<LessonService> lessons_served(const cases::CaseManifest& manifest);

}  // namespace trephine::lessons
