// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"

namespace trephine::json {

/// For sources that read JSON: who links the installed library needs no header of nlohmann's.
using Json = nlohmann::ordered_json;

/// One JSON value with the path to it ("haptic.shapes[0].window"), so that a refusal (Error 65) names it.
class JsonAt {
 public:
  JsonAt(const Json& value, std::string path) : value_(value), path_(std::move(path)) {}

  const std::string& path() const { return path_; }
  [[noreturn]] void refuse(const std::string& what) const { throw Error(ExitCode::bad_input, "", path_, what); }

  JsonAt operator[](const char* key) const {
    const Json* v = find(key);
    if (!v) throw Error(ExitCode::bad_input, "", path_of(key), "missing");
    return {*v, path_of(key)};
  }
  std::optional<JsonAt> optional(const char* key) const {
    const Json* v = find(key);
    return v ? std::optional<JsonAt>({*v, path_of(key)}) : std::nullopt;
  }
  bool has(const char* key) const { return find(key) != nullptr; }

  std::vector<JsonAt> items() const {
    if (!value_.is_array()) refuse("is not a list");
    std::vector<JsonAt> out;
    out.reserve(value_.size());
    for (std::size_t i = 0; i < value_.size(); ++i) out.push_back(item(i));
    return out;
  }
  JsonAt item(std::size_t i) const {
    if (!value_.is_array() || i >= value_.size()) refuse("has no item " + std::to_string(i));
    return {value_[i], path_ + "[" + std::to_string(i) + "]"};
  }
  /// The only item of a list.
  JsonAt only() const {
    if (!value_.is_array() || value_.size() != 1) refuse("must hold one item");
    return item(0);
  }

  std::uint64_t count(std::uint64_t most = UINT64_MAX) const {
    if (!value_.is_number_unsigned() || value_.get<std::uint64_t>() > most) refuse("is not a count in range");
    return value_.get<std::uint64_t>();
  }
  std::int64_t integer(std::int64_t least, std::int64_t most) const {
    const bool whole =
        value_.is_number_integer() && !(value_.is_number_unsigned() && value_.get<std::uint64_t>() >> 62);
    if (!whole || value_.get<std::int64_t>() < least || value_.get<std::int64_t>() > most)
      refuse("must be a whole number from " + std::to_string(least) + " to " + std::to_string(most));
    return value_.get<std::int64_t>();
  }
  double number() const {
    if (!value_.is_number() || !std::isfinite(value_.get<double>())) refuse("is not a finite number");
    return value_.get<double>();
  }
  bool flag() const {
    if (!value_.is_boolean()) refuse("must be true or false");
    return value_.get<bool>();
  }
  std::string text() const {
    if (!value_.is_string()) refuse("is not a text");
    return value_.get<std::string>();
  }
  std::vector<double> numbers(std::size_t n) const {
    if (!value_.is_array() || value_.size() != n) refuse("must be " + std::to_string(n) + " numbers");
    std::vector<double> out;
    for (std::size_t i = 0; i < n; ++i) out.push_back(item(i).number());
    return out;
  }
  const Json& value() const { return value_; }

 private:
  std::string path_of(const char* key) const { return path_.empty() ? key : path_ + "." + key; }
  const Json* find(const char* key) const {
    if (!value_.is_object()) refuse("is not an object");
    const auto found = value_.find(key);
    return found == value_.end() ? nullptr : &*found;
  }
  const Json& value_;
  std::string path_;
};

/// Parses text of unknown origin: nesting, keys and values are bounded, so that neither memory nor time exceeds a small
/// multiple of the text's size. Throws Error 65 with the field "json".
Json parse_json(std::string_view text);

}  // namespace trephine::json
