// SPDX-License-Identifier: GPL-3.0-or-later
#include "group/group_words.h"

namespace trephine::group {
namespace {

using texts::Language;
using texts::Wording;

constexpr Wording words[] = {
    {{"{}: the recording is gone; the report stands and cannot be judged again",
      "{}: die Aufnahme fehlt; der Bericht bleibt, neu bewertet werden kann er nicht"}},
    {{"{}: its motion is that of {}, and it is left out", "{}: seine Bewegung ist die von {}, es wird weggelassen"}},
    {{"{}: left out: {}", "{}: weggelassen: {}"}},
    // of plots
    {{"{} over attempts", "{} über die Versuche"}},
    {{"{} by {}", "{} nach {}"}},
    {{"{} by {}, {}", "{} nach {}, {}"}},
    {{"{}: distribution", "{}: Verteilung"}},
    {{"mean, interval", "Mittel, Intervall"}},
    {{"phase {}", "Phase {}"}},
    {{"before", "vorher"}},
    {{"practice", "Übung"}},
    {{"after", "nachher"}},
    {{"retention", "später"}},
    {{"participants", "Teilnehmer"}},
    {{"attempt", "Versuch"}},
    {{"phase", "Phase"}},
    {{"group", "Gruppe"}},
    {{"level", "Stufe"}},
    {{"points", "Punkte"}},
    {{"count", "Anzahl"}},
    {{"median", "Median"}},
    {{"mean", "Mittel"}},
};

}  // namespace

std::string group_words(Language language, const texts::Phrase& phrase) {
  std::string said = phrase.words;
  for (const Wording& w : words)
    if (phrase.words == w.of(Language::english)) said = w.of(language);
  std::vector<std::string> values;
  for (const texts::Phrase& value : phrase.values) values.push_back(group_words(language, value));
  return texts::filled(said, values);
}

}  // namespace trephine::group
