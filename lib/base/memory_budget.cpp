// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory_budget.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "base/error.h"

namespace trephine {
namespace {

constexpr std::uint64_t unknown = std::numeric_limits<std::uint64_t>::max();

std::uint64_t number_in(const char* file) {
  std::ifstream stream(file);
  std::uint64_t value = 0;
  return stream >> value ? value : unknown;  // "max" is no number
}

std::uint64_t of_the_machine() {
  std::ifstream stream("/proc/meminfo");
  std::string name;
  std::uint64_t kilobytes = 0, available = 0, swap = 0;
  bool known = false;
  while (stream >> name >> kilobytes) {
    if (name == "MemAvailable:") available = kilobytes, known = true;
    if (name == "SwapFree:") swap = kilobytes;
    stream.ignore(256, '\n');
  }
  return known ? (available + swap) * 1024 : unknown;
}

std::uint64_t of_the_control_group() {
  const std::uint64_t most = number_in("/sys/fs/cgroup/memory.max"), used = number_in("/sys/fs/cgroup/memory.current");
  if (most == unknown || used == unknown) return unknown;
  // Cached files are given back when memory is asked for.
  std::ifstream stream("/sys/fs/cgroup/memory.stat");
  std::string name;
  std::uint64_t bytes = 0, cached = 0;
  while (stream >> name >> bytes)
    if (name == "inactive_file" || name == "active_file") cached += bytes;
  return most - std::min(most, used - std::min(used, cached));
}

std::uint64_t of_the_address_space() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return unknown;
  const std::uint64_t pages = number_in("/proc/self/statm");
  if (pages == unknown) return limit.rlim_cur;
  const std::uint64_t used = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  return limit.rlim_cur - std::min<std::uint64_t>(limit.rlim_cur, used);
}

}  // namespace

std::uint64_t available_memory_bytes() {
  return std::min({of_the_machine(), of_the_control_group(), of_the_address_space()});
}

void require_memory(std::uint64_t bytes, const std::string& what) {
  constexpr std::uint64_t never_asked = 64 << 20;
  if (bytes <= never_asked) return;
  const std::uint64_t available = available_memory_bytes();
  if (bytes <= available) return;
  throw Error(ExitCode::internal, "", "memory",
              fmt::format("{} needs about {:.1f} GB, {:.1f} GB are available here", what, double(bytes) * 1e-9,
                          double(available) * 1e-9));
}

}  // namespace trephine
