// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/lesson_words.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>
#include <vector>

#include "lessons/lesson_type.h"

namespace trephine::lessons {
namespace {

using texts::Language;
using texts::Wording;

// What every lesson may say.
constexpr Wording common[] = {{{"Finish the lesson", "Lektion beenden"}},
                              {{"What is left in place is judged.", "Bewertet wird, was liegen bleibt."}},
                              {{"finished", "beendet"}},
                              {{"not finished", "nicht beendet"}},
                              {{"device lost", "Gerät verloren"}},
                              {{"completed", "vollendet"}},
                              {{"not completed", "nicht vollendet"}},
                              {{"failed", "nicht bestanden"}},
                              {{"not judged", "nicht bewertet"}},
                              {{"not in the allotted time", "nicht in der gegebenen Zeit"}},
                              {{"not completed in the allotted time", "nicht in der gegebenen Zeit vollendet"}},
                              {{"not completed: {}", "nicht vollendet: {}"}},
                              {{"a critical error happened", "ein kritischer Fehler geschah"}},
                              {{"Time to complete procedure", "Dauer des Eingriffs"}},
                              {{"{} of this case is doubtful", "{} ist in diesem Fall nicht sicher bekannt"}},
                              // critical errors, by their names in a rubric
                              {{"dura by burr", "Dura durch den Bohrer"}},
                              {{"sagittal sinus", "Sinus sagittalis"}},
                              {{"brainstem", "Hirnstamm"}},
                              {{"eloquent zone", "eloquente Zone"}},
                              {{"wrong side", "falsche Seite"}},
                              {{"wrong level", "falsche Höhe"}},
                              {{"dry catheter", "trockener Katheter"}},
                              {{"anterior cortex mm", "durch die Vorderwand"}},
                              {{"canal", "Wirbelkanal"}},
                              {{"medial breach mm", "durch die mediale Wand"}},
                              {{"great vessel", "großes Gefäß"}},
                              {{"artery", "Arterie"}},
                              {{"pleura or lung", "Pleura oder Lunge"}},
                              {{"needle", "Nadel"}},
                              {{"finder", "Pfriem"}},
                              {{"marker", "Stift"}},
                              {{"burr", "Bohrer"}},
                              {{"catheter", "Katheter"}}};

// Figures and limits, by their English titles.
constexpr Wording figures[] = {{{"midline off", "Abstand zur Mittellinie"}},
                               {{"midline trace", "Länge der Linie der Mitte"}},
                               {{"suture off", "Abstand zur Kranznaht"}},
                               {{"suture trace", "Länge der Linie der Kranznaht"}},
                               {{"midline near", "nahe der Mittellinie"}},
                               {{"suture near", "nahe der Kranznaht"}},
                               {{"midline", "Mittellinie"}},
                               {{"suture", "Kranznaht"}},
                               {{"kocher off", "Abstand zu Kochers Punkt"}},
                               {{"lateral", "seitlich der Mitte"}},
                               {{"before suture", "vor der Kranznaht"}},
                               {{"removed", "abgetragen"}},
                               {{"kocher", "Kochers Punkt"}},
                               {{"near", "nahe"}},
                               {{"far", "fern"}},
                               {{"beyond midline", "über die Mittellinie"}},
                               {{"line off foramen", "Linie neben dem Foramen"}},
                               {{"line off lateral", "davon nach lateral"}},
                               {{"ideal", "ideal"}},
                               {{"good", "gut"}},
                               {{"acceptable", "annehmbar"}},
                               {{"allotted", "gegeben"}},
                               {{"least", "mindestens"}},
                               {{"low", "niedrig"}},
                               {{"ideal low", "ideal ab"}},
                               {{"ideal high", "ideal bis"}},
                               {{"high", "hoch"}},
                               {{"most", "höchstens"}},
                               {{"depth", "Tiefe"}},
                               {{"outside ventricles", "außerhalb der Ventrikel"}},
                               {{"foramen off", "Abstand zum Foramen"}},
                               {{"foramen", "Foramen"}},
                               {{"passes", "Durchgänge"}},
                               {{"procedure", "Dauer"}},
                               {{"paused", "Pausen"}},
                               {{"five", "5 Punkte bis"}},
                               {{"four", "4 Punkte bis"}},
                               {{"three", "3 Punkte bis"}},
                               {{"two", "2 Punkte bis"}},
                               {{"entry off", "Abstand zum Eintritt"}},
                               {{"target off", "Abstand zum Ziel"}},
                               {{"breach", "Wand durchbrochen"}},
                               {{"depth beyond target", "hinter dem Ziel"}},
                               {{"exposure", "Röntgenzeit"}},
                               {{"shots", "Aufnahmen"}},
                               {{"coronal entry off", "Abstand zum Eintritt, koronal"}},
                               {{"axial off", "Abweichung, axial"}},
                               {{"sagittal off", "Abweichung, sagittal"}},
                               {{"tip beyond target", "Spitze hinter dem Ziel"}},
                               {{"errors", "Fehler"}},
                               {{"most errors", "Fehler höchstens"}},
                               {{"entry", "Eintritt"}},
                               {{"axial", "axial"}},
                               {{"sagittal", "sagittal"}},
                               {{"length", "Länge"}},
                               {{"head out", "Kopf über dem Knochen"}},
                               {{"fill", "Anteil der Breite"}},
                               {{"pedicle width", "Breite des Pedikels"}},
                               {{"head", "Kopf"}},
                               {{"widest", "am weitesten"}},
                               {{"narrowest", "am engsten"}},
                               {{"below border", "unter dem Unterrand"}},
                               {{"off notch", "neben dem Jugulum"}},
                               // of the hand's motion
                               {{"path", "Weg der Hand"}},
                               {{"tissue path", "Weg im Gewebe"}},
                               {{"economy", "Geradheit der Bewegungen"}},
                               {{"smoothness sparc", "Glätte (SPARC)"}},
                               {{"idle", "Ruhe"}},
                               {{"tremor", "Tremor"}},
                               {{"force integral n", "Kraft über die Zeit"}},
                               {{"tissue force integral n", "Kraft im Gewebe über die Zeit"}},
                               {{"contact force", "Kraft bei Berührung"}}};

// What stands in the places {} of the pattern; nothing where the text is not of it.
std::optional<std::vector<std::string>> values_of(const std::string& pattern, const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t at = 0;;) {
    const std::size_t place = pattern.find("{}", at);
    parts.push_back(pattern.substr(at, place == std::string::npos ? place : place - at));
    if (place == std::string::npos) break;
    at = place + 2;
  }
  if (parts.size() < 2 || text.compare(0, parts[0].size(), parts[0]) != 0) return {};
  std::vector<std::string> values;
  std::size_t at = parts[0].size();
  for (std::size_t n = 1; n < parts.size(); ++n) {
    const bool last = n + 1 == parts.size();
    const std::size_t next = last ? text.size() - std::min(text.size(), parts[n].size()) : text.find(parts[n], at);
    if (next == std::string::npos || next <= at || text.compare(next, parts[n].size(), parts[n]) != 0) return {};
    values.push_back(text.substr(at, next - at));
    at = next + parts[n].size();
  }
  return values;
}

std::string filled(std::string text, Language language, const std::vector<std::string>& values) {
  std::size_t at = 0;
  for (const std::string& value : values) {
    const std::size_t place = text.find("{}", at);
    if (place == std::string::npos) break;
    const std::string said = lesson_words(language, value);
    text.replace(place, 2, said);
    at = place + said.size();
  }
  return text;
}

}  // namespace

std::string lesson_words(Language language, const std::string& english) {
  if (language == Language::english) return english;
  for (const Wording& w : common)
    if (english == w.of(Language::english)) return w.of(language);
  for (const LessonType& lesson : lesson_types())
    for (const LessonText& text : lesson.texts)
      if (english == text.in[0]) return text.in[std::size_t(language)];
  // Those of lessons first: they say more exactly what is meant.
  for (const LessonType& lesson : lesson_types())
    for (const LessonText& text : lesson.texts)
      if (const auto values = values_of(text.in[0], english))
        return filled(text.in[std::size_t(language)], language, *values);
  for (const Wording& w : common)
    if (const auto values = values_of(w.of(Language::english), english))
      return filled(w.of(language), language, *values);
  return english;
}

std::string tool_title(Language language, const std::string& name) {
  const std::size_t size = name.rfind('_'), by = name.find('x', size);
  if (size == std::string::npos || by == std::string::npos || !std::isdigit(static_cast<unsigned char>(name[by - 1])))
    return lesson_words(language, name);
  return lesson_words(language, name.substr(0, size) + " " + name.substr(size + 1, by - size - 1) + " x " +
                                    name.substr(by + 1) + " mm");
}

std::string figure_title(Language language, const std::string& name) {
  std::string text = name;
  const std::size_t unit = text.rfind('_');
  std::replace(text.begin(), text.end(), '_', ' ');
  if (unit != std::string::npos && name != "smoothness_sparc") text = text.substr(0, unit);
  for (const Wording& w : figures)
    if (text == w.of(Language::english) && language != Language::english) return w.of(language);
  const std::string newton_seconds = "_n_s";  // a unit of two parts
  if (name.size() > newton_seconds.size() &&
      name.compare(name.size() - newton_seconds.size(), newton_seconds.size(), newton_seconds) == 0)
    text.resize(text.size() - 2);
  return text;
}

std::string figure_unit(const std::string& name) {
  constexpr std::pair<const char*, const char*> units[] = {{"_n_s", "N s"}, {"_n", "N"},   {"_mm3", "mm³"},
                                                           {"_um", "µm"},   {"_deg", "°"}, {"_ratio", ""},
                                                           {"_count", ""},  {"_sparc", ""}};
  for (const auto& [end, said] : units)
    if (const std::string wanted = end;
        name.size() > wanted.size() && name.compare(name.size() - wanted.size(), wanted.size(), wanted) == 0)
      return said;
  const std::size_t unit = name.rfind('_');
  return unit == std::string::npos ? "" : name.substr(unit + 1);
}

}  // namespace trephine::lessons
