// SPDX-License-Identifier: GPL-3.0-or-later
// No score of a needle or a screw is better for a worse performance.
#include "lessons_monotone.h"
#include "lessons_spine_facts.h"

using namespace lesson_cases;

namespace {

using SpineScore = std::function<lessons::LessonScore(const lessons::SpineNeedleFacts&)>;

void check_spine(const std::string& lesson, const std::string& task, const SpineAim& perfect, const SpineScore& score) {
  const auto aimed = [&](const std::function<void(SpineAim&, int)>& spoil) {
    return [=](int n) {
      lessons::SpineNeedleFacts f = spine_facts(task);
      SpineAim aim = perfect;
      spoil(aim, n);
      finder_along(task, aim, f);
      pass_along(task, aim, f);
      return score(f);
    };
  };
  const auto happened = [&](const std::function<void(lessons::SpineNeedleFacts&, int)>& spoil) {
    return [=](int n) {
      lessons::SpineNeedleFacts f = spine_facts(task);
      finder_along(task, perfect, f);
      pass_along(task, perfect, f);
      spoil(f, n);
      return score(f);
    };
  };
  const std::string name = lesson + " at " + task;
  check(name, "entry and line to the outer side, 2.2 mm a step",
        aimed([](SpineAim& a, int n) { a.aside_mm += 2.2 * n; }), false);
  check(name, "entry and line to the inner side, 2 mm a step", aimed([](SpineAim& a, int n) { a.aside_mm -= 2 * n; }),
        false);
  check(name, "entry and line too high, 2.2 mm a step", aimed([](SpineAim& a, int n) { a.up_mm += 2.2 * n; }), false);
  check(name, "entry and line too low, 2.2 mm a step", aimed([](SpineAim& a, int n) { a.up_mm -= 2.2 * n; }), false);
  check(name, "turned to the outer side, 3 mm at the target a step",
        aimed([](SpineAim& a, int n) { a.turn_aside_mm += 3 * n; }), false);
  check(name, "turned to the inner side, 3 mm a step", aimed([](SpineAim& a, int n) { a.turn_aside_mm -= 3 * n; }),
        false);
  check(name, "turned up, 3 mm a step", aimed([](SpineAim& a, int n) { a.turn_up_mm += 3 * n; }),
        lesson == "pedicle_screw");
  check(name, "turned down, 3 mm a step", aimed([](SpineAim& a, int n) { a.turn_up_mm -= 3 * n; }),
        lesson == "pedicle_screw");
  check(name, "too short, 5 mm a step", aimed([](SpineAim& a, int n) { a.beyond_mm -= 5 * n; }), false);
  check(name, "too deep, 5 mm a step", aimed([](SpineAim& a, int n) { a.beyond_mm += 5 * n; }), false);
  check(
      name, "another level, from step 1",
      [=](int n) {
        lessons::SpineNeedleFacts f = spine_facts(task);
        const std::string at = n == 0                                ? task
                               : task.find('1') == std::string::npos ? "pedicle_1_left"
                                                                     : "pedicle_2_left";
        finder_along(at, perfect, f);
        pass_along(at, perfect, f);
        return score(f);
      },
      false);
  check(
      name, "the other side, from step 1",
      [=](int n) {
        lessons::SpineNeedleFacts f = spine_facts(task);
        std::string other = task;
        if (n > 0)
          other.replace(other.rfind('_'), std::string::npos,
                        other.find("left") != std::string::npos ? "_right" : "_left");
        finder_along(other, perfect, f);
        pass_along(other, perfect, f);
        return score(f);
      },
      false);
  check(name, "one more pass a step", happened([](lessons::SpineNeedleFacts& f, int n) {
          const lessons::NeedlePass last = f.passes.back();
          f.passes.back().in_place = n == 0;
          for (int k = 0; k < n; ++k) f.passes.push_back(last), f.passes.back().in_place = k + 1 == n;
          for (lessons::FluoroShot& s : f.shots)  // and each is looked at
            if (n > 0 && &s == &f.shots.back()) s.begin_s = last.begin_s, s.end_s = last.begin_s + 0.5;
        }),
        true);
  check(name, "X-rays, 6 s more a step",
        happened([](lessons::SpineNeedleFacts& f, int n) { f.shots[0].end_s += 6 * n; }), true);
  check(name, "no picture, from step 1", happened([](lessons::SpineNeedleFacts& f, int n) {
          if (n > 0) f.shots.clear();
        }),
        true);
  const int more_s = lesson == "pedicle_screw" ? 110 : 90;  // past the time that is allotted
  check(name, fmt::format("time, {} s more a step", more_s),
        happened([=](lessons::SpineNeedleFacts& f, int n) { f.end_s += more_s * n; }), false);
  check(name, "not finished, from step 1", happened([](lessons::SpineNeedleFacts& f, int n) {
          if (n > 0) f.end = lessons::LessonEnd::running;
        }),
        false);
  check(name, "drawn out again, from step 1", happened([](lessons::SpineNeedleFacts& f, int n) {
          if (n > 0) f.passes.back().in_place = false;
        }),
        false);
  check(name, "one picture and nothing else, from step 1", happened([](lessons::SpineNeedleFacts& f, int n) {
          if (n > 0) f.passes.clear();
        }),
        false);
  check(name, "nothing done, from step 1", happened([](lessons::SpineNeedleFacts& f, int n) {
          if (n > 0) f.passes.clear(), f.shots.clear();
        }),
        false);
  check(name, "largest force, 1 N a step (not scored)",
        happened([](lessons::SpineNeedleFacts& f, int n) { f.most_force_n += n; }), true);
}

}  // namespace

namespace {

void check_needle(const std::string& task) {
  check_spine("spine_needle", task, {}, [](const lessons::SpineNeedleFacts& f) {
    return lessons::score_spine_needle(f, *spine_in_use().manifest, *spine_in_use().volume, shipped());
  });
}

void check_screw(const std::string& task) {
  const SpineScore score = [](const lessons::SpineNeedleFacts& f) {
    return score_screw(f, *spine_in_use().manifest, *spine_in_use().volume);
  };
  SpineAim perfect;
  perfect.tool = "screw_5.5x45";
  perfect.diameter_mm = 5.5;
  perfect.length_mm = norm(pedicle_named(task).target_mm - pedicle_named(task).entry_mm);
  check_spine("pedicle_screw", task, perfect, score);
  const auto sized = [&](double longer, double wider) {
    return [=](int n) {
      lessons::SpineNeedleFacts f = spine_facts(task);
      SpineAim aim = perfect;
      aim.length_mm += longer * n;
      aim.diameter_mm += wider * n;
      finder_along(task, aim, f);
      pass_along(task, aim, f);
      return score(f);
    };
  };
  check("pedicle_screw at " + task, "screw too long, 2 mm a step", sized(2, 0), false);
  check("pedicle_screw at " + task, "screw too short, 2 mm a step", sized(-2, 0), true);
  check("pedicle_screw at " + task, "screw too narrow, 0.3 mm a step", sized(0, -0.3), true);
}

}  // namespace

TEST(LongLessonsMonotone, SpineNeedle) { check_needle("pedicle_2_left"); }
TEST(LongLessonsMonotone, PedicleScrew) { check_screw("pedicle_2_left"); }
TEST(LongLessonsMonotone, OtherPedicles) {
  for (const char* task : {"pedicle_1_left", "pedicle_2_right"}) {
    check_needle(task);
    check_screw(task);
  }
}

// TREPHINE_LESSON_CASES=library/spine:...; docs/validation/lessons.md has what came of it.
TEST(LongLessonsMonotone, SpinesOfALibrary) {
  const SpineInUse phantom = spine_in_use();
  const auto cases = library_cases("canal");
  for (const auto& felt : cases) {
    spine_in_use() = {&felt->loaded.manifest, &felt->loaded.haptic};
    std::printf("case %s\n", felt->loaded.manifest.case_token.c_str());
    check_needle("pedicle_2_left");
    check_screw("pedicle_2_left");
  }
  spine_in_use() = phantom;
  if (cases.empty()) GTEST_SKIP() << "no spine in TREPHINE_LESSON_CASES";
}
