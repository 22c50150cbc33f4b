// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "lessons/score_recording.h"

namespace trephine::lessons {

/// What a CT after a procedure shows, judged as the lesson of the rubric: by the same functions as a recording. The
/// recording of the result has no frames. `participant` is a token; `task` names what was asked for, or is empty.
/// Throws Error 65 and 66; 64 where no CT shows enough of that lesson to judge it, or the case holds no such task.
ScoredLesson score_outcome(const std::filesystem::path& outcome, const std::filesystem::path& case_folder,
                           const lesson::CompiledRubric& rubric, const std::string& participant,
                           const std::string& task);

}  // namespace trephine::lessons
