// SPDX-License-Identifier: GPL-3.0-or-later
// What a case says of the parameters that it was made with.
#include <algorithm>
#include <cstring>

#include "pipeline/graph.h"

namespace trephine::pipeline {
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

std::string Node::anatomy() const {
  const std::string prefix = "original.";
  const std::string rest = name.rfind(prefix, 0) == 0 ? name.substr(prefix.size()) : name;
  const auto dot = rest.find('.');
  return dot == std::string::npos ? "" : rest.substr(0, dot);
}

std::string Node::parameters_text() const {
  if (file_sha256.empty()) return to_text(params);
  std::string text;
  for (const auto& [name, value] : recorded()) text += name + ": " + trephine::to_text(value) + "; ";
  return text;
}

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

std::vector<int> Graph::results(stages::DataKind kind) const {
  std::vector<int> all;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].wanted && nodes[i].output == kind) all.push_back(static_cast<int>(i));
  return all;
}

int Graph::result(stages::DataKind kind) const {
  const std::vector<int> all = results(kind);
  return all.empty() ? -1 : all[0];
}

std::vector<int> Graph::needs_of(int node) const {
  std::vector<int> all{node};
  std::vector<char> is(nodes.size());
  for (std::size_t n = 0; n < all.size(); ++n)
    for (const auto& [port, source] : nodes[std::size_t(all[n])].sources)
      if (!std::exchange(is[std::size_t(source)], char(1))) all.push_back(source);
  return all;
}

int Graph::find(const std::string& name) const {
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].name == name) return static_cast<int>(i);
  return -1;
}

int Graph::find_stage(const ParameterSet& params, const std::string& of) const {
  const std::string begin = of.empty() ? "" : of + ".";
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].params.set == &params && nodes[i].name.compare(0, begin.size(), begin) == 0)
      return static_cast<int>(i);
  return -1;
}

void require_allowed(const Graph& graph, bool allow_external) {
  if (allow_external) return;
  for (const Node& node : graph.nodes)
    if (node.type->runs_program) {
      const Parameter* program = node.params.set->find("program");
      throw Error(ExitCode::usage, "", node.name,
                  "runs the program " + (program ? to_text(node.params.get(*program)) : std::string()) +
                      " that the recipe names; where you trust it, say --allow-external");
    }
}

}  // namespace trephine::pipeline
