// SPDX-License-Identifier: GPL-3.0-or-later
#include "group/group_words.h"

namespace trephine::group {
namespace {

using texts::Language;
using texts::Wording;

constexpr Wording words[] = {
    // of the page
    {{"participant", "Teilnehmer"}},
    {{"group", "Gruppe"}},
    {{"level", "Stufe"}},
    {{"done of planned", "erledigt von geplant"}},
    {{"completed", "vollendet"}},
    {{"failed", "nicht bestanden"}},
    {{"signed", "unterschrieben"}},
    {{"Signatures were not asked for.", "Nach Unterschriften wurde nicht gefragt."}},
    {{"Signed: every attempt.", "Unterschrieben: jeder Versuch."}},
    {{"Not signed: {} of {} attempts.", "Nicht unterschrieben: {} von {} Versuchen."}},
    {{"first", "erster"}},
    {{"last", "letzter"}},
    {{"kept", "behalten"}},
    {{"all", "alle"}},
    {{"before", "vorher"}},
    {{"practice", "Übung"}},
    {{"after", "nachher"}},
    {{"retention", "später"}},
    {{"{} of {}", "{} von {}"}},
    {{"Shares of the points that could be had, as means over attempts. Kept: (retention - before) / (after - before), "
      "where there was a gain.",
      "Anteile der möglichen Punkte, als Mittel über Versuche. Behalten: (später - vorher) / (nachher - vorher), wo "
      "etwas gewonnen war."}},
    {{"row", "Zeile"}},
    {{"Rows of the score: mean of 1 to 5, and how often it was judged",
      "Zeilen der Bewertung: Mittel von 1 bis 5, und wie oft bewertet wurde"}},
    {{"not judged", "nicht bewertet"}},
    {{"Critical errors", "Schwere Fehler"}},
    {{"None happened.", "Keiner kam vor."}},
    {{"error", "Fehler"}},
    {{"by whom", "von wem"}},
    {{"how often", "wie oft"}},
    {{"Pass mark, by contrasting groups", "Bestehensgrenze, nach kontrastierenden Gruppen"}},
    {{"not set: {}", "nicht gesetzt: {}"}},
    {{"By {}: <b>{:.1f} %</b> of the points, where the normal densities of {} ({} participants, mean {:.1f} %, sd "
      "{:.1f}) and {} ({}, mean {:.1f} %, sd {:.1f}) cross. Who failed by a critical error or did not finish has not "
      "passed, whatever the points.",
      "Nach {}: <b>{:.1f} %</b> der Punkte, wo sich die Normaldichten von {} ({} Teilnehmer, Mittel {:.1f} %, SD "
      "{:.1f}) und {} ({}, Mittel {:.1f} %, SD {:.1f}) schneiden. Wer einen schweren Fehler machte oder nicht fertig "
      "wurde, hat nicht bestanden, gleich mit wie vielen Punkten."}},
    {{"{} of {} pass and {} of {} fail (expected of normal distributions: {:.1f} and {:.1f} %). A mark from few "
      "participants is uncertain.",
      "{} von {} bestehen und {} von {} nicht (von Normalverteilungen erwartet: {:.1f} und {:.1f} %). Eine Grenze aus "
      "wenigen Teilnehmern ist unsicher."}},
    {{"the mean of all attempts", "dem Mittel aller Versuche"}},
    {{"Passed:", "Bestanden:"}},
    {{"Not passed:", "Nicht bestanden:"}},
    {{"nobody", "niemand"}},
    {{"figure of the hand's motion", "Größe der Handbewegung"}},
    {{"experts", "Erfahrene"}},
    {{"{} to {}", "{} bis {}"}},
    {{"Motion in the last attempt, beside {} recordings of experts",
      "Bewegung im letzten Versuch, neben {} Aufnahmen von Erfahrenen"}},
    {{"Coloured: outside of the experts' band.", "Farbig: außerhalb des Bandes der Erfahrenen."}},
    {{"Questionnaire", "Fragebogen"}},
    {{"question", "Frage"}},
    {{"phase", "Phase"}},
    {{"answers", "Antworten"}},
    {{"mean", "Mittel"}},
    {{"median", "Median"}},
    {{"change in those who answered in both", "Änderung bei denen, die in beiden antworteten"}},
    {{"Trephine: a group", "Trephine: eine Gruppe"}},
    {{"A group of {} participants, {} attempts", "Eine Gruppe von {} Teilnehmern, {} Versuche"}},
    {{"not a medical device", "kein Medizinprodukt"}},
    // of notes
    {{"{}: the recording is gone; the report stands and cannot be judged again",
      "{}: die Aufnahme fehlt; der Bericht bleibt, neu bewertet werden kann er nicht"}},
    {{"{}: the recording is gone, so that it cannot be scored anew: left out",
      "{}: die Aufnahme fehlt, neu bewertet werden kann er nicht: weggelassen"}},
    {{"{}: was scored by another rubric, and is scored anew",
      "{}: war nach einem anderen Raster bewertet und wird neu bewertet"}},
    {{"{}: its signature is of another recording: not signed",
      "{}: seine Unterschrift ist die einer anderen Aufnahme: nicht unterschrieben"}},
    {{"{}: what is signed names another rubric or none: not signed",
      "{}: was unterschrieben ist, nennt einen anderen Bewertungsbogen oder keinen: nicht unterschrieben"}},
    {{"{}: its signature is not by the owner of the public key: not signed",
      "{}: seine Unterschrift ist nicht vom Inhaber des öffentlichen Schlüssels: nicht unterschrieben"}},
    {{"{}: its motion is that of {}, and it is left out", "{}: seine Bewegung ist die von {}, es wird weggelassen"}},
    {{"{}: left out: {}", "{}: weggelassen: {}"}},
    // of plots
    {{"{} over attempts", "{} über die Versuche"}},
    {{"{} by {}", "{} nach {}"}},
    {{"{} by {}, {}", "{} nach {}, {}"}},
    {{"{}: distribution", "{}: Verteilung"}},
    {{"mean, interval", "Mittel, Intervall"}},
    {{"phase {}", "Phase {}"}},
    {{"participants", "Teilnehmer"}},
    {{"attempt", "Versuch"}},
    {{"points", "Punkte"}},
    {{"count", "Anzahl"}},
};

// Null where there is none.
const char* looked_up(Language language, std::string_view english) {
  for (const Wording& w : words)
    if (english == w.of(Language::english)) return w.of(language);
  return nullptr;
}

}  // namespace

const char* group_word(Language language, std::string_view english) {
  const char* const found = looked_up(language, english);
  return found ? found : english.data();
}

std::string group_words(Language language, const texts::Phrase& phrase) {
  return phrase.said([&](const std::string& own) { return looked_up(language, own); });
}

}  // namespace trephine::group
