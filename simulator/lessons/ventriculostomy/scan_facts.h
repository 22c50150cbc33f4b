// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "lesson/outcome_record.h"
#include "lessons/ventriculostomy/ventriculostomy_watch.h"

namespace trephine::lessons {

/// What a CT after a ventriculostomy shows as the lesson's facts: the catheter as one pass that stays, along the course
/// that was found, in the case's own anatomy, and the surest hole. What is doubtful is left out, and `seen` says so.
std::shared_ptr<LessonFacts> facts_of_scan(const lesson::OutcomeRecord& record, const cases::LoadedCase& loaded,
                                           const std::string& task = "");

/// What a volume shows that another program drilled: the holes in the bone, each along the line from the middle of the
/// head, and that is all.
std::shared_ptr<LessonFacts> facts_of_drilled(const cases::LoadedCase& loaded, const voxel::HapticVolume& now);

}  // namespace trephine::lessons
