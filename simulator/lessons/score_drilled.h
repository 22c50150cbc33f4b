// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "lessons/score_recording.h"

namespace trephine::lessons {

/// What was drilled in a case's haptic volume in another program, judged as the lesson of the rubric: by the same
/// functions as a recording. `labels` is what `trephine drilled` writes: segments NAME_removed on the volume's voxels.
/// The recording of the result has no frames. `participant` is a token; `task` names what was asked for, or is empty.
/// Throws Error 65 where the labels are no such file of this case, and 66; 64 where a drilled volume does not show
/// enough of that lesson to judge it, or the case holds no such task.
ScoredLesson score_drilled(const std::filesystem::path& labels, const std::filesystem::path& case_folder,
                           const lesson::CompiledRubric& rubric, const std::string& participant,
                           const std::string& task);

}  // namespace trephine::lessons
