// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a head to be printed, of a phantom whose shapes are known.
#include <gtest/gtest.h>

#include "base/error.h"
#include "meshing/contour.h"
#include "meshing/validity.h"
#include "outcome_case.h"
#include "print/head_parts.h"
#include "print/measure_parts.h"
#include "print/print_head.h"
#include "print/solid.h"
#include "surface/point_to_mesh.h"

namespace trephine::print {
namespace {

template <class F>
ExitCode code_of(F&& f, std::string* line = nullptr) {
  try {
    f();
  } catch (const Error& e) {
    if (line) *line = e.line("print");
    return e.code();
  }
  return ExitCode::ok;
}

const cases::LoadedCase& the_case() {
  static const cases::LoadedCase made = [] {
    phantom::HeadParams p;
    p.seed = 3;
    return case_of(phantom::Head(p));
  }();
  return made;
}

PrintParams coarse() {
  PrintParams p;
  p.wall_mm = 3.6;
  p.voxel_mm = 1.2;
  p.gap_mm = 0.5;
  p.ventricles = Ventricles::core;
  return p;
}

const Printed& the_head() {
  static const Printed made = print_head(the_case(), coarse());
  return made;
}

const PrintedPart& part_of(const Printed& made, const std::string& name) {
  for (const PrintedPart& p : made.parts)
    if (p.name == name) return p;
  throw Error(ExitCode::internal, "", name, "no such part");
}

template <class F>
Solid solid_of(double half_mm, double voxel_mm, const F& f) {
  Solid s(lattice_over({{-half_mm, -half_mm, -half_mm}, {half_mm, half_mm, half_mm}}, voxel_mm));
  change(s, [&](Vec3 p, double) { return f(p); });
  return s;
}
double capsule(Vec3 p, double half_length, double radius) {
  p.x -= std::clamp(p.x, -half_length, half_length);
  return radius - norm(p);
}
/// A sheet of rounded rim about z = 0.
double sheet(Vec3 p, double radius, double half_thick) {
  const double off = std::max(0.0, std::hypot(p.x, p.y) - (radius - half_thick));
  return half_thick - std::hypot(off, p.z);
}

TEST(Print, AWallIsMeasuredWhereItIsThinnest) {
  for (const double radius : {1.0, 2.5}) {
    const surface::TriMesh rod = surface_of(solid_of(14, 0.4, [&](Vec3 p) { return capsule(p, 8, radius); }));
    EXPECT_NEAR(smallest_wall_mm(rod, {6}), 2 * radius, 0.12);
    const surface::TriMesh plate = surface_of(solid_of(14, 0.4, [&](Vec3 p) { return sheet(p, 10, radius); }));
    EXPECT_NEAR(smallest_wall_mm(plate, {6}), 2 * radius, 0.12);
    EXPECT_EQ(smallest_wall_mm(plate, {radius}), radius) << "no more is looked for";
  }
  // Two balls on a thin neck.
  const surface::TriMesh neck = surface_of(solid_of(14, 0.4, [&](Vec3 p) {
    const double balls = std::max(4 - norm(p - Vec3{7, 0, 0}), 4 - norm(p + Vec3{7, 0, 0}));
    return std::max(balls, capsule(p, 7, 0.7));
  }));
  EXPECT_NEAR(smallest_wall_mm(neck, {6}), 1.4, 0.12);
}

TEST(Print, AGapIsMeasuredOnBothSides) {
  const surface::TriMesh one = surface_of(solid_of(9, 0.4, [](Vec3 p) { return capsule(p, 0, 3); }));
  surface::TriMesh other = one;
  for (const double gap : {0.3, -0.5}) {
    other.origin_mm = one.origin_mm + Vec3{6 + gap, 0, 0};
    EXPECT_NEAR(smallest_gap_mm(one, other, 2, {}), gap, 0.05);
    EXPECT_NEAR(smallest_gap_mm(other, one, 2, {}), gap, 0.05);
  }
  // A ball over the middle of a box, whose corners are far off.
  surface::TriMesh box;
  for (int n = 0; n < 8; ++n) box.points_mm.push_back({n & 1 ? 20.0 : -20, n & 2 ? 20.0 : -20, n & 4 ? -3.5 : -9.5});
  box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  EXPECT_NEAR(smallest_gap_mm(one, box, 2, {}), 0.5, 0.05);
  EXPECT_NEAR(smallest_gap_mm(box, one, 2, {}), 0.5, 0.05);
  other.origin_mm = one.origin_mm + Vec3{20, 0, 0};
  EXPECT_EQ(smallest_gap_mm(one, other, 2, {}), 2);
}

TEST(Print, ThinWallsBecomeThickAndThickOnesStay) {
  const double ball = 1.5;
  const auto thin = [](Vec3 p) { return sheet(p, 10, 0.5); };
  const Solid made = with_walls(thickened(as_distances(solid_of(14, 0.5, thin)), ball + 0.3), ball, 2.6);
  EXPECT_GE(smallest_wall_mm(surface_of(made), {6}), 2.6);
  EXPECT_NEAR(at(made, {0, 0, 0}), 1.8, 0.3);
  const Solid thick = as_distances(solid_of(14, 0.5, [](Vec3 p) { return sheet(p, 10, 3); }));
  EXPECT_TRUE(thickened(thick, ball) == thick);
  // A needle and a ridge are taken off, not made thick.
  const Solid ridged = as_distances(solid_of(14, 0.5, [](Vec3 p) {
    return std::max(sheet(p, 10, 3), std::min(0.5 - std::hypot(p.x, p.y), 9 - std::abs(p.z)));
  }));
  EXPECT_LT(at(opened(ridged, ball), {0, 0, 6}), 0);
  EXPECT_GT(at(opened(ridged, ball), {0, 0, 2}), 0);
}

TEST(Print, AHeadInPartsThatFit) {
  const Printed& made = the_head();
  const PrintParams asked = coarse();
  std::vector<std::string> names;
  for (const PrintedPart& p : made.parts) {
    names.push_back(p.name);
    EXPECT_TRUE(p.mesh.proven_valid()) << p.name;
    EXPECT_EQ(surface::topology_of(p.mesh).components, 1) << p.name;
  }
  EXPECT_EQ(names, (std::vector<std::string>{"skull", "insert-right", "insert-left", "ventricles", "base", "lid"}));
  for (const PrintPart& p : made.record.parts) {
    EXPECT_GE(p.smallest_wall_mm, asked.wall_mm) << p.name;
    EXPECT_LT(p.smallest_wall_mm, 2.5 * asked.wall_mm) << p.name;
  }
  std::vector<std::string> pairs;
  for (const PrintGap& g : made.record.gaps) {
    pairs.push_back(g.a + " " + g.b);
    EXPECT_GT(g.smallest_mm, 0.8 * asked.gap_mm) << pairs.back();
    EXPECT_LT(g.smallest_mm, 2 * asked.gap_mm) << pairs.back();
  }
  EXPECT_EQ(pairs, (std::vector<std::string>{"skull insert-right", "skull insert-left", "skull base", "ventricles base",
                                             "base lid"}));
  EXPECT_GT(made.record.gel_ml, 500);
  EXPECT_LT(made.record.gel_ml, 2000);
}

// Skin is no part, and nothing of the head below the cut is: the face policy of prints.
TEST(Print, NothingBelowTheCutIsPrinted) {
  const Printed& made = the_head();
  const itk::LinearMap to_print = map_of(made.record.case_to_print);
  const Vec3 nasion = to_print(landmark_mm(the_case(), "nasion"));
  EXPECT_NEAR(nasion.z, -coarse().cut_above_mm, 1e-6);
  EXPECT_NEAR(to_print(landmark_mm(the_case(), "inion")).z, -coarse().cut_above_mm, 1e-6);
  EXPECT_TRUE(itk::is_rigid(to_print));
  for (const char* name : {"skull", "insert-right", "insert-left"})
    EXPECT_GE(surface::bounds_of(part_of(made, name).mesh).min_mm.z, 0) << name;
}

// The skull is the phantom's bone where nothing was made thicker, cut or added.
TEST(Print, TheSkullIsTheCases) {
  const Printed& made = the_head();
  const itk::LinearMap to_case = itk::inverse(map_of(made.record.case_to_print));
  phantom::HeadParams p;
  p.seed = 3;
  const phantom::Head head(p);
  const surface::TriMesh& skull = part_of(made, "skull").mesh;
  std::vector<double> off;
  for (std::size_t n = 0; n < skull.points_mm.size(); n += 7) {
    const Vec3 at = skull.world_mm(n);
    if (at.z < 12) continue;
    off.push_back(std::abs(head.implicit_mm(phantom::Anatomy::skull, to_case(at))));
  }
  std::sort(off.begin(), off.end());
  ASSERT_GT(off.size(), 1000u);
  EXPECT_LT(off[off.size() / 2], 0.25);
}

TEST(Print, MarksAreSpheresWhereTheRecordSays) {
  const Printed& made = the_head();
  const surface::TriMesh& skull = part_of(made, "skull").mesh;
  const itk::LinearMap to_print = map_of(made.record.case_to_print);
  ASSERT_GE(made.record.marks.size(), 5u);
  for (const PrintMark& m : made.record.marks) {
    EXPECT_LT(norm(to_print(m.case_mm) - m.at_mm), 1e-9);
    const Vec3 post = to_print.matrix * m.post;
    Vec3 sum;
    double radius = 0;
    int count = 0;
    for (std::size_t n = 0; n < skull.points_mm.size(); ++n) {
      const Vec3 d = skull.world_mm(n) - m.at_mm;
      if (norm(d) > 0.5 * m.diameter_mm + 0.8 || dot(d, post) > 0) continue;
      sum += d;
      radius += norm(d);
      ++count;
    }
    ASSERT_GT(count, 30) << m.number;
    EXPECT_NEAR(radius / count, 0.5 * m.diameter_mm, 0.2) << m.number;
    // Of the half that looks away from the post, the mean lies half a radius off.
    EXPECT_LT(norm(sum * (1.0 / count) + post * (0.25 * m.diameter_mm)), 0.35) << m.number;
    const Vec3 kocher = to_print(landmark_mm(the_case(), "kocher_right"));
    EXPECT_GT(norm(m.at_mm - kocher), 0.5 * coarse().insert_mm) << m.number;
  }
}

TEST(Print, AnInsertHoldsKochersPointAndLeavesItsHole) {
  const Printed& made = the_head();
  const itk::LinearMap to_print = map_of(made.record.case_to_print);
  const surface::PointToMesh skull(part_of(made, "skull").mesh);
  for (const char* side : {"right", "left"}) {
    const surface::PointToMesh insert(part_of(made, std::string("insert-") + side).mesh);
    const Vec3 skin = to_print(landmark_mm(the_case(), std::string("kocher_") + side));
    const Vec3 in = normalized(to_print(landmark_mm(the_case(), std::string("monro_") + side)) - skin);
    double first = -1;
    for (double d = 0; d < 30 && first < 0; d += 0.25)
      if (insert.signed_distance_mm(skin + in * d) < 0) first = d;
    ASSERT_GT(first, 0) << side;
    EXPECT_GT(skull.signed_distance_mm(skin + in * (first + 1)), 10) << side;
    surface::Bounds box = surface::bounds_of(part_of(made, std::string("insert-") + side).mesh);
    EXPECT_GT(norm(box.max_mm - box.min_mm), coarse().insert_mm) << side;
  }
}

TEST(Print, TheTokenIsEngravedFromBelow) {
  const HeadPlan plan = plan_head(the_case(), coarse());
  const auto engraved = [&](const std::string& token) { return base_parts(plan, nullptr, token); };
  const BaseParts plain = engraved(""), one = engraved("i"), all = engraved("phantom");
  const double letter = volume_ml(plain.base.solid) - volume_ml(one.base.solid),
               word = volume_ml(plain.base.solid) - volume_ml(all.base.solid);
  EXPECT_GT(letter, 0.005);
  EXPECT_GT(word, 4 * letter);
  // No deeper than they say, and not through.
  for (std::size_t n = 0; n < plain.base.solid.voxels.size(); ++n) {
    if (plain.base.solid.voxels[n] == all.base.solid.voxels[n]) continue;
    const int k = int(n / (std::size_t(plain.base.solid.size[0]) * std::size_t(plain.base.solid.size[1])));
    EXPECT_LT(plain.base.solid.to_world_mm({0, 0, double(k)}).z, all.letters_to_mm + 2 * coarse().voxel_mm);
  }
}

TEST(Print, WhatACaseLacksIsSaid) {
  const auto line_of = [](const cases::LoadedCase& lacking, const PrintParams& params) {
    std::string line;
    EXPECT_EQ(code_of([&] { print_head(lacking, params); }, &line), ExitCode::bad_input);
    return line;
  };
  cases::LoadedCase lacking;
  lacking.manifest.landmarks = the_case().manifest.landmarks;
  EXPECT_NE(line_of(lacking, coarse()).find("`skull`"), std::string::npos);
  lacking.manifest.landmarks.clear();
  EXPECT_NE(line_of(lacking, coarse()).find("`nasion`"), std::string::npos);
  cases::LoadedCase dry = the_case();
  dry.haptic.shapes.erase(dry.haptic.shapes.begin());
  EXPECT_NE(line_of(dry, coarse()).find("`ventricles`"), std::string::npos);
  PrintParams high = coarse();
  high.cut_above_mm = 60;
  std::string line;
  high.insert_mm = 60;
  EXPECT_EQ(code_of([&] { print_head(the_case(), high); }, &line), ExitCode::quality);
  EXPECT_NE(line.find("insert"), std::string::npos) << line;
  PrintParams rough;
  rough.voxel_mm = 1;
  EXPECT_EQ(code_of([&] { print_head(the_case(), rough); }, &line), ExitCode::usage);
  EXPECT_NE(line.find("voxel_mm"), std::string::npos) << line;
}

TEST(Print, ARecordComesBackAsItWasWritten) {
  PrintRecord r = the_head().record;
  r.case_sha256 = std::string(64, '0');
  r.program = "trephine";
  for (PrintPart& p : r.parts) p.file = p.name + ".stl";
  const std::string text = to_json(r);
  EXPECT_EQ(to_json(parse_print(text)), text);
  std::string spoilt = text;
  spoilt.replace(spoilt.find("\"trephine_print\": 1"), 19, "\"trephine_print\": 2");
  EXPECT_THROW(parse_print(spoilt), Error);
}

TEST(LongPrint, TheSameSurfacesOnAnyNumberOfThreads) {
  set_thread_count(1);
  const Printed one = print_head(the_case(), coarse());
  set_thread_count(0);
  ASSERT_EQ(one.parts.size(), the_head().parts.size());
  for (std::size_t n = 0; n < one.parts.size(); ++n) {
    EXPECT_TRUE(one.parts[n].mesh.points_mm == the_head().parts[n].mesh.points_mm) << one.parts[n].name;
    EXPECT_EQ(one.parts[n].mesh.triangles, the_head().parts[n].mesh.triangles) << one.parts[n].name;
  }
  EXPECT_EQ(to_json(one.record), to_json(the_head().record));
}

}  // namespace
}  // namespace trephine::print
