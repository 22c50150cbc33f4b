// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace trephine::tools {

/// JSON schemas (draft 2020-12) of case.json and of the files that a user writes, made from their declarations, as
/// pages of the reference: case.schema.json, recipe.schema.json, scene.schema.json, configuration.schema.json,
/// library.schema.json, materials.schema.json and trade.schema.json. Editors that know JSON schemas complete and check
/// keys with them. case.md and files.md list the same keys for a reader.
std::vector<std::pair<std::string, std::string>> file_schemas();

}  // namespace trephine::tools
