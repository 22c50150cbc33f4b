// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "base/params.h"
#include "json/json_bounds.h"

namespace trephine::json {

/// How strictly JSON is read, and how much of it: text of unknown origin is bounded before it is parsed.
struct JsonRules {
  /// A program wrote the file: every declared key must be there, but for those that may be left out; other keys are
  /// ignored, for a newer program may have written them. In a file that a person wrote a key may be missing unless it
  /// is required, and one that is not declared is refused.
  bool by_program = false;
  std::size_t max_bytes = 1 << 20;
  JsonBounds bounds;
};

/// JSON of a declared object, for programs that read no YAML. The keys are those of the declaration, in its order;
/// every value is written, so that a later default changes nothing, but for those that are declared as left out.
/// Throws Error 70 where a text is not UTF-8.
std::string declared_json(const ParameterSet& set, void* object, int indent = 1);
std::string declared_json(const AnyParams& params, int indent = 1);

/// Reads such JSON into the object, as strictly as YAML is read: a missing key, a value out of its range, a key that is
/// given twice, and what the struct's fault() says are Error 65 with the path as field. A step is "name" or
/// {"name": {...}}.
void read_declared_json(std::string_view json, const ParameterSet& set, void* object, const JsonRules& rules = {});

/// Of what this program wrote for itself and reads back, such as a cache.
inline const JsonRules of_a_program{true, 1 << 24, {}};
template <class R>
std::string json_of_value(R value) {
  return declared_json(parameters_of<R>(), &value, -1);
}
template <class R>
R value_of_json(std::string_view json) {
  R value;
  read_declared_json(json, parameters_of<R>(), &value, of_a_program);
  return value;
}

/// The text below these keys, which says how the rest is to be read; "" where there is none. The bounds are the same,
/// and Error 65 is thrown where it is no JSON.
std::string declared_text(std::string_view json, const std::vector<std::string>& keys);

}  // namespace trephine::json
