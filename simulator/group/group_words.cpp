// SPDX-License-Identifier: GPL-3.0-or-later
#include "group/group_words.h"

#include <cctype>

namespace trephine::group {
namespace {

using texts::Language;
using texts::Wording;

constexpr Wording parts_of_notes[] = {
    {{": the recording is gone; the report stands and cannot be judged again",
      ": die Aufnahme fehlt; der Bericht bleibt, neu bewertet werden kann er nicht"}},
    {{": its motion is that of ", ": seine Bewegung ist die von "}},
    {{", and it is left out", ", es wird weggelassen"}},
    {{": left out: ", ": weggelassen: "}},
};
// Longer ones first: a word is looked for where no letter stands beside it.
constexpr Wording plot_terms[] = {
    {{"over attempts", "über die Versuche"}},
    {{"mean, interval", "Mittel, Intervall"}},
    {{"by group", "nach Gruppe"}},
    {{"by phase", "nach Phase"}},
    {{"by attempt", "nach Versuch"}},
    {{"phase before", "Phase vorher"}},
    {{"phase practice", "Phase Übung"}},
    {{"phase after", "Phase nachher"}},
    {{"phase retention", "Phase später"}},
    {{"participants", "Teilnehmer"}},
    {{"attempt", "Versuch"}},
    {{"group", "Gruppe"}},
    {{"points", "Punkte"}},
    {{"median", "Median"}},
    {{"mean", "Mittel"}},
};

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) || (static_cast<unsigned char>(c) & 0x80); }

template <std::size_t N>
std::string replaced(std::string text, const Wording (&words)[N], Language language, bool whole) {
  for (const Wording& w : words) {
    const std::string from = w.of(Language::english), to = w.of(language);
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos;) {
      const std::size_t end = at + from.size();
      if (whole && ((at > 0 && is_letter(text[at - 1])) || (end < text.size() && is_letter(text[end])))) {
        at = end;
        continue;
      }
      text.replace(at, from.size(), to);
      at += to.size();
    }
  }
  return text;
}

}  // namespace

std::string note_words(Language language, const std::string& english) {
  return language == Language::english ? english : replaced(english, parts_of_notes, language, false);
}

std::string caption_words(Language language, const std::string& english) {
  return language == Language::english ? english : replaced(english, plot_terms, language, true);
}

std::string plot_words(Language language, const std::string& svg) {
  if (language == Language::english) return svg;
  std::string out;
  for (std::size_t at = 0; at < svg.size();) {
    const bool tag = svg[at] == '<';
    std::size_t end = svg.find(tag ? '>' : '<', at);
    end = end == std::string::npos ? svg.size() : tag ? end + 1 : end;
    const std::string part = svg.substr(at, end - at);
    out += tag ? part : caption_words(language, part);
    at = end;
  }
  return out;
}

}  // namespace trephine::group
