// SPDX-License-Identifier: GPL-3.0-or-later
// Simulated residents who miss what they aim at, by more and more: the worse the aim, the lower the score.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "lessons_head.h"

using namespace lesson_cases;

namespace {

struct Level {
  double mean = 0, half_width = 0;  // of the 95 % interval of the mean
  std::map<int, int> counts;        // of residents, by their points
};

// A whole lesson where `whole`, else the catheter's part.
Level residents(Head& head, bool whole, double noise_mm, int count) {
  const std::string catheter =
      R"({"take": {"tool": "catheter"}}, {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}}, "finish")";
  const std::string steps = whole ? std::string(perfect_marks) + ", " + perfect_hole + ", " + catheter : catheter;
  Level level;
  double sum = 0, squares = 0;
  for (int n = 0; n < count; ++n) {
    const Head::Done d = head.run(steps, 500, 1000 + n, noise_mm);
    int points = 0;
    for (const lessons::ScoreRow& row : d.score.rows) points += row.score.value_or(0);
    ++level.counts[points];
    sum += points;
    squares += double(points) * points;
  }
  level.mean = sum / count;
  level.half_width = 1.96 * std::sqrt(std::max(0.0, squares / count - level.mean * level.mean) / (count - 1));
  return level;
}

void check(Head& head, bool whole, const std::vector<double>& noises_mm, int count) {
  std::vector<Level> levels;
  for (const double noise : noises_mm) {
    levels.push_back(residents(head, whole, noise, count));
    const Level& l = levels.back();
    std::printf("aim noise %4.1f mm: mean %.2f +- %.2f |", noise, l.mean, l.half_width);
    for (const auto& [points, count] : l.counts) std::printf(" %d:%d", points, count);
    std::printf("\n");
  }
  for (std::size_t n = 1; n < levels.size(); ++n) EXPECT_LT(levels[n].mean, levels[n - 1].mean) << noises_mm[n];
  EXPECT_LT(levels.back().mean + levels.back().half_width, levels.front().mean - levels.front().half_width);
}

}  // namespace

TEST(LongLessonsResidents, WorseAimScoresLess) {
  Head head(Kind::drilled);
  check(head, false, {0, 4, 12}, 12);
}

TEST(LongLessonsResidents, FiveLevelsOfSixtyScoreLessAtEveryStep) {
  Head head(Kind::whole);
  check(head, true, {0, 2, 4, 8, 14}, 60);
}
