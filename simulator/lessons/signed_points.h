// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "lesson/rubric.h"

namespace trephine::lessons {

/// What a teacher's signature says of an attempt. It is of the recording alone; points are signed where they are those
/// that the signed recording gives in its case by its rubric.
enum class SignedState {
  not_signed,
  recording,     ///< the recording is signed, and nobody compared the points: no rubric or no case is at hand
  other_rubric,  ///< the report is what the recording gives, which names another rubric or none
  points,        ///< the report is what the signed recording gives
};
const char* to_text(SignedState state);

/// An attempt of a participant's plan: whose it is, and where its files lie.
struct SignedAttempt {
  std::string participant, module, case_token;
  std::filesystem::path recording, report;
};

/// Compares them with the signature beside the recording. `case_folder` is empty where the case is not at hand,
/// `rubric` null where none was given. A report that is not there is not compared.
///
/// Throws Error 80, naming the file and the field, where the recording is signed and is another participant's, of
/// another lesson or case, or where the report says anything else than it gives: other points, or another recording's
/// or rubric's; as signature_state and score_recording do; 65 where the report is damaged.
SignedState signed_state(const SignedAttempt& attempt, const std::filesystem::path& case_folder,
                         const lesson::CompiledRubric* rubric, const std::filesystem::path& public_key);

}  // namespace trephine::lessons
