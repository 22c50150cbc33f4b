// SPDX-License-Identifier: GPL-3.0-or-later
// Burr holes against the analytic head's own Kocher points and shells whose answers are known.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/pi.h"
#include "boolean/burr_hole.h"
#include "boolean/cut_faces.h"
#include "boolean/outer_curve.h"
#include "phantom/truth.h"
#include "report_of.h"
#include "surface/ray_column.h"

namespace trephine {
namespace {

using At = boolean::BurrHoleRequest::At;
using Side = boolean::BurrHoleRequest::Side;
using Marks = std::map<std::string, Vec3>;

double degrees_between(Vec3 a, Vec3 b) {
  return std::acos(std::min(1.0, std::max(-1.0, dot(normalized(a), normalized(b))))) * 180 / pi;
}

/// A sphere as rings of points; turned inside out where `inwards`.
void add_sphere(surface::TriMesh& mesh, Vec3 centre, double radius, bool inwards, int rings = 96) {
  const auto first = static_cast<std::uint32_t>(mesh.points_mm.size());
  const int around = 2 * rings;
  const auto at = [&](int i, int j) -> std::uint32_t {
    if (i == 0) return first;
    if (i == rings) return first + 1;
    return first + 2 + static_cast<std::uint32_t>((i - 1) * around + j % around);
  };
  mesh.points_mm.push_back(centre + Vec3{0, 0, radius});
  mesh.points_mm.push_back(centre - Vec3{0, 0, radius});
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      const double a = pi * i / rings, b = 2 * pi * j / around;
      mesh.points_mm.push_back(centre +
                               Vec3{std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)} * radius);
    }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (inwards) std::swap(b, c);
    mesh.triangles.push_back({a, b, c});
  };
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < around; ++j) {
      if (i > 0) add(at(i, j), at(i + 1, j), at(i, j + 1));
      if (i + 1 < rings) add(at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
    }
}

/// Bone from 74 to 80 mm, skin at 86 mm, about (5, -7, 11).
struct Shell {
  Vec3 centre{5, -7, 11};
  surface::TriMesh skull, skin;
  Shell() {
    add_sphere(skull, {}, 80, false);
    add_sphere(skull, {}, 74, true);
    add_sphere(skin, {}, 86, false);
    skull.origin_mm = skin.origin_mm = centre;
  }
  Marks marks() const { return {{"nasion", centre + Vec3{0, -86, 0}}, {"inion", centre + Vec3{0, 86, 0}}}; }
};

std::string refused(const std::function<void()>& f, ExitCode code = ExitCode::quality) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(static_cast<int>(e.code()), static_cast<int>(code)) << e.what();
    EXPECT_NE(e.field().find("burr_holes."), std::string::npos) << e.field();
    return e.what();
  }
  ADD_FAILURE() << "not refused";
  return "";
}

TEST(RayColumn, SpansOfNestedSpheresAreExactAndGapsMerge) {
  const Shell s;
  const surface::detail::RayColumn column(s.skull, s.centre, {0, 0, -1}, 12);
  for (const auto& p : surface::detail::disc_samples(50, 8)) {
    const double r = 10 * std::hypot(p[0], p[1]);
    const auto spans = column.spans(10 * p[0], 10 * p[1], 0);
    ASSERT_EQ(spans.size(), 2u);
    EXPECT_NEAR(spans[0].enter, -std::sqrt(6400 - r * r), 0.06);
    EXPECT_NEAR(spans[0].leave, -std::sqrt(74.0 * 74 - r * r), 0.06);
    EXPECT_NEAR(spans[1].leave, std::sqrt(6400 - r * r), 0.06);
    EXPECT_EQ(column.spans(10 * p[0], 10 * p[1], 150).size(), 1u);
  }
}

TEST(OuterCurve, ArcsOnASphereAreExact) {
  const Shell s;
  const auto curve = boolean::detail::outer_curve(s.skin, {s.centre, {0, -1, 0}, {0, 0, 1}});
  for (const double length : {0.0, 1.0, 60.0, 110.0, 200.0}) {
    const auto p = surface::point_along(curve, length);
    ASSERT_TRUE(p);
    const double angle = length / 86;
    EXPECT_LT(norm(*p - s.centre - Vec3{0, -std::cos(angle), std::sin(angle)} * 86), 0.05) << length;
  }
  EXPECT_FALSE(surface::point_along(curve, 400));
}

TEST(BurrHole, OnAShellTheAxisIsRadialAndTheHoleEndsJustInside) {
  const Shell s;
  for (const Side side : {Side::left, Side::right}) {
    for (const double diameter : {1.0, 14.0, 40.0}) {
      boolean::BurrHoleRequest r;
      r.side = side;
      r.diameter_mm = diameter;
      Report report;
      const boolean::BurrHole hole = value_of(report, boolean::place_burr_hole(r, s.marks(), &s.skin, s.skull));
      // 110 mm along the great circle, then 27.5 mm along the one square to it.
      const double a = 110.0 / 86, b = 27.5 / 86, x = side == Side::left ? 1 : -1;
      const Vec3 up{0, -std::cos(a), std::sin(a)};
      const Vec3 expected = up * std::cos(b) + Vec3{x, 0, 0} * std::sin(b);
      EXPECT_LT(norm(hole.skin_mm - s.centre - expected * 86), 0.1);
      EXPECT_LT(norm(hole.position_mm - s.centre - expected * 80), 0.1);
      EXPECT_LT(degrees_between(hole.direction, -expected), 0.1);
      EXPECT_NEAR(hole.bone_thickness_mm, 6, 0.05);
      const double rr = diameter * diameter / 4;
      EXPECT_NEAR(hole.cutter.depth_mm, 80 - std::sqrt(74.0 * 74 - rr) + 1, 0.1) << diameter;
      EXPECT_GT(hole.cutter.above_mm, 6 + 1.9);
      EXPECT_LT(hole.cutter.above_mm, 6 + 2.2);
      EXPECT_EQ(*report.find("arcs_on"), ParameterValue(std::string("skin")));
      EXPECT_NEAR(std::get<double>(*report.find("axis_to_normal_deg")), 0, 0.1);
    }
  }
}

TEST(BurrHole, ByPositionTowardsATargetAndByDirection) {
  const Shell s;
  boolean::BurrHoleRequest r;
  r.at = At::position;
  r.position_mm = s.centre + Vec3{0, 0, 80};
  r.toward_mm = s.centre + Vec3{20, 10, 0};
  Report report;
  const boolean::BurrHole hole = value_of(report, boolean::place_burr_hole(r, {}, &s.skin, s.skull));
  // The axis passes through the target, and through the position.
  const Vec3 to_target = *r.toward_mm - hole.position_mm;
  EXPECT_LT(norm(to_target - hole.direction * dot(to_target, hole.direction)), 1e-6);
  EXPECT_LT(norm(hole.position_mm - r.position_mm), 0.05);
  EXPECT_NEAR(std::get<double>(*report.find("axis_to_normal_deg")), degrees_between({20, 10, -80}, {0, 0, -1}), 0.1);
  // Oblique: the rim's far side of the inner table is deeper than the axis', and the cutter reaches it.
  EXPECT_GT(hole.cutter.depth_mm, hole.bone_thickness_mm + 1 + 7 * std::tan(0.25));
  EXPECT_LT(hole.cutter.depth_mm, hole.bone_thickness_mm + 10);

  r.toward_mm.reset();
  r.direction = Vec3{0, 0, -1};
  r.position_mm = s.centre + Vec3{3, 4, 84};  // above the bone, within the skin
  const boolean::BurrHole straight = value_of(report, boolean::place_burr_hole(r, {}, nullptr, s.skull));
  EXPECT_NEAR(straight.position_mm.z - s.centre.z, std::sqrt(6400.0 - 25), 0.05);
  EXPECT_EQ(straight.direction, (Vec3{0, 0, -1}));
  EXPECT_EQ(straight.skin_mm, straight.position_mm);
  EXPECT_GE(straight.cutter.above_mm, 20);

  r.direction.reset();
  EXPECT_LT(
      degrees_between(value_of(report, boolean::place_burr_hole(r, {}, &s.skin, s.skull)).direction, Vec3{-3, -4, -84}),
      0.1);
}

TEST(BurrHole, CellsOfTheDiploeDoNotEndTheBoneWiderGapsDo) {
  for (const double gap : {2.0, 4.0}) {
    Shell s;
    surface::TriMesh skull;
    add_sphere(skull, {}, 80, false);
    add_sphere(skull, {}, 78, true);
    add_sphere(skull, {}, 78 - gap, false);
    add_sphere(skull, {}, 72, true);
    skull.origin_mm = s.centre;
    const boolean::BurrHole hole = boolean::place_burr_hole({}, s.marks(), &s.skin, skull).value;
    EXPECT_NEAR(hole.bone_thickness_mm, gap < 3 ? 8 : 2, 0.05);
  }
}

TEST(BurrHole, PitsAndKnobsOfTheOuterTableDoNotTiltTheAxis) {
  Shell s;
  // A deep foramen and a knob beside the place: a quarter of the hole.
  const Vec3 outwards = normalized(Vec3{-0.1, -0.2, 1}), beside = normalized(cross(outwards, Vec3{0, 1, 0}));
  const Vec3 at = outwards * 80 + beside * 5;
  for (auto& p : s.skull.points_mm) {
    if (norm(p) < 79) continue;
    if (norm(p - at) < 2.5) p = p * ((80 - 4) / 80.0);
    if (norm(p - (outwards * 80 + cross(outwards, beside) * 4)) < 2.5) p = p * ((80 + 3) / 80.0);
  }
  boolean::BurrHoleRequest r;
  r.at = At::position;
  r.position_mm = s.centre + outwards * 80;
  const boolean::BurrHole hole = boolean::place_burr_hole(r, {}, &s.skin, s.skull).value;
  EXPECT_LT(degrees_between(hole.direction, -outwards), 0.5);
  EXPECT_NEAR(hole.bone_thickness_mm, 6, 0.05);
}

TEST(BurrHole, RefusesNamingWhatIsMissingOrWrong) {
  const Shell s;
  const auto place = [&](const boolean::BurrHoleRequest& r, const Marks& marks) {
    return refused([&] { boolean::place_burr_hole(r, marks, &s.skin, s.skull); });
  };
  EXPECT_NE(place({}, {}).find("landmarks: {nasion: [x, y, z], inion: [x, y, z]}"), std::string::npos);
  EXPECT_NE(place({}, {{"nasion", {}}}).find("landmarks: {inion: [x, y, z]}"), std::string::npos);
  EXPECT_NE(place({}, {{"vertex", {}}}).find("needs nasion, which is not known"), std::string::npos);
  Marks off = s.marks();
  off["nasion"] = off["nasion"] + Vec3{0, -30, 0};
  EXPECT_NE(place({}, off).find("30.0 mm from the skin"), std::string::npos);

  boolean::BurrHoleRequest r;
  r.name = "left";
  r.at = At::position;
  r.position_mm = s.centre + Vec3{0, 0, 160};
  EXPECT_NE(place(r, {}).find("meets no skull"), std::string::npos);
  r.position_mm = s.centre + Vec3{0, 0, 80};
  r.direction = Vec3{0, 0, 1};
  EXPECT_NE(place(r, {}).find("out of the head"), std::string::npos);
  r.direction = normalized(Vec3{0, 1.7, -1});
  EXPECT_NE(place(r, {}).find("mm deeper"), std::string::npos);
  r.position_mm = s.centre + Vec3{79, 0, 20};
  r.direction = normalized(Vec3{-0.01, 0, -1});
  EXPECT_NE(place(r, {}).find("lie on the skull"), std::string::npos);

  Marks exchanged = s.marks();
  exchanged["tragus_left"] = s.centre + Vec3{-80, 0, 0};
  exchanged["tragus_right"] = s.centre + Vec3{80, 0, 0};
  EXPECT_NE(refused([&] { boolean::place_burr_hole({}, exchanged, &s.skin, s.skull); }, ExitCode::bad_config)
                .find("exchanged"),
            std::string::npos);
  r = {};
  r.diameter_mm = 61;
  EXPECT_NE(refused([&] { boolean::place_burr_hole(r, s.marks(), &s.skin, s.skull); }, ExitCode::bad_config)
                .find("diameter_mm"),
            std::string::npos);
}

TEST(BurrHole, WithoutSkinTheArcRunsOverTheSkull) {
  const Shell s;
  Report report;
  Marks marks{{"nasion", s.centre + Vec3{0, -80, 0}}, {"vertex", s.centre + Vec3{0, 0, 80}}};
  const boolean::BurrHole hole = value_of(report, boolean::place_burr_hole({}, marks, nullptr, s.skull));
  const double a = 110.0 / 80, b = 27.5 / 80;
  const Vec3 expected = Vec3{0, -std::cos(a), std::sin(a)} * std::cos(b) - Vec3{1, 0, 0} * std::sin(b);
  EXPECT_LT(norm(hole.position_mm - s.centre - expected * 80), 0.1);
  EXPECT_EQ(*report.find("arcs_on"), ParameterValue(std::string("skull")));
  EXPECT_EQ(*report.find("midline_from"), ParameterValue(std::string("nasion, vertex and the scan's superior axis")));
}

/// The phantom's upper head as truth's meshes, turned and moved about.
struct Patient {
  phantom::Head head;
  surface::TriMesh skin, skull;
  Marks marks;
  Mat3 turn;
  Vec3 shift;

  Vec3 world(Vec3 p) const { return turn * p + shift; }
  Vec3 own(Vec3 p) const { return transpose_times(turn, p - shift); }
};

Mat3 turned_by(Vec3 axis, double degrees) {
  const Vec3 u = normalized(axis);
  const double c = std::cos(degrees * pi / 180), s = std::sin(degrees * pi / 180);
  const auto rotate = [&](Vec3 p) { return p * c + cross(u, p) * s + u * (dot(u, p) * (1 - c)); };
  return {{rotate({1, 0, 0}), rotate({0, 1, 0}), rotate({0, 0, 1})}};
}

Patient patient(const phantom::HeadParams& who, const Mat3& turn, Vec3 shift, double step_mm, double top_mm = 300) {
  Patient p{phantom::Head(who), {}, {}, {}, turn, shift};
  const surface::Bounds box{{-120, -150, -10}, {120, 150, top_mm}};
  p.skin = phantom::truth_mesh(p.head, phantom::Anatomy::skin, box, step_mm);
  p.skull = phantom::truth_mesh(p.head, phantom::Anatomy::skull, box, step_mm);
  for (surface::TriMesh* mesh : {&p.skin, &p.skull}) {
    for (auto& point : mesh->points_mm) point = turn * point;
    mesh->origin_mm = p.world(mesh->origin_mm);
  }
  for (const auto& l : p.head.landmarks()) p.marks[l.first] = p.world(l.second);
  return p;
}

/// The analytic skull's normal averaged over a disc, as the hole sees it.
Vec3 truth_normal(const Patient& p, Vec3 at, Vec3 axis, double radius) {
  const Vec3 across = normalized(cross(axis, std::fabs(axis.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  const Vec3 upwards = cross(axis, across);
  Vec3 sum;
  for (const auto& s : surface::detail::disc_samples(400, 0)) {
    const Vec3 start = p.own(at + across * (radius * s[0]) + upwards * (radius * s[1]) - axis * 3.0);
    const Vec3 foot = p.head.project_mm(phantom::Anatomy::skull, start);
    Vec3 normal;
    p.head.implicit_mm(phantom::Anatomy::skull, foot, normal);
    sum += normalized(normal);
  }
  return p.turn * normalized(sum);
}

void expect_kocher(const Patient& p, const char* what) {
  for (const Side side : {Side::left, Side::right}) {
    boolean::BurrHoleRequest r;
    r.side = side;
    const boolean::BurrHole hole = boolean::place_burr_hole(r, p.marks, &p.skin, p.skull).value;
    const Vec3 truth = p.marks.at(side == Side::left ? "kocher_left" : "kocher_right");
    const double off = norm(hole.skin_mm - truth);
    const double tilt = degrees_between(hole.direction, -truth_normal(p, hole.position_mm, hole.direction, 7));
    EXPECT_LT(off, 0.5) << what;
    EXPECT_LT(tilt, 1) << what;
    EXPECT_LT(std::fabs(p.head.signed_distance_mm(phantom::Anatomy::skull, p.own(hole.position_mm))), 0.1) << what;
    // Just through: the end of the cutter lies outside the bone everywhere, its start outside the skin.
    double through = 0;
    for (const auto& s : surface::detail::disc_samples(60, 60)) {
      const surface::detail::RayColumn frame({}, hole.position_mm, hole.direction, 7);
      const Vec3 beside = frame.across() * (7 * s[0]) + frame.upwards() * (7 * s[1]);
      const Vec3 end = p.own(hole.position_mm + beside + hole.direction * hole.cutter.depth_mm);
      const Vec3 begin = p.own(hole.position_mm + beside - hole.direction * hole.cutter.above_mm);
      EXPECT_GT(p.head.signed_distance_mm(phantom::Anatomy::skull, end), 0.5) << what;
      EXPECT_GT(p.head.signed_distance_mm(phantom::Anatomy::skin, begin), 0.5) << what;
      through = std::max(through, p.head.signed_distance_mm(phantom::Anatomy::skull, end));
    }
    EXPECT_LT(through, 5) << what;
    std::printf("%s %s: %.3f mm from the truth, axis %.2f deg from the analytic normal, bone %.2f mm\n", what,
                side == Side::left ? "left" : "right", off, tilt, hole.bone_thickness_mm);
  }
}

TEST(BurrHolePhantom, KocherPointsOfTheAnalyticHead) { expect_kocher(patient({}, {}, {}, 2), "normal"); }

TEST(BurrHolePhantom, OfASmallVariantTurnedAndMoved) {
  phantom::HeadParams who;
  who.variant = phantom::Variant::small;
  who.seed = 7;
  expect_kocher(patient(who, turned_by({1, 0.4, -0.3}, 25), {40, -300, 900}, 2), "small, turned");
}

TEST(BurrHolePhantom, TheScansEdgeIsNotTakenForTheHead) {
  // The vertex was not scanned: 110 mm from the nasion lie beyond the cut.
  const Patient p = patient({}, turned_by({0, 1, 0.2}, 10), {}, 2.5, 75);
  EXPECT_GE(boolean::detail::cut_faces(p.skin).size(), 2u);
  const auto what = refused([&] { boolean::place_burr_hole({}, p.marks, &p.skin, p.skull); });
  EXPECT_NE(what.find("runs over the scan's edge"), std::string::npos) << what;
  // A hole beside the cut leaves the volume, one farther down does not.
  boolean::BurrHoleRequest r;
  r.at = At::position;
  const auto frontal = [&](double z) {
    Vec3 at{0, -60, z};
    return p.world(p.head.project_mm(phantom::Anatomy::skull, at + Vec3{0, -30, 0}));
  };
  r.position_mm = frontal(70);
  EXPECT_NE(refused([&] { boolean::place_burr_hole(r, {}, &p.skin, p.skull); }).find("leave the scanned volume"),
            std::string::npos);
  r.position_mm = frontal(55);
  EXPECT_NO_THROW(boolean::place_burr_hole(r, {}, &p.skin, p.skull));
}

}  // namespace
}  // namespace trephine
