// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "base/error.h"

namespace trephine::dicom {

// Requests and results of the bounded child: 8-byte numbers, and texts with their length.

class Packer {
 public:
  void number(std::uint64_t v) { bytes_.append(reinterpret_cast<const char*>(&v), sizeof v); }
  void text(std::string_view s) {
    number(s.size());
    bytes_ += s;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Throws Error 70 where the bytes end too early: the other side may have lost its mind.
class Unpacker {
 public:
  explicit Unpacker(std::string_view bytes) : bytes_(bytes) {}
  bool empty() const { return bytes_.empty(); }
  std::uint64_t number() {
    std::uint64_t v = 0;
    std::memcpy(&v, take(sizeof v).data(), sizeof v);
    return v;
  }
  std::string_view text() { return take(number()); }
  std::string_view take(std::uint64_t count) {
    if (count > bytes_.size()) throw Error(ExitCode::internal, "", "dicom", "a child's message is cut short");
    const std::string_view s = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return s;
  }

 private:
  std::string_view bytes_;
};

}  // namespace trephine::dicom
