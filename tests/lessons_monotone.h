// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What happened in a perfect lesson is spoilt along one axis, in ten steps, and scored.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <sstream>

#include "lessons/lesson_words.h"
#include "lessons/score_report.h"
#include "lessons_run.h"
#include "voxel/decode.h"

namespace lesson_cases {

constexpr int steps_count = 10;

inline int rank(const lessons::LessonScore& s) { return s.outcome() == lessons::LessonOutcome::completed ? 1 : 0; }

// Whatever a score says, a German reader reads it in German.
inline void expect_german(const lessons::LessonScore& s) {
  const std::function<void(const texts::Phrase&)> expect = [&](const texts::Phrase& phrase) {
    // Figures, and names of the case such as a pedicle's by another program, stay as they are.
    for (const texts::Phrase& value : phrase.values)
      if (value.words.find_first_of("0123456789") == std::string::npos) expect(value);
    const std::string german = lessons::lesson_words(texts::Language::german, phrase);
    EXPECT_TRUE(phrase.empty() || lessons::lesson_words(texts::Language::german, phrase.words) != phrase.words)
        << phrase;
    EXPECT_EQ(german.find('{'), std::string::npos) << german;
  };
  const auto expect_figure = [](const std::string& name) {
    for (const char* same :
         {"ideal_mm", "ideal_s", "ideal_deg", "ideal_count", "foramen_mm", "axial_deg", "sagittal_deg"})
      if (name == same) return;
    EXPECT_NE(lessons::figure_title(texts::Language::german, name),
              lessons::figure_title(texts::Language::english, name))
        << name;
  };
  for (const lessons::ScoreRow& row : s.rows) {
    expect(row.title);
    expect(row.why);
    for (const auto& figure : row.measured) expect_figure(figure.first);
    for (const auto& limit : row.limits) expect_figure(limit.first);
  }
  for (const lessons::CriticalError& e : s.critical) expect(e.what);
  expect(s.unreached);
  for (const lessons::Advice& a : s.advice) {
    EXPECT_FALSE(a.in[0].empty());
    EXPECT_FALSE(a.in[1].empty());
    EXPECT_NE(a.in[0], a.in[1]);
  }
}

// The rows that score more than they did: what they say, and what they said.
inline std::string better(const lessons::LessonScore& now, const lessons::LessonScore& before) {
  std::string out;
  for (std::size_t n = 0; n < now.rows.size() && n < before.rows.size(); ++n)
    if (now.rows[n].score.value_or(0) > before.rows[n].score.value_or(0))
      out += "\n  " + now.rows[n].name + ": " + now.rows[n].why.english() + ", after " + before.rows[n].why.english();
  return out;
}

// In a case of a library a line that is spoilt more may end better by Table XIII: in a ventricle again (3 or more as it
// is printed), where it ended beside one (1). Then the row of the tip, and what is judged of a catheter that lies in
// place, may rise; no other may.
inline bool& in_a_case() {
  static bool one = false;
  return one;
}
inline bool drains_again(const lessons::LessonScore& now, const lessons::LessonScore& before) {
  const lessons::ScoreRow *tip = now.row("tip"), *was = before.row("tip");
  if (!tip || was->why != "not in the ventricle" || tip->score.value_or(0) <= was->score.value_or(0)) return false;
  for (std::size_t n = 0; n < now.rows.size() && n < before.rows.size(); ++n) {
    const std::string& name = now.rows[n].name;
    if (name != "tip" && name != "time" && name != "passes" &&
        now.rows[n].score.value_or(0) > before.rows[n].score.value_or(0))
      return false;
  }
  return true;
}

// `spoilt(0)` is the perfect one, `spoilt(9)` the worst. Prints a line of the table in docs/validation/lessons.md.
inline void check(const std::string& lesson, const std::string& axis,
                  const std::function<lessons::LessonScore(int)>& spoilt, bool ends_completed) {
  std::string sums;
  int last = 0, last_rank = 1;
  bool drained_again = false;
  lessons::LessonScore score, before;
  for (int n = 0; n < steps_count; ++n) {
    score = spoilt(n);
    expect_german(score);
    const int points = lessons::sum_of(score).points;
    sums += fmt::format("{}{}", n == 0 ? "" : " ", points);
    if (n > 0 && in_a_case() && drains_again(score, before)) {
      drained_again = true;
      std::printf("  drains again in step %d:%s\n", n, better(score, before).c_str());
    } else if (n > 0) {
      EXPECT_LE(points, last) << lesson << ", " << axis << ", step " << n << ": " << score.reason()
                              << better(score, before);
      EXPECT_LE(rank(score), last_rank) << lesson << ", " << axis << ", step " << n;
    } else {
      EXPECT_EQ(score.outcome(), lessons::LessonOutcome::completed) << lesson << ", " << axis << ": " << score.reason();
    }
    before = score;
    last = points;
    last_rank = rank(score);
  }
  if (!ends_completed && !drained_again) {
    EXPECT_NE(score.outcome(), lessons::LessonOutcome::completed) << lesson << ", " << axis;
  }
  std::printf("| %s | %s | %s | %s |\n", lesson.c_str(), axis.c_str(), sums.c_str(),
              lessons::headline_of(score).c_str());
}

// Cases of a library in which scores are shown to be monotone too, by their folders in TREPHINE_LESSON_CASES (a:b:c).
inline std::vector<std::unique_ptr<session::FeltCase>> library_cases(const std::string& needs_shape) {
  std::vector<std::unique_ptr<session::FeltCase>> all;
  const char* given = std::getenv("TREPHINE_LESSON_CASES");
  std::stringstream folders(given ? given : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    auto felt = std::make_unique<session::FeltCase>(folder, "");
    for (const cases::CaseShape& s : felt->loaded.manifest.haptic.shapes)
      if (s.name == needs_shape) {
        all.push_back(std::move(felt));
        break;
      }
  }
  return all;
}

// A tool that goes straight along its axis, by the shapes in which its tip is.
template <class Point, class F>
void walk(const voxel::HapticVolume& volume, Vec3 from, Vec3 to, F visit) {
  const voxel::HapticDecoder decoder(volume);
  const double length = norm(to - from);
  const Vec3 way = normalized(to - from);
  for (double t = 0; t < length + 0.25; t += 0.25) {
    const Vec3 at = from + way * std::min(t, length), i = volume.voxels.to_index(at);
    visit(at, decoder.shape_at(int(std::lround(i.x)), int(std::lround(i.y)), int(std::lround(i.z))));
  }
}

}  // namespace lesson_cases
