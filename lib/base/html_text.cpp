// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/html_text.h"

#include <cstdlib>

#include "base/printable_lines.h"

namespace trephine {
namespace {

// Whether the four digits behind \u name a character that printable_lines replaces. Those are all below U+10000.
bool is_replaced(const std::string& digits) {
  char* end = nullptr;
  const unsigned long c = std::strtoul(digits.c_str(), &end, 16);
  if (digits.size() != 4 || *end) return false;
  std::string utf8;
  if (c < 0x80)
    utf8 = {char(c)};
  else if (c < 0x800)
    utf8 = {char(0xc0 | c >> 6), char(0x80 | (c & 0x3f))};
  else
    utf8 = {char(0xe0 | c >> 12), char(0x80 | (c >> 6 & 0x3f)), char(0x80 | (c & 0x3f))};
  return printable_lines(utf8) != utf8;
}

}  // namespace

std::string html_text(std::string_view text) {
  std::string out;
  for (const char c : printable_lines(text)) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else
      out += c;
  }
  return out;
}

std::string html_json(std::string_view json) {
  const std::string plain = printable_lines(json);
  std::string out;
  out.reserve(plain.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    if (plain[i] == '<') {
      out += "\\u003c";
    } else if (plain[i] != '\\' || i + 1 == plain.size()) {
      out += plain[i];
    } else if (const char kind = plain[++i]; kind == 'b' || kind == 'f') {
      out += '?';
    } else if (kind == 'u' && is_replaced(plain.substr(i + 1, 4))) {
      out += '?';
      i += 4;
    } else {
      out += {'\\', kind};
    }
  }
  return out;
}

}  // namespace trephine
