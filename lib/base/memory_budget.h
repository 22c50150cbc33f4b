// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>

namespace trephine {

/// How many bytes this process may still take: what the machine has available, at most what is left of the limits of
/// its control group and of its address space (ulimit -v).
std::uint64_t available_memory_bytes();

/// Throws Error 70, field "memory", where `bytes` are more than is available: what needs them, how much, and how much
/// there is. To be asked before they are allocated, because a machine that is short of memory kills whom it likes.
void require_memory(std::uint64_t bytes, const std::string& what);

}  // namespace trephine
