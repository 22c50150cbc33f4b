// SPDX-License-Identifier: GPL-3.0-or-later
#include "lesson/approval.h"

#include <algorithm>

#include "base/error.h"
#include "base/write_file.h"
#include "json/declared_json.h"

namespace trephine::lesson {
namespace {

constexpr const char* approval_file = "approved.json";

struct ApprovalFile {
  int trephine_approval = 1;
  std::string case_sha256, by;
  int difficulty_level = 3;
  std::vector<AcceptedLesson> accepted;
  template <class V>
  static void describe(V& v) {
    using P = ApprovalFile;
    v.integer(&P::trephine_approval, "trephine_approval", Range{1, 1}, "The version of the format: 1.").is_required();
    v.text(&P::case_sha256, "case_sha256", "SHA-256 of case.json as it was approved.").is_required();
    v.text(&P::by, "by", "The reviewer's token.").is_required();
    v.integer(&P::difficulty_level, "difficulty_level", Range{1, 5}, "1 easy to 5 hard.").is_required();
    v.list(&P::accepted, "accepted", "Lessons that the case cannot serve, each with the reviewer's reason.");
  }
};

}  // namespace

void validate_token(const std::string& token, const std::string& flag) {
  const bool plain = std::all_of(token.begin(), token.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  if (!plain || token.empty() || token.size() > 32)
    throw Error(ExitCode::usage, "", flag, "must be 1 to 32 characters of a-z, 0-9, _ and -: a token, never a name");
}

void write_approval(const std::filesystem::path& folder, const std::string& case_sha256, const std::string& by,
                    int difficulty_level, const std::vector<AcceptedLesson>& accepted) {
  const ApprovalFile file{1, case_sha256, by, difficulty_level, accepted};
  write_file(folder / approval_file, json::declared_json(AnyParams::make<ApprovalFile>(file)) + "\n");
}

std::optional<CaseApproval> read_approval(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / approval_file;
  if (!std::filesystem::exists(file)) return {};
  return with_file(file.string(), [&] {
    const std::vector<char> bytes = read_file(file, 1 << 16);
    ApprovalFile said;
    json::read_declared_json({bytes.data(), bytes.size()}, parameters_of<ApprovalFile>(), &said);
    return CaseApproval{said.by, said.difficulty_level, said.case_sha256};
  });
}

bool remove_approval(const std::filesystem::path& folder) { return std::filesystem::remove(folder / approval_file); }

}  // namespace trephine::lesson
