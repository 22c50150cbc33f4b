// SPDX-License-Identifier: GPL-3.0-or-later
// No score is better for a worse performance, in a head and in a chest.
#include "lessons_monotone.h"
#include "lessons_chest.h"
#include "lessons_head_facts.h"

using namespace lesson_cases;

namespace {

// A head in which a lesson is spoilt: the phantom of the tests, or a case.
struct SpoiltHead {
  const cases::CaseManifest& manifest;
  const voxel::HapticVolume& volume;
  std::function<lessons::VentriculostomyFacts(bool left)> perfect;
  std::function<void(lessons::VentriculostomyFacts&, Vec3)> shift_hole;
  lessons::HeadFrame frame;
  Vec3 foramen(bool left) const { return *lessons::foramen_of(manifest, left); }
};

SpoiltHead spoilt_phantom() {
  const cases::CaseManifest& m = phantom_head().felt().loaded.manifest;
  return {m, phantom_head().whole(), perfect_head,
          [](lessons::VentriculostomyFacts& f, Vec3 by) {
            f.hole->out = normalized(f.hole->out * outer_mm + by);
            f.hole->outer_mm = f.hole->out * outer_mm;
            f.hole->inner_mm = f.hole->out * inner_mm;
          },
          lessons::head_frame_of(m)};
}

// Perfect by the case's landmarks: traces in the planes of midline and suture, a hole at Kocher's point, upright as it
// points at the foramen, through bone that is so thick as the case's.
SpoiltHead spoilt_case(const session::FeltCase& felt) {
  const cases::CaseManifest& m = felt.loaded.manifest;
  const lessons::HeadFrame frame = lessons::head_frame_of(m);
  const auto perfect = [&m, frame](bool left) {
    lessons::VentriculostomyFacts f = perfect_head(left);
    lessons::MarkerTrace &midline = f.traces[0], &suture = f.traces[1];
    midline.points_mm.clear(), suture.points_mm.clear();
    const Vec3 bregma = frame.bregma_mm.value_or(frame.nasion_mm);
    for (int n = 0; n <= 110; ++n) {
      const Vec3 on = frame.nasion_mm + (bregma - frame.nasion_mm) * (n / 110.0);
      midline.points_mm.push_back(on - frame.left * frame.left_of_midline_mm(on));
    }
    for (int n = -20; n <= 20; ++n) suture.points_mm.push_back(bregma + frame.left * double(n));
    const Vec3 kocher = lessons::find_landmark(m, left ? "kocher_left" : "kocher_right")->position_mm;
    const Vec3 monro = *lessons::foramen_of(m, left);
    f.hole->out = normalized(kocher - monro);
    // So far from the foramen that this is 57 mm below the inner table; the skin is farther out.
    f.hole->inner_mm = monro + f.hole->out * 57.0;
    f.hole->outer_mm = f.hole->inner_mm + f.hole->out * 7.0;
    return f;
  };
  // About the foramen, which stays as far away as it was: what spoils the hole's place spoils no depth.
  const auto shift = [&m](lessons::VentriculostomyFacts& f, Vec3 by) {
    const Vec3 monro = *lessons::foramen_of(m, f.task == "left");
    const double outer = norm(f.hole->outer_mm - monro), inner = norm(f.hole->inner_mm - monro);
    f.hole->out = normalized(f.hole->outer_mm + by - monro);
    f.hole->outer_mm = monro + f.hole->out * outer;
    f.hole->inner_mm = monro + f.hole->out * inner;
  };
  return {m, felt.loaded.haptic, perfect, shift, frame};
}

void check_head(bool left, const SpoiltHead& head = spoilt_phantom()) {
  const auto score = [&head](const lessons::VentriculostomyFacts& f) {
    return lessons::score_ventriculostomy(f, head.manifest, head.volume, Head::rubric());
  };
  const auto perfect_head = head.perfect;
  const auto pass_into = [&head](lessons::VentriculostomyFacts& f, bool to_left, const HeadAim& aim) {
    pass_to(f, head.manifest, head.volume, head.foramen(to_left), aim);
  };
  using Spoil = std::function<void(lessons::VentriculostomyFacts&, int)>;
  const auto before = [&](const Spoil& spoil) {  // of what was done before the catheter
    return [=](int n) {
      lessons::VentriculostomyFacts f = perfect_head(left);
      pass_into(f, left, {});
      spoil(f, n);
      return score(f);
    };
  };
  const auto aimed = [&](const std::function<void(HeadAim&, int)>& spoil) {
    return [=](int n) {
      lessons::VentriculostomyFacts f = perfect_head(left);
      HeadAim aim;
      spoil(aim, n);
      pass_into(f, left, aim);
      return score(f);
    };
  };
  const auto shifted = [&](Vec3 by) {  // the hole, and the catheter through it
    return [=](int n) {
      lessons::VentriculostomyFacts f = perfect_head(left);
      head.shift_hole(f, by * n);
      pass_into(f, left, {});
      return score(f);
    };
  };
  const Vec3 outwards = left ? head.frame.left : -head.frame.left, forwards = head.frame.forwards;
  const std::string name = std::string("ventriculostomy, ") + (left ? "left" : "right");
  check(name, "line of the midline beside it, 2 mm a step", before([&](lessons::VentriculostomyFacts& f, int n) {
          for (Vec3& p : f.traces[0].points_mm) p += head.frame.left * (2.0 * n);
        }),
        true);
  check(name, "line of the midline shorter, 12 mm a step",
        before([](lessons::VentriculostomyFacts& f, int n) { f.traces[0].length_mm -= 12 * n; }), true);
  check(name, "line of the suture before it, 2 mm a step", before([&](lessons::VentriculostomyFacts& f, int n) {
          for (Vec3& p : f.traces[1].points_mm) p += forwards * (2.0 * n);
        }),
        true);
  check(name, "nothing marked, from step 1", before([](lessons::VentriculostomyFacts& f, int n) {
          if (n > 0) f.traces.clear();
        }),
        true);
  check(name, "hole too lateral, 5 mm a step", shifted(outwards * 5.0), true);
  check(name, "hole too medial, 5 mm a step", shifted(outwards * -5.0), false);
  check(name, "hole too anterior, 5 mm a step", shifted(forwards * 5.0), true);
  check(name, "hole too posterior, 5 mm a step", shifted(forwards * -5.0), true);
  check(name, "hole not through, from step 1", before([](lessons::VentriculostomyFacts& f, int n) {
          if (n > 0) f.hole->through = false;
        }),
        true);
  check(name, "catheter too lateral, 4 mm at the foramen a step",
        aimed([&](HeadAim& a, int n) { a.off_mm += outwards * (4.0 * n); }), false);
  check(name, "catheter too medial, 4 mm at the foramen a step",
        aimed([&](HeadAim& a, int n) { a.off_mm -= outwards * (4.0 * n); }), false);
  check(name, "catheter too anterior, 4 mm at the foramen a step",
        aimed([&](HeadAim& a, int n) { a.off_mm += forwards * (4.0 * n); }), false);
  check(name, "catheter too posterior, 4 mm at the foramen a step",
        aimed([&](HeadAim& a, int n) { a.off_mm -= forwards * (4.0 * n); }), false);
  check(name, "catheter too short, 4 mm a step", aimed([](HeadAim& a, int n) { a.beyond_mm -= 4 * n; }), false);
  check(name, "catheter too deep, 4 mm a step", aimed([](HeadAim& a, int n) { a.beyond_mm += 4 * n; }), false);
  check(
      name, "the other side, from step 1",
      [=](int n) {
        lessons::VentriculostomyFacts f = perfect_head(n > 0 ? !left : left);
        pass_into(f, n > 0 ? !left : left, {});
        f.task = left ? "left" : "right";
        return score(f);
      },
      false);
  check(name, "one more pass a step", before([](lessons::VentriculostomyFacts& f, int n) {
          for (int k = 0; k < n; ++k) {
            f.passes.insert(f.passes.begin(), f.passes.back());
            f.passes.front().in_place = false;
          }
        }),
        true);
  check(name, "time, 100 s more a step", before([](lessons::VentriculostomyFacts& f, int n) { f.end_s += 100 * n; }),
        false);
  check(name, "burr on the dura, 0.2 N a step", before([](lessons::VentriculostomyFacts& f, int n) {
          f.dura->burr_n = 0.2 * n;
          if (f.dura->burr_n > 1) f.dura->breach.emplace();
        }),
        false);
  check(name, "not finished, from step 1", before([](lessons::VentriculostomyFacts& f, int n) {
          if (n > 0) f.end = lessons::LessonEnd::running;
        }),
        false);
  check(name, "catheter drawn out again, from step 1", before([](lessons::VentriculostomyFacts& f, int n) {
          if (n > 0) f.passes.back().in_place = false;
        }),
        false);
  check(name, "nothing done, from step 1", before([](lessons::VentriculostomyFacts& f, int n) {
          if (n == 0) return;
          f.traces.clear(), f.passes.clear(), f.incisions.clear(), f.hole.reset();
        }),
        false);
}

}  // namespace

TEST(LessonsMonotone, Ventriculostomy) {
  for (const bool left : {false, true}) check_head(left);
}

void check_chest(const std::string& name, const lessons::SubclavianFacts& perfect, const cases::CaseManifest& manifest,
                 const voxel::HapticVolume& volume) {
  const auto axis = [&](const std::string& what, bool completed,
                        const std::function<void(lessons::SubclavianFacts&, int)>& spoil) {
    check(
        name, what,
        [&](int n) {
          lessons::SubclavianFacts f = perfect;
          spoil(f, n);
          return lessons::score_subclavian(f, manifest, volume, lessons_chest::Chest::rubric());
        },
        completed);
  };
  using F = lessons::SubclavianFacts;
  axis("puncture too low, 6 mm a step", true,
       [](F& f, int n) { f.passes[0].entry_mm.z -= 6 * n, f.passes[0].tip_mm.z -= 6 * n; });
  axis("puncture too high, 3 mm a step", true,
       [](F& f, int n) { f.passes[0].entry_mm.z += 3 * n, f.passes[0].tip_mm.z += 3 * n; });
  axis("needle turned down, 12 degrees a step", true, [](F& f, int n) {
    const Vec3 w = f.passes[0].tip_mm - f.passes[0].entry_mm;
    const double a = -12.0 * n * M_PI / 180;
    f.passes[0].tip_mm =
        f.passes[0].entry_mm + Vec3{w.x * std::cos(a) - w.z * std::sin(a), w.y, w.x * std::sin(a) + w.z * std::cos(a)};
  });
  axis("one more pass a step", true, [](F& f, int n) {
    for (int k = 0; k < n; ++k) f.passes.insert(f.passes.begin(), f.passes.back());
  });
  axis("time, 75 s more a step", false, [](F& f, int n) { f.end_s += 75 * n; });
  axis("no aspiration, from step 1", false, [](F& f, int n) {
    if (n > 0) f.blood_s = -1, f.aspirations.clear();
  });
  axis("vein left again, from step 1", false, [](F& f, int n) {
    if (n > 0) f.blood_s = -1, f.inside = 0;
  });
  axis("vein missed, from step 1", false, [](F& f, int n) {
    if (n > 0) f.blood_s = f.vein_s = -1, f.inside = 0;
  });
  if (lessons::chest_shapes_of(manifest).artery != 0)
    axis("artery entered, from step 1", false, [](F& f, int n) {
      if (n > 0) f.artery_s = 5;
    });
  axis("pleura entered, from step 1", false, [](F& f, int n) {
    if (n > 0) f.pleura_s = 5;
  });
  axis("lung entered, from step 1", false, [](F& f, int n) {
    if (n > 0) f.lung_s = 5;
  });
  axis("the other side, from step 1", false, [](F& f, int n) {
    if (n > 0) f.task = "left";
  });
  axis("not finished, from step 1", false, [](F& f, int n) {
    if (n > 0) f.end = lessons::LessonEnd::running;
  });
  axis("nothing done, from step 1", false, [](F& f, int n) {
    if (n > 0) f.passes.clear(), f.aspirations.clear(), f.blood_s = f.vein_s = -1, f.inside = 0;
  });
  axis("largest force, 1 N a step (not scored)", true, [](F& f, int n) { f.most_force_n += n; });
}

TEST(LongLessonsMonotone, Subclavian) {
  for (const bool artery : {false, true}) {
    lessons_chest::Chest chest(artery);
    const auto perfect = chest.run(
        R"({"puncture": {"from": {"at": "vein_right", "offset_mm": [-30, 0, -6], "on_skin": true},
            "toward": {"at": "vein_right"}, "short_of_mm": -4}}, "aspirate", "finish")");
    check_chest(artery ? "subclavian with an artery" : "subclavian", perfect.facts, chest.felt().loaded.manifest,
                chest.whole());
  }
}

// What examples/lessons/subclavian.json does in the chests of a library, spoilt in the same way.
TEST(LongLessonsMonotone, ChestsOfALibrary) {
  const auto cases = library_cases("clavicle");
  for (const auto& felt : cases) {
    const std::string& token = felt->loaded.manifest.case_token;
    const voxel::HapticVolume whole = felt->loaded.haptic;
    lessons::LessonOptions o;
    o.script = lessons::parse_lesson_script(
        R"({"module": "subclavian", "steps": [
             {"puncture": {"from": {"at": "vein_right", "offset_mm": [-30, 0, -5], "on_skin": true},
                           "toward": {"at": "vein_right"}, "short_of_mm": -6}}, "aspirate", "finish"]})");
    o.servo.rate_hz = 500;
    const std::atomic<bool> stop{false};
    const haptics::Recording recording = lessons::run_lesson(*felt, o, stop).recording;
    felt->loaded.haptic = whole;
    const auto facts = lessons::facts_of_recording(*felt, "test", recording);
    std::printf("case %s\n", token.c_str());
    check_chest("subclavian in " + token, dynamic_cast<const lessons::SubclavianFacts&>(*facts), felt->loaded.manifest,
                whole);
  }
  if (cases.empty()) GTEST_SKIP() << "no chest in TREPHINE_LESSON_CASES";
}

// TREPHINE_LESSON_CASES=library/head:...; docs/validation/lessons.md has what came of it.
TEST(LongLessonsMonotone, HeadsOfALibrary) {
  const auto cases = library_cases("ventricles");
  in_a_case() = true;
  for (const auto& felt : cases) {
    std::printf("case %s\n", felt->loaded.manifest.case_token.c_str());
    check_head(false, spoilt_case(*felt));
  }
  in_a_case() = false;
  if (cases.empty()) GTEST_SKIP() << "no head in TREPHINE_LESSON_CASES";
}
