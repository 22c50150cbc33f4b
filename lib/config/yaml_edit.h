// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace trephine::config {

/// One change of a YAML file, as a person would make it in an editor.
struct YamlChange {
  /// Keys from the top of the file; an item of a list by its number ("0"), a new one at its end by "+".
  std::vector<std::string> path;
  /// What stands there afterwards, as YAML on one line: `[0, -93.2, 40.1]`, `ct_head.yaml`; nothing: the key goes.
  std::optional<std::string> value;
};

/// The text of a configuration with these changes, one after the other. Every other line stays as it is: comments, the
/// order of keys, the layout. A key that is not there yet is added after the last one of its map; a map that becomes
/// empty goes with its key. `file` is named in messages only.
///
/// The result is read back and compared with what was asked for, so that a layout that is not understood (a text over
/// several lines, for example) is refused and never spoilt. Throws Error 78 naming file and key for that, and for a
/// path that leads through a value which is no map or list; ErrorList (78) where the text is no configuration.
std::string edited_yaml(const std::string& text, const std::vector<YamlChange>& changes,
                        const std::filesystem::path& file);

/// A text as one YAML scalar: plain where that reads back as the same text, else in double quotes.
std::string yaml_scalar(const std::string& text);
/// Numbers as a YAML list: "[0, -93.2, 40.1]".
std::string yaml_list(const std::vector<double>& numbers);

}  // namespace trephine::config
