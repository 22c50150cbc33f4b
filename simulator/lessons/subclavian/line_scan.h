// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "cases/load_case.h"
#include "lesson/outcome_record.h"
#include "lessons/subclavian/subclavian_watch.h"
#include "texts/phrase.h"

namespace trephine::lessons {

/// What a CT with a central line shows as the lesson's facts: the needle's way as one pass from the skin to the vein,
/// and the line that went on from there, in the case's own anatomy. With a task it is the line of that side, or the
/// only one. What is doubtful is left out, and `seen` says so. Throws Error 64 where there is one on each side and no
/// task names one.
std::shared_ptr<LessonFacts> line_facts_of_scan(const lesson::OutcomeRecord& record, const cases::LoadedCase& loaded,
                                                const std::string& task);

/// Why no line can be judged: of a scan that shows none, or one that is doubtful; else empty.
texts::Phrase unseen_line(const SubclavianFacts& facts);

}  // namespace trephine::lessons
