// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace trephine::library {

/// What the simulator says of a case and one of its lessons.
struct LessonUse {
  std::string name;
  std::vector<std::string> tasks;
  std::vector<std::pair<std::string, std::string>> doubtful;  ///< a task, and why
  std::string why_not;                                        ///< empty: the case can serve
};

/// Of every lesson, as `trephine-sim lessons --json` says it, for the simulator alone knows the lessons; nothing where
/// it does not lie beside this program. Throws Error 65 with what it says where it cannot read the case, and where it
/// read another case.json than the one of that SHA-256, if one is given.
std::optional<std::vector<LessonUse>> lesson_uses(const std::filesystem::path& case_folder,
                                                  const std::string& case_sha256 = "");

}  // namespace trephine::library
