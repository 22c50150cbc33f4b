// SPDX-License-Identifier: GPL-3.0-or-later
// Ventriculostomies in a head of known lengths: perfect, wrong and hostile ones, through the servo.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include "lessons/rubric_types.h"
#include "lessons/score_report.h"
#include "lessons_head.h"
#include "session/playback.h"

using namespace lesson_cases;

namespace {

Head& whole() {
  static Head head(Kind::whole);
  return head;
}
Head& drilled() {
  static Head head(Kind::drilled);
  return head;
}

std::string perfect() {
  return std::string(perfect_marks) + ", " + perfect_hole +
         R"(, {"take": {"tool": "catheter"}}, {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}}, "finish")";
}

std::string json_of(const Head::Done& d) {
  return lessons::score_json({"head", "ventriculostomy", "p1", "a", "b", "c"}, d.facts, d.score);
}

}  // namespace

TEST(Lessons, APerfectOneScoresFiveInAllRowsAndReplaysBitForBit) {
  const Head::Done d = whole().run(perfect());
  for (const lessons::ScoreRow& row : d.score.rows) EXPECT_EQ(row.score.value_or(0), 5) << row.name << ": " << row.why;
  EXPECT_TRUE(d.score.flag("first_pass"));
  EXPECT_EQ(d.facts.end, lessons::LessonEnd::finished);
  ASSERT_EQ(d.facts.traces.size(), 3u);
  EXPECT_NEAR(d.facts.traces[1].length_mm, 110, 2);  // along the skin
  EXPECT_NEAR(d.facts.traces[2].length_mm, 27.5, 1);
  EXPECT_EQ(d.facts.incisions.size(), 1u);
  EXPECT_LT(norm(d.facts.incisions[0].at_mm - kocher()), 2);
  ASSERT_TRUE(d.facts.hole);
  EXPECT_NEAR(norm(d.facts.hole->outer_mm), outer_mm, 1.3);
  EXPECT_NEAR(norm(d.facts.hole->inner_mm), inner_mm, 1.3);
  // Depth from the inner table, by the last frame's tip alone.
  const Vec3 inner = normalized(kocher()) * inner_mm;
  EXPECT_NEAR(d.measured("depth", "depth_mm"), norm(d.last_tip() - inner), 1.5);
  EXPECT_NEAR(d.measured("tip", "foramen_off_mm"), norm(d.last_tip() - foramen), 0.05);  // frames go on a little

  // The same bytes when it is scored again, and the same bits when it is run again.
  Head::Done again;
  again.recording = d.recording;
  whole().score(again);
  EXPECT_EQ(json_of(d), json_of(again));
  whole().felt().loaded.haptic = whole().whole();
  contact::ContactVolume contact(whole().felt().loaded.haptic, d.recording.header.contact);
  session::Rerun rerun(whole().felt(), contact, "test", d.recording.header);
  const std::vector<haptics::ServoFrame> frames = rerun.run(d.recording.frames);
  std::size_t different = 0;
  for (std::size_t n = 0; n < frames.size(); ++n) different += !haptics::same_frame(frames[n], d.recording.frames[n]);
  EXPECT_EQ(different, 0u);
  EXPECT_EQ(haptics::volume_digest(whole().felt().loaded.haptic), d.recording.header.outcome->volume_sha256);

  // Through a file.
  const ScratchFolder folder;
  haptics::RecordingWriter writer(folder.path() / "one.lesson", d.recording.header);
  writer.add(d.recording.frames);
  writer.finish(d.recording.header.outcome);
  Head::Done read;
  read.recording = haptics::read_recording(folder.path() / "one.lesson");
  whole().score(read);
  EXPECT_EQ(json_of(d), json_of(read));

  // Forces keep to the device's limits over every change of the tool.
  const double max_step = d.recording.header.force.force_rate_n_per_s() / d.recording.header.rate_hz;
  std::set<int> tools;
  for (std::size_t n = 1; n < d.recording.frames.size(); ++n) {
    const haptics::ServoFrame &a = d.recording.frames[n - 1], &b = d.recording.frames[n];
    const Vec3 step{b.force_n[0] - a.force_n[0], b.force_n[1] - a.force_n[1], b.force_n[2] - a.force_n[2]};
    ASSERT_LE(norm(step), max_step * (1 + 1e-9)) << n;
    tools.insert(haptics::belt_button::tool(b.buttons));
  }
  EXPECT_EQ(tools, (std::set<int>{0, 1, 2}));
}

TEST(Lessons, ACaseWithAHoleBeginsAtTheCatheter) {
  const Head::Done d = drilled().run(
      R"({"take": {"tool": "catheter"}}, {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}}, "finish")");
  EXPECT_EQ(d.points("landmarks"), 0);
  EXPECT_EQ(d.points("burr_hole"), 0);
  EXPECT_EQ(d.row("burr_hole").why, "the hole was there beforehand");
  for (const char* name : {"trajectory", "depth", "tip", "time"})
    EXPECT_EQ(d.points(name), 5) << name << d.row(name).why;
  EXPECT_TRUE(d.facts.drilled_beforehand);
  EXPECT_EQ(lessons::sum_of(d.score).most, 25);
  EXPECT_EQ(lessons::sum_of(d.score).max_of_table, 20);
}

TEST(Lessons, EveryPassOfTheCatheterIsKept) {
  const Head::Done d = drilled().run(
      R"({"take": {"tool": "catheter"}}, {"insert": {"toward": {"at": "monro_right", "offset_mm": [-25, 0, 0]}}},
         "withdraw", {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 30}}, "withdraw",
         {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}}, "finish")");
  ASSERT_EQ(d.facts.passes.size(), 3u);
  EXPECT_FALSE(d.facts.passes[0].in_place);
  EXPECT_LT(d.facts.passes[0].csf_s, 0);
  EXPECT_LT(d.facts.passes[1].csf_s, 0);
  EXPECT_TRUE(d.facts.passes[2].in_place);
  EXPECT_GT(d.facts.passes[2].csf_s, d.facts.passes[2].begin_s);
  EXPECT_TRUE(d.score.flag("in_ventricle"));
  EXPECT_FALSE(d.score.flag("first_pass"));
  EXPECT_EQ(d.points("tip"), 5);
}

TEST(Lessons, ADoubtfulSutureIsNotJudged) {
  Head doubtful(Kind::whole, 0.45);
  const Head::Done d = doubtful.run(std::string(perfect_marks) + R"(, "finish")");
  for (const char* name : {"landmarks", "burr_hole"}) {
    EXPECT_FALSE(d.row(name).score.has_value()) << name;
    EXPECT_NE(d.row(name).why.english().find("doubtful"), std::string::npos) << d.row(name).why;
  }
  EXPECT_EQ(d.points("tip"), 1);
}

TEST(LessonsHostile, ACatheterWithoutAHoleStaysOutside) {
  const Head::Done d =
      whole().run(std::string(perfect_marks) +
                  R"(, {"take": {"tool": "catheter"}}, {"insert": {"toward": {"at": "monro_right"}}}, "finish")");
  EXPECT_TRUE(d.facts.passes.empty());
  EXPECT_EQ(d.points("landmarks"), 5);
  for (const char* name : {"burr_hole", "trajectory", "depth", "tip"}) EXPECT_EQ(d.points(name), 1) << name;
  EXPECT_GT(norm(d.last_tip()), outer_mm - 1);
}

TEST(LessonsHostile, AToolSwappedInTheMiddleOfDrilling) {
  // The burr is in the bone when the catheter is taken in its place, and is drawn out.
  const Head::Done d = whole().run(std::string(perfect_marks) +
                                   R"(, {"take": {"tool": "burr"}}, {"drill": {"past_mm": -4, "hole_diameter_mm": 8}},
      {"take": {"tool": "catheter"}}, {"wait": {"seconds": 0.2}}, {"take": {"tool": "burr"}},
      {"drill": {"past_mm": -3, "hole_diameter_mm": 8}}, {"take": {"tool": "marker"}}, "finish")");
  EXPECT_EQ(d.facts.end, lessons::LessonEnd::finished);
  ASSERT_TRUE(d.facts.hole);
  EXPECT_FALSE(d.facts.hole->through);
  EXPECT_LT(d.facts.through_s, 0);
  EXPECT_EQ(d.points("burr_hole"), 1);
  EXPECT_EQ(d.row("burr_hole").why, "the hole does not let the catheter through");
}

TEST(Lessons, TheBurrIsTheOneOfWhatStaysDrilled) {
  const auto with = [](const char* between) {
    return whole().run(std::string(perfect_marks) + R"(, {"take": {"tool": "burr_7"}}, {"drill": {"past_mm": -3}}, )" +
                       between + R"({"take": {"tool": "burr_3"}}, {"drill": {"past_mm": -3}}, "finish")");
  };
  EXPECT_EQ(with("").facts.burr_mm, 7) << "the widest";
  const Head::Done d = with(R"("reset", {"wait": {"seconds": 0.5}}, "incise", )");
  EXPECT_EQ(d.facts.undone, 1);
  EXPECT_EQ(d.facts.burr_mm, 3);
}

TEST(LessonsScore, AHoleIsNoBetterFartherFromKochersPoint) {
  const Head::Done d =
      whole().run(std::string(perfect_marks) + ", " + perfect_hole + R"(, {"take": {"tool": "marker"}}, "finish")");
  ASSERT_EQ(d.points("burr_hole"), 5);
  lessons::VentriculostomyFacts facts = d.facts;
  const Vec3 own = normalized(kocher()) * outer_mm;
  const Vec3 side = normalized(cross(own, {0, 1, 1})), up = normalized(cross(own, side));
  std::map<int, int> seen;
  for (int way = 0; way < 24; ++way)
    for (int off = 0, last = 5; off < 34; ++off) {  // farther off it may lie on the other side
      const double angle = way * M_PI / 12;
      facts.hole->outer_mm = own + (side * std::cos(angle) + up * std::sin(angle)) * off;
      const lessons::LessonScore score =
          lessons::score_ventriculostomy(facts, whole().felt().loaded.manifest, whole().whole(), Head::rubric());
      ASSERT_EQ(score.rows[1].name, "burr_hole");
      const int points = score.rows[1].score.value_or(0);
      ASSERT_LE(points, last) << way << " " << off << ": " << score.rows[1].why;
      last = points;
      ++seen[points];
    }
  for (int points = 1; points <= 5; ++points) EXPECT_GT(seen[points], 0) << points;
}

TEST(LessonsHostile, APauseCountsNothingAndWaitingAll) {
  const std::string take = R"({"take": {"tool": "catheter"}}, )";
  const std::string insert = R"(, {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}}, "finish")";
  const Head::Done paused = drilled().run(take + R"("pause", {"wait": {"seconds": 3600}}, "resume")" + insert, 100);
  EXPECT_EQ(paused.facts.pauses, 1);
  EXPECT_NEAR(paused.facts.paused_s, 3600, 1);
  EXPECT_EQ(paused.points("time"), 5);
  EXPECT_EQ(paused.points("tip"), 5);
  const Head::Done waited = drilled().run(take + R"({"wait": {"seconds": 1000}})" + insert, 100);
  EXPECT_EQ(waited.points("time"), 1);
  EXPECT_EQ(waited.row("time").why.english(), "not completed: not in the allotted time");
  // Nothing is felt meanwhile: a catheter that is pushed in is where it was not.
  const Head::Done pushed = drilled().run(take + R"("pause")" + insert, 100);
  EXPECT_TRUE(pushed.facts.passes.empty());
  EXPECT_EQ(pushed.facts.end,
            lessons::LessonEnd::finished);  // a lesson that stands still can be ended, and does nothing else
  const Head::Done marked = whole().run(
      R"({"take": {"tool": "marker"}}, {"trace": {"from": {"at": "nasion"}, "to": {"at": "nasion", "along_mm": 5}}},
         "pause", "erase", "resume", "finish")",
      100);
  ASSERT_EQ(marked.facts.pauses, 1);
  ASSERT_FALSE(marked.facts.traces.empty());
  EXPECT_FALSE(marked.facts.traces.front().erased) << "and erases nothing";
}

// In a cistern or a sulcus the catheter is in nothing, so that the lesson can be paused: it stays where it is. The
// sample has none on the way; so the end of the recording is made to say that there is one.
TEST(LessonsHostile, ACatheterStaysInAPauseAndIsJudgedWhereItIs) {
  Head::Done d = drilled().run(
      R"({"take": {"tool": "catheter"}}, {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}},
         {"wait": {"seconds": 1}}, "pause", {"wait": {"seconds": 1}}, "finish")",
      100);
  EXPECT_EQ(d.facts.pauses, 0) << "in the brain there is no pause";
  for (std::size_t n = d.recording.frames.size() - 180; n < d.recording.frames.size(); ++n)
    d.recording.frames[n].inside = d.recording.frames[n].touched = 0;
  drilled().score(d);
  EXPECT_EQ(d.facts.pauses, 1);
  ASSERT_EQ(d.facts.passes.size(), 1u);
  EXPECT_TRUE(d.facts.passes.back().in_place);
  // Drawn out in the pause, it is not there any more.
  for (std::size_t n = d.recording.frames.size() - 50; n < d.recording.frames.size(); ++n)
    d.recording.frames[n].proxy_mm[2] += 100;
  drilled().score(d);
  ASSERT_EQ(d.facts.passes.size(), 1u);
  EXPECT_FALSE(d.facts.passes.back().in_place);
}

TEST(LessonsHostile, ALostDeviceEndsTheLessonAndKeepsWhatWasDone) {
  const Head::Done d = drilled().run(
      R"({"take": {"tool": "catheter"}}, {"insert": {"toward": {"at": "monro_right"}, "short_of_mm": 1}},
         "lose_device", {"wait": {"seconds": 1}}, "finish")");
  EXPECT_EQ(d.facts.end, lessons::LessonEnd::device_lost);
  EXPECT_EQ(d.points("time"), 1);
  EXPECT_EQ(d.row("time").why.english(), "not completed: device lost");
  EXPECT_EQ(d.points("tip"), 5);  // where it was when the device went
  for (std::size_t n = d.recording.frames.size() - 100; n < d.recording.frames.size(); ++n)
    for (const double f : d.recording.frames[n].force_n) ASSERT_EQ(f, 0);
}

TEST(LessonsHostile, RecordingsThatAreNoLessonsAreRefused) {
  Head::Done d = drilled().run(R"({"take": {"tool": "catheter"}}, "finish")", 100);
  const auto refused = [&](ExitCode code, const char* field) {
    try {
      drilled().score(d);
      ADD_FAILURE() << field;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), code);
      EXPECT_EQ(e.field(), field);
    }
  };
  const haptics::Recording good = d.recording;
  d.recording.header.lesson = "";
  refused(ExitCode::bad_input, "lesson");
  d.recording = good;
  d.recording.frames.erase(d.recording.frames.begin() + 5);
  refused(ExitCode::bad_input, "frames");
  d.recording.frames.clear();
  refused(ExitCode::bad_input, "frames");
  d.recording = good;
  drilled().score(d);
}

TEST(LessonsScript, FaultsNameTheStep) {
  const auto refused = [](const std::string& steps, const std::string& field) {
    try {
      whole().run(steps);
      ADD_FAILURE() << steps;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      EXPECT_EQ(e.field(), field) << e.what();
    }
  };
  refused(R"({"take": {"tool": "spoon"}})", "steps[0].take: tool");
  refused(R"("incise", {"take": {"too": "burr"}})", "steps[1].take.too");
  refused(R"("fly")", "steps[0]");
  refused(R"({"wait": {"seconds": -1}})", "steps[0].wait.seconds");
  refused(R"({"drill": {}})", "steps[0].drill: at");
  refused(R"({"insert": {"toward": {"at": "nowhere"}}})", "steps[0].insert: at");
}

TEST(LessonsRubric, IsReadAsItWasCompiledAndNotAsItWasChanged) {
  const std::string json = lesson::compile_rubric(AnyParams::make(Head::rubric()));
  EXPECT_EQ(lesson::compile_rubric(lesson::read_rubric(json, lessons::rubric_types()).rubric), json);
  const auto refused = [](std::string text, const std::string& from, const std::string& to, const std::string& field) {
    text.replace(text.find(from), from.size(), to);
    try {
      lesson::read_rubric(text, lessons::rubric_types());
      ADD_FAILURE() << to;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      EXPECT_EQ(e.field(), field);
    }
  };
  refused(json, "\"limit\": 300.0", "\"limit\": 310.0", "sha256");
  refused(json, "\"limit\": 300.0", "\"limit\": 310.0,\n\"limit\": 300.0", "limit");
  refused(json, "\"limit\": 300.0", "\"limit\": 700.0", "rubric.time.good_s.limit");
  refused(json, "\"trephine_rubric\": 2", "\"trephine_rubric\": 3", "trephine_rubric");
  refused(json, "\"ideal_s\"", "\"idle_s\"", "rubric.time.idle_s");
  refused(json, "{", "[", "json");
}

TEST(Lessons, ARecordingThatNoSessionMadeIsNotFollowed) {
  const Head::Done d = drilled().run(R"({"take": {"tool": "catheter"}}, "finish")");
  const auto refused = [&](auto&& damage) -> std::string {
    haptics::Recording r = d.recording;
    damage(r);
    drilled().felt().loaded.haptic = drilled().whole();
    try {
      lessons::facts_of_recording(drilled().felt(), "test", r);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_input);
      return e.field();
    }
    return "followed";
  };
  EXPECT_EQ(refused([](haptics::Recording&) {}), "followed");
  EXPECT_EQ(refused([](haptics::Recording& r) { r.header.tools.clear(); }), "lesson.tools");
  EXPECT_EQ(refused([](haptics::Recording& r) { r.frames[5].touched = 4000; }), "frames");
  EXPECT_EQ(refused([](haptics::Recording& r) { r.frames[5].touched = -1; }), "frames");
  EXPECT_EQ(refused([](haptics::Recording& r) { r.frames[5].tip_mm[1] = std::nan(""); }), "frames");
  EXPECT_EQ(refused([](haptics::Recording& r) { r.frames[5].dt_s = 0; }), "frames");
}

TEST(Lessons, ARecordingShowsItsIncisionWhereTheMarkerWas) {
  const Head::Done d = whole().run(std::string(perfect_marks) + R"(, "finish")");
  session::IncisionWatch watch(d.recording.header);
  std::vector<session::IncisionMark> seen;
  for (const haptics::ServoFrame& f : d.recording.frames) watch.look(f, seen);
  ASSERT_EQ(seen.size(), 1u);
  ASSERT_EQ(d.facts.incisions.size(), 1u);
  EXPECT_EQ(norm(seen[0].point_mm - d.facts.incisions[0].at_mm), 0);
}
