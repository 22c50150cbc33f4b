// SPDX-License-Identifier: GPL-3.0-or-later
#include "texts/phrase.h"

#include <ostream>

namespace trephine::texts {

std::string filled(std::string words, const std::vector<std::string>& values) {
  std::size_t from = 0;
  for (const std::string& value : values) {
    const std::size_t place = words.find("{}", from);
    if (place == std::string::npos) break;
    words.replace(place, 2, value);
    from = place + value.size();
  }
  return words;
}

std::string Phrase::english() const {
  std::vector<std::string> said;
  for (const Phrase& value : values) said.push_back(value.english());
  return filled(words, said);
}

bool operator==(const Phrase& a, const Phrase& b) { return a.words == b.words && a.values == b.values; }
bool operator!=(const Phrase& a, const Phrase& b) { return !(a == b); }

std::ostream& operator<<(std::ostream& out, const Phrase& phrase) { return out << phrase.english(); }

}  // namespace trephine::texts
