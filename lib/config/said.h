// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/params.h"

namespace trephine::config {

/// Values that stand alone in a configuration's files, without keys of their own: `nasion: [0, -95, 10]`,
/// `kocher_right: 0.5`.

struct SaidPosition {
  std::array<double, 3> position_mm{0, 0, 0};
  template <class V>
  static void describe(V& v) {
    v.numbers(&SaidPosition::position_mm, "", Range{-1e5, 1e5}, "Position in mm, LPS.");
  }
};

struct SaidConfidence {
  double least = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&SaidConfidence::least, "", Range{0, 1}, "The least confidence that is accepted.");
  }
};

/// A file or folder, relative to the file that names it.
struct SaidPath {
  std::string path;
  template <class V>
  static void describe(V& v) {
    v.text(&SaidPath::path, "", "A file or folder, relative to this file.").names("file");
  }
};

struct SaidAnatomy {
  std::string name;
  template <class V>
  static void describe(V& v) {
    v.text(&SaidAnatomy::name, "", "An anatomy of the recipe.").names("anatomy");
  }
};

/// A value of any parameter, as --set takes it: "0.2", "[1, 1, 1]". A list in YAML becomes that text.
struct SaidValue {
  std::string text;
  template <class V>
  static void describe(V& v) {
    v.text(&SaidValue::text, "", "A value, or a list of values.").names("value");
  }
};

/// The values as "path=value", as --set takes them.
inline std::vector<std::string> settings_of(const Named<SaidValue>& values) {
  std::vector<std::string> all;
  for (const auto& [path, value] : values) all.push_back(path + "=" + value.text);
  return all;
}

/// The version, which is the first line of every file.
struct VersionParams {
  int trephine = 1;
  template <class V>
  static void describe(V& v) {
    v.integer(&VersionParams::trephine, "trephine", Range{1, 1}, "The version of the format: 1.").is_required();
  }
};

}  // namespace trephine::config
