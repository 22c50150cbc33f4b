// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory_kills.h"

#include <fstream>
#include <optional>
#include <string>

namespace trephine {
namespace fs = std::filesystem;
namespace {

std::optional<std::uint64_t> value_in(const fs::path& file, const std::string& key) {
  std::ifstream in(file);
  std::string name;
  for (std::uint64_t value = 0; in >> name >> value;)
    if (name == key) return value;
  return {};
}

}  // namespace

std::uint64_t memory_kills(const fs::path& groups_of_process, const fs::path& mounted) {
  std::ifstream in(groups_of_process);
  for (std::string line; std::getline(in, line);) {  // number:controllers:/group; version 2 names no controllers
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const fs::path group = fs::path(line.substr(second + 1)).relative_path();
    std::optional<std::uint64_t> kills;
    if (controllers == ",,") {
      kills = value_in(mounted / group / "memory.events", "oom_kill");
      if (!kills) kills = value_in(mounted / "unified" / group / "memory.events", "oom_kill");
    } else if (controllers.find(",memory,") != std::string::npos) {
      kills = value_in(mounted / "memory" / group / "memory.oom_control", "oom_kill");
    }
    if (kills) return *kills;
  }
  return 0;
}

}  // namespace trephine
