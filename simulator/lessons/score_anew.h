// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "lesson/rubric.h"
#include "lessons/results.h"

namespace trephine::lessons {

/// By what the results of a folder are scored anew.
struct ScoreAnew {
  std::filesystem::path cases;            ///< holds the case of each attempt, in a folder of its token
  lesson::CompiledRubric rubric;          ///< attempts of other lessons stay as they are
  std::filesystem::path cache = {};       ///< keeps what was scored, by digest; empty: nothing is kept
  std::filesystem::path public_key = {};  ///< of the teacher; empty: nobody asks who signed
};

/// Puts in place of each report of the rubric's lesson what its recording gives, replayed and scored by the rubric. An
/// attempt whose recording is gone is left out and noted; so is, as a note, each that had been scored by another
/// rubric. A report that names the same rubric and says something else than its recording gives was edited: throws
/// Error 80, naming it, the field and both values. A signature that does not fit is noted, and its attempt is not
/// signed. Throws as score_recording does, and 66 where a case is missing.
///
/// What the cache holds is believed: nobody but the one who calls should be able to write there.
void score_anew(Results& results, const ScoreAnew& params);

}  // namespace trephine::lessons
