// SPDX-License-Identifier: GPL-3.0-or-later
// Each cell of Table XIII on both sides of each limit, by sessions through the real servo. What a session should score
// is computed from its frames and the phantom's own lengths, not by the program's measures.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <map>

#include "lessons_head.h"

using namespace lesson_cases;

namespace {

Head& drilled() {
  static Head head(Kind::drilled);
  return head;
}
Head& whole() {
  static Head head(Kind::whole);
  return head;
}

// How near to each limit, on both sides, sessions came; and that each scored as it should.
class Cells {
 public:
  Cells(std::vector<double> limits, double nearest) : limits_(std::move(limits)), nearest_(nearest) {}
  void saw(int score) { scores_[score]++; }
  void near(double figure) {
    for (const double limit : limits_) {
      double& gap = (figure <= limit ? below_ : above_).emplace(limit, 1e9).first->second;
      gap = std::min(gap, std::abs(figure - limit));
    }
  }
  void check(const std::vector<int>& scores) {
    for (const double limit : limits_) {
      EXPECT_LE(below_.emplace(limit, 1e9).first->second, nearest_) << "no session below " << limit;
      EXPECT_LE(above_.emplace(limit, 1e9).first->second, nearest_) << "no session above " << limit;
    }
    for (const int s : scores) EXPECT_GT(scores_[s], 0) << "no session scored " << s;
  }

 private:
  std::vector<double> limits_;
  double nearest_;
  std::map<double, double> below_, above_;
  std::map<int, int> scores_;
};

Head::Done insert(double x, double y, double z, double short_of_mm, const char* extra = "") {
  return drilled().run(fmt::format(R"({{"take": {{"tool": "catheter"}}}},
    {{"insert": {{"toward": {{"at": "monro_right", "offset_mm": [{}, {}, {}]}}, "short_of_mm": {}, "speed_mm_per_s": 40}}}},
    {} "finish")",
                                   x, y, z, short_of_mm, extra));
}

int expected_depth(double mm) {
  if (mm < 30 || mm > 90) return 1;
  if (mm < 40 || mm > 70) return 2;
  return mm < 50 || mm > 60 ? 3 : 5;
}

}  // namespace

TEST(LessonsCells, DepthOfTheCatheter) {
  Cells cells({30, 40, 50, 60, 70, 90}, 2.2);
  // The table where the catheter's line crosses it, by the line's two ends alone.
  const auto crossing = [](Vec3 from, Vec3 to, double radius) {
    double low = 0, high = 1;
    for (int n = 0; n < 60; ++n) {
      const double middle = 0.5 * (low + high);
      (norm(from + (to - from) * middle) > radius ? low : high) = middle;
    }
    return from + (to - from) * low;
  };
  // Beside the ventricles, whose walls hold a catheter back.
  const Vec3 hole = normalized(kocher()) * outer_mm, end = foramen + Vec3{-26, 0, 0};
  const double whole_mm = norm(end - crossing(hole, end, inner_mm));
  for (const double limit : {30.0, 40.0, 50.0, 60.0, 70.0, 90.0})
    for (const double more : {-1.4, 1.4}) {
      const Head::Done d = insert(-26, 0, 0, whole_mm - limit - more);
      const Vec3 tip = d.last_tip();
      const double measured = norm(tip - crossing(hole, tip, inner_mm));
      EXPECT_NEAR(d.measured("depth", "depth_mm"), measured, 0.7) << limit;  // the table is no plane
      ASSERT_GT(std::abs(measured - limit), 0.7);
      EXPECT_EQ(d.points("depth"), expected_depth(measured)) << measured << " " << d.row("depth").why;
      cells.saw(d.points("depth"));
      cells.near(measured);
    }
  cells.check({1, 2, 3, 5});
}

TEST(LongLessonsCells, TheTipOfTheCatheter) {
  Cells cells({5, 10}, 0.8);
  std::map<std::string, int> seen;
  const auto check = [&](const Head::Done& d) {
    const Vec3 tip = d.last_tip();
    const double off = norm(tip - foramen), inside = in_ventricles(tip);
    const std::string why = d.row("tip").why.english();
    ++seen[why];
    const bool drains = d.points("tip") > 1;
    EXPECT_EQ(d.score.known("kakarla_grade"), drains || failed_by(d.score, "brainstem")) << why;
    if (drains) {
      EXPECT_EQ(d.score.count("kakarla_grade"), why == "in the contralateral ventricle" ? 2 : 1) << why;
    }
    EXPECT_EQ(d.score.flag("first_pass"), d.points("tip") >= 3 && why != "in the contralateral ventricle") << why;
    cells.saw(d.points("tip"));
    if (std::abs(off - 5) < 0.05 || std::abs(off - 10) < 0.05) return;  // on a limit: the score may round either way
    if (inside > 0.7) {                                                 // beyond doubt of a voxel
      const bool third = std::abs(tip.x) <= 4 && tip.z < foramen.z - 4;
      const int expected = third ? 2 : tip.x > 0 ? 3 : off <= 5 ? 5 : off <= 10 ? 4 : 3;
      EXPECT_EQ(d.points("tip"), expected) << tip.x << " " << tip.y << " " << tip.z << " " << why;
      if (!third && tip.x < 0) cells.near(off);
    } else if (inside < -0.7) {
      EXPECT_EQ(d.points("tip"), 1) << why << inside;  // Table XIII: not positioned in ventricle
    }
  };
  for (const double along : {0.0, 2.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 7.0, 8.0, 9.0, 9.5, 10.0, 10.5, 11.0, 13.0})
    check(insert(-0.55 * along, -0.25 * along, 0.8 * along, 0));
  check(insert(12, -3, 6, 0));   // contralateral
  check(insert(0, 0, 0, 30));    // not yet there
  check(insert(-25, 0, 0, 0));   // beside
  check(insert(3.5, 2, -9, 0));  // third ventricle
  for (const double lateral : {10.0, 12.0, 14.0, 16.0, 17.0}) check(insert(-lateral, -2, 2, 0));
  cells.check({1, 2, 3, 4, 5});
  EXPECT_GT(seen["in the contralateral ventricle"], 0);
  EXPECT_GT(seen["in the ipsilateral ventricle"], 0);
  EXPECT_GT(seen["not in the ventricle"], 0);
  EXPECT_GT(seen["in the third ventricle"], 0);
}

TEST(LongLessonsCells, TheTrajectoryOfTheCatheter) {
  Cells cells({5, 10, 20}, 1.6);
  std::map<std::string, int> seen;
  const auto check = [&](const Head::Done& d) {
    ++seen[d.row("trajectory").why.english()];
    cells.saw(d.points("trajectory"));
    // Of the whole way, by the frames: how far beyond the midline, and how near to the third ventricle.
    double across = -1e9;
    bool third = false, stem = false, in = false;
    Vec3 entry, tip = d.last_tip();
    for (const haptics::ServoFrame& f : d.recording.frames) {
      const Vec3 p{f.proxy_mm[0], f.proxy_mm[1], f.proxy_mm[2]};
      if (f.inside != 1 && f.inside != 2) continue;
      if (!in) entry = p;
      in = true;
      across = std::max(across, p.x);
      third = third || (f.inside == 1 && std::abs(p.x) <= 4 && p.z <= foramen.z - 3);
      stem = stem || (std::abs(p.x) <= 15 && p.z <= foramen.z - 25);
    }
    ASSERT_TRUE(in);
    if (std::abs(across - 1) < 0.1) return;
    if (across > 1 || third || stem) {
      EXPECT_EQ(d.points("trajectory"), 1) << d.row("trajectory").why;
      return;
    }
    const Vec3 way = normalized(tip - entry), miss = foramen - entry - way * dot(foramen - entry, way);
    const double off = norm(miss);
    EXPECT_NEAR(d.measured("trajectory", "line_off_foramen_mm"), off, 0.8);
    for (const double limit : {5.0, 10.0, 20.0})
      if (std::abs(off - limit) < 0.8) return;  // within what the two ways of measuring differ
    EXPECT_EQ(d.points("trajectory"), off <= 5 ? 5 : off <= 10 ? 4 : off <= 20 ? 3 : 2) << off;
    cells.near(off);
  };
  for (const double side : {0.0, 2.0, 4.0, 6.0, 6.5, 8.0, 9.0, 11.0, 12.0, 15.0, 18.5, 19.0, 21.0, 21.5, 22.0, 26.0})
    check(insert(-side, 0, 0, 12));
  check(insert(6, 0, 0, -4));     // over the midline
  check(insert(1.5, 2, -12, 0));  // third ventricle
  check(insert(-1, 2, -30, 0));   // brainstem
  cells.check({1, 2, 3, 4, 5});
  EXPECT_GT(seen["traverses the midline"], 0);
  EXPECT_GT(seen["passes through the third ventricle"], 0);
}

TEST(LongLessonsCells, TimeToComplete) {
  constexpr double rate_hz = 50;
  const auto lasting = [&](double wait_s) {
    return drilled().run(fmt::format(R"({{"take": {{"tool": "catheter"}}}}, {{"wait": {{"seconds": {}}}}},
           {{"insert": {{"toward": {{"at": "monro_right"}}, "short_of_mm": 1, "speed_mm_per_s": 60}}}}, "finish")",
                                     wait_s),
                         rate_hz);
  };
  const double rest = lasting(10).facts.procedure_s() - 10;
  int checked = 0;
  for (const auto& [seconds, below, at, above] :
       std::vector<std::tuple<double, int, int, int>>{{300, 5, 4, 4}, {450, 4, 3, 3}, {600, 3, 3, 2}, {900, 2, 2, 1}})
    for (const int tick : {-1, 0, 1}) {
      const Head::Done d = lasting(seconds - rest + tick / rate_hz);
      ASSERT_NEAR(d.facts.procedure_s(), seconds + tick / rate_hz, 1e-9);
      EXPECT_EQ(d.points("time"), tick < 0 ? below : tick == 0 ? at : above) << seconds << " " << tick;
      ++checked;
    }
  EXPECT_EQ(checked, 12);
}

TEST(LongLessonsCells, LandmarksByTraces) {
  // Largest distance of what was drawn, by the frames: from the midline, and from the suture along the vault.
  struct Drawn {
    double midline = 0, suture = 0;
  };
  const auto drawn = [](const Head::Done& d, double begin_s, double end_s) {
    Drawn most;
    for (const haptics::ServoFrame& f : d.recording.frames)
      if (f.time_s >= begin_s && f.time_s <= end_s && (f.buttons & 1) && f.touched) {
        most.midline = std::max(most.midline, std::abs(f.proxy_mm[0]));
        const Vec3 p{f.proxy_mm[0], f.proxy_mm[1], f.proxy_mm[2]}, up = normalized(bregma());
        const Vec3 front = normalized(towards(nasion_deg, 0) - up * dot(towards(nasion_deg, 0), up));
        most.suture = std::max(most.suture, std::abs(dot(p - bregma(), front)));
      }
    return most;
  };
  Cells midline({5, 10}, 1), suture({5, 10}, 1);
  for (const double side : {3.0, 4.0, 4.5, 7.0, 8.4, 8.8, 12.0})
    for (const double along : {112.0, 113.5, 114.5, 115.5, 116.5, 118.0, 119.0, 120.0, 121.0, 125.0}) {
      if (side != 3 && along != 125 && along != 112) continue;
      const Head::Done d = whole().run(fmt::format(
          R"({{"take": {{"tool": "marker"}}}},
          {{"trace": {{"from": {{"at": "nasion", "right_mm": {0}}}, "to": {{"at": "nasion", "along_mm": 100, "right_mm": {0}}}}}}},
          {{"trace": {{"from": {{"at": "nasion", "along_mm": {1}, "right_mm": 20}},
                      "to": {{"at": "nasion", "along_mm": {1}, "right_mm": -20}}}}}}, "finish")",
          side, along));
      ASSERT_EQ(d.facts.traces.size(), 2u);
      const auto of = [&](int n) { return drawn(d, d.facts.traces[n].begin_s, d.facts.traces[n].end_s); };
      const double a = of(0).midline, b = of(1).suture;
      const int found = (a <= 5) + (b <= 5), nearly = (a > 5 && a <= 10) + (b > 5 && b <= 10);
      const int expected = 1 + 2 * found + (nearly > 0);
      EXPECT_EQ(d.points("landmarks"), expected) << a << " " << b;
      midline.saw(d.points("landmarks"));
      midline.near(a);
      suture.near(b);
    }
  midline.check({1, 2, 3, 4, 5});
  suture.check({});
  // Too short for a midline; nothing drawn; in the air; the pedal up.
  EXPECT_EQ(whole()
                .run(R"({"take": {"tool": "marker"}}, {"trace": {"from": {"at": "nasion"}, "to": {"at": "nasion",
                           "along_mm": 75}}}, "finish")")
                .points("landmarks"),
            1);
  EXPECT_EQ(whole().run(R"({"take": {"tool": "marker"}}, "finish")").points("landmarks"), 1);
  EXPECT_EQ(whole()
                .run(R"({"take": {"tool": "catheter"}}, {"trace": {"from": {"at": "nasion"}, "to": {"at": "nasion",
                           "along_mm": 110}}}, "finish")")
                .points("landmarks"),
            1);
}

TEST(LongLessonsCells, PlaceOfTheBurrHole) {
  Cells off({10, 15, 30}, 2.6);
  std::map<std::string, int> seen;
  const auto check = [&](double along, double right) {
    const Head::Done d = whole().run(
        fmt::format(
            R"({{"take": {{"tool": "marker"}}}}, {{"trace": {{"from": {{"at": "nasion", "along_mm": {0}, "right_mm": {1}}},
           "to": {{"at": "nasion", "along_mm": {0}, "right_mm": {2}}}}}}}, "incise", {{"take": {{"tool": "burr"}}}},
           {{"drill": {{"past_mm": 2.5, "hole_diameter_mm": 11, "feed_force_n": 1.5, "speed_mm_per_s": 40}}}},
           "finish")",
            along, right > 0 ? right - 2 : right + 2, right),
        500, 1, 0, right > 0 ? "right" : "left");
    ASSERT_GE(d.facts.through_s, 0) << along << " " << right;
    ++seen[d.row("burr_hole").why.english()];
    off.saw(d.points("burr_hole"));
    // The middle of the hole on the bone as the script asked for it.
    const double angle = deg_of(along) + nasion_deg;
    const Vec3 at = towards(angle, deg_of(right)) * outer_mm;
    const Vec3 own = normalized(kocher(at.x > 0)) * outer_mm;
    const double away = norm(at - own), up_deg = nasion_deg + deg_of(125);
    const double before = dot(at - bregma(), towards(up_deg - 90, 0));
    EXPECT_NEAR(d.measured("burr_hole", "kocher_off_mm"), away, 2) << along << " " << right;
    EXPECT_NEAR(d.measured("burr_hole", "lateral_mm"), std::abs(at.x), 2);
    EXPECT_NEAR(d.measured("burr_hole", "before_suture_mm"), before, 2);
    const double own_before = dot(own - bregma(), towards(up_deg - 90, 0));
    const double lateral = std::abs(at.x) - std::abs(own.x), anterior = before - own_before;
    const int expected = std::abs(at.x) <= 10 || before < 0                                      ? 1
                         : away <= 10                                                            ? 5
                         : away <= 15                                                            ? 4
                         : std::max(lateral, anterior) <= 0 || std::min(lateral, anterior) < -10 ? 2
                         : away > 30                                                             ? 2
                                                                                                 : 3;
    EXPECT_EQ(d.points("burr_hole"), expected) << along << " " << right << " " << away << " " << d.row("burr_hole").why;
    if (std::abs(at.x) > 10 && before >= 0 && std::max(lateral, anterior) > 0) off.near(away);
  };
  // Lateral of Kocher's point, on either side of each limit.
  for (const double more : {0.0, 8.0, 12.5, 14.0, 18.0, 30.5, 34.5}) check(110, 27.5 + more);
  check(85, 27.5);    // too anterior
  check(114, 44);     // too lateral, and a little nearer to the suture
  check(123, 40);     // too lateral, and almost on the suture
  check(110, 8);      // along the midline
  check(110, -27.5);  // on the left
  check(132, 27.5);   // behind the suture
  off.check({1, 2, 3, 4, 5});
  for (const char* why : {"at Kocher's point", "near Kocher's point", "too lateral", "too anterior",
                          "far from Kocher's point", "nearer to midline or suture than Kocher's point",
                          "placed along the midline", "placed behind the coronal suture"})
    EXPECT_GT(seen[why], 0) << why;
}
