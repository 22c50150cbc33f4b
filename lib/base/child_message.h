// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.h"

namespace trephine {

/// Writes a message between the parent and the bounded child (base/child.h): values and arrays as they lie in memory,
/// with 8 bytes of length before each text and array. Both sides are the same program, so the message names no version
/// and no byte order.
class MessageWriter {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&v), sizeof v);
  }
  void number(std::uint64_t v) { value(v); }
  void text(std::string_view s) {
    number(s.size());
    bytes_ += s;
  }
  /// Takes anything that has data() and size().
  template <class Array>
  void array(const Array& items) {
    static_assert(std::is_trivially_copyable_v<std::decay_t<decltype(*items.data())>>);
    number(items.size());
    if (items.size() > 0)
      bytes_.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(*items.data()));
  }
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads such a message in the same order. The other side may be corrupted, so none of its lengths is trusted: where
/// the bytes end too early, Error 70 is thrown with the worker's name. Texts are views of the bytes.
class MessageReader {
 public:
  MessageReader(std::string worker, std::string_view bytes) : worker_(std::move(worker)), bytes_(bytes) {}
  bool empty() const { return bytes_.empty(); }
  template <class T>
  T value() {
    static_assert(std::is_trivially_copyable_v<T>);
    T v;
    std::memcpy(&v, take(sizeof v).data(), sizeof v);
    return v;
  }
  std::uint64_t number() { return value<std::uint64_t>(); }
  std::string_view text() { return take(number()); }
  template <class T>
  std::vector<T> array() {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::uint64_t count = number();
    if (count > bytes_.size() / sizeof(T)) refuse();
    std::vector<T> items(count);
    const std::string_view from = take(count * sizeof(T));
    if (count > 0) std::memcpy(items.data(), from.data(), from.size());
    return items;
  }
  std::string_view take(std::uint64_t count) {
    if (count > bytes_.size()) refuse();
    const std::string_view s = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return s;
  }

 private:
  [[noreturn]] void refuse() const {
    throw Error(ExitCode::internal, "", worker_, "a message of parent or child is cut short");
  }
  std::string worker_;
  std::string_view bytes_;
};

}  // namespace trephine
