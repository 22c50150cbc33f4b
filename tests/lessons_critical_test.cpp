// SPDX-License-Identifier: GPL-3.0-or-later
// Performances that would kill, that were never asked for, that do nothing, and that no hand does.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>

#include <nlohmann/json.hpp>

#include "base/hash.h"
#include "base/write_file.h"
#include "lessons/attempts.h"
#include "lessons/rubric_types.h"
#include "lessons/score_report.h"
#include "lessons_chest.h"
#include "lessons_head.h"
#include "lessons_spine_run.h"

using namespace lesson_cases;

namespace {

SpineCase& spine() {
  static SpineCase one;
  return one;
}
Head& drilled() {
  static Head head(Kind::drilled);
  return head;
}
std::string needle(const std::string& more = "", const std::string& pedicle = "pedicle_2_left") {
  return R"({"shoot": {}}, {"needle": {"pedicle": ")" + pedicle + "\"" + (more.empty() ? "" : ", " + more) +
         R"(}}, {"shoot": {}}, "finish")";
}
std::string catheter(const std::string& toward, const std::string& more = "\"short_of_mm\": 1") {
  return R"({"take": {"tool": "catheter"}}, {"insert": {"toward": )" + toward + ", " + more + R"(}}, "finish")";
}
template <class Done>
void expect_nothing(const Done& d) {
  EXPECT_EQ(d.score.outcome(), lessons::LessonOutcome::not_completed);
  for (const lessons::ScoreRow& row : d.score.rows)
    if (row.score) {
      EXPECT_EQ(*row.score, 1) << row.name << ": " << row.why;
    }
}

}  // namespace

TEST(LessonsCritical, ANeedleThroughTheFrontOfTheVertebraFails) {
  const auto d = spine().run(needle("\"short_of_mm\": -33"));
  EXPECT_EQ(d.score.outcome(), lessons::LessonOutcome::failed);
  EXPECT_TRUE(failed_by(d.score, "anterior_cortex_mm")) << d.score.reason();
  // The sum stands beside it: of where the needle went in and to where it pointed, and of nothing else.
  EXPECT_EQ(lessons::sum_of(d.score).points, 5 + 5 + 1 + 1 + 1 + 1 + 1);
  const std::string text = lessons::score_text({"spine", "spine_needle", "p1", "a", "b", "c"}, d.facts, d.score);
  EXPECT_NE(text.find("failed: needle came through the front of the vertebra"), std::string::npos) << text;
  // What the rubric does not list does not fail.
  lessons::SpineNeedleRubric without = shipped();
  without.critical_errors.clear();
  EXPECT_NE(lessons::score_spine_needle(d.facts, spine().felt().loaded.manifest, spine().whole(), without).outcome(),
            lessons::LessonOutcome::failed);
}

TEST(LessonsCritical, ANeedleTowardsTheCanalFails) {
  const auto d = spine().run(needle("\"entry_aside_mm\": -2, \"target_aside_mm\": -22"));
  EXPECT_EQ(d.score.outcome(), lessons::LessonOutcome::failed);
  EXPECT_TRUE(failed_by(d.score, "medial_breach_mm") || failed_by(d.score, "canal"))
      << d.score.reason() << lessons::score_text({"spine", "spine_needle", "p1", "a", "b", "c"}, d.facts, d.score);
}

TEST(LessonsCritical, SideAndLevelAreAskedFor) {
  for (const auto& [pedicle, error] :
       {std::pair<const char*, const char*>{"pedicle_2_right", "wrong_side"}, {"pedicle_1_left", "wrong_level"}}) {
    const auto d = spine().run(needle("", pedicle));
    EXPECT_EQ(d.recording.header.task, "pedicle_2_left");
    EXPECT_EQ(d.score.outcome(), lessons::LessonOutcome::failed) << pedicle;
    EXPECT_TRUE(failed_by(d.score, error)) << d.score.reason();
    EXPECT_EQ(d.points("entry"), 1);
    EXPECT_EQ(d.points("time"), 1);
    EXPECT_LT(lessons::sum_of(d.score).points, 15);
  }
  // Asked for, it is perfect.
  EXPECT_EQ(
      lessons::sum_of(spine().run(needle("", "pedicle_2_right"), "spine_needle", 0, 1, "pedicle_2_right").score).points,
      35);
  EXPECT_THROW(spine().run(needle(), "spine_needle", 0, 1, "pedicle_9_left"), Error);
  // A recording that says nothing of what was asked for is judged by what was done.
  auto old = spine().run(needle("", "pedicle_2_right"));
  old.recording.header.task.clear();
  spine().score(old);
  EXPECT_EQ(lessons::sum_of(old.score).points, 35);
  EXPECT_EQ(old.score.outcome(), lessons::LessonOutcome::completed);
}

TEST(LessonsCritical, AHeadsWrongSideAndADryCatheterFail) {
  const auto right = drilled().run(catheter(R"({"at": "monro_right"})"), 500, 1, 0, "right");
  EXPECT_EQ(right.score.outcome(), lessons::LessonOutcome::completed) << right.score.reason();
  const auto wrong = drilled().run(catheter(R"({"at": "monro_right"})"), 500, 1, 0, "left");
  EXPECT_TRUE(failed_by(wrong.score, "wrong_side")) << wrong.score.reason();
  EXPECT_LT(lessons::sum_of(wrong.score).points, lessons::sum_of(right.score).points - 5);
  const auto dry = drilled().run(catheter(R"({"at": "monro_right", "offset_mm": [-25, 0, 0]})"));
  EXPECT_TRUE(failed_by(dry.score, "dry_catheter")) << dry.score.reason();
  EXPECT_EQ(dry.points("tip"), 1);
  EXPECT_EQ(dry.points("time"), 1);
  // Several passes cost something.
  const auto twice = drilled().run(
      R"({"take": {"tool": "catheter"}}, {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 30}}, "withdraw",
         {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}}, "finish")");
  EXPECT_EQ(twice.points("passes"), 4);
  EXPECT_EQ(right.points("passes"), 5);
  EXPECT_EQ(lessons::sum_of(right.score).max_of_table, lessons::sum_of(right.score).most - 5);
}

TEST(LessonsCritical, ABurrThatBreachedTheDuraFails) {
  auto d = drilled().run(catheter(R"({"at": "monro_right"})"));
  lessons::VentriculostomyFacts facts = d.facts;
  facts.dura.emplace().breach.emplace();
  const lessons::LessonScore score =
      lessons::score_ventriculostomy(facts, drilled().felt().loaded.manifest, drilled().whole(), Head::rubric());
  EXPECT_EQ(score.outcome(), lessons::LessonOutcome::failed);
  EXPECT_EQ(lessons::sum_of(score).of_table, lessons::sum_of(d.score).of_table) << "Table XIII scores none of it";
  EXPECT_EQ(score.row("passes")->score, 1) << "who did harm saved nothing";
}

TEST(LessonsCritical, AMissedVeinIsNotCompletedAndALungFails) {
  lessons_chest::Chest chest(false);
  const std::string from = R"({"puncture": {"from": {"at": "vein_right", "offset_mm": [-30, 0, -6], "on_skin": true},)";
  const auto missed = chest.run(from + R"("toward": {"at": "vein_right"}, "short_of_mm": 18}}, "aspirate", "finish")");
  EXPECT_EQ(missed.score.outcome(), lessons::LessonOutcome::not_completed);
  EXPECT_EQ(missed.score.reason(), "no blood was drawn from the vein");
  EXPECT_EQ(missed.points("time"), 1);
  const auto lung = chest.run(
      from +
      R"("toward": {"at": "vein_right", "offset_mm": [-14, 29, -22]}, "short_of_mm": -6}}, "aspirate", "finish")");
  EXPECT_TRUE(failed_by(lung.score, "pleura_or_lung")) << lung.score.reason();
  const auto wrong =
      chest.run(from + R"("toward": {"at": "vein_right"}, "short_of_mm": -4}}, "aspirate", "finish")", 500, 0, "left");
  EXPECT_TRUE(failed_by(wrong.score, "wrong_side")) << wrong.score.reason();
}

TEST(LessonsCritical, DoingNothingScoresOneInEveryRow) {
  lessons_chest::Chest chest(false);
  Head whole(Kind::whole);
  for (const std::string& steps : {std::string(R"("finish")"), std::string(R"({"wait": {"seconds": 1}})")}) {
    expect_nothing(whole.run(steps));
    expect_nothing(drilled().run(steps));
    expect_nothing(spine().run(steps));
    expect_nothing(spine().run(steps, "pedicle_screw"));
    const auto none = chest.run(steps);
    expect_nothing(none);
    EXPECT_FALSE(none.row("artery").score) << "an artery that the case does not have";
  }
}

// One picture, a tool in the hand, or a draw at the syringe is as good as nothing.
TEST(LessonsCritical, NearlyNothingScoresOneInEveryRow) {
  lessons_chest::Chest chest(false);
  Head whole(Kind::whole);
  for (const char* lesson : {"spine_needle", "pedicle_finder", "pedicle_screw"}) {
    const auto looked = spine().run(R"({"shoot": {"seconds": 1}}, "finish")", lesson);
    EXPECT_EQ(looked.facts.shots.size(), 1u);
    expect_nothing(looked);
  }
  expect_nothing(whole.run(R"({"take": {"tool": "burr"}}, "erase", "finish")"));
  expect_nothing(chest.run(R"("aspirate", "finish")"));
}

// What was placed and taken out again earns nothing for having been quick.
TEST(LessonsCritical, WhoPlacesNothingEarnsNothingForFewPasses) {
  auto taken_out = drilled().run(catheter(R"({"at": "monro_right"})"));
  EXPECT_EQ(taken_out.points("passes"), 5);
  taken_out.facts.passes.back().in_place = false;
  const lessons::LessonScore score = lessons::score_ventriculostomy(taken_out.facts, drilled().felt().loaded.manifest,
                                                                    drilled().whole(), Head::rubric());
  EXPECT_EQ(score.row("passes")->score, 1);
  EXPECT_EQ(score.row("passes")->why, "no catheter lies in the brain");
  const auto dry = drilled().run(catheter(R"({"at": "monro_right", "offset_mm": [-25, 0, 0]})"));
  EXPECT_EQ(dry.points("passes"), 1) << dry.row("passes").why;

  lessons_chest::Chest chest(false);
  const auto pricked = chest.run(
      R"({"puncture": {"from": {"at": "vein_right", "offset_mm": [-30, 0, -6], "on_skin": true},
          "toward": {"at": "vein_right"}, "short_of_mm": 18}}, "aspirate", "finish")");
  EXPECT_EQ(pricked.facts.passes.size(), 1u);
  EXPECT_EQ(pricked.points("passes"), 1) << pricked.row("passes").why;
  EXPECT_EQ(pricked.points("lung"), 1) << pricked.row("lung").why;
  EXPECT_EQ(pricked.points("puncture"), 5);
  EXPECT_EQ(lessons::sum_of(pricked.score).points, 5 + 5 + 1 + 1 + 1 + 1);  // the phantom has no artery
}

// As head_invesalius_0051, whose foramina have a confidence of 0.23.
TEST(LessonsCritical, ACaseThatDoesNotKnowItsForaminaMarksNobodyDown) {
  for (const char* toward : {R"({"at": "monro_right"})", R"({"at": "monro_right", "offset_mm": [1.5, 2, -12]})",
                             R"({"at": "monro_right", "offset_mm": [-25, 0, 0]})"}) {
    const auto d = drilled().run(catheter(toward));
    cases::CaseManifest m = drilled().felt().loaded.manifest;
    for (cases::CaseTarget& t : m.targets) t.confidence = 0.23;
    for (const bool nothing : {false, true}) {
      lessons::VentriculostomyFacts facts = d.facts;
      if (nothing) facts.passes.clear();
      const lessons::LessonScore score = lessons::score_ventriculostomy(facts, m, drilled().whole(), Head::rubric());
      for (const lessons::ScoreRow& row : score.rows)
        if (row.name == "trajectory" || row.name == "tip") {
          EXPECT_FALSE(row.score) << row.name << ": " << row.why;
          EXPECT_NE(row.why.english().find("doubtful"), std::string::npos) << row.why;
        }
      EXPECT_FALSE(score.flag("third_ventricle"));
    }
  }
}

TEST(LessonsCritical, TheScrewsSizeIsJudged) {
  const auto with = [](const std::string& screw) {
    return spine().run(R"({"take": {"tool": ")" + screw + R"("}}, )" + needle(), "pedicle_screw");
  };
  const auto fits = with("screw_5.5x45");
  EXPECT_EQ(fits.points("size"), 5) << fits.row("size").why << fits.measured("head_out_mm");
  EXPECT_EQ(with("screw_5.5x35").row("size").why, "too short for where its tip lies");
  EXPECT_LT(with("screw_5.5x35").points("size"), 5);
}

// ---- Teleports ----

TEST(LessonsTeleport, AHandThatBeginsInsideFeelsNothing) {
  // Every pose as if the first were at the target already.
  auto d = spine().run(needle());
  spine().felt().loaded.haptic = spine().whole();
  contact::ContactVolume contact(spine().felt().loaded.haptic, d.recording.header.contact);
  std::vector<haptics::ServoFrame> poses = d.recording.frames;
  const haptics::ServoFrame last = poses.back();
  for (haptics::ServoFrame& f : poses)
    std::copy(last.tip_mm, last.tip_mm + 3, f.tip_mm), std::copy(last.axis, last.axis + 3, f.axis);
  session::Rerun rerun(spine().felt(), contact, "test", d.recording.header);
  haptics::Recording forged{d.recording.header, rerun.run(poses)};
  forged.header.outcome.reset();
  for (const haptics::ServoFrame& f : forged.frames) ASSERT_EQ(f.inside, 0);
  auto again = d;
  again.recording = forged;
  spine().score(again);
  EXPECT_EQ(again.points("entry"), 1);
  EXPECT_EQ(again.score.outcome(), lessons::LessonOutcome::not_completed);
  // A recording that says otherwise.
  for (haptics::ServoFrame& f : forged.frames) f.inside = 1;
  spine().felt().loaded.haptic = spine().whole();
  EXPECT_THROW(lessons::facts_of_recording(spine().felt(), "test", forged), Error);
}

TEST(LessonsTeleport, AToolIsNotChangedInsideOfThePatient) {
  Head whole(Kind::whole);
  const auto d = whole.run(std::string(perfect_marks) +
                           R"(, {"take": {"tool": "marker"}}, {"insert": {"from": {"at": "mark"}, "toward":
                           {"at": "monro_right"}, "short_of_mm": 1}}, {"take": {"tool": "catheter"}}, "finish")");
  EXPECT_TRUE(d.facts.passes.empty()) << "a pass through intact bone";
  EXPECT_EQ(d.points("tip"), 1);
  // A recording that says that it was so gains nothing: by the rules of the belt the tool was not taken.
  auto forged = d;
  for (haptics::ServoFrame& f : forged.recording.frames)
    if (haptics::belt_button::tool(f.buttons) == 2) f.inside = 2, std::copy(f.tip_mm, f.tip_mm + 3, f.proxy_mm);
  whole.score(forged);
  EXPECT_TRUE(forged.facts.passes.empty());
  EXPECT_EQ(forged.points("tip"), 1);
}

TEST(LessonsTeleport, MovesThatNoHandMakesAreRefused) {
  const auto d = drilled().run(catheter(R"({"at": "monro_right"})"));
  const auto judged = [&](const std::function<void(std::vector<haptics::ServoFrame>&)>& forge) -> std::string {
    haptics::Recording r = d.recording;
    forge(r.frames);
    drilled().felt().loaded.haptic = drilled().whole();
    try {
      lessons::facts_of_recording(drilled().felt(), "test", r);
    } catch (const Error& e) {
      EXPECT_EQ(e.field(), "frames");
      return e.what();
    }
    return "judged";
  };
  EXPECT_EQ(judged([](auto&) {}), "judged");
  const std::string jump = judged([](auto& f) {
    for (std::size_t n = 100; n < f.size(); ++n) f[n].tip_mm[0] += 200;
  });
  EXPECT_NE(jump.find("m/s"), std::string::npos) << jump;
  const std::string shake = judged([](auto& f) {
    for (std::size_t n = 100; n < f.size(); ++n) f[n].tip_mm[0] += n / 10 % 2 ? 35 : 0;
  });
  EXPECT_NE(shake.find("m/s2"), std::string::npos) << shake;
  // What the session itself found to be a jump; and a device that was silent, which says nothing new meanwhile.
  const std::string found = judged([](auto& f) { f[100].faults = haptics::haptic_fault::jump; });
  EXPECT_NE(found.find("the device jumped"), std::string::npos) << found;
  const auto silent = [](double step_mm) {
    return [step_mm](std::vector<haptics::ServoFrame>& f) {
      for (std::size_t n = 100; n < 160; ++n) {
        f[n].faults = haptics::haptic_fault::gap;
        for (int a = 0; a < 3; ++a) f[n].tip_mm[a] = f[99].tip_mm[a] + step_mm * double(n - 99);
      }
    };
  };
  EXPECT_EQ(judged(silent(0)), "judged");
  EXPECT_NE(judged(silent(0.1)).find("silent"), std::string::npos);
  // Times that were shrunk are a faster hand.
  const auto shrunk = [](double by) {
    return [by](auto& f) {
      for (haptics::ServoFrame& frame : f) frame.time_s /= by, frame.dt_s /= by;
    };
  };
  EXPECT_NE(judged(shrunk(200)), "judged");
  EXPECT_NE(judged(shrunk(40)).find("goes into the patient"), std::string::npos) << judged(shrunk(40));
  EXPECT_EQ(judged(shrunk(4)), "judged");  // somebody may be that quick
}

// A device that is silent for a moment leaves the tool where it is: there is no second pass, and no faster one.
TEST(LessonsTeleport, ASilentDeviceMakesNoSecondPass) {
  const auto in_spine = spine().run(needle());
  ASSERT_EQ(in_spine.facts.passes.size(), 1u);
  const auto silent =
      spine().facts_with_silence<lessons::SpineNeedleFacts>(in_spine.recording, in_spine.facts.fastest_s - 0.1);
  EXPECT_EQ(silent.passes.size(), 1u);
  EXPECT_EQ(silent.punctures.size(), in_spine.facts.punctures.size());
  EXPECT_LE(silent.fastest_mm_per_s, 1.05 * in_spine.facts.fastest_mm_per_s);
  const auto in_head = drilled().run(catheter(R"({"at": "monro_right"})"));
  ASSERT_EQ(in_head.facts.passes.size(), 1u);
  const auto head_silent =
      drilled().facts_with_silence<lessons::VentriculostomyFacts>(in_head.recording, in_head.facts.fastest_s - 0.1);
  EXPECT_EQ(head_silent.passes.size(), 1u);
  EXPECT_LE(head_silent.fastest_mm_per_s, 1.05 * in_head.facts.fastest_mm_per_s);
}

TEST(LessonsTeleport, AWholeLessonThatWasShrunkIsRefused) {
  Head whole(Kind::whole);
  const auto d =
      whole.run(std::string(perfect_marks) + R"(, {"take": {"tool": "burr"}}, {"drill": {"past_mm": -30}}, "finish")");
  const auto judged = [&](double by) -> std::string {
    haptics::Recording r = d.recording;
    for (haptics::ServoFrame& frame : r.frames) frame.time_s /= by, frame.dt_s /= by;
    whole.felt().loaded.haptic = whole.whole();
    try {
      lessons::facts_of_recording(whole.felt(), "test", r);
    } catch (const Error& e) {
      return e.what();
    }
    return "judged";
  };
  EXPECT_EQ(judged(1), "judged");
  EXPECT_NE(judged(40), "judged");
  EXPECT_NE(judged(16), "judged");
}

// ---- Older files ----

TEST(LessonsOlder, ARubricOfVersionOneIsReadAndFailsNobody) {
  Head::Done d = drilled().run(catheter(R"({"at": "monro_right", "offset_mm": [-25, 0, 0]})"));
  lessons::VentriculostomyRubric old = Head::rubric();
  old.passes.reset();
  old.critical_errors.clear();
  is(old.tip.missed_mm.emplace(), 3);
  std::string json = lesson::compile_rubric(AnyParams::make(old));
  // As version 1 wrote it: without the list, and with the hash of that.
  nlohmann::ordered_json file = nlohmann::ordered_json::parse(json);
  file["trephine_rubric"] = 1;
  file["rubric"].erase("critical_errors");
  file["sha256"] = sha256_of_bytes(file["rubric"].dump());
  const lesson::CompiledRubric read = lesson::read_rubric(file.dump(2), lessons::rubric_types());
  const lessons::LessonScore score = lessons::score_ventriculostomy(
      d.facts, drilled().felt().loaded.manifest, drilled().whole(), read.rubric.as<lessons::VentriculostomyRubric>());
  EXPECT_TRUE(score.critical.empty());
  EXPECT_EQ(score.rows.size(), 6u);
  file["rubric"]["tip"]["near_mm"]["limit"] = 12.0;
  EXPECT_THROW(lesson::read_rubric(file.dump(2), lessons::rubric_types()), Error);
  // What the lesson does not know is no critical error of it.
  lessons::VentriculostomyRubric wrong = Head::rubric();
  lists(wrong.critical_errors, {{"sneezing", 0}});
  EXPECT_NE(wrong.fault().find("sneezing"), std::string::npos);
  wrong = Head::rubric();
  lists(wrong.critical_errors, {{"brainstem", 0}});
  EXPECT_NE(wrong.fault().find("twice"), std::string::npos);
}

TEST(LessonsOlder, ALogOfBeforeGetsTheNewColumns) {
  const Head::Done d = drilled().run(catheter(R"({"at": "monro_right"})"));
  const ScratchFolder folder;
  const auto file = folder.path() / "log.csv";
  std::string columns, line;
  for (const auto& [name, help] : lessons::attempt_columns(lessons::lesson_type("ventriculostomy"))) {
    if (name == "task" || name == "outcome" || name == "critical_errors" || name == "passes_score") continue;
    columns += (columns.empty() ? "" : ",") + name;
    line += (line.empty() ? "" : ",") + (name == "participant" ? std::string("p0") : name == "attempt" ? "1" : "");
  }
  write_file(file, columns + "\n" + line + "\n");
  EXPECT_EQ(lessons::log_attempt(file, {"head", "ventriculostomy", "p1", "a", "b", "c"}, d.facts, d.score), 1);
  const std::vector<char> bytes = read_file(file, 1 << 20);
  const std::string text(bytes.begin(), bytes.end());
  EXPECT_NE(text.find(",task,outcome,critical_errors,decisions_score,seal,signature\np0,"), std::string::npos) << text;
  EXPECT_NE(text.find(",right,completed,,,not sealed,\n"), std::string::npos) << text;
}
