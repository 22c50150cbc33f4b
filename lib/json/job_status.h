// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace trephine::json {

/// How far a program is that another program started, and how it ended: values, so that nobody reads its log for them.
struct JobStatus {
  struct Stage {
    std::string name;     ///< "skull.decimate"
    double fraction = 0;  ///< of this stage
  };
  double fraction = -1;       ///< of all that the program does; below 0: not known
  std::vector<Stage> stages;  ///< at work, in the order in which they began
  /// Why it ended, each as its line without the program's name and the case's token; empty before that, and where it
  /// ended well. They may hold a path that was typed.
  std::vector<std::string> errors;
  bool out_of_memory = false;
};

/// The environment variable in which the one program names the file that the other writes.
constexpr const char* job_status_variable = "TREPHINE_JOB_STATUS";

/// Replaces the file: who reads it sees the old status or the new one. A failure is ignored: that nobody can see how
/// far a program is stops no program.
void write_job_status(const std::filesystem::path& file, const JobStatus& status);

/// Nothing where the file is missing or damaged.
std::optional<JobStatus> read_job_status(const std::filesystem::path& file);

}  // namespace trephine::json
