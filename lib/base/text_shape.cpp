// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text_shape.h"

namespace trephine {

bool has_shape(std::string_view text, std::string_view shape) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t at = 0;
  for (const char s : shape) {
    const char c = at < text.size() ? text[at] : '\0';
    const bool fits = s == 'A'               ? c >= 'A' && c <= 'Z'
                      : s == 'a'             ? c >= 'a' && c <= 'z'
                      : s == '9' || s == '8' ? digit(c)
                                             : c == s;
    if (fits)
      ++at;
    else if (s != 'a' && s != '8')
      return false;
  }
  return at == text.size();
}

}  // namespace trephine
