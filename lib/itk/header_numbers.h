// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/error.h"
#include "base/text.h"

namespace trephine::itk::detail {

/// What the readers of text headers share; for the sources of this room only.

[[noreturn]] inline void bad(const std::string& key, const std::string& what) {
  throw Error(ExitCode::bad_input, "", key, what);
}

/// The numbers between blanks. Throws Error 65 with the key where a word is no finite number.
inline std::vector<double> numbers_of(const std::string& key, const std::string& text) {
  std::vector<double> found;
  for (const std::string& word : split_at(text, ' ')) {
    if (word.empty()) continue;
    const auto number = parse_number(word);
    if (!number) bad(key, "holds what is no finite number");
    found.push_back(*number);
  }
  return found;
}

}  // namespace trephine::itk::detail
