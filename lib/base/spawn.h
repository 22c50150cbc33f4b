// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace trephine {

/// A program that runs beside us and dies with us (PR_SET_PDEATHSIG): call from a thread that lives as long as it. It
/// reads nothing from stdin; no handler, no ignored SIGINT, SIGTERM, SIGPIPE or SIGXFSZ, no blocked signal and no open
/// file of ours reaches it but what is named here.
struct SpawnRequest {
  std::vector<std::string> argv;
  std::string program;           ///< to run, looked for in PATH where it holds no '/'; empty: argv[0]
  std::filesystem::path folder;  ///< to run in; empty: ours
  std::filesystem::path output;  ///< of stdout and stderr, emptied first; where it cannot be made, nothing is kept
  bool shares_stdout = false;    ///< it writes to our own instead
  bool shares_stderr = false;    ///< it writes to our own instead
  std::vector<std::pair<std::string, std::string>> environment;  ///< besides ours
  std::vector<int> descriptors;  ///< of ours that it finds as 3, 4, ...; n of them: each above 3 + n
  bool own_group = false;        ///< in a process group of its own: the terminal's Ctrl-C does not reach it
  bool core_file = true;         ///< false: it may not leave one
};

/// Costs the same however much memory we hold (vfork). Throws Error 70 where it cannot be started.
pid_t spawn(const SpawnRequest& request);

struct Ended {
  bool ended = false;
  int code = 0;                     ///< of exit; 128 + signal where one killed it
  int signal = 0;                   ///< that killed it
  double memory_mb = 0, cpu_s = 0;  ///< of it and of the processes that it waited for
};
/// Waits at most so long (0: looks only).
constexpr double until_it_ends_s = 1e9;
Ended wait_for(pid_t pid, double seconds);

/// This very program, for commands that it runs itself.
std::filesystem::path own_program();

}  // namespace trephine
