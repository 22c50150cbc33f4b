// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/lesson_words.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "lessons/lesson_type.h"

namespace trephine::lessons {
namespace {

using texts::Language;
using texts::Phrase;
using texts::Wording;

// What every lesson may say.
constexpr Wording common[] = {
    {{"Finish the lesson", "Lektion beenden"}},
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
    {{"it went in too fast", "zu schnell eingeführt"}},
    {{"too many passes", "zu viele Durchgänge"}},
    {{"a critical error happened", "ein kritischer Fehler geschah"}},
    {{"Time-out and decisions", "Time-out und Entscheidungen"}},
    {{"all were answered rightly and in time", "alle richtig und rechtzeitig beantwortet"}},
    {{"{} of {} were not answered rightly and in time", "{} von {} nicht richtig oder nicht rechtzeitig beantwortet"}},
    {{"the time-out was left out", "das Time-out wurde ausgelassen"}},
    {{"the time-out named another patient or task",
      "das Time-out nannte einen anderen Patienten oder eine andere Aufgabe"}},
    {{"it was asked by another rubric", "ein anderer Bewertungsbogen fragte"}},
    {{"The other hand", "Die andere Hand"}},
    {{"it pressed on {} with up to {} N", "sie drückte auf {} mit bis zu {} N"}},
    {{"it spared what it must spare", "sie schonte, was zu schonen ist"}},
    {{"blood was left where it bled", "Blut blieb, wo es blutete"}},
    {{"its tip was in {}", "ihre Spitze war in {}"}},
    {{"its device was lost after {} s", "ihr Gerät war nach {} s verloren"}},
    {{"its device gives at most {} N, which is too little to show how hard it pressed",
      "ihr Gerät gibt höchstens {} N, zu wenig, um zu zeigen, wie fest sie drückte"}},
    {{"not answered", "nicht beantwortet"}},
    {{"wrong", "falsch"}},
    {{"after the cut", "nach dem Schnitt"}},
    {{"right", "rechts"}},
    {{"left", "links"}},
    {{"pedicle", "Pedikel"}},
    {{"Time to complete procedure", "Dauer des Eingriffs"}},
    {{"the tool may have been {} mm off, and a limit is {} mm",
      "das Instrument kann um {} mm abgewichen sein, und eine Grenze ist {} mm"}},
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
    {{"other breach mm", "durch eine andere Wand"}},
    {{"beside spine mm", "am Wirbel vorbei"}},
    {{"great vessel", "großes Gefäß"}},
    {{"artery", "Arterie"}},
    {{"pleura or lung", "Pleura oder Lunge"}},
    {{"needle", "Nadel"}},
    {{"finder", "Pfriem"}},
    {{"marker", "Stift"}},
    {{"burr", "Bohrer"}},
    {{"catheter", "Katheter"}},
    // what the other hand must spare
    {{"dura", "Dura"}},
    {{"brain", "Gehirn"}},
    {{"ventricles", "Ventrikel"}}};

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
                               {{"burr", "Bohrer"}},
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
                               {{"deepest", "am tiefsten"}},
                               {{"deepest beyond target", "am tiefsten hinter dem Ziel"}},
                               {{"fastest", "am schnellsten"}},
                               {{"holes", "Bohrlöcher"}},
                               {{"incisions", "Hautschnitte"}},
                               {{"punctures", "Einstiche ohne Knochen"}},
                               {{"aspirations", "Aspirationen"}},
                               {{"beyond vein", "hinter der Vene"}},
                               {{"proud", "Kopf zu weit heraus"}},
                               {{"outside ventricles", "außerhalb der Ventrikel"}},
                               {{"foramen off", "Abstand zum Foramen"}},
                               {{"foramen", "Foramen"}},
                               {{"passes", "Durchgänge"}},
                               {{"wrong answers", "nicht richtig beantwortet"}},
                               {{"second force", "Kraft der anderen Hand"}},
                               {{"blood left", "Blut, das blieb"}},
                               {{"suction", "gesaugt"}},
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

// Null where no lesson says it.
const char* looked_up(Language language, const std::string& english) {
  for (const Wording& w : common)
    if (english == w.of(Language::english)) return w.of(language);
  for (const LessonType& lesson : lesson_types())
    for (const LessonText& text : lesson.texts)
      if (english == text.in[0]) return text.in[std::size_t(language)].c_str();
  return nullptr;
}

}  // namespace

std::string lesson_words(Language language, const Phrase& phrase) {
  if (language == Language::english) return phrase.english();
  return phrase.said([&](const std::string& words) { return looked_up(language, words); });
}

Phrase tool_phrase(const std::string& name) {
  const std::size_t size = name.rfind('_'), by = name.find('x', size);
  if (size == std::string::npos || size + 1 == name.size()) return name;
  std::string kind = name.substr(0, size);
  std::replace(kind.begin(), kind.end(), '_', ' ');
  const auto is_number = [](const std::string& text) {
    return !text.empty() && text.find_first_not_of("0123456789.") == std::string::npos;
  };
  if (const std::string width = name.substr(size + 1); is_number(width)) return {kind + " {} mm", {width}};
  if (by == std::string::npos) return name;
  const std::string width = name.substr(size + 1, by - size - 1), length = name.substr(by + 1);
  if (!is_number(width) || !is_number(length)) return name;
  return {kind + " {} x {} mm", {width, length}};
}

std::string tool_title(Language language, const std::string& name) { return lesson_words(language, tool_phrase(name)); }

std::string figure_title(Language language, const std::string& name) {
  std::string text = name;
  const std::string speed = "_mm_per_s";  // a unit of several words
  const std::size_t unit =
      name.size() > speed.size() && name.compare(name.size() - speed.size(), speed.size(), speed) == 0
          ? name.size() - speed.size()
          : text.rfind('_');
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
  constexpr std::pair<const char*, const char*> units[] = {{"_n_s", "N s"}, {"_mm_per_s", "mm/s"}, {"_n", "N"},
                                                           {"_mm3", "mm³"}, {"_um", "µm"},         {"_deg", "°"},
                                                           {"_ratio", ""},  {"_count", ""},        {"_sparc", ""}};
  for (const auto& [end, said] : units)
    if (const std::string wanted = end;
        name.size() > wanted.size() && name.compare(name.size() - wanted.size(), wanted.size(), wanted) == 0)
      return said;
  const std::size_t unit = name.rfind('_');
  return unit == std::string::npos ? "" : name.substr(unit + 1);
}

}  // namespace trephine::lessons
