// SPDX-License-Identifier: GPL-3.0-or-later
// Clavicles and subclavian veins of an analytic chest: clavicles are bent capsules that touch a sternum and a scapula
// by bridges, behind them ribs and a spine, lung below, and a vein behind and below each clavicle.
#include <gtest/gtest.h>

#include <functional>

#include "base/error.h"
#include "report_of.h"
#include "segmentation/segment.h"
#include "trunk/clavicle.h"
#include "trunk/vein.h"
#include "trunk_samples.h"

namespace trephine {
namespace {

using namespace bodies;

struct Chest {
  double vein_contrast_hu = 0;
  bool clavicles = true;
  double bridge_mm = 1.5;  ///< radius of the bone at the joints
  static constexpr double clavicle_mm = 6, vein_mm = 5;

  static std::vector<Vec3> clavicle(int side) {  // side: 1 left, -1 right
    std::vector<Vec3> line;
    for (double t = 0; t <= 1.0001; t += 0.02)
      line.push_back({side * (18 + 105 * t), -60 + 45 * t - 7 * std::sin(2 * M_PI * t), 10 + 22 * t});
    return line;
  }
  static std::vector<Vec3> vein(int side) {
    std::vector<Vec3> line;
    const std::vector<Vec3> c = clavicle(side);
    for (std::size_t n = 0; n < 30; ++n) {
      const double t = double(n) / 30;
      line.push_back(c[n] + Vec3{0, 13 - 4 * t, -4 - 9 * t});
    }
    std::vector<Vec3> all;
    for (double s = 30; s > 0.5; s -= 2) all.push_back(line.front() + Vec3{side * -0.6, 0.1, -0.75} * s);
    all.insert(all.end(), line.begin(), line.end());
    return all;
  }

  std::vector<Vec3> clavicle_line[2] = {clavicle(-1), clavicle(1)}, vein_line[2] = {vein(-1), vein(1)};

  grid::Field truth(const grid::Lattice& l, const std::vector<Vec3> lines[2], double radius_mm) const {
    grid::Field out = distances(l, lines[0], 2 * radius_mm);
    const grid::Field other = distances(l, lines[1], 2 * radius_mm);
    for (std::size_t v = 0; v < out.count(); ++v)
      out.voxels[v] = float(radius_mm) - std::min(out.voxels[v], other.voxels[v]);
    return out;
  }
  double clavicles_mm(Vec3 p) const {
    return clavicle_mm - std::min(to_line(clavicle_line[0], p), to_line(clavicle_line[1], p));
  }
  double veins_mm(Vec3 p) const { return vein_mm - std::min(to_line(vein_line[0], p), to_line(vein_line[1], p)); }
  bool other_bone(Vec3 p) const {
    if (std::abs(p.x) < 11 && std::abs(p.y + 62) < 6 && p.z < 8) return true;  // sternum
    if (std::hypot(p.x, p.y - 45) < 14) return true;                           // spine
    for (int r = 0; r < 4; ++r) {                                              // ribs, slanted rings
      const double a = 45 + 12 * r, b = 62, z = -8 - 22 * r + 0.3 * p.y;
      const double x = p.x / a, y = (p.y + 5) / b, ring = (std::hypot(x, y) - 1) * std::min(a, b);
      if (std::hypot(ring, p.z - z) < 4 && (p.y > -58 || std::abs(p.x) > 11)) return true;
    }
    for (int side : {0, 1}) {
      const Vec3 inner = clavicle_line[side].front(), outer = clavicle_line[side].back();
      const double s = side ? 1 : -1;
      if (std::abs(p.x - outer.x - s * 16) < 7 && std::abs(p.y - outer.y) < 12 && std::abs(p.z - outer.z) < 8)
        return true;  // acromion
      if (!clavicles) continue;
      if (to_line({inner, {0, -62, 5}}, p) < bridge_mm) return true;
      if (to_line({outer, outer + Vec3{s * 14, 0, 0}}, p) < bridge_mm) return true;
    }
    return false;
  }
  float around_hu(Vec3 p) const {  // without clavicles and veins
    if (p.x * p.x / (150. * 150) + (p.y + 5) * (p.y + 5) / (85. * 85) > 1) return -1000;
    if (other_bone(p)) return 600;
    for (double s : {-1., 1.})
      if (norm(Vec3{(p.x - s * 28) / 22, (p.y + 2) / 40, (p.z + 60) / 45}) < 1) return -850;  // lungs
    return 50;
  }
  grid::HuVolume volume(double noise_hu, Vec3 spacing_mm = {1, 1, 1}) const {
    const auto n = [](double mm, double step) { return int(std::lround(mm / step)); };
    const grid::Lattice l =
        lattice(n(310, spacing_mm.x), n(160, spacing_mm.y), n(90, spacing_mm.z), spacing_mm, {-155, -95, -45});
    grid::Grid<float> g = drawn(l, [&](Vec3 p) { return around_hu(p); });
    for (int side : {0, 1}) {
      draw_tube(g, vein_line[side], vein_mm, float(50 + vein_contrast_hu));
      if (clavicles) draw_tube(g, clavicle_line[side], clavicle_mm, 700);
    }
    return scanned(std::move(g), 0.6, noise_hu);
  }
};

/// As pipelines/chest.yaml.
grid::Field bone_of(const grid::HuVolume& volume) {
  segmentation::SegmentParams p;
  p.lower_hu = 200;
  p.smoothing_sigma_mm = 0.7;
  p.seed_lower_hu = 350;
  p.edge = segmentation::SegmentEdge::half_maximum;
  p.min_component_ml = 0.5;
  p.fill = segmentation::SegmentFill::cavities_and_cut;
  p.fill_close_mm = 2;
  p.fill_max_ml = 150;
  return segmentation::segment(volume, {}, p).value;
}

double figure(const Report& r, const std::string& name) {
  const auto* f = r.find(name);
  return f ? std::get<double>(*f) : -1e9;
}
std::string text(const Report& r, const std::string& name) {
  const auto* f = r.find(name);
  return f ? std::get<std::string>(*f) : "";
}

/// Spine and shoulder blades, and a rod as round and as long as a clavicle; and a pole that stands there.
grid::Field rod_among_bones(Vec3 medial_mm, Vec3 lateral_mm, Vec3 pole_mm = {0, 1000, 0}) {
  const grid::Lattice l = lattice(300, 150, 100, {1, 1, 1}, {-150, -90, -50});
  grid::Field bone(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
        const double spine = 14 - std::hypot(p.x, p.y - 45), blade = 6 - std::abs(std::abs(p.x) - 135);
        const double blades = std::min({blade, 15 - std::abs(p.y - 30), 30 - std::abs(p.z)});
        const double pole = 4 - std::hypot(p.x - pole_mm.x, p.y - pole_mm.y);
        bone.at(i, j, k) = float(std::max({spine, blades, pole, 6 - to_line({medial_mm, lateral_mm}, p)}) + 1e-3);
      }
  return bone;
}

// A rib runs forward to the side, so its front end was taken for the sternal one, and the right rib for a left
// clavicle.
TEST(Clavicle, ARibOfTheOtherSideIsNone) {
  const auto sides = [](Vec3 medial_mm, Vec3 lateral_mm) {
    std::vector<trunk::BodySide> all;
    for (const auto& c : trunk::clavicle_courses(rod_among_bones(medial_mm, lateral_mm), {})) all.push_back(c.side);
    return all;
  };
  EXPECT_EQ(sides({-20, -20, 20}, {-112, 10, 30}), std::vector<trunk::BodySide>{trunk::BodySide::right});
  EXPECT_EQ(sides({20, -20, 20}, {112, 10, 30}), std::vector<trunk::BodySide>{trunk::BodySide::left});
  EXPECT_TRUE(sides({-20, 20, 0}, {-112, -5, -10}).empty());
  EXPECT_TRUE(sides({20, 20, 0}, {112, -5, -10}).empty());
  EXPECT_TRUE(sides({-20, 62, 20}, {-112, 70, 30}).empty()) << "behind";
}

// Where something dense touches a clavicle it is not round; a rod that holds a phantom together does so.
TEST(Clavicle, GoesOnBeyondWhatTouchesIt) {
  const auto made = trunk::find_clavicles(rod_among_bones({-20, -20, 20}, {-112, 10, 30}, {-66, 1, 0}), {});
  ASSERT_EQ(made.result.sides.size(), 1u);
  EXPECT_NEAR(made.result.sides.front().second.length_mm, 97, 8);
  EXPECT_NEAR(made.result.sides.front().second.volume_ml, M_PI * 36 * 101e-3, 0.8);
}

TEST(LongClavicle, BothArePartedFromSternumAndScapula) {
  for (const double noise : {60.}) {
    const Chest chest;
    const grid::HuVolume volume = chest.volume(noise);
    const grid::Field bone = bone_of(volume);
    Report report;
    const grid::Field found = value_of(report, trunk::find_clavicles(bone, {}));
    const auto all = [](Vec3) { return true; };
    // The bridges, 3 mm thin, belong to nobody.
    const auto counts = [&](Vec3 p) {
      for (int side : {0, 1})
        if (norm(p - chest.clavicle_line[side].front()) < 9 || norm(p - chest.clavicle_line[side].back()) < 9)
          return false;
      return true;
    };
    const Distances d = surface_distance(
        found, chest.truth(grid::lattice_of(volume), chest.clavicle_line, Chest::clavicle_mm),
        [&](Vec3 p) { return chest.clavicles_mm(p); }, counts);
    double length = 0;
    for (std::size_t n = 1; n < chest.clavicle_line[0].size(); ++n)
      length += norm(chest.clavicle_line[0][n] - chest.clavicle_line[0][n - 1]);
    const double r = Chest::clavicle_mm, truth = 2 * (M_PI * r * r * length + 4 * M_PI / 3 * r * r * r);
    const double percent = 100 * (volume_mm3(found, all) / truth - 1);
    std::printf("noise %.0f: mean %.3f p95 %.3f max %.3f mm, volume %+.2f %%\n", noise, d.mean, d.p95, d.max, percent);
    EXPECT_LT(d.mean, 0.2);
    EXPECT_LT(d.p95, 0.5);
    EXPECT_LT(std::abs(percent), 4);
    EXPECT_TRUE(report.warnings.empty()) << report.warnings.front();
    EXPECT_NEAR(figure(report, "right_ml"), figure(report, "left_ml"), 0.5);
    EXPECT_LT(figure(report, "left_joint_mm2"), 60);

    trunk::ClavicleParams rest;
    rest.part = trunk::ClaviclePart::rest;
    const grid::Field other = trunk::find_clavicles(bone, rest).value;
    EXPECT_NEAR(volume_mm3(other, all) + volume_mm3(found, all), volume_mm3(bone, all), 1);
    const grid::Field no_bone = trunk::find_clavicles(bone, rest, {}, &found).value;
    EXPECT_TRUE(no_bone == other) << "without what is none of it anyway";
  }
}

TEST(Clavicle, OneSideIsThePatientsOwn) {
  const Chest chest;
  const grid::Field bone = bone_of(chest.volume(10, {1.2, 1.2, 2}));
  for (const trunk::BodySide side : {trunk::BodySide::left, trunk::BodySide::right}) {
    trunk::ClavicleParams p;
    p.side = side;
    const grid::Field found = trunk::find_clavicles(bone, p).value;
    const double left_mm3 = volume_mm3(found, [](Vec3 q) { return q.x > 0; });
    const double right_mm3 = volume_mm3(found, [](Vec3 q) { return q.x < 0; });
    EXPECT_GT(side == trunk::BodySide::left ? left_mm3 : right_mm3, 10000);
    EXPECT_EQ(side == trunk::BodySide::left ? right_mm3 : left_mm3, 0);
    const auto courses = trunk::clavicle_courses(bone, p);
    ASSERT_EQ(courses.size(), 1u);
    EXPECT_LT(std::abs(courses[0].points_mm.front().x), 35) << "the sternal end comes first";
    EXPECT_GT(std::abs(courses[0].points_mm.back().x), 105);
    for (std::size_t n = 10; n + 10 < courses[0].points_mm.size(); ++n) {
      EXPECT_LT(to_line(chest.clavicle_line[side == trunk::BodySide::left], courses[0].points_mm[n]), 1.5);
      EXPECT_NEAR(courses[0].radius_mm[n], Chest::clavicle_mm, 1.5);
    }
  }
}

TEST(Clavicle, FusedWithOtherBoneIsSaidSo) {
  Chest chest;
  chest.bridge_mm = 8;  // thicker than the clavicle itself
  Report report;
  const grid::Field found = value_of(report, trunk::find_clavicles(bone_of(chest.volume(10, {1.2, 1.2, 2})), {}));
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_NE(report.warnings.front().find("clavicle"), std::string::npos);
}

template <class F>
std::string refused(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.code() == ExitCode::quality ? e.field() + ": " + e.what() : "wrong code";
  }
  return "not refused";
}

TEST(Clavicle, WhereThereIsNoneIsRefusedAndSoIsItsVein) {
  Chest chest;
  chest.clavicles = false;
  const grid::HuVolume volume = chest.volume(10, {1.2, 1.2, 2});
  const grid::Field bone = bone_of(volume);
  std::string what = refused([&] { trunk::find_clavicles(bone, {}); });
  EXPECT_EQ(what.rfind("clavicle", 0), 0u) << what;
  what = refused([&] { trunk::find_vein(volume, bone, {}); });
  EXPECT_EQ(what.rfind("vein", 0), 0u) << what;
  const grid::Lattice& l = bone;
  what = refused([&] { trunk::find_clavicles(grid::Field(l, -1.f), {}); });
  EXPECT_NE(what.find("empty"), std::string::npos) << what;
  what = refused([&] { trunk::find_clavicles(grid::Field(l, 1.f), {}); });
  EXPECT_EQ(what.rfind("clavicle", 0), 0u) << what;
  what = refused([&] { trunk::find_vein(volume, grid::Field(l, -1.f), {}); });
  EXPECT_NE(what.find("empty"), std::string::npos) << what;
}

struct Trial {
  const char* name;
  double contrast_hu, noise_hu, mean_mm, p95_mm, volume_percent;
};
void PrintTo(const Trial& t, std::ostream* os) { *os << t.name; }
class Veins : public testing::TestWithParam<Trial> {};

TEST_P(Veins, WithContrastLieWhereTheyAre) {
  const Trial t = GetParam();
  Chest chest;
  chest.vein_contrast_hu = t.contrast_hu;
  const grid::HuVolume volume = chest.volume(t.noise_hu);
  const grid::Field bone = bone_of(volume);
  Report report;
  const grid::Field found = value_of(report, trunk::find_vein(volume, bone, {}));
  EXPECT_EQ(text(report, "left_source"), "contrast");
  EXPECT_EQ(text(report, "right_source"), "contrast");
  EXPECT_TRUE(report.warnings.empty()) << report.warnings.front();
  // Along the clavicle; how far it goes on is not the truth's.
  const auto counts = [&](Vec3 p) { return std::abs(p.x) > 22 && std::abs(p.x) < 70; };
  const grid::Field true_field = chest.truth(grid::lattice_of(volume), chest.vein_line, Chest::vein_mm);
  const Distances d = surface_distance(
      found, true_field, [&](Vec3 p) { return chest.veins_mm(p); }, counts);
  const double percent = 100 * (volume_mm3(found, counts) / volume_mm3(true_field, counts) - 1);
  std::printf("%s: mean %.3f p95 %.3f max %.3f mm, volume %+.2f %%\n", t.name, d.mean, d.p95, d.max, percent);
  EXPECT_LT(d.mean, t.mean_mm);
  EXPECT_LT(d.p95, t.p95_mm);
  EXPECT_LT(std::abs(percent), t.volume_percent);
  EXPECT_NEAR(figure(report, "left_contrast_hu"), t.contrast_hu, 0.15 * t.contrast_hu + 5);
}

std::string name_of(const testing::TestParamInfo<Trial>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Contrast, Veins, testing::Values(Trial{"usual", 120, 30, 0.25, 0.7, 4}), name_of);
INSTANTIATE_TEST_SUITE_P(LongContrast, Veins,
                         testing::Values(Trial{"faint", 50, 10, 0.3, 0.8, 5}, Trial{"bright", 300, 20, 0.25, 0.9, 4}),
                         name_of);

TEST(Vein, ASideThatShowsNoLungIsSaid) {
  const Chest chest;
  const grid::HuVolume volume = chest.volume(0);
  const grid::Lattice l = grid::lattice_of(volume);
  // 100 ml on the left, and what is no more than a windpipe's end on the right.
  grid::Field lung(l, -1.f);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
        if (norm(p - Vec3{50, 0, -10}) < 29 || norm(p - Vec3{-30, 0, -20}) < 10) lung.at(i, j, k) = 1;
      }
  trunk::VeinParams estimated;
  estimated.source = trunk::VeinSource::estimated;
  Report report;
  value_of(report, trunk::find_vein(volume, bone_of(volume), estimated, {}, &lung));
  EXPECT_NEAR(figure(report, "left_lung_ml"), 102, 5);
  EXPECT_NEAR(figure(report, "right_lung_ml"), 4, 1);
  const auto said = [&](const std::string& part) {
    return std::any_of(report.warnings.begin(), report.warnings.end(),
                       [&](const std::string& w) { return w.find(part) != std::string::npos; });
  };
  EXPECT_TRUE(said("4 ml of the right lung"));
  EXPECT_FALSE(said("of the left lung"));
}

TEST(Vein, ALungOfWhichAPartIsMissingIsSaid) {
  const Chest chest;
  const grid::HuVolume volume = chest.volume(0);
  const grid::Lattice l = grid::lattice_of(volume);
  trunk::VeinParams estimated;
  estimated.source = trunk::VeinSource::estimated;
  const double bottom = l.to_world_mm({0, 0, 0}).z, top = l.to_world_mm({0, 0, l.size[2] - 1.0}).z;
  // Two columns of lung; of the right one `missing` tells where there is none.
  const auto warned = [&](const std::function<bool(double)>& missing) {
    grid::Field lung(l, -1.f);
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
          if (std::abs(std::abs(p.x) - 60) < 35 && std::abs(p.y) < 25 && !(p.x < 0 && missing(p.z)))
            lung.at(i, j, k) = 1;
        }
    std::vector<std::string> ids;
    for (const Warning& w : trunk::find_vein(volume, bone_of(volume), estimated, {}, &lung).warnings)
      if (w.id.rfind("lung", 0) == 0) ids.push_back(w.id);
    return ids;
  };
  using Ids = std::vector<std::string>;
  const double middle = (bottom + top) / 2;
  EXPECT_EQ(warned([](double) { return false; }), Ids{});
  EXPECT_EQ(warned([&](double z) { return std::abs(z - middle) < 5; }), Ids{"lung_interrupted"});
  EXPECT_EQ(warned([&](double z) { return std::abs(z - middle) < 1; }), Ids{}) << "a slice is no part";
  EXPECT_EQ(warned([&](double z) { return z < bottom + 65; }), Ids{"lung_ends_early"});
  EXPECT_EQ(warned([&](double z) { return z < bottom + 40; }), Ids{}) << "as a liver raises it";
}

TEST(Vein, WithoutContrastIsEstimatedAndSaysSo) {
  for (const double noise : {60.}) {
    const Chest chest;
    const grid::HuVolume volume = chest.volume(noise);
    const grid::Field bone = bone_of(volume);
    Report report;
    trunk::VeinParams p;
    const grid::Field found = value_of(report, trunk::find_vein(volume, bone, p));
    EXPECT_EQ(text(report, "left_source"), "estimated") << noise;
    EXPECT_EQ(text(report, "right_source"), "estimated") << noise;
    ASSERT_GE(report.warnings.size(), 2u);
    EXPECT_NE(report.warnings[0].find("estimated"), std::string::npos);
    // Behind or below the clavicle, in soft tissue, not far from a vein that runs as veins do.
    std::vector<double> off;
    for (const Vec3& q : crossings(found)) {
      EXPECT_LT(chest.clavicles_mm(q), 0);
      if (std::abs(q.x) > 22 && std::abs(q.x) < 60) off.push_back(std::abs(chest.veins_mm(q)));
    }
    const Distances d = summary(off);
    std::printf("estimated, noise %.0f: mean %.2f, max %.2f mm off a vein that was made otherwise\n", noise, d.mean,
                d.max);
    EXPECT_LT(d.mean, 2.5);
    const double length = figure(report, "left_length_mm"), ml = figure(report, "left_ml");
    EXPECT_NEAR(ml * 1000 / (M_PI * p.radius_mm * p.radius_mm * length), 1, 0.2);
  }
}

TEST(Vein, IsTheSameWhateverTheThreadCount) {
  Chest chest;
  chest.vein_contrast_hu = 150;
  const grid::HuVolume volume = chest.volume(20, {1.2, 1.2, 2});
  const grid::Field bone = bone_of(volume);
  const int before = thread_count();
  set_thread_count(1);
  const grid::Field one = trunk::find_vein(volume, bone, {}).value, clavicles = trunk::find_clavicles(bone, {}).value;
  set_thread_count(4);
  EXPECT_TRUE(one == trunk::find_vein(volume, bone, {}).value);
  EXPECT_TRUE(clavicles == trunk::find_clavicles(bone, {}).value);
  set_thread_count(before);
}

}  // namespace
}  // namespace trephine
