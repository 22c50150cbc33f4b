// SPDX-License-Identifier: GPL-3.0-or-later
// Zones that a case holds take the place of the rubric's distances from landmarks.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "lessons_head.h"
#include "meshing_box.h"

using namespace lesson_cases;

namespace {

// The case's score where one of its anatomies is this box.
lessons::LessonScore with_zone(Head& head, const Head::Done& d, const std::string& name, const surface::TriMesh& box) {
  cases::LoadedCase loaded = head.felt().loaded;
  cases::CaseAnatomy anatomy;
  anatomy.name = name;
  loaded.manifest.anatomies.push_back(anatomy);
  loaded.surfaces.push_back(box);
  const lessons::CriticalZones zones(loaded);
  EXPECT_TRUE(zones.has(name));
  return lessons::score_ventriculostomy(d.facts, loaded.manifest, head.whole(), Head::rubric(), zones);
}

std::string trajectory(const lessons::LessonScore& score) {
  for (const lessons::ScoreRow& row : score.rows)
    if (row.name == "trajectory") return std::to_string(row.score.value_or(0)) + " " + row.why.english();
  return "";
}

Head::Done insert(Head& head, double x, double y, double z, double short_of_mm) {
  return head.run(fmt::format(
      R"({{"take": {{"tool": "catheter"}}}}, {{"insert": {{"toward": {{"at": "monro_right", "offset_mm": [{}, {}, {}]}},
          "short_of_mm": {}, "speed_mm_per_s": 40}}}}, "finish")",
      x, y, z, short_of_mm));
}

surface::TriMesh around(Vec3 middle, double half_mm) {
  return shapes::box(middle - Vec3{half_mm, half_mm, half_mm}, Vec3{2 * half_mm, 2 * half_mm, 2 * half_mm}, 2);
}

}  // namespace

TEST(LessonsZones, AZoneOfTheCaseDecides) {
  Head head(Kind::drilled);
  const Head::Done good = insert(head, 0, 0, 0, 4);
  ASSERT_EQ(good.points("trajectory"), 5) << good.row("trajectory").why;
  // A zone beside the way changes nothing; one on it is passed through.
  EXPECT_EQ(trajectory(with_zone(head, good, "brainstem", around({40, 40, 0}, 5))).substr(0, 1), "5");
  const Vec3 tip = good.last_tip();
  EXPECT_EQ(trajectory(with_zone(head, good, "brainstem", around(tip, 2))).substr(0, 1), "1");
  EXPECT_NE(trajectory(with_zone(head, good, "sagittal_sinus", around(good.facts.passes.back().entry_mm, 2)))
                .find("sagittal sinus"),
            std::string::npos);
  EXPECT_EQ(trajectory(with_zone(head, good, "third_ventricle", around(tip, 2))).substr(0, 1), "5")
      << "the tip is at the foramen, to which it was to go";

  // What the rubric's distances call third ventricle is none where the case says that it lies elsewhere.
  const Head::Done low = insert(head, 1.5, 2, -12, 0);
  ASSERT_EQ(low.row("trajectory").why, "passes through the third ventricle");
  EXPECT_EQ(trajectory(with_zone(head, low, "third_ventricle", around(low.last_tip(), 2))).substr(0, 1), "1")
      << "the tip is in liquor";
  const std::string now = trajectory(with_zone(head, low, "third_ventricle", around({0, 40, -40}, 3)));
  EXPECT_EQ(now.find("third ventricle"), std::string::npos) << now;
  EXPECT_NE(now.substr(0, 1), "1") << now;
}
