// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What parent and bounded child hand each other: counts as 8 bytes, then arrays as they lie in memory.
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/error.h"

namespace trephine {

template <class T>
void put_array(std::string& bytes, const std::vector<T>& v) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::uint64_t n = v.size();
  bytes.append(reinterpret_cast<const char*>(&n), sizeof n);
  if (n > 0) bytes.append(reinterpret_cast<const char*>(v.data()), n * sizeof(T));
}

/// Throws Error 70 where the message is cut short.
template <class T>
std::vector<T> take_array(std::string_view& bytes) {
  std::uint64_t n = 0;
  const auto refuse = [] { throw Error(ExitCode::internal, "", "child", "its message is cut short"); };
  if (bytes.size() < sizeof n) refuse();
  std::memcpy(&n, bytes.data(), sizeof n);
  bytes.remove_prefix(sizeof n);
  if (n > bytes.size() / sizeof(T)) refuse();
  std::vector<T> v(n);
  if (n > 0) std::memcpy(v.data(), bytes.data(), n * sizeof(T));
  bytes.remove_prefix(n * sizeof(T));
  return v;
}

/// Whether a child ended because it reached a limit of its (time, memory): M11, 70. Else it refused, or died.
inline bool is_child_limit(const Error& e) {
  return e.code() == ExitCode::internal && std::string_view(e.what()).find("limit ") != std::string_view::npos;
}

}  // namespace trephine
