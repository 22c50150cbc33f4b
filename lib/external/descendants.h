// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <sys/types.h>

#include <cstdint>

namespace trephine::external {

/// Resident memory that is not shared, in bytes, of all processes that descend from this one, but for itself and
/// `except`.
std::uint64_t memory_of_descendants(pid_t root, pid_t except);

/// Kills all processes that descend from this one, as long as there are any, and takes their ends. The process must be
/// the caller, and gather orphans (PR_SET_CHILD_SUBREAPER): then no descendant can get away.
void end_descendants(pid_t root);

}  // namespace trephine::external
