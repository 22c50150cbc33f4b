// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

namespace trephine {

/// The JSON schema (draft 2020-12) of pipelines/*.yaml, for editors that complete and check YAML: every stage with its
/// parameters and ports, from their declarations.
std::string recipe_schema();

}  // namespace trephine
