// SPDX-License-Identifier: GPL-3.0-or-later
// What a window tells its user, in either language.
#include "window/notes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "haptics/proxy.h"
#include "haptics/tool.h"
#include "render/coarse.h"
#include "scene/view_params.h"
#include "window/texts.h"

using namespace trephine;

TEST(Notes, OnlyTheLastAreKeptAndNoneIsTakenTwice) {
  window::Notes notes;
  std::size_t told = 0;
  EXPECT_TRUE(notes.since(told).empty());
  EXPECT_EQ(window::notes_line(notes, 8, texts::Language::english), "none");
  const auto add = [&](double at_s, int n) { notes.add(at_s, {texts::NoteId::verbatim, {std::to_string(n)}}); };
  for (int n = 0; n < 3; ++n) add(n, n);
  EXPECT_EQ(notes.since(told).size(), 3u);
  EXPECT_TRUE(notes.since(told).empty());
  add(65.9, 3);
  ASSERT_EQ(notes.since(told).size(), 1u);
  EXPECT_EQ(window::notes_line(notes, 2, texts::Language::english), "1:05 3 | 0:02 2") << "the newest first";
  EXPECT_EQ(window::notes_line(notes, 8, texts::Language::english), "1:05 3 | 0:02 2 | 0:01 1 | 0:00 0");
  for (int n = 4; n < 400; ++n) add(100, n);
  EXPECT_EQ(notes.count(), 400u);
  ASSERT_EQ(notes.kept().size(), window::Notes::max_kept);
  EXPECT_EQ(texts::text_of(notes.kept().front().note, texts::Language::german), "300");
  const std::deque<window::TimedNote> last = notes.since(told);
  ASSERT_EQ(last.size(), window::Notes::max_kept);
  EXPECT_EQ(texts::text_of(last.front().note, texts::Language::english), "300");
  EXPECT_EQ(told, 400u);
  EXPECT_EQ(window::clock_text(3725), "1:02:05");
}

TEST(Notes, AnOldNoteFadesAndCanStillBeRead) {
  const window::TimedNote note{100, texts::NoteId::nothing_there};
  EXPECT_EQ(window::freshness(note, 100), 1);
  EXPECT_EQ(window::freshness(note, 109), 1);
  EXPECT_LT(window::freshness(note, 125), window::freshness(note, 115));
  // Grey on the panel's nearly black: 7 to 1, which is what WCAG asks for low vision.
  const double grey = std::pow(window::freshness(note, 1e6), 2.2);
  EXPECT_LT(grey, 0.6);
  EXPECT_GT((grey + 0.05) / (std::pow(0.06, 2.2) + 0.05), 7);
}

std::size_t blanks(const std::string& wording) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = wording.find("{}", at)) != std::string::npos; at += 2) ++n;
  return n;
}

// Every note is worded in each language, with the same names and figures in it.
TEST(Notes, EachIsWordedInEachLanguage) {
  for (int n = 0; n < int(texts::NoteId::count); ++n) {
    const std::string english = texts::wording_of(texts::NoteId(n)).of(texts::Language::english),
                      german = texts::wording_of(texts::NoteId(n)).of(texts::Language::german);
    SCOPED_TRACE(english);
    EXPECT_FALSE(english.empty());
    EXPECT_EQ(blanks(english), blanks(german));
    EXPECT_TRUE(texts::NoteId(n) == texts::NoteId::verbatim || english != german);
    texts::Note note{texts::NoteId(n)};
    for (std::size_t v = 0; v < blanks(english); ++v) note.values.push_back("<" + std::to_string(v) + ">");
    for (const texts::Language language : {texts::Language::english, texts::Language::german}) {
      const std::string text = texts::text_of(note, language);
      EXPECT_EQ(blanks(text), 0u);
      std::size_t at = 0;
      for (const std::string& value : note.values) EXPECT_NE(at = text.find(value, at), std::string::npos) << text;
    }
  }
  for (int n = 0; n < haptics::haptic_fault::count; ++n)
    EXPECT_STREQ(texts::wording_of(texts::NoteId(int(texts::NoteId::fault_pose) + n)).of(texts::Language::english),
                 haptics::haptic_fault::names[n]);
}

// Names and figures stay, in their places; the words are the language's.
TEST(Notes, NamesAndFiguresStayInTheirPlaces) {
  const render::CoarseFacts facts{983832, 241358, 622542, 2.414, 0};
  const std::tuple<texts::Note, std::string, std::string> all[] = {
      {{texts::NoteId::force_is_zero, {}, {texts::NoteId::fault_pose, texts::NoteId::fault_device_lost}},
       "fault: pose, device lost: the force is zero from now on",
       "Fehler: Lage, Gerät verloren: die Kraft ist ab jetzt null"},
      {{texts::NoteId::coarse, facts.values("skull")},
       "skull is shown coarse: 241358 of 983832 triangles, 622542 places measured, the worst 2.41 mm off",
       "skull ist grob gezeigt: 241358 von 983832 Dreiecken, 622542 Stellen gemessen, die schlechteste 2.41 mm "
       "daneben"},
      {{texts::NoteId::ticks_with_faults,
        {"burr", "196", "5.6", "41.6", "0.220", "4.015", "473"},
        {texts::NoteId::fault_time_step}},
       "burr: 196 ticks, tick time p50 5.6, p99 41.6 us, woken late p50 0.220, p99 4.015 ms, 473 overruns, faults time "
       "step",
       "burr: 196 Takte, Dauer p50 5.6, p99 41.6 us, verspätet p50 0.220, p99 4.015 ms, 473 zu lange, Fehler: "
       "Zeitschritt"},
      {{texts::NoteId::judged_in, {"out/a.html", "12", "15"}, {texts::NoteId::outcome_failed}},
       "the lesson is judged in out/a.html: 12 of 15 points, failed",
       "die Lektion ist bewertet in out/a.html: 12 von 15 Punkten, nicht bestanden"},
  };
  for (const auto& [note, english, german] : all) {
    EXPECT_EQ(texts::text_of(note, texts::Language::english), english);
    EXPECT_EQ(texts::text_of(note, texts::Language::german), german);
  }
}

// No sentence is read back: what stands in a note stays as it is, though it be another note's English.
TEST(Notes, NoSentenceIsParsed) {
  for (int n = 1; n < int(texts::NoteId::count); ++n) {
    const std::string sentence = texts::wording_of(texts::NoteId(n)).of(texts::Language::english);
    EXPECT_EQ(texts::text_of({texts::NoteId::verbatim, {sentence}}, texts::Language::german), sentence);
    EXPECT_EQ(texts::text_of({texts::NoteId::removed, {sentence, "{} und {}"}}, texts::Language::german),
              sentence + " hat entfernt: {} und {}");
  }
}

// Of each button that the panels show, whatever becomes a tool or a view.
TEST(Notes, EveryToolAndViewHasANameInTheOtherLanguage) {
  std::vector<std::string> all{"none", "tool"};
  for (const haptics::ToolKind& kind : haptics::all_tool_kinds()) all.push_back(kind.name);
  for (const auto& [name, value] : scene::view_presets()) all.push_back(name);
  ASSERT_GT(all.size(), 15u);
  for (const std::string& name : all) {
    EXPECT_EQ(window::translated_name(texts::Language::english, name), name);
    if (name == "jamshidi") continue;
    EXPECT_NE(window::translated_name(texts::Language::german, name), name);
  }
  EXPECT_EQ(window::translated_name(texts::Language::german, "finder"), "Pfriem");
  EXPECT_EQ(window::translated_name(texts::Language::german, "axial"), "axial");
}
