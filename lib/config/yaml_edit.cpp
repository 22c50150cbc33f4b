// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/yaml_edit.h"

#include <algorithm>
#include <utility>

#include "base/joined.h"
#include "base/text.h"
#include "config/parse_yaml.h"

namespace trephine::config {
namespace {

using Kind = YamlNode::Kind;
using Path = std::vector<std::string>;

std::string told(const Path& path) { return printable(joined(path, ".")); }

/// The child of a map or list by its key or number; null where there is none.
YamlNode* child_of(YamlNode& node, const std::string& part) {
  if (node.kind == Kind::map) {
    for (auto& [key, value] : node.entries)
      if (key.text == part) return &value;
  } else if (node.kind == Kind::list) {
    const auto number = parse_integer(part);
    if (number && *number >= 0 && *number < static_cast<long long>(node.items.size()))
      return &node.items[static_cast<std::size_t>(*number)];
  }
  return nullptr;
}

bool same(const YamlNode& a, const YamlNode& b) {
  if (a.kind != b.kind || a.text != b.text || a.items.size() != b.items.size() || a.entries.size() != b.entries.size())
    return false;
  for (std::size_t i = 0; i < a.items.size(); ++i)
    if (!same(a.items[i], b.items[i])) return false;
  for (std::size_t i = 0; i < a.entries.size(); ++i)
    if (a.entries[i].first.text != b.entries[i].first.text || !same(a.entries[i].second, b.entries[i].second))
      return false;
  return true;
}

/// One change of a text, whose tree is known.
class Editor {
 public:
  Editor(std::string text, const YamlChange& change, const std::filesystem::path& file)
      : text_(std::move(text)), change_(change), file_(file), root_(parse_yaml(text_, file)) {
    lines_.push_back(0);
    for (std::size_t at = text_.find('\n'); at != std::string::npos; at = text_.find('\n', at + 1))
      lines_.push_back(at + 1);
  }

  std::string run() {
    YamlNode wanted = expected();
    make();
    const YamlNode is = parse_yaml(text_, file_);
    if (!same(is, wanted)) refuse("cannot be changed without spoiling the file's layout");
    return std::move(text_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ExitCode::bad_config, file_.string(), told(change_.path),
                what + "; write it by hand: " + change_.value.value_or("remove it"));
  }

  // ---- what the tree must be afterwards
  YamlNode value_node() const { return parse_yaml("v: " + *change_.value + "\n", file_).entries.at(0).second; }

  YamlNode expected() const {
    YamlNode tree = root_;
    Path path = change_.path;
    if (!change_.value) {
      while (!path.empty()) {
        YamlNode* parent = &tree;
        for (std::size_t i = 0; i + 1 < path.size(); ++i)
          if (!(parent = child_of(*parent, path[i]))) refuse("is not there");
        if (!child_of(*parent, path.back())) refuse("is not there");
        if (parent->kind == Kind::list) {
          parent->items.erase(parent->items.begin() + static_cast<std::ptrdiff_t>(*parse_integer(path.back())));
        } else {
          auto& all = parent->entries;
          all.erase(std::remove_if(all.begin(), all.end(), [&](const auto& e) { return e.first.text == path.back(); }),
                    all.end());
        }
        if (!parent->entries.empty() || !parent->items.empty() || path.size() == 1) break;
        path.pop_back();
      }
      return tree;
    }
    YamlNode* at = &tree;
    for (const std::string& part : path) {
      if (YamlNode* next = child_of(*at, part)) {
        at = next;
        continue;
      }
      if (at->kind == Kind::null) at->kind = part == "+" ? Kind::list : Kind::map;
      if (part == "+" && at->kind == Kind::list) {
        at = &at->items.emplace_back();
      } else {
        if (at->kind != Kind::map) refuse("lies within a value that is no map");
        YamlNode key;
        key.kind = Kind::scalar;
        key.text = part;
        at = &at->entries.emplace_back(key, YamlNode()).second;
      }
    }
    *at = value_node();
    return tree;
  }

  // ---- where things stand in the text
  std::size_t begin_of(const YamlNode& node) const {
    const auto line = static_cast<std::size_t>(node.line - 1);
    return line < lines_.size() ? lines_[line] + static_cast<std::size_t>(node.column - 1) : text_.size();
  }
  char at(std::size_t i) const { return i < text_.size() ? text_[i] : '\0'; }
  bool is_flow(const YamlNode& node) const {
    const char c = at(begin_of(node));
    return (node.kind == Kind::map && c == '{') || (node.kind == Kind::list && c == '[');
  }
  std::size_t end_of_quoted(std::size_t i) const {
    const char quote = at(i++);
    for (; i < text_.size(); ++i) {
      if (quote == '"' && text_[i] == '\\')
        ++i;
      else if (text_[i] == quote && quote == '\'' && at(i + 1) == '\'')
        ++i;
      else if (text_[i] == quote)
        return i + 1;
    }
    refuse("stands beside a text without an end");
  }
  std::size_t end_of_flow(std::size_t i) const {
    int depth = 0;
    char before = ' ';
    for (; i < text_.size(); ++i) {
      const char c = text_[i];
      if ((c == '"' || c == '\'') && std::string("[{,:").find(before) != std::string::npos) {
        i = end_of_quoted(i) - 1;
        before = c;
        continue;
      }
      if (c == '#' && std::string(" \t\n").find(at(i - 1)) != std::string::npos) {
        i = std::min(text_.find('\n', i), text_.size());
        continue;
      }
      depth += c == '[' || c == '{' ? 1 : c == ']' || c == '}' ? -1 : 0;
      if (depth == 0) return i + 1;
      if (c != ' ' && c != '\t' && c != '\n' && c != '\r') before = c;
    }
    refuse("stands beside a list without an end");
  }
  std::size_t end_of(const YamlNode& node) const {
    const std::size_t from = begin_of(node);
    if (is_flow(node)) return end_of_flow(from);
    if (node.kind == Kind::map) return end_of_entry(node.entries.back());
    if (node.kind == Kind::list) {
      const YamlNode& last = node.items.back();
      if (last.kind == Kind::null) refuse("stands beside an empty item");
      return end_of(last);
    }
    if (at(from) == '"' || at(from) == '\'') return end_of_quoted(from);
    if (text_.compare(from, node.text.size(), node.text) != 0) refuse("stands beside a text of several lines");
    return from + node.text.size();
  }
  std::size_t colon_of(const YamlNode& key) const {
    std::size_t i = end_of(key);
    while (at(i) == ' ') ++i;
    if (at(i) != ':') refuse("stands beside a key that is not understood");
    return i;
  }
  std::size_t end_of_entry(const std::pair<YamlNode, YamlNode>& entry) const {
    if (entry.second.kind != Kind::null) return end_of(entry.second);
    std::size_t i = colon_of(entry.first) + 1, j = i;
    while (at(j) == ' ') ++j;
    for (const char* word : {"null", "~"})
      if (text_.compare(j, std::string(word).size(), word) == 0) return j + std::string(word).size();
    return i;
  }
  std::size_t line_begin(std::size_t i) const { return i == 0 ? 0 : text_.rfind('\n', i - 1) + 1; }
  std::size_t after_line(std::size_t i) const {
    const std::size_t end = text_.find('\n', i);
    return end == std::string::npos ? text_.size() : end + 1;
  }

  // ---- the change itself
  void replace(std::size_t from, std::size_t to, const std::string& by) { text_.replace(from, to - from, by); }

  void insert_line_after(std::size_t i, const std::string& line) {
    std::size_t to = after_line(i);
    if (to == 0 || text_[to - 1] != '\n') text_.insert(to++, "\n");
    text_.insert(to, line + "\n");
  }

  static std::string keyed(const std::string& key, const std::string& value) { return yaml_scalar(key) + ": " + value; }

  /// What stands under path[from]: the value, or maps that lead to it.
  std::string nested_value(std::size_t from) const {
    std::string value = *change_.value;
    for (std::size_t i = change_.path.size(); i-- > from;)
      value = change_.path[i] == "+" ? "[" + value + "]" : "{" + keyed(change_.path[i], value) + "}";
    return value;
  }

  void make() {
    if (change_.path.empty()) refuse("names nothing");
    if (!change_.value) return remove();
    YamlNode* node = &root_;
    const std::pair<YamlNode, YamlNode>* entry = nullptr;
    for (std::size_t i = 0; i < change_.path.size(); ++i) {
      YamlNode* next = child_of(*node, change_.path[i]);
      if (!next) return add(*node, entry, i);
      entry = nullptr;
      for (const auto& e : node->entries)
        if (&e.second == next) entry = &e;
      node = next;
    }
    set(*node, entry, *change_.value);
  }

  void set(const YamlNode& node, const std::pair<YamlNode, YamlNode>* entry, const std::string& value) {
    if (entry)  // a block begins on a line of its own, and a value that is nothing has no place
      replace(colon_of(entry->first) + 1, end_of_entry(*entry), " " + value);
    else
      replace(begin_of(node), end_of(node), value);
  }

  void add(const YamlNode& node, const std::pair<YamlNode, YamlNode>* entry, std::size_t part) {
    const std::string& name = change_.path[part];
    const std::string value = nested_value(part + 1);
    if (node.kind == Kind::null) return set(node, entry, nested_value(part));
    const bool to_list = node.kind == Kind::list;
    if (to_list != (name == "+")) refuse("is not there");
    const std::string item = to_list ? value : keyed(name, value);
    if (is_flow(node)) {
      const std::size_t end = end_of(node) - 1;
      std::size_t last = end;
      while (last > 0 && std::string(" \n\t\r").find(text_[last - 1]) != std::string::npos) --last;
      const bool is_empty = node.items.empty() && node.entries.empty(), ends_in_comma = at(last - 1) == ',';
      text_.insert(last, (is_empty ? "" : ends_in_comma ? " " : ", ") + item);
      return;
    }
    const std::size_t first = begin_of(node);
    // The keys of a map that is an item of a list stand where its first one does: "  - case: a" gives four blanks.
    const std::string indent(first - line_begin(first), ' ');
    insert_line_after(end_of(node), indent + (to_list ? "- " : "") + item);
  }

  void remove() {
    Path path = change_.path;
    for (;;) {
      YamlNode* parent = &root_;
      for (std::size_t i = 0; i + 1 < path.size(); ++i) parent = child_of(*parent, path[i]);
      if (path.size() > 1 && parent->entries.size() + parent->items.size() == 1) {
        path.pop_back();
        continue;
      }
      return remove_from(*parent, path.back());
    }
  }

  void remove_from(const YamlNode& parent, const std::string& part) {
    std::size_t from = 0, to = 0;
    if (parent.kind == Kind::map) {
      for (const auto& e : parent.entries)
        if (e.first.text == part) from = begin_of(e.first), to = end_of_entry(e);
    } else {
      const YamlNode& item = parent.items.at(static_cast<std::size_t>(*parse_integer(part)));
      from = begin_of(item), to = end_of(item);
    }
    if (is_flow(parent)) {
      std::size_t next = to, before = from;
      while (at(next) == ' ') ++next;
      while (before > 0 && std::string(" \n\r").find(text_[before - 1]) != std::string::npos) --before;
      if (at(next) == ',') {
        to = next + 1;
        while (at(to) == ' ') ++to;
      } else if (before > 0 && text_[before - 1] == ',') {
        from = before - 1;
      }
      return replace(from, to, "");
    }
    replace(line_begin(from), after_line(to), "");
  }

  std::string text_;
  const YamlChange& change_;
  const std::filesystem::path& file_;
  YamlNode root_;
  std::vector<std::size_t> lines_;  ///< where each line begins
};

}  // namespace

std::string edited_yaml(const std::string& text, const std::vector<YamlChange>& changes,
                        const std::filesystem::path& file) {
  std::string now = text;
  for (const YamlChange& change : changes) now = Editor(now, change, file).run();
  return now;
}

std::string yaml_scalar(const std::string& text) {
  const bool plain = !text.empty() && text != "null" && text != "~" && text.front() != '-' && text.front() != '.' &&
                     std::all_of(text.begin(), text.end(), [](unsigned char c) {
                       return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
                              c == '-' || c == '.' || c == '/';
                     });
  return plain ? text : in_quotes(text);
}

std::string yaml_list(const std::vector<double>& numbers) {
  return "[" + joined(numbers, ", ", [](double number) { return to_text(number); }) + "]";
}

}  // namespace trephine::config
