// SPDX-License-Identifier: GPL-3.0-or-later
// Subclavian lines in a chest of known lengths: perfect and wrong ones, through the servo.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "lessons/score_report.h"
#include "lessons_chest.h"

using namespace lessons_chest;

namespace {

Chest& chest() {
  static Chest one(false);
  return one;
}
Chest& with_artery() {
  static Chest one(true);
  return one;
}

// The notch lies at (0, -35, 10), the vein's point at (-41, -15, 2): beside it, below the clavicle, on the line to the
// notch.
const char* const way = R"({"puncture": {"from": {"at": "vein_right", "offset_mm": [-30, 0, -6], "on_skin": true},
                                        "toward": {"at": "vein_right"})";
// The hand aims beyond the place, for tissue holds the needle back by some millimetres.
std::string puncture(const std::string& more = ", \"short_of_mm\": -4") { return std::string(way) + more + "}}"; }
std::string to(const std::string& offset, const std::string& more = "") {
  return R"({"puncture": {"from": {"at": "vein_right", "offset_mm": [-30, 0, -6], "on_skin": true},
             "toward": {"at": "vein_right", "offset_mm": )" +
         offset + "}" + more + "}}";
}
lessons::NeedleColour colour(const Chest::Done& d) { return lessons::needle_colour(d.facts, Chest::rubric()); }

}  // namespace

TEST(LessonsSubclavian, APerfectOneScoresFiveAndIsGreen) {
  for (Chest* c : {&chest(), &with_artery()}) {
    const Chest::Done d = c->run(puncture() + R"(, "aspirate", "finish")");
    for (const lessons::ScoreRow& row : d.score.rows)
      if (row.name == "artery" && c == &chest())
        EXPECT_FALSE(row.score) << "an artery that the case does not have is judged";
      else
        EXPECT_EQ(row.score.value_or(0), 5) << row.name << ": " << row.why;
    EXPECT_EQ(colour(d), lessons::NeedleColour::green);
    EXPECT_TRUE(d.score.flag("first_pass"));
    // By the phantom's lengths: the lower border is at z = 4, the puncture at vein_z - 6.
    EXPECT_NEAR(d.row("puncture").measured[0].second, clavicle_z - clavicle_r - (vein_z - 6), 2);
    EXPECT_LT(d.row("direction").measured[0].second, 4);
    ASSERT_EQ(d.facts.passes.size(), 1u);
    EXPECT_LT(std::abs(d.facts.passes[0].entry_mm.y - front_y), 1.5);
  }
}

TEST(LessonsSubclavian, ASilentDeviceMakesNoSecondPass) {
  const Chest::Done d = chest().run(puncture() + R"(, "aspirate", "finish")");
  EXPECT_EQ(chest().facts_with_silence<lessons::SubclavianFacts>(d.recording, d.facts.fastest_s - 0.1).passes.size(),
            1u);
}

TEST(LessonsSubclavian, ScoredAgainItIsTheSameAndItReplaysBitForBit) {
  Chest::Done d = chest().run(puncture() + R"(, "aspirate", "finish")");
  const auto json = [](const Chest::Done& x) {
    return lessons::score_json({"chest", "subclavian", "p1", "a", "b", "c"}, x.facts, x.score);
  };
  const std::string before = json(d);
  chest().score(d);
  EXPECT_EQ(json(d), before);
  contact::ContactVolume contact(chest().felt().loaded.haptic, d.recording.header.contact);
  session::Rerun rerun(chest().felt(), contact, "test", d.recording.header);
  const std::vector<haptics::ServoFrame> again = rerun.run(d.recording.frames);
  ASSERT_EQ(again.size(), d.recording.frames.size());
  for (std::size_t n = 0; n < again.size(); ++n) ASSERT_TRUE(haptics::same_frame(again[n], d.recording.frames[n])) << n;
}

std::string syringe(const Chest::Done& d) {
  for (const lessons::LessonStatus& s : lessons::lesson_type("subclavian").status(d.facts))
    if (s.name == "syringe") return s.value;
  return "";
}

TEST(LessonsSubclavian, BloodComesFromTheVeinAlone) {
  // Stopped before the vein: nothing is drawn.
  const Chest::Done before = chest().run(puncture(R"(, "short_of_mm": 18)") + R"(, "aspirate", "finish")");
  EXPECT_EQ(before.points("vein"), 1);
  EXPECT_EQ(syringe(before), "none");
  EXPECT_EQ(colour(before), lessons::NeedleColour::red);
  // In it, and nobody draws.
  const Chest::Done dry = chest().run(puncture() + R"(, "finish")");
  EXPECT_EQ(dry.points("vein"), 3);
  EXPECT_EQ(syringe(dry), "-");
  EXPECT_EQ(colour(dry), lessons::NeedleColour::red);
  // Drawn, and then the needle leaves.
  const Chest::Done left = chest().run(puncture() + R"(, "aspirate", "withdraw", "finish")");
  EXPECT_EQ(left.points("vein"), 2);
  EXPECT_EQ(syringe(left), "none");
  EXPECT_EQ(colour(left), lessons::NeedleColour::red);
}

TEST(LessonsSubclavian, WhatMustNotBeEnteredIsSeen) {
  const Chest::Done pleura = chest().run(to("[-14, 29, -22]", ", \"short_of_mm\": -6") + R"(, "aspirate", "finish")");
  EXPECT_EQ(pleura.points("lung"), 1) << pleura.row("lung").why;
  EXPECT_EQ(colour(pleura), lessons::NeedleColour::red);
  EXPECT_TRUE(pleura.facts.pleura_s >= 0 || pleura.facts.lung_s >= 0);  // it may pop through a zone of 2 mm
  EXPECT_EQ(syringe(pleura), "air");
  // Through the vein into the artery behind it, and back into the vein: green never comes again.
  const Chest::Done artery = with_artery().run(to("[0, 18, 2]", ", \"short_of_mm\": -6") +
                                               R"(, "aspirate", {"withdraw": {"by_mm": 22}}, "aspirate", "finish")");
  EXPECT_EQ(artery.points("artery"), 1) << artery.row("artery").why;
  EXPECT_EQ(artery.points("lung"), 5);
  EXPECT_EQ(colour(artery), lessons::NeedleColour::red);
  EXPECT_FALSE(artery.score.flag("success"));
  EXPECT_EQ(syringe(artery), "blood") << "drawn from the vein at last";
  EXPECT_EQ(syringe(with_artery().run(to("[0, 18, 2]", ", \"short_of_mm\": -6") + R"(, "aspirate", "finish")")),
            "bright blood");
}

// What examples/lessons/subclavian_lung.json is shipped for.
TEST(LessonsSubclavian, TheShippedScriptEntersTheLungAndFails) {
  std::ifstream file(std::string(TREPHINE_SOURCE_DIR) + "/examples/lessons/subclavian_lung.json");
  const nlohmann::json script = nlohmann::json::parse(file);
  std::string steps;
  for (const nlohmann::json& step : script.at("steps")) steps += (steps.empty() ? "" : ", ") + step.dump();
  const Chest::Done d = chest().run(steps);
  EXPECT_EQ(d.score.outcome(), lessons::LessonOutcome::failed);
  EXPECT_TRUE(::lesson_cases::failed_by(d.score, "pleura_or_lung")) << d.score.reason();
  EXPECT_GE(d.facts.lung_s, 0) << "it ended in the pleura";
  EXPECT_LE(lessons::sum_of(d.score).points, 15);
}

TEST(LessonsSubclavian, ALungThatTheCaseDoesNotShowIsNotJudged) {
  const Chest::Done d = chest().run(puncture() + R"(, "aspirate", "finish")");
  // The right one is soft tissue, as where it holds no air.
  voxel::HapticVolume volume = volume_of(false);
  const int width = volume.voxels.size[0];
  for (std::size_t n = 0; n < volume.voxels.voxels.size(); ++n)
    if (std::int16_t& v = volume.voxels.voxels[n];
        int(n % std::size_t(width)) < width / 2 && (v / 1000 == 3 || v / 1000 == 4))
      v = 5255;
  const lessons::LessonScore score =
      lessons::score_subclavian(d.facts, chest().felt().loaded.manifest, volume, Chest::rubric());
  EXPECT_FALSE(score.rows[4].score) << score.rows[4].name << ": " << score.rows[4].why;
  EXPECT_EQ(d.points("lung"), 5);
}

TEST(LessonsSubclavian, PunctureAndDirectionHaveTheirLimits) {
  const auto from = [](const char* offset) {
    return std::string(R"({"puncture": {"from": {"at": "vein_right", "offset_mm": )") + offset +
           R"(, "on_skin": true}, "toward": {"at": "vein_right"}, "short_of_mm": -4}}, "aspirate", "finish")";
  };
  // On both sides of each limit: the border is about 3 mm above the vein's point, and the skin slides along by some.
  EXPECT_EQ(chest().run(from("[-30, 0, -18]")).points("puncture"), 5);
  EXPECT_EQ(chest().run(from("[-30, 0, -23]")).points("puncture"), 3);
  EXPECT_EQ(chest().run(from("[-30, 0, -40]")).points("puncture"), 3);
  EXPECT_EQ(chest().run(from("[-30, 0, -48]")).points("puncture"), 2);
  EXPECT_EQ(chest().run(from("[-30, 0, 22]")).points("puncture"), 1);
  // Towards the shoulder instead of the notch.
  EXPECT_EQ(chest().run(from("[25, 0, -8]")).points("direction"), 1);
  // From straight below, the needle goes up instead of to the middle.
  EXPECT_EQ(chest().run(from("[0, 0, -30]")).points("direction"), 2);
}

TEST(LessonsSubclavian, PassesAndTimeHaveTheirLimits) {
  std::string steps;
  for (int n = 1; n <= 4; ++n) {
    const Chest::Done d = chest().run(steps + puncture() + R"(, "aspirate", "finish")");
    EXPECT_EQ(int(d.facts.passes.size()), n);
    EXPECT_EQ(d.points("passes"), n == 4 ? 1 : 6 - n);
    EXPECT_EQ(colour(d), n == 4 ? lessons::NeedleColour::red : lessons::NeedleColour::green);
    steps += puncture(R"(, "short_of_mm": 15)") + ", \"withdraw\", ";
  }
  for (const auto& [wait_s, score] : {std::pair<int, int>{125, 4}, {250, 3}, {370, 2}, {610, 1}}) {
    const Chest::Done d = chest().run(
        R"({"wait": {"seconds": )" + std::to_string(wait_s) + "}}, " + puncture() + R"(, "aspirate", "finish")", 100);
    EXPECT_EQ(d.points("time"), score) << wait_s;
    EXPECT_EQ(colour(d), score == 1 ? lessons::NeedleColour::red : lessons::NeedleColour::green);
  }
}

TEST(LessonsSubclavianHostile, AnHoursPauseCountsNothingAndALostDeviceKeepsWhatWasDone) {
  const Chest::Done paused = chest().run(
      R"("pause", {"wait": {"seconds": 3600}}, "aspirate", "resume", )" + puncture() + R"(, "aspirate", "finish")",
      100);
  EXPECT_EQ(paused.facts.pauses, 1);
  EXPECT_NEAR(paused.facts.paused_s, 3600, 2);
  EXPECT_EQ(paused.facts.aspirations.size(), 1u);  // in the pause nothing is drawn
  EXPECT_EQ(paused.points("time"), 5);
  EXPECT_EQ(paused.points("vein"), 5);
  EXPECT_EQ(colour(paused), lessons::NeedleColour::green);

  const Chest::Done lost = chest().run(puncture() + R"(, "aspirate", "lose_device", "finish")");
  EXPECT_EQ(lost.facts.end, lessons::LessonEnd::device_lost);
  EXPECT_EQ(lost.points("time"), 1);
  EXPECT_EQ(lost.facts.passes.size(), 1u);
  EXPECT_EQ(lost.facts.aspirations.size(), 1u);
  EXPECT_EQ(lost.points("artery"), chest().run(puncture() + R"(, "aspirate", "finish")").points("artery"));
}

TEST(LessonsSubclavian, WhatIsNoChestIsRefused) {
  cases::CaseManifest m = chest_case(false).manifest;
  m.haptic.shapes[1].name = "tube";
  EXPECT_THROW(lessons::chest_shapes_of(m), Error);
  voxel::HapticVolume one = volume_of(false);
  for (std::int16_t& v : one.voxels.voxels)
    if (v / 1000 == 1) v = 5255;
  EXPECT_THROW(lessons::chest_frame_of(one, lessons::chest_shapes_of(chest_case(false).manifest)), Error);
}
