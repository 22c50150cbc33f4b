// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "library/library_state.h"

namespace trephine {

/// One command that Ninja starts for a library build: `trephine library job NAME`. What it has to do stands in memory
/// of the build that started Ninja (paths of series are never written to disk), and what becomes of it goes there too.

struct LibraryJob {
  std::string name;   ///< "case.TOKEN" or "phantom.NAME"
  std::string token;  ///< of the case; of a phantom its name
  bool is_phantom = false;
  std::vector<std::string> arguments;  ///< of trephine
  std::string settings_sha256;         ///< case
  std::string phantom;                 ///< case: whose series it needs; empty: none
  std::string identity;                ///< of the phantom
  std::filesystem::path library, series;
  double time_limit_s = 0;
  bool keep_going = true;
};

/// The environment's variables that say where jobs are read and events are written.
constexpr const char* jobs_variable = "TREPHINE_LIBRARY_JOBS";
constexpr const char* events_variable = "TREPHINE_LIBRARY_EVENTS";

std::string jobs_json(const std::vector<LibraryJob>& jobs);

struct JobEvent {
  std::string name;
  bool is_end = false;
  JobResult result;
};
/// One line, at most 4 KiB, so that it goes into a pipe in one piece.
std::string event_line(const JobEvent& event);
/// False where it is none.
bool parse_event(const std::string& line, JobEvent& event);

/// Does one job: runs trephine with its arguments, its output into the job's log, and records what was built.
/// Idempotent. A case that another run holds is tried again for a few seconds. Returns 0 where the job ended, well or
/// not, and the build wants the others all the same; else the job's exit code. Throws 64 where it was not started by a
/// build.
int run_library_job(const std::string& name);

}  // namespace trephine
