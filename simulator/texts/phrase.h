// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace trephine::texts {

/// A text with a place {} for each of its values: {"{} of five errors", {"2"}}. Its English words, with the places left
/// open, are the name by which a table finds the same in another language (as a msgid of gettext is), so it is put
/// into a language when it is shown, and nobody has to take a finished sentence apart. A value is a phrase itself: the
/// name of a tool is put into the language too, a figure stays as it is.
struct Phrase {
  std::string words;
  std::vector<Phrase> values;

  Phrase() = default;
  Phrase(const char* words_) : words(words_) {}
  Phrase(std::string words_) : words(std::move(words_)) {}
  Phrase(std::string words_, std::vector<Phrase> values_) : words(std::move(words_)), values(std::move(values_)) {}

  bool empty() const { return words.empty(); }
  std::string english() const;
  /// In the words that a table has for its own and for those of each value; null: there are none, they stay.
  std::string said(const std::function<const char*(const std::string& words)>& look_up) const;
};
bool operator==(const Phrase& a, const Phrase& b);
bool operator!=(const Phrase& a, const Phrase& b);
std::ostream& operator<<(std::ostream& out, const Phrase& phrase);  ///< in English

/// The words with the values in their places, in their order; what is said in a value is no place.
std::string filled(std::string words, const std::vector<std::string>& values);

}  // namespace trephine::texts
