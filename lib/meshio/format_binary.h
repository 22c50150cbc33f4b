// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of meshio: numbers as the binary formats hold them, in little endian.
#include <cstring>
#include <string>

#include "meshio/export_encode.h"

namespace trephine::meshio {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "floats and integers are written as they lie in memory");

/// Adds the number as it lies in memory; a vector as three float32, where a zero is +0.
template <class T>
void append_binary(std::string& out, T v) {
  char bytes[sizeof v];
  std::memcpy(bytes, &v, sizeof v);
  out.append(bytes, sizeof v);
}

inline void append_binary(std::string& out, Vec3 v) {
  for (int c = 0; c < 3; ++c) append_binary(out, float(v[c]) + 0.f);
}

}  // namespace trephine::meshio
