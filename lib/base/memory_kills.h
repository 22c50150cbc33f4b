// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>

namespace trephine {

/// How many processes of this process's control group the kernel has killed for want of memory, by `oom_kill` of its
/// memory.events (version 2) or memory.oom_control (version 1); 0 where the system does not say. What grows it between
/// two calls was killed for want of memory, in a group that Slurm made for one task.
std::uint64_t memory_kills(const std::filesystem::path& groups_of_process = "/proc/self/cgroup",
                           const std::filesystem::path& mounted = "/sys/fs/cgroup");

}  // namespace trephine
