// SPDX-License-Identifier: GPL-3.0-or-later
// What a window tells its user, in either language.
#include "window/notes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "haptics/proxy.h"
#include "haptics/tool.h"
#include "render/coarse.h"
#include "scene/view_params.h"

using namespace trephine;

TEST(Notes, OnlyTheLastAreKeptAndNoneIsTakenTwice) {
  Notes notes;
  std::size_t told = 0;
  EXPECT_TRUE(notes.since(told).empty());
  EXPECT_EQ(notes_line(notes, 8, Language::english), "none");
  for (int n = 0; n < 3; ++n) notes.add(n, std::to_string(n));
  EXPECT_EQ(notes.since(told).size(), 3u);
  EXPECT_TRUE(notes.since(told).empty());
  notes.add(65.9, "3");
  ASSERT_EQ(notes.since(told).size(), 1u);
  EXPECT_EQ(notes_line(notes, 2, Language::english), "1:05 3 | 0:02 2") << "the newest first";
  EXPECT_EQ(notes_line(notes, 8, Language::english), "1:05 3 | 0:02 2 | 0:01 1 | 0:00 0");
  for (int n = 4; n < 400; ++n) notes.add(100, std::to_string(n));
  EXPECT_EQ(notes.count(), 400u);
  ASSERT_EQ(notes.kept().size(), Notes::most_kept);
  EXPECT_EQ(notes.kept().front().text, "300");
  const std::deque<Note> last = notes.since(told);
  ASSERT_EQ(last.size(), Notes::most_kept);
  EXPECT_EQ(last.front().text, "300");
  EXPECT_EQ(told, 400u);
  EXPECT_EQ(clock_text(3725), "1:02:05");
}

TEST(Notes, AnOldNoteFadesAndCanStillBeRead) {
  const Note note{100, ""};
  EXPECT_EQ(freshness(note, 100), 1);
  EXPECT_EQ(freshness(note, 109), 1);
  EXPECT_LT(freshness(note, 125), freshness(note, 115));
  // Grey on the panel's nearly black: 7 to 1, which is what WCAG asks for low vision.
  const double grey = std::pow(freshness(note, 1e6), 2.2);
  EXPECT_LT(grey, 0.6);
  EXPECT_GT((grey + 0.05) / (std::pow(0.06, 2.2) + 0.05), 7);
}

// Names and figures stay, in their places; the words are the language's. Nothing of the English is left over.
TEST(Notes, EachIsSaidInTheOtherLanguage) {
  CoarseFacts facts{983832, 241358, 622542, 2.414, 0};
  const std::pair<std::string, std::string> both[] = {
      {"fault: " + fault_names(haptic_fault::device_lost) + ": the force is zero from now on",
       "Fehler: Gerät verloren: die Kraft ist ab jetzt null"},
      {"beyond 30 mm of the tool skull is shown coarse: " + facts.text(),
       "weiter als 30 mm vom Instrument ist skull grob gezeigt: 241358 von 983832 Dreiecken, 622542 Stellen gemessen, "
       "die schlechteste 2.41 mm daneben"},
      {"third_ventricle is shown coarse: " + facts.text(),
       "third_ventricle ist grob gezeigt: 241358 von 983832 Dreiecken, 622542 Stellen gemessen, die schlechteste 2.41 "
       "mm daneben"},
      {"graphics memory: skin shown coarse: " + facts.text(),
       "Grafikspeicher: skin grob gezeigt: 241358 von 983832 Dreiecken, 622542 Stellen gemessen, die schlechteste 2.41 "
       "mm daneben"},
      {"graphics memory: rough edges", "Grafikspeicher: raue Kanten"},
      {"graphics memory: pictures of 12 x 8 pixels in place of 2560 x 1600",
       "Grafikspeicher: Bilder von 12 x 8 Bildpunkten statt 2560 x 1600"},
      {"burr removed skull 12.3 mm3, dura 0.1 mm3", "burr hat entfernt: skull 12.3 mm3, dura 0.1 mm3"},
      {"burr: 196 ticks, tick time p50 5.6, p99 41.6 us, woken late p50 0.220, p99 4.015 ms, 473 overruns",
       "burr: 196 Takte, Dauer p50 5.6, p99 41.6 us, verspätet p50 0.220, p99 4.015 ms, 473 zu lange"},
      {"burr: 196 ticks, tick time p50 5.6, p99 41.6 us, woken late p50 0.220, p99 4.015 ms, 473 overruns, faults time "
       "step",
       "burr: 196 Takte, Dauer p50 5.6, p99 41.6 us, verspätet p50 0.220, p99 4.015 ms, 473 zu lange, Fehler: "
       "Zeitschritt"},
      {"the lesson is judged: 12 of 15 points", "die Lektion ist bewertet: 12 von 15 Punkten"},
      {"the lesson is judged: 12 of 15 points, out/a.html", "die Lektion ist bewertet: 12 von 15 Punkten, out/a.html"},
      {"waiting for a device on 127.0.0.1:5000", "warte auf ein Gerät an 127.0.0.1:5000"},
  };
  for (const auto& [english, german] : both) {
    EXPECT_EQ(translated_note(Language::english, english), english);
    EXPECT_EQ(translated_note(Language::german, english), german);
  }
  EXPECT_EQ(translated_note(Language::german, "nothing is there"), "da ist nichts");
  for (const char* other : {"", "something new", "graphics memory: ", " removed ", "{} removed {}x{}"}) {
    const std::string said = translated_note(Language::german, other);
    EXPECT_TRUE(said == other || said == "{} hat entfernt: {}x{}") << said;
  }
}

// Of each button that the panels show, whatever becomes a tool or a view.
TEST(Notes, EveryToolAndViewHasANameInTheOtherLanguage) {
  std::vector<std::string> all{"none", "tool"};
  for (const ToolKind& kind : all_tool_kinds()) all.push_back(kind.name);
  for (const auto& [name, value] : view_presets()) all.push_back(name);
  ASSERT_GT(all.size(), 15u);
  for (const std::string& name : all) {
    EXPECT_EQ(translated_name(Language::english, name), name);
    if (name == "jamshidi") continue;
    EXPECT_NE(translated_name(Language::german, name), name);
  }
  EXPECT_EQ(translated_name(Language::german, "axial"), "axial");
}
