// SPDX-License-Identifier: GPL-3.0-or-later
// The window's notes in other languages. They come from everywhere in English, with names and figures; here is what
// they look like. A further language is a further column, as in texts.cpp.
#include <optional>
#include <vector>

#include "haptics/tool.h"
#include "window/texts.h"

namespace trephine {
namespace {

struct Row {
  const char* in[2];  // {}: a name or a figure, which stays; as many and in the same order in each
};

// What begins with a word of its own comes before what begins with {}.
constexpr Row table[] = {
    {{"fault: {}: the force is zero from now on", "Fehler: {}: die Kraft ist ab jetzt null"}},
    {{"pose", "Lage"}},
    {{"time step", "Zeitschritt"}},
    {{"force", "Kraft"}},
    {{"device lost", "Gerät verloren"}},
    {{"waiting for a device on {}", "warte auf ein Gerät an {}"}},
    {{"holding a 3D mouse", "eine 3D-Maus hält das Instrument"}},
    {{"holding {}", "{} hält das Instrument"}},
    {{"beyond {} mm of the tool {} is shown coarse: {} of {} triangles, {} places measured, the worst {} mm off",
      "weiter als {} mm vom Instrument ist {} grob gezeigt: {} von {} Dreiecken, {} Stellen gemessen, die schlechteste "
      "{} mm daneben"}},
    {{"graphics memory: {} shown coarse: {} of {} triangles, {} places measured, the worst {} mm off",
      "Grafikspeicher: {} grob gezeigt: {} von {} Dreiecken, {} Stellen gemessen, die schlechteste {} mm daneben"}},
    {{"graphics memory: rough edges", "Grafikspeicher: raue Kanten"}},
    {{"graphics memory: no CT on cuts and slices", "Grafikspeicher: kein CT in Schnitten und Schichten"}},
    {{"graphics memory: the CT in voxels of {} mm", "Grafikspeicher: das CT in Voxeln von {} mm"}},
    {{"graphics memory: the oldest incisions look closed, and are not",
      "Grafikspeicher: die ältesten Inzisionen sehen geschlossen aus und sind es nicht"}},
    {{"graphics memory: the newest incision takes {} MB more than graphics_budget_mb",
      "Grafikspeicher: die neueste Inzision braucht {} MB mehr als graphics_budget_mb"}},
    {{"graphics memory: pictures of {} x {} pixels in place of {} x {}",
      "Grafikspeicher: Bilder von {} x {} Bildpunkten statt {} x {}"}},
    {{"more than {} incisions: the oldest look closed, and are not",
      "mehr als {} Inzisionen: die ältesten sehen geschlossen aus und sind es nicht"}},
    {{"the lesson is judged: {} of {} points, {}", "die Lektion ist bewertet: {} von {} Punkten, {}"}},
    {{"the lesson is judged: {} of {} points", "die Lektion ist bewertet: {} von {} Punkten"}},
    {{"{} is shown coarse: {} of {} triangles, {} places measured, the worst {} mm off",
      "{} ist grob gezeigt: {} von {} Dreiecken, {} Stellen gemessen, die schlechteste {} mm daneben"}},
    {{"{} frames were not recorded: the disk is too slow",
      "{} Zeitschritte fehlen in der Aufnahme: die Platte ist zu langsam"}},
    {{"{}: {} ticks, tick time p50 {}, p99 {} us, woken late p50 {}, p99 {} ms, {} overruns, faults {}",
      "{}: {} Takte, Dauer p50 {}, p99 {} us, verspätet p50 {}, p99 {} ms, {} zu lange, Fehler: {}"}},
    {{"{}: {} ticks, tick time p50 {}, p99 {} us, woken late p50 {}, p99 {} ms, {} overruns",
      "{}: {} Takte, Dauer p50 {}, p99 {} us, verspätet p50 {}, p99 {} ms, {} zu lange"}},
    {{"a picture could not be written: {}", "ein Bild konnte nicht geschrieben werden: {}"}},
    {{"{} removed {}", "{} hat entfernt: {}"}},
    // Answers to keys.
    {{"nothing is there", "da ist nichts"}},
    {{"this is no lesson", "das ist keine Lektion"}},
    {{"this lesson has no C-arm", "diese Lektion hat keinen C-Bogen"}},
    {{"the case has no target", "der Fall hat kein Ziel"}},
    {{"not before the lesson's end", "nicht vor dem Ende der Lektion"}},
    {{"Enter again: the lesson ends", "noch einmal Eingabe: die Lektion endet"}},
    {{"only the end is left: press Enter twice", "es bleibt nur das Ende: zweimal Eingabe"}},
    {{"the lesson is paused: go on first", "die Lektion ist angehalten: erst weiter"}},
    {{"the marker has not touched yet", "der Stift hat noch nichts berührt"}},
    {{"this is the last step", "das ist der letzte Schritt"}},
    {{"this is the first step", "das ist der erste Schritt"}},
    {{"not now: the lesson waits for its device, or has ended",
      "nicht jetzt: die Lektion wartet auf ihr Gerät oder ist zu Ende"}},
};

constexpr Row names[] = {
    {{"surgeon", "Chirurg"}},   {{"front", "vorn"}},      {{"back", "hinten"}},  {{"left", "links"}},
    {{"right", "rechts"}},      {{"top", "oben"}},        {{"bottom", "unten"}}, {{"oblique", "schräg"}},
    {{"none", "keine"}},        {{"tool", "Instrument"}}, {{"axial", "axial"}},  {{"coronal", "koronal"}},
    {{"sagittal", "sagittal"}},
};

// What of the text stands for each {} of the form; none where it has another form. Each is as short as it can be, but
// the last one, which goes on to what the form ends with.
std::optional<std::vector<std::string>> parts_of(const std::string& text, const std::string& form) {
  std::vector<std::string> literals;
  std::size_t from = 0;
  for (std::size_t at; (at = form.find("{}", from)) != std::string::npos; from = at + 2)
    literals.push_back(form.substr(from, at - from));
  literals.push_back(form.substr(from));
  if (literals.size() == 1) return text == form ? std::optional(std::vector<std::string>()) : std::nullopt;
  if (text.compare(0, literals[0].size(), literals[0]) != 0) return std::nullopt;
  std::vector<std::string> parts;
  std::size_t at = literals[0].size();
  for (std::size_t n = 1; n < literals.size(); ++n) {
    const std::string& next = literals[n];
    const bool last = n + 1 == literals.size();
    std::size_t end = text.find(next, at);
    if (last) end = text.size() >= at + next.size() ? text.size() - next.size() : std::string::npos;
    if (end == std::string::npos || text.compare(end, next.size(), next) != 0) return std::nullopt;
    if (end == at) return std::nullopt;  // a name or a figure is something
    parts.push_back(text.substr(at, end - at));
    at = end + next.size();
  }
  return parts;
}

}  // namespace

std::string translated_name(Language language, const std::string& english) {
  for (const Row& row : names)
    if (english == row.in[0]) return row.in[std::size_t(language)];
  for (const ToolKind& kind : all_tool_kinds())
    if (language == Language::german && english == kind.name) return kind.german;
  return english;
}

std::string translated_note(Language language, const std::string& english) {
  if (language == Language::english) return english;
  for (const Row& row : table) {
    const std::optional<std::vector<std::string>> parts = parts_of(english, row.in[0]);
    if (!parts) continue;
    std::string out = row.in[std::size_t(language)];
    std::size_t from = 0;
    for (const std::string& part : *parts) {
      const std::string said = translated_note(language, part);
      const std::size_t at = out.find("{}", from);
      out.replace(at, 2, said);
      from = at + said.size();
    }
    return out;
  }
  return english;
}

}  // namespace trephine
