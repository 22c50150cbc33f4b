// SPDX-License-Identifier: GPL-3.0-or-later
#include "external/descendants.h"

#include <dirent.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <map>
#include <vector>

namespace trephine::external {
namespace {

/// The parent of a process; -1 where it is gone. The name in /proc/N/stat may hold blanks and brackets.
pid_t parent_of(const char* pid) {
  char path[64], text[512];
  std::snprintf(path, sizeof path, "/proc/%.20s/stat", pid);
  std::FILE* file = std::fopen(path, "r");
  if (!file) return -1;
  const std::size_t n = std::fread(text, 1, sizeof text - 1, file);
  std::fclose(file);
  text[n] = 0;
  const char* end = std::strrchr(text, ')');
  int parent = -1;
  return end && std::sscanf(end + 1, " %*c %d", &parent) == 1 ? parent : -1;
}

std::vector<pid_t> descendants(pid_t root) {
  std::multimap<pid_t, pid_t> children;
  DIR* all = opendir("/proc");
  if (!all) return {};
  while (const dirent* entry = readdir(all)) {
    if (entry->d_name[0] < '0' || entry->d_name[0] > '9') continue;
    const pid_t parent = parent_of(entry->d_name);
    if (parent > 0) children.emplace(parent, std::atoi(entry->d_name));
  }
  closedir(all);
  std::vector<pid_t> found{root};
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto [from, to] = children.equal_range(found[i]);
    for (auto child = from; child != to; ++child)
      if (std::find(found.begin(), found.end(), child->second) == found.end()) found.push_back(child->second);
  }
  found.erase(found.begin());
  return found;
}

}  // namespace

std::uint64_t memory_of_descendants(pid_t root, pid_t except) {
  const auto page = std::uint64_t(sysconf(_SC_PAGESIZE));
  std::uint64_t bytes = 0;
  for (const pid_t pid : descendants(root)) {
    if (pid == except) continue;
    char path[64];
    std::snprintf(path, sizeof path, "/proc/%d/statm", pid);
    std::FILE* file = std::fopen(path, "r");
    if (!file) continue;
    unsigned long long resident = 0, shared = 0;
    if (std::fscanf(file, "%*u %llu %llu", &resident, &shared) == 2 && resident > shared)
      bytes += (resident - shared) * page;
    std::fclose(file);
  }
  return bytes;
}

void end_descendants(pid_t root) {
  for (;;) {
    for (const pid_t pid : descendants(root)) kill(pid, SIGKILL);
    const pid_t ended = waitpid(-1, nullptr, WNOHANG);
    if (ended < 0 && errno == ECHILD) return;
    if (ended == 0) usleep(1000);
  }
}

}  // namespace trephine::external
