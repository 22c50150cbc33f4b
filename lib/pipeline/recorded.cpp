// SPDX-License-Identifier: GPL-3.0-or-later
// What a case says of the parameters that it was made with.
#include <algorithm>
#include <cstring>

#include "pipeline/graph.h"

namespace trephine {
namespace {

/// The text with the last name alone of each absolute path: the folders of a machine may hold its user's name.
std::string without_folders(const std::string& text) {
  constexpr const char* between = " :;,=\"'|()";
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const bool begins = text[at] == '/' && (at == 0 || std::strchr(between, text[at - 1]) != nullptr);
    const std::size_t end = begins ? std::min(text.find_first_of(between, at), text.size()) : at + 1;
    std::string piece = text.substr(at, end - at);
    if (begins) {
      while (piece.size() > 1 && piece.back() == '/') piece.pop_back();
      piece.erase(0, piece.rfind('/') + 1);
    }
    out += piece;
    at = end;
  }
  return out;
}

}  // namespace

std::vector<std::pair<std::string, ParameterValue>> Node::recorded() const {
  std::vector<std::pair<std::string, ParameterValue>> all;
  for (const ParameterLeaf& leaf : leaves_of(params)) {
    const auto file = file_sha256.find(leaf.path);
    ParameterValue value = file == file_sha256.end() ? leaf.value() : ParameterValue("sha256 " + file->second);
    if (auto* text = std::get_if<std::string>(&value); text && type && type->runs_program)
      *text = without_folders(*text);
    all.emplace_back(leaf.path, std::move(value));
  }
  return all;
}

}  // namespace trephine
