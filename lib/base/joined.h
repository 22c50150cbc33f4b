// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace trephine {

/// The words in one line, with `between` between two of them.
template <class Words>
std::string joined(const Words& words, std::string_view between = ", ") {
  std::string text;
  for (const auto& word : words) text.append(text.empty() ? "" : between).append(word);
  return text;
}
/// The same of what `word` makes of each item: a function, or a member (`&Item::name`).
template <class Items, class Word>
std::string joined(const Items& items, std::string_view between, const Word& word) {
  std::vector<std::string> words;
  for (const auto& item : items) words.emplace_back(std::invoke(word, item));
  return joined(words, between);
}

/// "a, b and c"
std::string listed(const std::vector<std::string>& words, const std::string& last = "and");

/// The text as printable() makes it between quotation marks, with a backslash before each one and each backslash.
std::string in_quotes(std::string_view text);

}  // namespace trephine
