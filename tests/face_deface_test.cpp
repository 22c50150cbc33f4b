// SPDX-License-Identifier: GPL-3.0-or-later
// Defacing on the analytic head: what is left against the true skin, and what must not change.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "face/face_gate.h"
#include "head/brain.h"
#include "head/ventricles.h"
#include "head_recipe.h"
#include "phantom_heads.h"
#include "report_of.h"
#include "segmentation/segment.h"

namespace trephine {
namespace {

using phantom::Anatomy;
using phantom::Head;

struct Scanned {
  Head head;
  grid::HuVolume volume;
  grid::Field skin;
  face::FaceRegion region;
};

Scanned scanned(phantom::Level level, int pixels, int slices, double noise_hu) {
  Scanned s{phantom_heads::head_of(level, 7), {}, {}, {}};
  s.volume = phantom::volume_of(phantom::scan(s.head, phantom_heads::scan_of(pixels, slices, noise_hu)));
  s.skin = segmentation::segment(s.volume, {}, head_recipe::skin()).value;
  s.region = face::face_region(phantom_heads::face_landmarks(s.head));
  return s;
}

const Scanned& small_head() {
  static const Scanned s = scanned(phantom::Level::simple, 150, 80, 12);
  return s;
}

double figure(const Report& r, const char* name) { return std::get<double>(*r.find(name)); }

/// The least distance from the analytic skin (at most 7 mm; below `enough` the first found) of any point, within P4's
/// region (and the eyes above it, up to the nasion) in the patient's own axes, at which two neighbouring voxels differ:
/// no code of the gate's.
double min_distance_mm(const Head& head, const grid::Grid<std::int16_t>& g, Vec3& where, double enough = 0) {
  const double in_front = 0.5 * (head.landmark("tragus_left").y + head.landmark("tragus_right").y);
  // Where the eyes are, up to the nasion; farther back the two axes part by some mm.
  const Vec3 nasion = head.landmark("nasion");
  const auto level = [&](Vec3 p) { return nasion.z - (p.y < nasion.y + 35 ? 2 : 10); };
  double least = 7;
  for (int k = 0; k < g.size[2]; ++k)
    for (int j = 0; j < g.size[1]; ++j)
      for (int i = 0; i < g.size[0]; ++i)
        for (int axis = 0; axis < 3; ++axis) {
          const int n[3] = {i + (axis == 0), j + (axis == 1), k + (axis == 2)};
          if (!g.contains(n[0], n[1], n[2]) || g.at(i, j, k) == g.at(n[0], n[1], n[2])) continue;
          const auto at = [&](double t) {
            return g.to_world_mm({i + t * (axis == 0), j + t * (axis == 1), k + t * (axis == 2)});
          };
          if (!(at(0.5).y < in_front + 2) || !(at(0.5).z < level(at(0.5)) + 3)) continue;
          if (std::abs(head.implicit_mm(Anatomy::skin, at(0.5))) > least + 1) continue;
          // Nearly all of an edge shows some value: its end that is nearer to the skin, in the region.
          Vec3 nearest;
          double implicit = 1e9;
          for (const double t : {0.02, 0.5, 0.98}) {
            const double d = std::abs(head.implicit_mm(Anatomy::skin, at(t)));
            if (!(at(t).y < in_front && at(t).z < level(at(t))) || d >= implicit) continue;
            implicit = d;
            nearest = at(t);
          }
          if (implicit > least) continue;
          // Deep under a crease the projection may not arrive at the surface.
          const Vec3 foot = head.project_mm(Anatomy::skin, nearest);
          if (std::abs(head.implicit_mm(Anatomy::skin, foot)) > 0.05) continue;
          if (norm(foot - nearest) < least) where = nearest;
          least = std::min(least, norm(foot - nearest));
          if (least < enough) return least;
        }
  return least;
}

TEST(Deface, NothingIsLeftNearTheTrueSkin) {
  const Scanned& s = small_head();
  Vec3 where;
  EXPECT_LT(min_distance_mm(s.head, std::get<0>(s.volume), where, 0.5), 0.5) << "the control: a face is there";
  for (const face::FaceRemoval policy : {face::FaceRemoval::deface, face::FaceRemoval::crop}) {
    face::DefaceParams p;
    p.policy = policy;
    Report report;
    const grid::HuVolume out = value_of(report, face::deface(s.volume, s.skin, s.region, p));
    EXPECT_GT(min_distance_mm(s.head, std::get<0>(out), where), face::face_clearance_mm)
        << where.x << " " << where.y << " " << where.z;
    EXPECT_GT(figure(report, "face_removed_ml"), policy == face::FaceRemoval::crop ? 400 : 150);
    EXPECT_GT(figure(report, "face_depth_mm"), face::face_clearance_mm);
    EXPECT_TRUE(report.warnings.empty());
    const face::FaceGateResult gate = face::check_face_removed(s.skin, {s.region}, {}, {face::face_volume("ct", out)});
    EXPECT_GE(gate.face_distance_mm, face::face_clearance_mm);
    // The skin found again is closed over the cut, and one piece.
    Report again;
    const grid::Field skin = value_of(again, segmentation::segment(out, {}, head_recipe::skin()));
    EXPECT_NEAR(
        figure(again, "volume_ml"),
        figure(report, "face_removed_ml") * -1 +
            [&] {
              double ml = 0;
              for (const float v : s.skin.voxels) ml += v > 0;
              return ml * s.skin.voxel_volume_mm3() / 1000;
            }(),
        30);
  }
  try {
    face::check_face_removed(s.skin, {s.region}, {}, {face::face_volume("ct", s.volume)});
    ADD_FAILURE() << "the control must be refused";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::privacy);
  }
}

TEST(Deface, AllElseKeepsItsValues) {
  const Scanned& s = small_head();
  face::DefaceParams p;
  Report report;
  const grid::HuVolume out = value_of(report, face::deface(s.volume, s.skin, s.region, p));
  const auto& before = std::get<0>(s.volume);
  const auto& after = std::get<0>(out);
  std::size_t changed_outside = 0, brain_changed = 0, brain = 0;
  for (int k = 0; k < before.size[2]; ++k)
    for (int j = 0; j < before.size[1]; ++j)
      for (int i = 0; i < before.size[0]; ++i) {
        const Vec3 q = before.to_world_mm({double(i), double(j), double(k)});
        const bool changed = before.at(i, j, k) != after.at(i, j, k);
        const double voxel = 2.4;
        const bool outside = s.region.in_front_mm(q) < -(2 * voxel + 1) - p.cover_mm - voxel ||
                             s.region.below_mm(q) < -p.above_mm - p.cover_mm - voxel;
        changed_outside += changed && outside;
        if (outside || s.head.implicit_mm(Anatomy::brain, q) > -1) continue;
        ++brain;
        brain_changed += changed;
      }
  EXPECT_EQ(changed_outside, 0u);
  EXPECT_GT(brain, 1000u) << "temporal lobes lie in the region";
  EXPECT_EQ(brain_changed, 0u);
}

TEST(Deface, TheSameBitsWhateverTheThreadsAndTheSamplesType) {
  const Scanned& s = small_head();
  Report report;
  set_thread_count(1);
  const grid::HuVolume one = value_of(report, face::deface(s.volume, s.skin, s.region, {}));
  set_thread_count(8);
  const grid::HuVolume eight = value_of(report, face::deface(s.volume, s.skin, s.region, {}));
  set_thread_count(0);
  EXPECT_TRUE(one == eight);
  // A skin that covers only a part of the raster, and a volume of floats.
  const auto& whole = std::get<0>(s.volume);
  grid::Grid<float> real(whole);
  for (std::size_t v = 0; v < real.voxels.size(); ++v) real.voxels[v] = whole.voxels[v];
  const grid::HuVolume floats = value_of(report, face::deface(real, s.skin, s.region, {}));
  double worst = 0;
  for (std::size_t v = 0; v < real.voxels.size(); ++v)
    worst = std::max(worst, double(std::abs(std::get<1>(floats).voxels[v] - std::get<0>(one).voxels[v])));
  EXPECT_LE(worst, 0.51);
}

TEST(Deface, WhereThereIsNoFace) {
  const Scanned& s = small_head();
  const auto& g = std::get<0>(s.volume);
  // The vertex alone.
  const grid::Box top{{0, 0, g.size[2] - 20}, g.size};
  const grid::HuVolume vertex = grid::crop(g, top);
  Report report;
  const grid::Field skin = value_of(report, segmentation::segment(vertex, {}, head_recipe::skin()));
  const grid::HuVolume out = value_of(report, face::deface(vertex, skin, s.region, {}));
  EXPECT_TRUE(out == vertex);
  ASSERT_EQ(report.warnings.size(), 1u);
  EXPECT_NE(report.warnings[0].find("no face"), std::string::npos);
  // A nasion in the brain is none.
  head::HeadLandmarks wrong = phantom_heads::face_landmarks(s.head);
  wrong.landmarks[0].position_mm.y += 40;
  try {
    value_of(report, face::deface(s.volume, s.skin, face::face_region(wrong), {}));
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::privacy);
    EXPECT_EQ(e.field(), "landmarks.nasion");
  }
  // Of another raster.
  grid::Field moved = s.skin;
  moved.origin_mm.x += 0.3;
  EXPECT_THROW(value_of(report, face::deface(s.volume, moved, s.region, {})), Error);
}

double dice(const grid::Field& a, const grid::Field& b, const grid::Lattice& l) {
  const grid::Field fa = grid::fit(a, l, -1.f), fb = grid::fit(b, l, -1.f);
  double both = 0, sum = 0;
  for (std::size_t v = 0; v < l.count(); ++v) {
    both += fa.voxels[v] > 0 && fb.voxels[v] > 0;
    sum += int(fa.voxels[v] > 0) + int(fb.voxels[v] > 0);
  }
  return 2 * both / sum;
}

TEST(LongDeface, BrainAndVentriclesAreFoundAsBefore) {
  const Scanned s = scanned(phantom::Level::clinical, 256, 96, 12);
  const head_recipe::Fields before = head_recipe::fields_of(s.volume, 24);
  for (const face::FaceRemoval policy : {face::FaceRemoval::deface, face::FaceRemoval::crop}) {
    face::DefaceParams p;
    p.policy = policy;
    Report report;
    const grid::HuVolume out = value_of(report, face::deface(s.volume, s.skin, s.region, p));
    const head_recipe::Fields after = head_recipe::fields_of(out, 24);
    const grid::Lattice& l = grid::lattice_of(s.volume);
    const double of_brain = dice(before.brain, after.brain, l),
                 of_ventricles = dice(before.ventricles, after.ventricles, l);
    std::printf("Dice before and after: brain %.5f, ventricles %.5f\n", of_brain, of_ventricles);
    // What differs lies in front, over the orbits: their contents are removed up to the nasion.
    EXPECT_GT(of_brain, 0.998);
    EXPECT_GT(of_ventricles, 0.998);
    Vec3 where;
    EXPECT_GT(min_distance_mm(s.head, std::get<0>(out), where), face::face_clearance_mm);
  }
}

}  // namespace
}  // namespace trephine
