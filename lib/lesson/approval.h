// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/params.h"

namespace trephine::lesson {

/// Throws Error 64 naming the flag unless the text is 1 to 32 characters of a-z, 0-9, _ and -: a token, never a name.
void validate_token(const std::string& token, const std::string& flag);

/// What a reviewer said of a case: that lessons may use it, and how difficult it is. It lies beside the case
/// (approved.json) and is void for a case.json of another hash: compare it with that of the bytes that are parsed.
struct CaseApproval {
  std::string by;            ///< the reviewer's token
  int difficulty_level = 3;  ///< 1 easy to 5 hard
  std::string case_sha256;   ///< of case.json as it was approved
};

/// A lesson that the case cannot serve, and why it is approved all the same.
struct AcceptedLesson {
  std::string lesson, reason;
  template <class V>
  static void describe(V& v) {
    v.text(&AcceptedLesson::lesson, "lesson", "A lesson that the case cannot serve.").is_required();
    v.text(&AcceptedLesson::reason, "reason", "Why it is approved all the same.").is_required();
  }
};

/// Approves the case.json of that SHA-256, whatever lies in the folder by now. Throws Error 73 and 74.
void write_approval(const std::filesystem::path& case_folder, const std::string& case_sha256, const std::string& by,
                    int difficulty_level, const std::vector<AcceptedLesson>& accepted = {});
/// Nothing where the case was never approved. Throws Error 65 where the file is damaged.
std::optional<CaseApproval> read_approval(const std::filesystem::path& case_folder);
/// Whether there was one.
bool remove_approval(const std::filesystem::path& case_folder);

}  // namespace trephine::lesson
