// SPDX-License-Identifier: GPL-3.0-or-later
// All that was done to the patient is judged, whenever it was done (docs/validation/lessons.md has the table).
#include "lessons_spoilt.h"

#include "lessons_chest.h"
#include "lessons_head.h"
#include "lessons_spine_run.h"

using namespace lesson_cases;

namespace {

// ---- The spine ----

std::string needle(const std::string& pedicle, const std::string& more = "") {
  return R"({"needle": {"pedicle": ")" + pedicle + "\"" + (more.empty() ? "" : ", " + more) + "}}, ";
}
std::string prick(const std::string& offset_mm, double short_of_mm, const std::string& toward = "") {
  return fmt::format(R"({{"insert": {{"from": {{"at": "pedicle_2_left_entry", "offset_mm": {0}}},
      "toward": {{"at": "pedicle_2_left_target", "offset_mm": {1}}}, "short_of_mm": {2}}}}}, )",
                     offset_mm, toward.empty() ? offset_mm : toward, short_of_mm);
}
const std::string shoot = R"({"shoot": {"seconds": 0.3}}, )", out = R"({"withdraw": {"by_mm": 160}}, )",
                  asked = "pedicle_2_left";

// What a tool may do in a spine that it should not, with a picture before each pass.
std::vector<Excess> spine_excesses() {
  const auto seen = [](const std::string& steps) { return shoot + steps + shoot + out; };
  const auto to = [&](const std::string& pedicle, const std::string& more = "") { return seen(needle(pedicle, more)); };
  const auto degrees = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all;
    for (const std::string& m : more) all.push_back(to(asked, m));
    return all;
  };
  return {{"the other side, to the target", {to("pedicle_2_right")}},
          {"another level, to the target", {to("pedicle_1_left"), to("pedicle_3_left")}},
          {"the skin of the other side pricked", {seen(prick("[-50, 0, 0]", 60)), seen(prick("[-50, 0, 0]", 50))}},
          {"past the vertebra through the flank, 20 mm short of the target and beside it",
           {seen(prick("[38, 0, 0]", 20)), seen(prick("[38, 0, 0]", 0))}},
          {"through the lateral wall", degrees({"\"entry_aside_mm\": 7, \"target_aside_mm\": 9",
                                                "\"entry_aside_mm\": 8, \"target_aside_mm\": 14"})},
          {"turned up through the upper wall",
           degrees({"\"target_up_mm\": 12, \"short_of_mm\": 5", "\"target_up_mm\": 22"})},
          {"towards the canal", degrees({"\"entry_aside_mm\": -4, \"target_aside_mm\": -14",
                                         "\"entry_aside_mm\": -4, \"target_aside_mm\": -22"})},
          {"through the front, and drawn back", degrees({"\"short_of_mm\": -25", "\"short_of_mm\": -40"})},
          {"too deep within bone, and drawn back",
           degrees({"\"short_of_mm\": -7", "\"short_of_mm\": -10", "\"short_of_mm\": -13"})},
          {"pushed in with 150, 300 and 400 mm/s",
           degrees({"\"speed_mm_per_s\": 150", "\"speed_mm_per_s\": 300", "\"speed_mm_per_s\": 400"})},
          {"1, 3 and 7 more passes", {to(asked), times(3, to(asked)), times(7, to(asked))}},
          {"1, 2 and 4 pricks that meet no bone",
           {seen(prick("[12, 0, 0]", 55)), times(2, seen(prick("[12, 0, 0]", 55))),
            times(4, seen(prick("[12, 0, 0]", 55)))}},
          {"8, 20 and 45 s more of X-rays",
           {R"({"shoot": {"seconds": 8}}, )", R"({"shoot": {"seconds": 20}}, )", R"({"shoot": {"seconds": 45}}, )"}}};
}

SpineCase& spine() {
  static SpineCase one;
  return one;
}
RightLesson right_needle() {
  const std::string half = shoot + needle(asked, "\"short_of_mm\": 20") + shoot;
  const std::string right = half + R"({"push": {"by_mm": 20}}, )" + shoot;
  return {"spine needle", spine().felt(), spine().whole(), "spine_needle", asked, AnyParams::make(shipped()), "", half,
          right,          right};
}
RightLesson right_screw() {
  const std::string finder =
      R"({"take": {"tool": "finder"}}, )" + shoot + needle(asked, "\"short_of_mm\": 5") + shoot + out;
  const std::string screw = R"({"take": {"tool": "screw_5.5x45"}}, )" + needle(asked) + shoot;
  return {
      "pedicle screw", spine().felt(), spine().whole(),    "pedicle_screw", asked, AnyParams::make(shipped_screw()), "",
      finder,          finder + screw, out + shoot + screw};
}

std::vector<Excess> needle_excesses() {
  std::vector<Excess> all = spine_excesses();
  all.push_back({"the whole way blind, one picture at the end, or none", {needle(asked) + shoot, needle(asked)}, true});
  return all;
}
std::vector<Excess> screw_excesses() {
  std::vector<Excess> all = spine_excesses();
  const RightLesson r = right_screw();
  const std::string taken = R"({"take": {"tool": "screw_5.5x45"}}, )";
  all.push_back({"no finder before the screw", {shoot + taken + needle(asked) + shoot}, true});
  all.push_back({"the finder by half of the way to the half",
                 {R"({"take": {"tool": "finder"}}, )" + shoot + needle(asked, "\"short_of_mm\": 34") + shoot + out +
                  taken + needle(asked) + shoot},
                 true});
  all.push_back({"the head 7 and 14 mm out of the bone",
                 {r.begun + taken + needle(asked, "\"short_of_mm\": 7") + shoot,
                  r.begun + taken + needle(asked, "\"short_of_mm\": 14") + shoot},
                 true});
  all.push_back({"finder and screw blind",
                 {R"({"take": {"tool": "finder"}}, )" + needle(asked) + out + taken + needle(asked) + shoot},
                 true});
  return all;
}

// ---- The chest ----

std::string puncture(const std::string& side, const std::string& offset_mm, double short_of_mm, double speed = 15) {
  return fmt::format(R"({{"puncture": {{"from": {{"at": "vein_{0}", "offset_mm": [{1}, 0, -6], "on_skin": true}},
      "toward": {{"at": "vein_{0}", "offset_mm": {2}}}, "short_of_mm": {3}, "speed_mm_per_s": {4}}}}}, )",
                     side, side == "right" ? -30 : 30, offset_mm, short_of_mm, speed);
}
std::vector<Excess> chest_excesses(bool artery) {
  const std::string o = "[0, 0, 0]", drawn = R"({"withdraw": {}}, )", draw = "\"aspirate\", ";
  const std::string pricked = puncture("right", o, 18) + drawn;
  std::vector<Excess> all = {
      {"8, 14 and 20 draws at the syringe",
       {pricked + times(8, draw), pricked + times(14, draw), pricked + times(20, draw)}},
      {"pushed in with 150, 300 and 450 mm/s",
       {puncture("right", o, -4, 150) + drawn, puncture("right", o, -4, 300) + drawn,
        puncture("right", o, -4, 450) + drawn}},
      {"1, 2 and 4 more pricks", {pricked, times(2, pricked), times(4, pricked)}},
      {"the other side pricked, and punctured", {puncture("left", o, 30) + drawn, puncture("left", o, -4) + drawn}},
      {"the pleura or the lung entered", {puncture("right", "[-14, 29, -22]", -6) + drawn}},
      {"through the vein, ever farther, and drawn back",
       {puncture("right", o, -16) + drawn, puncture("right", o, -20) + drawn, puncture("right", o, -26) + drawn}}};
  if (artery) all = {{"the artery entered", {puncture("right", "[0, 18, 2]", -8) + drawn}}};
  return all;
}
RightLesson right_line(lessons_chest::Chest& chest, const std::string& name) {
  const std::string right = puncture("right", "[0, 0, 0]", -4) + "\"aspirate\", ";
  return {name,
          chest.felt(),
          chest.whole(),
          "subclavian",
          "right",
          AnyParams::make(lessons_chest::Chest::rubric()),
          "",
          puncture("right", "[0, 0, 0]", 12),
          right,
          right};
}

// ---- The head ----

// From the middle of the bone under Kocher's point, where the hole is.
std::string insert(const std::string& offset_mm, double short_of_mm, double speed = 15) {
  const Vec3 in = -normalized(kocher()) * (skin_mm - outer_mm);
  return fmt::format(R"({{"take": {{"tool": "catheter"}}}}, {{"insert": {{"from": {{"at": "kocher_right",
      "offset_mm": [{}, {}, {}]}}, "toward": {{"at": "monro_right", "offset_mm": {}}}, "short_of_mm": {},
      "speed_mm_per_s": {}}}}}, )",
                     in.x, in.y, in.z, offset_mm, short_of_mm, speed);
}
std::vector<Excess> catheter_excesses() {
  const std::string o = "[0, 0, 0]", drawn = R"({"withdraw": {}}, )";
  return {{"8, 15 and 25 mm past the foramen, and drawn back",
           {insert(o, -8) + R"({"withdraw": {"by_mm": 9}}, )", insert(o, -15) + R"({"withdraw": {"by_mm": 16}}, )",
            insert(o, -25) + R"({"withdraw": {"by_mm": 26}}, )"}},
          {"pushed in with 150, 300 and 450 mm/s",
           {insert(o, 1, 150) + drawn, insert(o, 1, 300) + drawn, insert(o, 1, 450) + drawn}},
          {"1, 3 and 7 more passes",
           {insert(o, 1) + drawn, times(3, insert(o, 1) + drawn), times(7, insert(o, 1) + drawn)}},
          {"into the other side's ventricle, and drawn back", {insert("[14, 0, 3]", 0) + drawn}},
          {"beside the ventricle, and drawn back", {insert("[-25, 0, 0]", 1) + drawn}},
          {"60 mm past the foramen, to the brainstem, and drawn back", {insert(o, -60) + drawn}}};
}

std::string hole(const std::string& at, double past_mm = 3) {
  return fmt::format(R"({{"take": {{"tool": "burr"}}}}, {{"drill": {{"at": {}, "past_mm": {}, "feed_force_n": 1.5,
      "hole_diameter_mm": 12}}}}, )",
                     at, past_mm);
}
// The skin is cut there, by a mark.
std::string opened(const std::string& place) {
  return R"({"withdraw": {}}, {"take": {"tool": "marker"}}, {"trace": {"from": {"at": "bregma"}, "to": )" + place +
         "}}, \"incise\", ";
}
std::vector<Excess> hole_excesses() {
  const std::string own = R"({"at": "kocher_right"})", other = R"({"at": "kocher_left"})",
                    before = R"({"at": "nasion", "along_mm": 92, "right_mm": 27.5})",
                    behind = R"({"at": "nasion", "along_mm": 146, "right_mm": 27.5})",
                    beside = R"({"at": "nasion", "along_mm": 110, "right_mm": 41})";
  return {{"a hole on the other side, through", {opened(other) + hole(other, -3), opened(other) + hole(other)}},
          {"the same, taken back", {opened(other) + hole(other) + "\"undo\", "}},
          {"the skin of the other side cut", {opened(other)}},
          {"1, 3 and 5 more incisions",
           {opened(own), opened(own) + times(2, "\"incise\", "), opened(own) + times(4, "\"incise\", ")}},
          {"another hole, 18 mm in front", {opened(before) + hole(before)}},
          {"another hole, behind the suture", {opened(behind) + hole(behind)}},
          {"a pit beside, 13 mm away", {opened(beside) + hole(beside, -3)}}};
}
Head& whole_head() {
  static Head one(Kind::whole);
  return one;
}
RightLesson right_hole() {
  const std::string own = R"({"at": "kocher_right"})", catheter = R"({"withdraw": {}}, )" + insert("[0, 0, 0]", 1);
  return {"ventriculostomy",
          whole_head().felt(),
          whole_head().whole(),
          "ventriculostomy",
          "right",
          AnyParams::make(Head::rubric()),
          std::string(perfect_marks) + ", ",
          hole(own, -4),
          hole(own) + catheter,
          catheter};
}
RightLesson right_catheter() {
  static Head drilled(Kind::drilled);
  const std::string o = "[0, 0, 0]";
  return {"catheter", drilled.felt(), drilled.whole(), "ventriculostomy", "right", AnyParams::make(Head::rubric()),
          "",         insert(o, 30),  insert(o, 1),    insert(o, 1)};
}

lessons_chest::Chest& chest_of(bool artery) {
  static lessons_chest::Chest without(false), with(true);
  return artery ? with : without;
}

}  // namespace

TEST(LessonsSpoilt, Subclavian) {
  check_in_short(right_line(chest_of(false), "subclavian line"), chest_excesses(false));
  check_in_short(right_line(chest_of(true), "line beside an artery"), chest_excesses(true));
}
TEST(LessonsSpoilt, Catheter) { check_in_short(right_catheter(), catheter_excesses()); }
TEST(LessonsSpoilt, BurrHole) {
  const std::vector<Excess> all = hole_excesses();
  check_excess(right_hole(), all[0], {0}, 1);
  check_excess(right_hole(), all[6], {2}, 1);
}

TEST(LongLessonsSpoilt, SpineNeedle) { check_all(right_needle(), needle_excesses()); }
TEST(LongLessonsSpoilt, PedicleScrew) { check_all(right_screw(), screw_excesses()); }
TEST(LongLessonsSpoilt, Subclavian) {
  check_all(right_line(chest_of(false), "subclavian line"), chest_excesses(false));
  check_all(right_line(chest_of(true), "line beside an artery"), chest_excesses(true));
}
TEST(LongLessonsSpoilt, Catheter) { check_all(right_catheter(), catheter_excesses()); }
TEST(LongLessonsSpoilt, BurrHole) { check_all(right_hole(), hole_excesses()); }
