// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace trephine {

/// The protocol between parent and child of base/child.h; for the two sources of that header only.
///
/// The child is started as `PROGRAM --trephine-child WORKER MEMORY_BYTES CPU_S PARENT_PID THREADS` with the request
/// (memfd, sealed), the result (memfd, to be written) and the pipe of messages as the three descriptors below.

constexpr const char* child_argument = "--trephine-child";
constexpr int child_request_fd = 3, child_result_fd = 4, child_pipe_fd = 5;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool built_with_sanitizer =
    true;  ///< a sanitizer's shadow needs terabytes of address space and a core that can be traced
#else
constexpr bool built_with_sanitizer = false;
#endif

struct ChildMessage {
  enum Kind : std::uint32_t { progress = 1, error = 2, done = 3 };
  std::uint32_t kind;
  std::uint32_t size;  ///< bytes of body that follow
};
constexpr std::uint32_t child_message_limit = 1 << 20;

/// Packs the parts of an error (code, case, file, field, what, cause), each with its length before it. Unpacking
/// returns an empty list where the bytes are not so many parts.
constexpr std::size_t child_error_parts = 6;
std::string pack_child_error(const std::vector<std::string>& parts);
std::vector<std::string> unpack_child_error(std::string_view bytes);

/// Gives a text such as "memory limit 512 MiB".
std::string child_memory_limit_text(std::uint64_t bytes);

}  // namespace trephine
