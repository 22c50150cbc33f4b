// SPDX-License-Identifier: GPL-3.0-or-later
// What a participant is told to do otherwise: errors that are known exactly, in each direction and on both sides.
#include <cmath>

#include "lessons/spine/spine_advice.h"
#include "lessons_chest.h"
#include "lessons_head_facts.h"
#include "lessons_spine_facts.h"

using namespace lesson_cases;
using lessons::BodyAxes;
using lessons::NamedPart;
using texts::Language;

namespace {

// The sentence of that row; empty where there is none.
std::string told(const lessons::LessonScore& s, const std::string& row, Language language = Language::english) {
  for (const lessons::Advice& a : s.advice)
    if (a.row == row) return a.of(language);
  return "";
}
bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

lessons::LessonScore head_score(bool left, Vec3 tip_off, double beyond_mm = 0, Vec3 hole_off = {}) {
  lessons::VentriculostomyFacts f = perfect_head(left);
  f.hole->out = normalized(f.hole->out * outer_mm + hole_off);
  f.hole->outer_mm = f.hole->out * outer_mm;
  f.hole->inner_mm = f.hole->out * inner_mm;
  pass_into(f, left, {tip_off, beyond_mm});
  return lessons::score_ventriculostomy(f, phantom_head().felt().loaded.manifest, phantom_head().whole(),
                                        Head::rubric());
}

lessons::LessonScore needle_score(const std::string& task, const SpineAim& aim) {
  lessons::SpineNeedleFacts f = spine_facts(task);
  pass_along(task, aim, f);
  return lessons::score_spine_needle(f, phantom_spine().felt().loaded.manifest, phantom_spine().whole(), shipped());
}

}  // namespace

TEST(LessonsAdvice, DirectionsAreOfTheSideThatIsTreated) {
  for (const bool left : {false, true}) {
    // A head that lies turned by 30 degrees about its length, and nods.
    const double c = std::cos(M_PI / 6), s = std::sin(M_PI / 6);
    const BodyAxes axes = lessons::body_axes(left, {c, s, 0}, {s, -c, 0.2});
    EXPECT_NEAR(dot(axes.lateral, axes.anterior), 0, 1e-12);
    EXPECT_NEAR(dot(axes.lateral, axes.cranial), 0, 1e-12);
    EXPECT_NEAR(norm(axes.cranial), 1, 1e-12);
    EXPECT_GT(axes.cranial.z, 0.9);
    const Vec3 outwards = Vec3{c, s, 0} * (left ? 1.0 : -1.0);
    const struct {
      Vec3 way;
      NamedPart::Name name;
    } six[] = {{outwards, NamedPart::lateral},       {-outwards, NamedPart::medial},
               {axes.anterior, NamedPart::anterior}, {-axes.anterior, NamedPart::posterior},
               {axes.cranial, NamedPart::cranial},   {-axes.cranial, NamedPart::caudal}};
    for (const auto& one : six) {
      const std::vector<NamedPart> parts = lessons::parts_of(axes, one.way * 9);
      ASSERT_EQ(parts.size(), 1u);
      EXPECT_EQ(parts[0].name, one.name);
      EXPECT_NEAR(parts[0].size, 9, 1e-9);
      EXPECT_EQ(lessons::opposite(parts)[0].name, NamedPart::Name(int(one.name) ^ 1));
    }
  }
}

TEST(LessonsAdvice, AcrossALineTheTwoPartsMakeTheWholeMiss) {
  const BodyAxes axes = lessons::body_axes(true, {1, 0, 0}, {0, -1, 0});
  const Vec3 line = normalized(Vec3{-0.3, 0.4, -1});
  const Vec3 across = normalized(cross(line, Vec3{0.2, 1, 0.4}));
  const Vec3 miss = normalized(across + cross(line, across)) * 12;  // a smaller part of less than a third is left out
  const std::vector<NamedPart> parts = lessons::parts_across(axes, line, miss, 0);
  double squares = 0;
  for (const NamedPart& p : parts) squares += p.size * p.size;
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_NEAR(squares, 144, 1e-9);
  // 10 mm after 100 mm are atan(0.1).
  EXPECT_NEAR(lessons::as_turns({{NamedPart::medial, 10}}, 100)[0].size, std::atan(0.1) * 180 / M_PI, 1e-12);
  EXPECT_EQ(lessons::more_words({{NamedPart::medial, 4.2}, {NamedPart::anterior, 1.4}}, lessons::PartUnit::degrees,
                                Language::english),
            "4 degrees more medially and 1 degree more anteriorly");
  EXPECT_EQ(lessons::place_words({{NamedPart::cranial, 9.4}, {NamedPart::lateral, 4}}, Language::german),
            "9 mm kranial und 4 mm lateral");
}

TEST(LessonsAdvice, ACatheterIsToldWhereToAim) {
  for (const bool left : {false, true}) {
    const double side = left ? 1 : -1;
    EXPECT_TRUE(head_score(left, {}).advice.empty()) << "nothing is to be done otherwise";
    const struct {
      Vec3 off;
      const char *english, *german, *place;
    } four[] = {{{12 * side, 0, 0}, "more medially", "weiter nach medial", "mm lateral"},
                {{-12 * side, 0, 0}, "more laterally", "weiter nach lateral", "mm medial"},
                {{0, -12, 0}, "more posteriorly", "weiter nach posterior", "mm anterior"},
                {{0, 12, 0}, "more anteriorly", "weiter nach anterior", "mm posterior"}};
    for (const auto& one : four) {
      const lessons::LessonScore score = head_score(left, one.off);
      const std::string said = told(score, "trajectory");
      EXPECT_TRUE(has(said, one.english)) << said;
      EXPECT_TRUE(has(said, one.place)) << said;
      EXPECT_TRUE(has(told(score, "trajectory", Language::german), one.german));
      EXPECT_TRUE(has(told(score, "tip"), one.english)) << told(score, "tip");
      EXPECT_EQ(told(score, "burr_hole"), "") << "the hole was right";
    }
    // The angle: between the line that was taken and the one to the foramen, from where the brain was entered.
    lessons::VentriculostomyFacts f = perfect_head(left);
    pass_into(f, left, {{12 * side, 0, 0}, 0});
    const Vec3 entry = f.passes[0].entry_mm, aim{left ? -foramen.x : foramen.x, foramen.y, foramen.z};
    const Vec3 went = normalized(f.passes[0].path.back().tip_mm - entry), should = normalized(aim - entry);
    const double degrees = std::acos(dot(went, should)) * 180 / M_PI;
    const std::string said = told(head_score(left, {12 * side, 0, 0}), "trajectory");
    EXPECT_EQ(said.find(fmt::format("Aim {:.0f} degrees more medially", degrees)), 0u) << said << degrees;
  }
}

TEST(LessonsAdvice, AHoleAndADepthAreToldInMillimetres) {
  for (const bool left : {false, true}) {
    const double side = left ? 1 : -1;
    const lessons::LessonScore lateral = head_score(left, {}, 0, {25 * side, 0, 0});
    EXPECT_TRUE(has(told(lateral, "burr_hole"), "more medially")) << told(lateral, "burr_hole");
    EXPECT_TRUE(has(told(lateral, "burr_hole", Language::german), "von Kochers Punkt"));
    const lessons::LessonScore anterior = head_score(left, {}, 0, {0, -25, -5});
    EXPECT_TRUE(has(told(anterior, "burr_hole"), "more posteriorly")) << told(anterior, "burr_hole");
    const lessons::LessonScore behind = head_score(left, {}, 0, {0, 20, 4});
    EXPECT_TRUE(has(told(behind, "burr_hole"), "more anteriorly")) << told(behind, "burr_hole");
    EXPECT_EQ(told(head_score(left, {}, -20), "depth").find("Push the catheter"), 0u);
    EXPECT_EQ(told(head_score(left, {}, 20), "depth").find("Stop "), 0u);
    EXPECT_EQ(told(head_score(left, {}, 20), "depth", Language::german).find("Halten Sie"), 0u);
  }
}

TEST(LessonsAdvice, ATurnOfLessThanADegreeIsNotSaid) {
  EXPECT_TRUE(lessons::as_turns({{NamedPart::medial, 1.5}}, 100).empty()) << "0.86 degrees";
  const std::vector<NamedPart> two = lessons::as_turns({{NamedPart::medial, 4}, {NamedPart::anterior, 1.5}}, 100);
  ASSERT_EQ(two.size(), 1u);
  EXPECT_EQ(two[0].name, NamedPart::medial);
}

// A hole on the midline in a lesson that asked for no side: medial and lateral are of neither.
TEST(LessonsAdvice, WhereTheSideIsNotKnownNoDirectionIsSaid) {
  for (const std::string task : {"", "right"}) {
    lessons::VentriculostomyFacts f = perfect_head(false);
    f.task = task;
    f.hole->outer_mm.x = f.hole->inner_mm.x = -1;
    pass_into(f, false, {{-14, 0, 0}, 20});
    for (lessons::PassPoint& p : f.passes[0].path) p.tip_mm.x -= 0.5;
    f.passes[0].entry_mm.x = -1;
    const lessons::LessonScore s = lessons::score_ventriculostomy(f, phantom_head().felt().loaded.manifest,
                                                                  phantom_head().whole(), Head::rubric());
    for (const char* row : {"burr_hole", "trajectory", "tip"})
      EXPECT_EQ(has(told(s, row), "medial") || has(told(s, row), "lateral"), task == "right" && s.lost(row))
          << task << " " << row << ": " << told(s, row);
    EXPECT_NE(told(s, "depth"), "") << "how deep it went is known all the same";
  }
}

TEST(LessonsAdvice, ElsewhereNoDirectionIsSaid) {
  lessons::VentriculostomyFacts f = perfect_head(true);
  pass_into(f, true, {});
  f.task = "right";
  EXPECT_TRUE(
      lessons::score_ventriculostomy(f, phantom_head().felt().loaded.manifest, phantom_head().whole(), Head::rubric())
          .advice.empty());
  lessons::SpineNeedleFacts needle = spine_facts("pedicle_2_left");
  pass_along("pedicle_2_right", {}, needle);
  EXPECT_TRUE(
      lessons::score_spine_needle(needle, phantom_spine().felt().loaded.manifest, phantom_spine().whole(), shipped())
          .advice.empty());
}

TEST(LessonsAdvice, LinesThatWereDrawnAreToldTheirSide) {
  for (const double off : {-7.0, 7.0}) {
    lessons::VentriculostomyFacts f = perfect_head(false);
    pass_into(f, false, {});
    for (Vec3& p : f.traces[0].points_mm) p.x += off;
    const lessons::LessonScore s = lessons::score_ventriculostomy(f, phantom_head().felt().loaded.manifest,
                                                                  phantom_head().whole(), Head::rubric());
    EXPECT_TRUE(has(told(s, "landmarks"),
                    off > 0 ? "7 mm farther to the patient's right" : "7 mm farther to the patient's left"))
        << told(s, "landmarks");
  }
}

TEST(LessonsAdvice, ANeedleIsToldEntryAimAndDepth) {
  for (const char* task : {"pedicle_2_left", "pedicle_2_right"}) {
    EXPECT_TRUE(needle_score(task, {}).advice.empty());
    const auto with = [&](double SpineAim::*member, double value) {
      SpineAim aim;
      aim.*member = value;
      return needle_score(task, aim);
    };
    EXPECT_TRUE(
        has(told(with(&SpineAim::aside_mm, 5), "entry"), "Enter 5 mm more medially: your line passed 5 mm lateral"));
    EXPECT_TRUE(
        has(told(with(&SpineAim::aside_mm, -5), "entry"), "Enter 5 mm more laterally: your line passed 5 mm medial"));
    EXPECT_TRUE(
        has(told(with(&SpineAim::up_mm, 5), "entry"), "Enter 5 mm more caudally: your line passed 5 mm cranial"));
    EXPECT_TRUE(
        has(told(with(&SpineAim::up_mm, -5), "entry"), "Enter 5 mm more cranially: your line passed 5 mm caudal"));
    EXPECT_TRUE(has(told(with(&SpineAim::up_mm, -5), "target"), "Keep the direction"));
    EXPECT_TRUE(has(told(with(&SpineAim::up_mm, -5), "entry", Language::german), "5 mm weiter nach kranial"));
    const lessons::CasePedicle& p = pedicle_named(task);
    const double turn = std::atan2(8, norm(p.target_mm - p.entry_mm)) * 180 / M_PI;
    const std::string outer = told(with(&SpineAim::turn_aside_mm, 8), "target");
    EXPECT_EQ(outer,
              fmt::format("Aim {:.0f} degrees more medially: your line passed 8 mm lateral of the target.", turn));
    EXPECT_TRUE(has(told(with(&SpineAim::turn_aside_mm, -8), "target"), "more laterally"));
    EXPECT_TRUE(has(told(with(&SpineAim::turn_up_mm, 8), "target"), "more caudally"));
    EXPECT_TRUE(has(told(with(&SpineAim::turn_up_mm, -8), "target"), "more cranially"));
    EXPECT_EQ(told(with(&SpineAim::beyond_mm, -10), "depth"), "Go 10 mm farther: the tip lay 10 mm before the target.");
    EXPECT_EQ(told(with(&SpineAim::beyond_mm, 10), "depth", Language::german),
              "Halten Sie 10 mm früher an: die Spitze lag 10 mm hinter dem Ziel.");
    EXPECT_TRUE(has(told(with(&SpineAim::turn_aside_mm, -9), "breach"), "Keep more laterally"));
  }
}

// A patient who lies on his side by 50 degrees and whose spine leans by 20 in the scanner: the directions are his own.
TEST(LessonsAdvice, APatientWhoLiesTurnedIsToldHisOwnDirections) {
  const auto turned = [](Vec3 p) {
    const double a = 50 * M_PI / 180, b = 20 * M_PI / 180;
    const Vec3 leaning{p.x, p.y * std::cos(b) - p.z * std::sin(b), p.y * std::sin(b) + p.z * std::cos(b)};
    return Vec3{leaning.x * std::cos(a) - leaning.y * std::sin(a), leaning.x * std::sin(a) + leaning.y * std::cos(a),
                leaning.z};
  };
  cases::CaseManifest m = phantom_spine().felt().loaded.manifest;
  for (cases::CaseLandmark& l : m.landmarks) l.position_mm = turned(l.position_mm);
  // One doubtful pedicle does not turn the axes of its vertebra: those of its neighbours take their place.
  for (cases::CaseLandmark& l : m.landmarks)
    if (l.name == "pedicle_1_right_entry") l.position_mm.z += 15, l.confidence = 0.2;
  lessons::LessonScore lost;
  for (const char* row : {"entry", "target", "axial", "sagittal"}) {
    lessons::ScoreRow r;
    r.name = row;
    r.score = 1;
    lost.rows.push_back(r);
  }
  for (const lessons::CasePedicle& p : lessons::pedicles_of(m)) {
    EXPECT_LT(norm(p.left - turned({1, 0, 0})), 0.02) << p.name;
    EXPECT_LT(norm(p.cranial - turned({0, 0, 1})), 0.02) << p.name;
    EXPECT_LT(norm(p.anterior() - turned({0, -1, 0})), 0.02) << p.name;
    const auto said = [&](Vec3 off, const std::string& row) {
      lessons::LessonScore s = lost;
      s.advice = lessons::pedicle_advice(s, lessons::needle_errors(p, p.target_mm + off, -p.forwards()));
      return told(s, row);
    };
    EXPECT_EQ(said(p.outer() * 6, "entry"),
              "Enter 6 mm more medially: your line passed 6 mm lateral of the ideal entry.");
    EXPECT_EQ(said(p.up() * -6, "entry"),
              "Enter 6 mm more cranially: your line passed 6 mm caudal of the ideal entry.");
    const lessons::NeedleErrors e = lessons::needle_errors(p, p.target_mm, -p.forwards());
    lessons::LessonScore s = lost;
    s.advice = lessons::five_errors_advice(s, e, turned({0, 0, 5}), p.on_left() ? 12 : -12, 0, true);
    EXPECT_TRUE(has(told(s, "entry"), "5 mm more caudally")) << told(s, "entry");
    EXPECT_TRUE(has(told(s, "axial"), "12 degrees more medially")) << told(s, "axial");
  }
}

TEST(LessonsAdvice, AScrewIsToldItsTwoPlanes) {
  for (const char* task : {"pedicle_2_left", "pedicle_2_right"}) {
    const auto score = [&](double aside, double up) {
      SpineAim aim{0, 0, aside, up, -2, "screw_5.5x45", 5.5, 45};
      lessons::SpineNeedleFacts f = spine_facts(task);
      pass_along(task, aim, f);
      return score_screw(f, phantom_spine().felt().loaded.manifest, phantom_spine().whole());
    };
    EXPECT_TRUE(has(told(score(12, 0), "axial"), "more medially")) << told(score(12, 0), "axial");
    EXPECT_TRUE(has(told(score(-12, 0), "axial"), "more laterally"));
    EXPECT_TRUE(has(told(score(0, 12), "sagittal"), "more caudally"));
    EXPECT_TRUE(has(told(score(0, -12), "sagittal", Language::german), "weiter nach kranial"));
    EXPECT_EQ(told(score(0, 0), "axial") + told(score(0, 0), "sagittal"), "");
  }
}

TEST(LessonsAdvice, ALineUnderTheClavicleIsToldPunctureAndDirection) {
  lessons_chest::Chest chest(false);
  const auto done = chest.run(
      R"({"puncture": {"from": {"at": "vein_right", "offset_mm": [-30, 0, -6], "on_skin": true},
          "toward": {"at": "vein_right"}, "short_of_mm": -4}}, "aspirate", "finish")");
  const auto score = [&](const std::function<void(lessons::VeinPass&)>& spoil) {
    lessons::SubclavianFacts f = done.facts;
    spoil(f.passes[0]);
    return lessons::score_subclavian(f, chest.felt().loaded.manifest, chest.whole(), lessons_chest::Chest::rubric());
  };
  const auto turned = [](double degrees) {
    return [degrees](lessons::VeinPass& p) {
      const Vec3 w = p.tip_mm - p.entry_mm;
      const double a = degrees * M_PI / 180;
      p.tip_mm = p.entry_mm + Vec3{w.x * std::cos(a) - w.z * std::sin(a), w.y, w.x * std::sin(a) + w.z * std::cos(a)};
    };
  };
  EXPECT_TRUE(score([](lessons::VeinPass&) {}).advice.empty());
  EXPECT_TRUE(has(told(score([](lessons::VeinPass& p) { p.entry_mm.z -= 40, p.tip_mm.z -= 40; }), "puncture"),
                  "more cranially"));
  EXPECT_TRUE(has(told(score([](lessons::VeinPass& p) { p.entry_mm.z += 30, p.tip_mm.z += 30; }), "puncture"),
                  "more caudally"));
  // On the right the needle goes to the left. Turned with the clock it points too low; turned against it, it is so
  // steep that it passes beside the notch.
  EXPECT_TRUE(has(told(score(turned(-40)), "direction"), "more cranially")) << told(score(turned(-40)), "direction");
  const std::string steep = told(score(turned(40)), "direction");
  EXPECT_TRUE(has(steep, "more medially")) << steep;
  EXPECT_TRUE(has(steep, "mm lateral of the sternal notch")) << steep;
  EXPECT_TRUE(has(told(score(turned(180)), "direction", Language::german), "sie zeigte von ihm weg"));
}

// The body's own directions and frontal plane, also of a patient who lies askew in the scanner.
TEST(LessonsAdvice, ALineIsMeasuredInTheBodysOwnFrontalPlane) {
  lessons_chest::Chest chest(false);
  const auto done = chest.run(
      R"({"puncture": {"from": {"at": "vein_right", "offset_mm": [-30, 0, -6], "on_skin": true},
          "toward": {"at": "vein_right", "offset_mm": [6, 0, -14]}, "short_of_mm": -4}}, "aspirate", "finish")");
  const double roll = 20 * M_PI / 180, tilt = 8 * M_PI / 180;
  const auto turn = [&](Vec3 p) {
    p = {p.x * std::cos(tilt) - p.z * std::sin(tilt), p.y, p.x * std::sin(tilt) + p.z * std::cos(tilt)};
    return Vec3{p.x * std::cos(roll) - p.y * std::sin(roll), p.x * std::sin(roll) + p.y * std::cos(roll), p.z};
  };
  voxel::HapticVolume askew = chest.whole();
  askew.voxels.origin_mm = turn(askew.voxels.origin_mm);
  askew.voxels.direction = {{turn({1, 0, 0}), turn({0, 1, 0}), turn({0, 0, 1})}};
  lessons::SubclavianFacts facts = done.facts;
  for (lessons::VeinPass& p : facts.passes) p.entry_mm = turn(p.entry_mm), p.tip_mm = turn(p.tip_mm);
  const auto& manifest = chest.felt().loaded.manifest;
  const auto rubric = lessons_chest::Chest::rubric();
  const auto straight = lessons::score_subclavian(done.facts, manifest, chest.whole(), rubric);
  const auto turned = lessons::score_subclavian(facts, manifest, askew, rubric);
  for (const char* row : {"puncture", "direction"}) {
    ASSERT_EQ(straight.row(row)->measured.size(), 1u);
    EXPECT_NEAR(turned.row(row)->measured[0].second, straight.row(row)->measured[0].second, 1.5) << row;
    EXPECT_EQ(turned.row(row)->score, straight.row(row)->score) << row;
  }
  ASSERT_LT(straight.row("direction")->score, 5);
  EXPECT_EQ(told(turned, "direction"), told(straight, "direction"));
}

// The last line of the table and the head of the page, which a lesson words itself.
TEST(LessonsAdvice, WhatALessonSaysOfItselfIsGermanToo) {
  const auto german = [](const std::string& module, const lessons::LessonFacts& facts,
                         const lessons::LessonScore& score) {
    const lessons::LessonType& type = lessons::lesson_type(module);
    for (const texts::Phrase& english : {type.outcome(facts, score), type.headline(facts, score)}) {
      const std::string said = lessons::lesson_words(Language::german, english);
      EXPECT_NE(said, english.english());
      for (const char* word : {"pass", "needle", "catheter lies", "bone", "success", "failure", "errors", "shots"})
        EXPECT_EQ(said.find(word), std::string::npos) << said;
    }
  };
  lessons::VentriculostomyFacts head = perfect_head(false);
  german("ventriculostomy", head,
         lessons::score_ventriculostomy(head, phantom_head().felt().loaded.manifest, phantom_head().whole(),
                                        Head::rubric()));
  pass_into(head, false, {});
  german("ventriculostomy", head,
         lessons::score_ventriculostomy(head, phantom_head().felt().loaded.manifest, phantom_head().whole(),
                                        Head::rubric()));
  const cases::CaseManifest& spine = phantom_spine().felt().loaded.manifest;
  lessons::SpineNeedleFacts needle = spine_facts("pedicle_2_left");
  german("spine_needle", needle, lessons::score_spine_needle(needle, spine, phantom_spine().whole(), shipped()));
  german("pedicle_screw", needle, score_screw(needle, spine, phantom_spine().whole()));
  pass_along("pedicle_2_left", {}, needle);
  german("spine_needle", needle, lessons::score_spine_needle(needle, spine, phantom_spine().whole(), shipped()));
}
