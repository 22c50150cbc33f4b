// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include "base/joined.h"

namespace trephine {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Length of the digits at the start of `text`.
std::size_t digits(std::string_view text) {
  std::size_t n = 0;
  while (n < text.size() && is_digit(text[n])) ++n;
  return n;
}

// JSON's grammar: -?(0|[1-9][0-9]*)(.[0-9]+)?([eE][+-]?[0-9]+)?
bool is_number(std::string_view text, bool integer_only) {
  if (!text.empty() && text[0] == '-') text.remove_prefix(1);
  const std::size_t whole = digits(text);
  if (whole == 0 || (whole > 1 && text[0] == '0')) return false;
  text.remove_prefix(whole);
  if (integer_only) return text.empty();
  if (!text.empty() && text[0] == '.') {
    text.remove_prefix(1);
    const std::size_t fraction = digits(text);
    if (fraction == 0) return false;
    text.remove_prefix(fraction);
  }
  if (!text.empty() && (text[0] == 'e' || text[0] == 'E')) {
    text.remove_prefix(1);
    if (!text.empty() && (text[0] == '+' || text[0] == '-')) text.remove_prefix(1);
    const std::size_t exponent = digits(text);
    if (exponent == 0) return false;
    text.remove_prefix(exponent);
  }
  return text.empty();
}

template <class T>
std::optional<T> convert(std::string_view text) {
  T value{};
  const auto r = std::from_chars(text.data(), text.data() + text.size(), value);
  if (r.ec != std::errc() || r.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

// Edits (insert, delete, replace, swap neighbours) from a to b: the optimal string alignment distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i)
    for (std::size_t j = 1; j <= b.size(); ++j) {
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

}  // namespace

std::string to_text(double v) {
  if (v == 0) return "0";
  // Whole numbers stay plain ("80000", not "8e+04") as long as every digit is exact.
  const bool plain = std::fabs(v) < 1e15 && v == std::trunc(v);
  char buffer[32];
  const auto r = plain ? std::to_chars(buffer, buffer + sizeof buffer, v, std::chars_format::fixed)
                       : std::to_chars(buffer, buffer + sizeof buffer, v);
  return std::string(buffer, r.ptr);
}

std::string grouped_text(long long number) {
  std::string text = std::to_string(number);
  for (std::size_t i = text.size(); i > 3 + (number < 0);) text.insert(i -= 3, ",");
  return text;
}

std::optional<double> parse_number(std::string_view text) {
  if (!is_number(text, false)) return std::nullopt;
  return convert<double>(text);
}

std::optional<long long> parse_integer(std::string_view text) {
  if (!is_number(text, true)) return std::nullopt;
  return convert<long long>(text);
}

std::string trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

std::vector<std::string> split_at(std::string_view text, char separator) {
  std::vector<std::string> pieces(1);
  for (const char c : text)
    if (c == separator)
      pieces.emplace_back();
    else
      pieces.back() += c;
  return pieces;
}

std::string listed(const std::vector<std::string>& words, const std::string& last) {
  if (words.size() < 2) return joined(words);
  return joined(std::vector<std::string>(words.begin(), words.end() - 1)) + " " + last + " " + words.back();
}

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : printable(text)) out.append(c == '"' || c == '\\' ? "\\" : "") += c;
  return out + "\"";
}

// How many bytes of UTF-8 at the front of the text are a character that controls how others are shown; 0: none.
static std::size_t control_bytes(std::string_view text) {
  const auto byte = [&](std::size_t at) -> unsigned { return at < text.size() ? std::uint8_t(text[at]) : 0; };
  if (byte(0) < 0x20 || byte(0) == 0x7f) return 1;
  if (byte(0) == 0xc2 && (byte(1) & 0xe0) == 0x80) return 2;  // U+0080 to U+009F
  // What turns the direction of writing, so that a text reads as another one, and other ends of lines.
  if (byte(0) == 0xd8 && byte(1) == 0x9c) return 2;  // U+061C
  if (byte(0) != 0xe2) return 0;
  const unsigned rest = byte(1) << 8 | byte(2);
  const bool marks = rest == 0x808e || rest == 0x808f;     // U+200E, U+200F
  const bool embeds = rest >= 0x80a8 && rest <= 0x80ae;    // U+2028 to U+202E
  const bool isolates = rest >= 0x81a6 && rest <= 0x81a9;  // U+2066 to U+2069
  return marks || embeds || isolates ? 3 : 0;
}

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t control = control_bytes(text);
    out += control > 0 ? '?' : text[0];
    text.remove_prefix(control > 0 ? control : 1);
  }
  return out;
}

std::string nearest_name(std::string_view name, const std::vector<std::string>& known) {
  const std::string* best = nullptr;
  std::size_t best_distance = std::max<std::size_t>(1, name.size() / 3) + 1;
  if (name.size() > 100) return "";
  for (const std::string& k : known) {
    // A name without its unit or its second word counts as a slip too.
    const bool beginning = name.size() > 2 && k.size() > name.size() && k.compare(0, name.size(), name) == 0 &&
                           (k[name.size()] == '_' || k[name.size()] == '-');
    const std::size_t d = beginning ? 1 : edit_distance(name, k);
    if (d < best_distance && d < std::max(name.size(), k.size())) {
      best = &k;
      best_distance = d;
    }
  }
  return best ? *best : std::string();
}

}  // namespace trephine
