// SPDX-License-Identifier: GPL-3.0-or-later
// MRML (slicer.readthedocs.io, developer guide, MRML overview): flat XML of nodes whose attributes say all.
#include "itk/slicer_scene.h"

#include <map>

#include "base/error.h"
#include "base/text.h"

namespace trephine::itk {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw Error(ExitCode::bad_input, "", "scene", what); }

constexpr std::size_t max_nodes = 100000;
constexpr std::size_t max_attributes = 1000;  ///< of a node
constexpr const char* blanks = " \t\r\n";

struct Node {
  std::string tag;
  std::map<std::string, std::string> attributes;
  const std::string& get(const std::string& name) const {
    static const std::string none;
    const auto at = attributes.find(name);
    return at == attributes.end() ? none : at->second;
  }
};

std::string without_entities(std::string_view text) {
  static const std::pair<std::string_view, char> known[] = {
      {"&amp;", '&'}, {"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}};
  std::string out;
  while (!text.empty()) {
    bool found = false;
    for (const auto& [entity, c] : known)
      if (!found && text.substr(0, entity.size()) == entity) {
        out += c;
        text.remove_prefix(entity.size());
        found = true;
      }
    if (found) continue;
    out += text[0];
    text.remove_prefix(1);
  }
  return out;
}

// The tag that begins at text[at], behind its '<'; `at` is moved behind its '>'.
Node tag_at(std::string_view text, std::size_t& at) {
  Node node;
  const std::size_t name_end = text.find_first_of(" \t\r\n/>", at);
  if (name_end == std::string_view::npos) refuse("is cut short");
  node.tag = std::string(text.substr(at, name_end - at));
  at = name_end;
  for (;;) {
    at = text.find_first_not_of(" \t\r\n/", at);
    if (at == std::string_view::npos) refuse("is cut short");
    if (text[at] == '>') {
      ++at;
      return node;
    }
    const std::size_t equals = text.find_first_of("=>", at);
    if (equals == std::string_view::npos || text[equals] == '>') refuse("an attribute has no value");
    const std::size_t open = text.find_first_not_of(blanks, equals + 1);
    if (open == std::string_view::npos || (text[open] != '"' && text[open] != '\''))
      refuse("an attribute has no value");
    const std::size_t close = text.find(text[open], open + 1);
    if (close == std::string_view::npos) refuse("is cut short");
    if (node.attributes.size() == max_attributes) refuse("a node has too many attributes");
    node.attributes[trephine::trimmed(text.substr(at, equals - at))] =
        without_entities(text.substr(open + 1, close - open - 1));
    at = close + 1;
  }
}

std::vector<Node> nodes_of(std::string_view text) {
  std::vector<Node> nodes;
  bool is_scene = false;
  for (std::size_t at = text.find('<'); at != std::string_view::npos; at = text.find('<', at)) {
    ++at;
    if (text.substr(at, 3) == "!--") {
      at = text.find("-->", at);
      if (at == std::string_view::npos) refuse("is cut short");
      continue;
    }
    if (at >= text.size()) refuse("is cut short");
    if (text[at] == '?' || text[at] == '!' || text[at] == '/') continue;
    Node node = tag_at(text, at);
    is_scene = is_scene || node.tag == "MRML";
    if (!is_scene) refuse("is no scene of 3D Slicer");
    if (nodes.size() == max_nodes) refuse("has too many nodes");
    nodes.push_back(std::move(node));
  }
  if (!is_scene) refuse("is no scene of 3D Slicer");
  return nodes;
}

// What "references" says of a role ("storage:ID1 ID2;transform:ID3;"), or the attribute of older scenes.
std::string referred(const Node& node, const std::string& role, const char* older) {
  for (const std::string& part : split_at(node.get("references"), ';'))
    if (part.rfind(role + ":", 0) == 0) return trephine::trimmed(std::string_view(part).substr(role.size() + 1));
  return trephine::trimmed(node.get(older));
}

int digit_of(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// Scenes write the names of files as in an URL.
std::string without_percents(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool coded =
        text[i] == '%' && i + 2 < text.size() && digit_of(text[i + 1]) >= 0 && digit_of(text[i + 2]) >= 0;
    out += coded ? static_cast<char>(16 * digit_of(text[i + 1]) + digit_of(text[i + 2])) : text[i];
    if (coded) i += 2;
  }
  return out;
}

std::string beneath(const std::string& written) {
  const std::string file = without_percents(written);
  if (file.empty()) refuse("a volume names no file: save the scene with its data");
  if (file[0] == '/' || file.find('\\') != std::string::npos || file.find(':') != std::string::npos ||
      file.find('\0') != std::string::npos)
    refuse("a volume's file lies elsewhere: save the scene with its data, or as .mrb");
  std::string clean;
  for (const std::string& part : split_at(file, '/')) {
    if (part == "..") refuse("a volume's file lies elsewhere: save the scene with its data, or as .mrb");
    if (!part.empty() && part != ".") clean += (clean.empty() ? "" : "/") + part;
  }
  return clean;
}

}  // namespace

std::vector<SceneVolume> scene_volumes(std::string_view mrml) {
  const std::vector<Node> nodes = nodes_of(mrml);
  std::map<std::string, const Node*> storages;
  for (const Node& n : nodes)
    if (n.tag.find("Storage") != std::string::npos && !storages.emplace(n.get("id"), &n).second)
      refuse("two storage nodes have one ID");
  std::vector<SceneVolume> volumes;
  for (const Node& n : nodes) {
    if (n.tag != "Volume") continue;
    const auto storage = storages.find(referred(n, "storage", "storageNodeRef"));
    if (storage == storages.end()) refuse("a volume is not stored in a file: save the scene with its data");
    if (!storage->second->get("fileListMember1").empty())
      refuse("a volume lies in several files: save it as one .nrrd");
    volumes.push_back(
        {beneath(storage->second->get("fileName")), !referred(n, "transform", "transformNodeRef").empty()});
  }
  return volumes;
}

}  // namespace trephine::itk
