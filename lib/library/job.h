// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "library/library_state.h"

namespace trephine::library {

/// One command that Ninja starts for a library build: `trephine library job NAME`. Its task stands in memory of the
/// build that started Ninja (paths of series are never written to disk), and its result goes there too.

struct LibraryJob {
  std::string name;   ///< "case.TOKEN" or "phantom.NAME"
  std::string token;  ///< of the case, or the name of the phantom
  bool is_phantom = false;
  std::vector<std::string> arguments;  ///< command line of trephine
  std::string settings_sha256;         ///< for a case
  std::string phantom;                 ///< for a case: the phantom whose series it needs; empty: none
  std::string identity;                ///< for a phantom
  std::filesystem::path library, series;
  double time_limit_s = 0;
  bool keep_going = true;
  /// It is built in this node's temporary folder and then published in the library, which lies on another disk.
  bool on_node = false;
};

/// The environment variables that tell a job where to read its task and where to write its events.
constexpr const char* jobs_variable = "TREPHINE_LIBRARY_JOBS";
constexpr const char* events_variable = "TREPHINE_LIBRARY_EVENTS";

std::string jobs_json(const std::vector<LibraryJob>& jobs);

/// One job as one line, with its name; and back. The line holds the series' path. Throws Error 65 where it is none.
std::string job_line(const LibraryJob& job);
LibraryJob parse_job_line(const std::string& line);

struct JobEvent {
  std::string name;
  bool is_end = false;
  JobResult result;
};
/// The event as one line of at most 4 KiB, so that it goes into a pipe in one piece.
std::string event_line(const JobEvent& event);
/// Returns false where the line is not an event.
bool parse_event(const std::string& line, JobEvent& event);

/// Does one job and returns how it ended, whatever happened: what it could not do is the result's code and reason.
JobResult do_library_job(const LibraryJob& job);

/// Whether what the job makes is there: a phantom's record, or a case that was built of these settings and is whole.
bool is_done_already(const LibraryJob& job);

/// Does one job: runs trephine with its arguments, writes the output into the job's log, and records what was built.
/// The function is idempotent. A case that another run holds is tried again for a few seconds. Returns 0 where the job
/// ended, successfully or not, and the build wants to do the others in any case; else the job's exit code. Throws Error
/// 64 where it was not started by a build.
int run_library_job(const std::string& name);

}  // namespace trephine::library
