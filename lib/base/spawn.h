// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace trephine {

/// A program that runs beside ours and dies with it (PR_SET_PDEATHSIG), so call spawn from a thread that lives as long
/// as the program does. It reads nothing from stdin. It inherits no signal handler, no ignored SIGINT, SIGTERM, SIGPIPE
/// or SIGXFSZ, no blocked signal and none of our open files except those named here.
struct SpawnRequest {
  std::vector<std::string> argv;
  std::string program;           ///< what to run, looked for in PATH where it holds no '/'; empty: argv[0]
  std::filesystem::path folder;  ///< working folder; empty: ours
  std::filesystem::path output;  ///< file for stdout and stderr, emptied first, for us alone; none where it cannot be
                                 ///< made
  bool shares_stdout = false;    ///< it writes to our stdout instead
  bool shares_stderr = false;    ///< it writes to our stderr instead
  std::vector<std::pair<std::string, std::string>> environment;  ///< added to ours
  std::vector<std::string> without;  ///< what of ours it does not get: names, or how they begin, as in "SQUEUE_*"
  std::vector<int> descriptors;  ///< our descriptors that it gets as 3, 4, ...; with n of them each must be above 3 + n
  bool own_group = false;        ///< it runs in its own process group, so the terminal's Ctrl-C does not reach it
  bool core_file = true;         ///< false: it may not leave a core file
};

/// Starts the program, at the same cost however much memory we hold (vfork). Throws Error 70 where it cannot be
/// started.
pid_t spawn(const SpawnRequest& request);

struct Ended {
  bool ended = false;
  int code = 0;                     ///< exit code, or 128 + signal where a signal killed it
  int signal = 0;                   ///< the signal that killed it, or 0
  double memory_mb = 0, cpu_s = 0;  ///< of the program and of the processes that it waited for
};
/// Waits at most this long; 0 only looks whether the program has ended.
constexpr double until_it_ends_s = 1e9;
Ended wait_for(pid_t pid, double seconds);

/// The path of this program, for commands that it runs itself.
std::filesystem::path own_program();

}  // namespace trephine
