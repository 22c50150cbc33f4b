// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "config/yaml_document.h"

namespace trephine::config {

/// read_yaml for a text that is in memory; `file` is what messages call it.
YamlNode parse_yaml(const std::string& text, const std::filesystem::path& file);

}  // namespace trephine::config
