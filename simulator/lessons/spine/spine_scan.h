// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "cases/load_case.h"
#include "lesson/outcome_record.h"
#include "lessons/spine/needle_watch.h"

namespace trephine::lessons {

/// What a CT after the procedure shows as the lesson's facts: a screw, or a needle, as one pass that stays, straight
/// along its axis, in the case's own bone. With a task it is the screw in that pedicle, or the only one. What is
/// doubtful is left out, and `seen` says so. Throws Error 64 where there are several and no task names one.
std::shared_ptr<LessonFacts> screw_facts_of_scan(const lesson::OutcomeRecord& record, const cases::LoadedCase& loaded,
                                                 const std::string& task);
std::shared_ptr<LessonFacts> needle_facts_of_scan(const lesson::OutcomeRecord& record, const cases::LoadedCase& loaded,
                                                  const std::string& task);

/// Why nothing that was put in can be judged: of a scan that shows none, or one that is doubtful; else empty.
/// `needle`: of a needle, not a screw.
texts::Phrase unseen_in_scan(const SpineNeedleFacts& facts, bool needle = false);

}  // namespace trephine::lessons
