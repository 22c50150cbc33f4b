// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "base/params.h"

namespace trephine {

/// JSON of a declared object, for programs that read no YAML. The keys are those of the declaration, in its order;
/// every value is written, so that a later default changes nothing.
std::string declared_json(const AnyParams& params, int indent = 1);

/// Reads such JSON into the object, as strictly as YAML is read: a key that is not declared, a missing required key, a
/// value out of its range, and what the struct's fault() says are Error 65 with the path as field. A step is "name" or
/// {"name": {...}}. Text of unknown origin is bounded in size and nesting before it is parsed.
void read_declared_json(std::string_view json, const ParameterSet& set, void* object);

/// The text below these keys, which says how the rest is to be read; "" where there is none. The bounds are the same,
/// and Error 65 is thrown where it is no JSON.
std::string declared_text(std::string_view json, const std::vector<std::string>& keys);

}  // namespace trephine
