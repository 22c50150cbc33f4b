// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace trephine {

/// A program that runs beside us and dies with us (PR_SET_PDEATHSIG): call from a thread that lives as long as it.
struct SpawnRequest {
  std::vector<std::string> argv;  ///< argv[0] is looked for in PATH where it holds no '/'
  std::filesystem::path folder;   ///< to run in; empty: ours
  std::filesystem::path output;   ///< of stdout and stderr, emptied first; where it cannot be made, nothing is kept
  std::vector<std::pair<std::string, std::string>> environment;  ///< besides ours
  bool own_group = false;  ///< in a process group of its own: the terminal's Ctrl-C does not reach it
};

/// Throws Error 70 where it cannot be started.
pid_t spawn(const SpawnRequest& request);

struct Ended {
  bool ended = false;
  int code = 0;                     ///< of exit; 128 + signal where one killed it
  int signal = 0;                   ///< that killed it
  double memory_mb = 0, cpu_s = 0;  ///< of it and of the processes that it waited for
};
/// Waits at most so long (0: looks only).
Ended wait_for(pid_t pid, double seconds);

/// This very program, for commands that it runs itself.
std::filesystem::path own_program();

}  // namespace trephine
