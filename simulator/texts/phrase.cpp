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

std::string Phrase::said(const std::function<const char*(const std::string&)>& look_up) const {
  std::vector<std::string> in_places;
  for (const Phrase& value : values) in_places.push_back(value.said(look_up));
  const char* const found = look_up(words);
  return filled(found ? found : words, in_places);
}

std::string Phrase::english() const {
  return said([](const std::string&) { return nullptr; });
}

bool operator==(const Phrase& a, const Phrase& b) { return a.words == b.words && a.values == b.values; }
bool operator!=(const Phrase& a, const Phrase& b) { return !(a == b); }

std::ostream& operator<<(std::ostream& out, const Phrase& phrase) { return out << phrase.english(); }

}  // namespace trephine::texts
