// SPDX-License-Identifier: GPL-3.0-or-later
// The window's words. A further language is a further column, and an entry in texts::languages().
#include "window/texts.h"

#include <algorithm>

#include "haptics/tool.h"
#include "lessons/lesson_guide.h"

namespace trephine::window {
namespace {

struct Row {
  Text text;
  texts::Wording in;
};

constexpr Row table[] = {
    {Text::anatomies, {{"Anatomies", "Anatomie"}}},
    {Text::view, {{"View", "Ansicht"}}},
    {Text::cut_away, {{"Cut away", "Schnittebene"}}},
    {Text::cast, {{"Ray casting", "Strahlen"}}},
    {Text::shows_ct, {{"CT on the cut", "CT im Schnitt"}}},
    {Text::move_plane, {{"Move, mm", "Verschieben, mm"}}},
    {Text::tool, {{"Tool", "Instrument"}}},
    {Text::time, {{"Time", "Zeit"}}},
    {Text::inside, {{"The tip is in", "Spitze in"}}},
    {Text::nothing, {{"air", "Luft"}}},
    {Text::depth, {{"Depth", "Tiefe"}}},
    {Text::force, {{"Force", "Kraft"}}},
    {Text::to_target, {{"To the target", "Zum Ziel"}}},
    {Text::behind_target, {{"Behind the target", "Hinter dem Ziel"}}},
    {Text::picture, {{"Picture", "Bild"}}},
    {Text::servo, {{"Servo", "Servo"}}},
    {Text::late, {{"woken late", "verspätet"}}},
    {Text::under_cursor, {{"Under the cursor", "Unter dem Zeiger"}}},
    {Text::pedal, {{"Pedal", "Pedal"}}},
    {Text::playback, {{"Recording", "Aufnahme"}}},
    {Text::speed, {{"Speed", "Tempo"}}},
    {Text::pause, {{"Pause", "Anhalten"}}},
    {Text::go_on, {{"Go on", "Weiter"}}},
    {Text::keys, {{"Keys", "Tasten"}}},
    {Text::lost_device, {{"FAULT: the force is zero", "FEHLER: die Kraft ist null"}}},
    {Text::trace, {{"Trace", "Spur"}}},
    {Text::reduced, {{"Reduced", "Vereinfacht"}}},
    {Text::lesson, {{"Lesson", "Lektion"}}},
    {Text::last_trace, {{"Last trace, mm", "Letzte Spur, mm"}}},
    {Text::passes, {{"Passes", "Durchgänge"}}},
    {Text::paused, {{"PAUSED: nothing is felt", "PAUSE: nichts ist zu spüren"}}},
    {Text::judging, {{"The lesson is judged ...", "Die Lektion wird bewertet ..."}}},
    {Text::not_judged, {{"not judged", "nicht bewertet"}}},
    {Text::points, {{"Points", "Punkte"}}},
    {Text::report, {{"Report", "Bericht"}}},
    {Text::review_help,
     {{"Review: orange your own way, green the expert's.\nX: cut away at the tool. F1 to F8: views.",
       "Nachbetrachtung: orange der eigene Weg, grün der des Experten.\nX: Schnitt am Instrument. F1 bis F8: "
       "Ansichten."}}},
    {Text::without_darkening, {{"no darkening of creases, rough edges", "ohne Abdunkeln von Falten, raue Kanten"}}},
    {Text::without_grain, {{"no grain", "ohne Körnung"}}},
    {Text::coarse_surfaces,
     {{"coarse surfaces ({:g} mm) beyond {:.0f} mm of the tool",
       "grobe Flächen ({:g} mm) weiter als {:.0f} mm vom Instrument"}}},
    {Text::without_shadow, {{"no shadow of the tool", "ohne Schatten des Instruments"}}},
    {Text::half_the_pixels, {{"half the pixels", "halb so viele Bildpunkte"}}},
    {Text::shots, {{"Shots", "Aufnahmen"}}},
    {Text::xrays, {{"X-rays, s", "Strahlung, s"}}},
    {Text::fluoroscopy, {{"Fluoroscopy", "Durchleuchtung"}}},
    {Text::xrays_on, {{"X-RAYS ON", "STRAHLUNG EIN"}}},
    {Text::picture_held, {{"last picture", "letztes Bild"}}},
    {Text::no_xray, {{"Space or left button: X-rays", "Leertaste, linke Taste: Strahlung"}}},
    {Text::arm_turned, {{"turned", "gedreht"}}},
    {Text::arm_tilted, {{"tilted", "gekippt"}}},
    {Text::notes, {{"Notes", "Meldungen"}}},
    {Text::log, {{"Log", "Protokoll"}}},
    {Text::sign, {{"Sign", "Zeichen"}}},
    {Text::opacity, {{"opacity", "Deckkraft"}}},
    {Text::colour, {{"colour", "Farbe"}}},
    {Text::felt_from_opacity, {{"is felt from that opacity on", "ab dieser Deckkraft zu spüren"}}},
    {Text::felt_from, {{"felt from", "zu spüren ab"}}},
    {Text::not_felt, {{"several ranges: a shape has one", "mehrere Bereiche: eine Form hat einen"}}},
};

// Of views, cuts and places of the C-arm; a tool brings its own.
constexpr texts::Wording names[] = {
    {{"surgeon", "Chirurg"}},    {{"front", "vorn"}},        {{"back", "hinten"}},          {{"left", "links"}},
    {{"right", "rechts"}},       {{"top", "oben"}},          {{"bottom", "unten"}},         {{"oblique", "schräg"}},
    {{"ap", "a.-p."}},           {{"lateral", "seitlich"}},  {{"none", "keine"}},           {{"tool", "Instrument"}},
    {{"bone", "Knochen"}},       {{"skin", "Haut"}},         {{"vessels", "Gefäße"}},       {{"haptic", "haptisch"}},
    {{"ct bone", "CT Knochen"}}, {{"ct skin", "CT Haut"}},   {{"ct vessels", "CT Gefäße"}}, {{"axial", "axial"}},
    {{"coronal", "koronal"}},    {{"sagittal", "sagittal"}},
};

constexpr bool complete() {
  for (int n = 0; n < int(Text::count); ++n)
    if (n >= int(sizeof table / sizeof *table) || table[n].text != Text(n)) return false;
  return true;
}
static_assert(complete(), "one row for each word, in the order of Text");

}  // namespace

std::string translated(texts::Language language, const texts::Phrase& phrase) {
  for (const Row& row : table)
    if (phrase == row.in.of(texts::Language::english)) return row.in.of(language);
  return lessons::lesson_words(language, phrase);
}

std::string translated_name(texts::Language language, const std::string& english) {
  if (language == texts::Language::german)
    for (const haptics::ToolKind& kind : haptics::all_tool_kinds())
      if (english == kind.name) return kind.german;
  for (const texts::Wording& name : names)
    if (english == name.of(texts::Language::english)) return name.of(language);
  return lessons::tool_title(language, english);
}

const char* text_of(texts::Language language, Text text) { return table[std::size_t(text)].in.of(language); }

}  // namespace trephine::window
