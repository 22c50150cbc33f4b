// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/printable_lines.h"

#include "base/text.h"

namespace trephine {

std::string printable_lines(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = text.find_first_of("\n\t", at);
    out += printable(text.substr(at, end == std::string_view::npos ? end : end - at));
    if (end == std::string_view::npos) break;
    out += text[end];
    at = end + 1;
  }
  return out;
}

}  // namespace trephine
