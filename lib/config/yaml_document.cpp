// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/yaml_document.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <sstream>
#include <unordered_set>

#include "base/hash.h"
#include "base/text.h"
#include "base/write_file.h"
#include "config/parse_yaml.h"

namespace trephine::config {
namespace {

constexpr std::uint64_t max_file_bytes = 1 << 20;
constexpr std::size_t max_depth = 32;

// Where the text stops being UTF-8 (RFC 3629: no overlong forms, no surrogates, nothing above U+10FFFF), else npos.
std::size_t find_bad_utf8(const std::string& text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80   ? 1
                               : lead < 0xc2 ? 0
                               : lead < 0xe0 ? 2
                               : lead < 0xf0 ? 3
                               : lead < 0xf5 ? 4
                                             : 0;
    if (length == 0 || i + length > text.size()) return i;
    for (std::size_t k = 1; k < length; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      unsigned low = 0x80, high = 0xbf;
      if (k == 1) {
        if (lead == 0xe0) low = 0xa0;
        if (lead == 0xed) high = 0x9f;
        if (lead == 0xf0) low = 0x90;
        if (lead == 0xf4) high = 0x8f;
      }
      if (next < low || next > high) return i;
    }
    i += length;
  }
  return std::string::npos;
}

std::string position(const std::filesystem::path& file, int line, int column) {
  return file.string() + ":" + std::to_string(line) + ":" + std::to_string(column);
}

[[noreturn]] void refuse(const std::filesystem::path& file, int line, int column, const std::string& what) {
  throw ErrorList({Error(ExitCode::bad_config, position(file, line, column), "", what)});
}

// Builds the tree from the parser's events. On the way it sees what yaml-cpp's own nodes hide (repeated keys, marks).
class TreeBuilder : public YAML::EventHandler {
 public:
  TreeBuilder(const std::filesystem::path& file, YamlNode& root, ConfigFaults& faults)
      : file_(file), root_(root), faults_(faults) {}

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    add(make(mark, YamlNode::Kind::null, "", anchor));
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse(file_, mark.line + 1, mark.column + 1, "aliases (*name) are not allowed");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    if (tag != "!") refuse_tag(mark, tag);
    YamlNode node = make(mark, YamlNode::Kind::scalar, value, anchor);
    // A plain null or ~ is no value; a quoted one (tag "!") is the text.
    if (tag != "!" && (value == "null" || value == "~")) node = make(mark, YamlNode::Kind::null, "", anchor);
    node.quoted = tag == "!";
    add(std::move(node));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value style) override {
    refuse_tag(mark, tag);
    push(make(mark, YamlNode::Kind::list, "", anchor), style);
  }
  void OnSequenceEnd() override { pop(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value style) override {
    refuse_tag(mark, tag);
    push(make(mark, YamlNode::Kind::map, "", anchor), style);
  }
  void OnMapEnd() override { pop(); }

  /// The innermost brace or bracket that has not been closed yet; null: there is none.
  const YamlNode* not_closed() const {
    return open_.empty() || !open_.back().in_brackets ? nullptr : &open_.back().node;
  }

 private:
  struct Open {
    YamlNode node, key;
    bool has_key = false, in_brackets = false;
    std::unordered_set<std::string> keys{};
  };

  void refuse_tag(const YAML::Mark& mark, const std::string& tag) {
    if (!tag.empty() && tag != "?") refuse(file_, mark.line + 1, mark.column + 1, "tags (!name) are not allowed");
  }
  YamlNode make(const YAML::Mark& mark, YamlNode::Kind kind, const std::string& text, YAML::anchor_t anchor) {
    if (anchor) refuse(file_, mark.line + 1, mark.column + 1, "anchors (&name) are not allowed");
    YamlNode node;
    node.kind = kind;
    node.text = text;
    node.line = mark.line + 1;
    node.column = mark.column + 1;
    return node;
  }
  void push(YamlNode node, YAML::EmitterStyle::value style) {
    if (open_.size() >= max_depth)
      refuse(file_, node.line, node.column, "nested deeper than " + std::to_string(max_depth) + " levels");
    open_.push_back({std::move(node), {}, false, style == YAML::EmitterStyle::Flow, {}});
  }
  void pop() {
    YamlNode node = std::move(open_.back().node);
    open_.pop_back();
    add(std::move(node));
  }
  void add(YamlNode node) {
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    Open& parent = open_.back();
    if (parent.node.kind == YamlNode::Kind::list) {
      parent.node.items.push_back(std::move(node));
    } else if (!parent.has_key) {
      if (node.kind != YamlNode::Kind::scalar) refuse(file_, node.line, node.column, "a key must be a plain word");
      parent.key = std::move(node);
      parent.has_key = true;
    } else {
      if (!parent.keys.insert(parent.key.text).second)
        faults_.add(file_, parent.key, parent.key.text, "the key is repeated");
      parent.node.entries.emplace_back(std::move(parent.key), std::move(node));
      parent.has_key = false;
    }
  }

  const std::filesystem::path& file_;
  YamlNode& root_;
  ConfigFaults& faults_;
  std::vector<Open> open_;
};

}  // namespace

const YamlNode* YamlNode::find(const std::string& key) const {
  for (const auto& e : entries)
    if (e.first.text == key) return &e.second;
  return nullptr;
}

void ConfigFaults::add(const std::filesystem::path& file, const YamlNode& at, const std::string& key,
                       const std::string& what) {
  ++count_;
  if (!full()) faults_.emplace_back(ExitCode::bad_config, position(file, at.line, at.column), key, what);
}

void ConfigFaults::add(Error fault) {
  ++count_;
  if (!full()) faults_.push_back(std::move(fault));
}

void ConfigFaults::raise() const {
  if (faults_.empty()) return;
  std::vector<Error> told = faults_;
  if (count_ > told.size())
    told.emplace_back(told.back().code(), told.back().file(), "",
                      std::to_string(count_ - told.size()) + " more faults are not listed");
  throw ErrorList(std::move(told));
}

YamlNode read_yaml(const std::filesystem::path& file) {
  std::vector<char> bytes;
  try {
    bytes = read_file(file, max_file_bytes);
  } catch (Error& e) {
    if (e.code() == ExitCode::bad_input) refuse(file, 1, 1, "is larger than 1 MiB, no configuration is");
    throw;
  }
  return parse_yaml({bytes.begin(), bytes.end()}, file);
}

YamlNode parse_yaml(const std::string& text, const std::filesystem::path& file) {
  const auto bad = std::find_if(text.begin(), text.end(), [](char c) {
    const auto u = static_cast<unsigned char>(c);
    return u == 0x7f || (u < 0x20 && c != '\n' && c != '\r' && c != '\t');
  });
  if (bad != text.end())
    refuse(file, 1 + static_cast<int>(std::count(text.begin(), bad, '\n')), 1,
           "holds a control character: not a text file");

  if (const std::size_t at = find_bad_utf8(text); at != std::string::npos) {
    const auto line_start = static_cast<std::ptrdiff_t>(at == 0 ? 0 : text.rfind('\n', at - 1) + 1);
    refuse(file, 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n')),
           1 + static_cast<int>(static_cast<std::ptrdiff_t>(at) - line_start), "is not UTF-8 text");
  }

  YamlNode root;
  ConfigFaults faults;
  TreeBuilder builder(file, root, faults);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    parser.HandleNextDocument(builder);
    YamlNode second;
    TreeBuilder rest(file, second, faults);
    if (parser.HandleNextDocument(rest)) refuse(file, second.line, second.column, "holds a second document");
  } catch (const YAML::Exception& e) {
    const auto is_letter = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; };
    const std::string whole = text.substr(0, text.find_last_not_of(" \n\r\t") + 1);
    const bool at_end = e.mark.pos >= std::count_if(whole.begin(), whole.end(), is_letter);
    if (const YamlNode* open = builder.not_closed(); open && at_end)
      refuse(file, open->line, open->column, "is not YAML: the brace or bracket that opens here is not closed");
    refuse(file, std::max(0, e.mark.line) + 1, std::max(0, e.mark.column) + 1, "is not YAML: " + e.msg);
  }
  faults.raise();
  if (root.kind != YamlNode::Kind::map) refuse(file, root.line, root.column, "must hold keys and values");
  return root;
}

std::optional<YamlNode> read_yaml_or_fault(const std::filesystem::path& file, ConfigFaults& faults) {
  try {
    return read_yaml(file);
  } catch (const ErrorList& e) {
    for (const Error& one : e.all()) faults.add(one);
  } catch (const Error& e) {
    faults.add(e);
  }
  return {};
}

namespace {

void add(const YamlNode& node, Sha256& digest) {
  digest.integer(static_cast<std::int64_t>(node.kind)).integer(node.quoted).text(node.text);
  digest.integer(static_cast<std::int64_t>(node.items.size()));
  for (const YamlNode& item : node.items) add(item, digest);
  digest.integer(static_cast<std::int64_t>(node.entries.size()));
  for (const auto& [key, value] : node.entries) add(key, digest), add(value, digest);
}

}  // namespace

std::string digest_of(const YamlNode& tree) {
  Sha256 digest;
  add(tree, digest);
  return digest.hex();
}

}  // namespace trephine::config
