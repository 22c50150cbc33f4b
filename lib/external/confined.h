// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/progress.h"

namespace trephine::external {

/// Somebody else's program, run with limits.
struct ConfinedRequest {
  std::vector<std::string> argv;  ///< argv[0] is an absolute path
  std::filesystem::path folder;   ///< its working folder, the only place where it may write
  std::filesystem::path log;      ///< its stdout and stderr
  std::vector<std::pair<std::string, std::string>> environment;  ///< all of it
  std::vector<std::string> may_write;                            ///< further folders in which it may write
  double time_limit_s = 3600;                                    ///< wall clock
  double memory_limit_gb = 16;                                   ///< memory of its own of all its processes together
  double file_limit_gb = 16;                                     ///< of each file that it writes
  bool require_confined = false;  ///< it is not started where the kernel does not confine it
};

struct ConfinedResult {
  int code = 0;    ///< exit code, or 0 where a signal ended it
  int signal = 0;  ///< the signal that ended it, or 0
  bool timed_out = false, over_memory = false;
  std::string not_started;  ///< why it could not be started; empty where it was
  /// What the kernel did not allow, each with the reason; empty where it is confined.
  std::string network_open, services_open, files_open, attributes_open, processes_open;
};

/// Runs the program and waits. It gets no network (a user, process and network namespace of its own, in which only
/// loopback is up), may write beneath `folder`, `may_write`, /dev and nowhere else (Landlock), changes neither modes,
/// times nor attributes of files elsewhere (a mount namespace that can only be read), sees no process but its own, may
/// neither trace nor read others (seccomp), gains no privilege, and leaves no core file. Where the kernel does not
/// allow that, it runs without and the result says so. It may read what the user may read. None of its processes
/// outlives the call, nor this program: they die with the namespace, or are found as descendants where there is none.
///
/// Memory is the resident memory that is not shared, looked at 20 times a second, because programs that use a GPU
/// reserve address space far beyond what they use.
///
/// Throws Error 70 where no child process can be started, or where it must be confined and cannot be; Cancelled.
ConfinedResult run_confined(const ConfinedRequest& request, const Progress& progress = {});

}  // namespace trephine::external
