// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include "base/error.h"
#include "phantom/measure_truth.h"
#include "phantom/phantom.h"
#include "phantom/random.h"
#include "scratch_folder.h"

using namespace trephine;
using namespace trephine::phantom;

namespace {

phantom::PhantomParams hard_phantom() {
  phantom::PhantomParams p;
  p.head.level = phantom::Level::hard;
  p.scan.columns_count = p.scan.rows_count = 128;
  p.scan.field_of_view_mm = 256;
  p.scan.slices_count = 40;
  p.scan.slice_step_mm = p.scan.slice_thickness_mm = 5;
  p.scan.noise_hu = 0;
  p.truth.mesh_step_mm = 0;
  return p;
}

std::map<int, double> shares(const grid::Mask& labels) {
  std::map<int, double> out;
  for (const std::uint8_t v : labels.voxels) out[v] += labels.voxel_volume_mm3() / 1000;
  return out;
}

grid::Lattice lattice(const phantom::PhantomParams& p) {
  return phantom::lattice_of(phantom::Scan{p.scan.columns_count,
                                           p.scan.rows_count,
                                           phantom::pixel_spacing_mm(p.scan),
                                           phantom::slice_poses(p.scan),
                                           {},
                                           false});
}

/// Where, in the slice's middle, a Gaussian of noise has this neighbour correlation and this standard deviation.
struct Texture {
  double sd = 0, neighbour = 0, slices = 0;
};
Texture texture_of(const phantom::Scan& s) {
  double sum = 0, next = 0, above = 0;
  std::size_t n = 0;
  const auto at = [&](int i, int j, int k) {
    return s.hu[(std::size_t(k) * s.rows + j) * s.columns + i] + 1000.0;  // of air
  };
  for (int k = 0; k + 1 < int(s.slices.size()); ++k)
    for (int j = 4; j < s.rows - 4; ++j)
      for (int i = 4; i < s.columns - 4; ++i, ++n)
        sum += at(i, j, k) * at(i, j, k), next += at(i, j, k) * at(i + 1, j, k), above += at(i, j, k) * at(i, j, k + 1);
  return {std::sqrt(sum / n), next / sum, above / sum};
}

}  // namespace

// Every thing that is asked for is in the truth, in a plausible amount, and nothing that is not asked for.
TEST(PhantomHard, TruthHoldsWhatIsAskedForAndNothingElse) {
  phantom::PhantomParams p = hard_phantom();
  const auto bare = shares(phantom::truth_things(phantom::Head(p.head), lattice(p)));
  EXPECT_EQ(bare.size(), 2u) << "none, and one filling";
  phantom::HardParams& h = p.head.hard;
  h.mask = h.couch = h.clamps = h.burr_hole = h.shunt = h.plexus = h.contrast = h.craniectomy = h.clip = true;
  h.blood = phantom::Blood::intracerebral;
  const phantom::Head head(p.head);
  auto things = shares(phantom::truth_things(head, lattice(p)));
  auto labels = shares(phantom::truth_labels(head, lattice(p)));
  const auto within = [&](phantom::Thing t, double low, double high) {
    EXPECT_GT(things[int(t)], low) << int(t);
    EXPECT_LT(things[int(t)], high) << int(t);
  };
  within(phantom::Thing::mask, 60, 250);
  within(phantom::Thing::couch, 300, 1500);
  within(phantom::Thing::head_rest, 200, 900);
  within(phantom::Thing::clamp, 80, 160);
  within(phantom::Thing::blood, 5, 40);
  within(phantom::Thing::bone_defect, 15, 70);
  within(phantom::Thing::vessel, 3, 25);
  within(phantom::Thing::catheter, 0.3, 5);
  EXPECT_GT(labels[6], 8) << "vertebrae: the first two";
  const double apparatus = things[1] + things[2] + things[3] + things[4] + things[5];
  EXPECT_NEAR(labels[7], apparatus, 1e-9 * apparatus);
  EXPECT_EQ(head.things_mm().size(), 6u);
}

// Blocks of a slice that are wholly within one tissue are found by the clearance, so it must hold for things too.
TEST(PhantomHard, ClearanceIsALowerBound) {
  phantom::HeadParams first, second;
  first.level = second.level = phantom::Level::hard;
  phantom::HardParams& h = first.hard;
  h.mask = h.couch = h.clamps = h.burr_hole = h.shunt = h.plexus = h.contrast = h.shoulders = true;
  h.blood = phantom::Blood::subdural;
  second.hard.craniectomy = second.hard.clip = true;
  second.hard.blood = phantom::Blood::intracerebral;
  second.hard.asymmetry_ratio = 0.5;
  second.hard.motion_mm = 5;
  for (const phantom::HeadParams& params : {first, second}) {
    const phantom::Head head(params);
    int tried = 0, wrong = 0;
    for (int i = 0; i < 60000; ++i) {
      const Vec3 p{130 * phantom::uniform(9, 1, 3 * i), 140 * phantom::uniform(9, 1, 3 * i + 1),
                   130 * phantom::uniform(9, 1, 3 * i + 2)};
      const phantom::Head::Sample s = head.sample(p, 0.5);
      if (s.clearance_mm < 0.3) continue;
      ++tried;
      for (int n = 0; n < 3; ++n) {
        const Vec3 u{phantom::uniform(9, 2, 9 * i + 3 * n), phantom::uniform(9, 2, 9 * i + 3 * n + 1),
                     phantom::uniform(9, 2, 9 * i + 3 * n + 2)};
        const Vec3 q = p + normalized(u) * (0.999 * s.clearance_mm);
        if (head.sample(q, 0.5).hu == s.hu && head.label(q) == head.label(p)) continue;
        if (++wrong < 6)
          ADD_FAILURE() << p.x << " " << p.y << " " << p.z << " clearance " << s.clearance_mm << ", " << s.hu << " HU, "
                        << head.sample(q, 0.5).hu << " at " << q.x << " " << q.y << " " << q.z;
      }
    }
    EXPECT_GT(tried, 20000);
    EXPECT_EQ(wrong, 0);
  }
}

// The mask lies on the skin: nowhere within it, in places within half a millimetre, and it is full of holes.
TEST(PhantomHard, MaskLiesOnTheSkinWithHoles) {
  phantom::PhantomParams p = hard_phantom();
  p.head.hard.mask = true;
  const phantom::Head head(p.head);
  int near = 0, sheet = 0, rays = 0, lifted = 0;
  for (int i = 0; i < 3000; ++i) {
    Vec3 u{phantom::uniform(3, 1, 3 * i), -std::fabs(phantom::uniform(3, 1, 3 * i + 1)),
           phantom::uniform(3, 1, 3 * i + 2)};
    if (norm(u) > 1 || norm(u) < 0.1 || u.z < -0.4 * norm(u)) continue;
    ++rays;
    double gap = -1;
    for (double t = 60; t < 160 && gap < 0; t += 0.2) {
      const Vec3 q = Vec3{0, -5, 25} + normalized(u) * t;
      if (head.implicit_mm(phantom::Anatomy::skin, q) > 0 && head.thing(q) == phantom::Thing::mask)
        gap = head.signed_distance_mm(phantom::Anatomy::skin, q);
    }
    sheet += gap >= 0;
    near += gap >= 0 && gap < 0.5;
    lifted += gap > 6;
  }
  std::printf("%d rays, %d through the sheet, %d with it on the skin, %d with it 6 mm off\n", rays, sheet, near,
              lifted);
  EXPECT_GT(sheet, 0.4 * rays);
  EXPECT_LT(sheet, 0.8 * rays);
  EXPECT_GT(near, 0.15 * sheet);
  EXPECT_GT(lifted, 0.03 * sheet);
}

// HU as the two real scans show them, through kernel and slices.
TEST(PhantomHard, ApparatusHasTheHuOfRealScans) {
  phantom::PhantomParams p = hard_phantom();
  p.head.hard.mask = p.head.hard.couch = p.head.hard.clamps = true;
  p.scan.columns_count = p.scan.rows_count = 512;
  p.scan.field_of_view_mm = 250;
  p.scan.slices_count = 3;
  p.scan.slice_step_mm = p.scan.slice_thickness_mm = 2;
  p.scan.centre_mm = {0, 0, 55};
  const phantom::Head head(p.head);
  const phantom::Scan s = phantom::scan(head, p.scan);
  std::map<phantom::Thing, std::vector<double>> hu;
  for (int j = 0; j < s.rows; ++j)
    for (int i = 0; i < s.columns; ++i) {
      const Vec3 q = s.position_mm(i, j, 1);
      if (const phantom::Thing t = head.thing(q); t != phantom::Thing::none)
        hu[q.y > 60 && t == phantom::Thing::mask ? phantom::Thing::vessel : t].push_back(
            s.hu[(std::size_t(s.rows) + j) * s.columns + i]);
    }
  const auto median = [&](phantom::Thing t) {
    std::vector<double>& v = hu[t];
    if (v.empty()) return -2000.0;
    std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
    return v[v.size() / 2];
  };
  EXPECT_NEAR(median(phantom::Thing::mask), -300, 170) << "strands";
  EXPECT_NEAR(median(phantom::Thing::clamp), 140, 30);
  EXPECT_NEAR(median(phantom::Thing::couch), -455, 30);
  EXPECT_NEAR(median(phantom::Thing::head_rest), -960, 25);
}

// Burr hole, craniectomy and blood change the skull and the brain, and only they.
TEST(PhantomHard, ShapesFollowTheirThings) {
  phantom::PhantomParams p = hard_phantom();
  const phantom::Head whole(p.head);
  p.head.hard.burr_hole = true;
  const phantom::Head holed(p.head);
  const Vec3 hole = holed.things_mm().front().second;
  EXPECT_GT(whole.implicit_mm(phantom::Anatomy::skull, hole), -1);
  EXPECT_LT(whole.signed_distance_mm(phantom::Anatomy::skull, hole), 1);
  EXPECT_GT(holed.signed_distance_mm(phantom::Anatomy::skull, hole), 5.5) << "7 mm of radius";
  EXPECT_LT(norm(hole - whole.landmark("kocher_right")), 30);
  EXPECT_LT(holed.implicit_mm(phantom::Anatomy::skin, hole), -2) << "closed by the scalp";
  for (const phantom::Anatomy a : {phantom::Anatomy::brain, phantom::Anatomy::ventricles})
    EXPECT_EQ(holed.implicit_mm(a, {-20, -20, 70}), whole.implicit_mm(a, {-20, -20, 70}));

  p.head.hard.burr_hole = false;
  p.head.hard.asymmetry_ratio = 0.5;
  const phantom::Head uneven(p.head);
  surface::Bounds left, right;
  left.min_mm = {0, -90, 0}, left.max_mm = {60, 90, 100};
  right.min_mm = {-60, -90, 0}, right.max_mm = {0, 90, 100};
  const double l = surface::volume_mm3(phantom::truth_mesh(uneven, phantom::Anatomy::ventricles, left, 1.5)),
               r = surface::volume_mm3(phantom::truth_mesh(uneven, phantom::Anatomy::ventricles, right, 1.5));
  EXPECT_LT(std::min(l, r), 0.5 * std::max(l, r));

  p.head.hard.asymmetry_ratio = 0;
  p.head.variant = phantom::Variant::slit;
  surface::Bounds both = left;
  both.min_mm.x = -60;
  const double slit =
      surface::volume_mm3(phantom::truth_mesh(phantom::Head(p.head), phantom::Anatomy::ventricles, both, 0.8)) / 1000;
  EXPECT_GT(slit, 1);
  EXPECT_LT(slit, 4.5);
}

// Motion moves truth and scan alike; below its height nothing changes.
TEST(PhantomHard, MotionMovesTheUpperPart) {
  phantom::PhantomParams p = hard_phantom();
  const phantom::Head still(p.head);
  p.head.hard.motion_mm = 5;
  const phantom::Head moved(p.head);
  EXPECT_EQ(still.landmark("nasion"), moved.landmark("nasion"));
  const Vec3 by = moved.landmark("monro_left") - still.landmark("monro_left");
  EXPECT_NEAR(norm(by), 5, 1e-6);
  EXPECT_EQ(by.z, 0);
  for (int i = 0; i < 300; ++i) {
    const Vec3 q{90 * phantom::uniform(9, 1, 3 * i), 90 * phantom::uniform(9, 1, 3 * i + 1),
                 45 + 60 * phantom::uniform(9, 1, 3 * i + 2)};
    if (q.z > 46) {
      EXPECT_EQ(moved.label(q + by), still.label(q));
    } else if (q.z < 42) {
      EXPECT_EQ(moved.label(q), still.label(q));
    }
  }
}

// A sharp kernel has more noise, neighbours that do not go together, and the same rays; thick overlapping slices share
// noise.
TEST(PhantomHard, KernelsOfOneScanShareTheirNoise) {
  phantom::PhantomParams p = hard_phantom();
  p.scan.columns_count = p.scan.rows_count = 96;
  p.scan.field_of_view_mm = 48;
  p.scan.centre_mm = {0, -300, 40};  // air
  p.scan.slices_count = 12;
  p.scan.noise_hu = 6;
  p.scan.slice_step_mm = 1;
  p.scan.slice_thickness_mm = 2;
  p.scan.table = false;
  const phantom::Head head(p.head);
  const phantom::Scan soft = phantom::scan(head, p.scan), sharp = phantom::scan(head, p.scan, phantom::Kernel{0.6, 2});
  const Texture a = texture_of(soft), b = texture_of(sharp);
  std::printf("soft %.2f HU, neighbours %.2f, slices %.2f; sharp %.2f, %.2f, %.2f\n", a.sd, a.neighbour, a.slices, b.sd,
              b.neighbour, b.slices);
  EXPECT_NEAR(a.sd, 6, 0.6);
  EXPECT_GT(b.sd, 2.5 * a.sd);
  EXPECT_GT(a.neighbour, 0.6);
  EXPECT_LT(b.neighbour, 0.3);
  EXPECT_NEAR(a.slices, 2.0 / 3, 0.08) << "two slices of 2 mm at 1 mm: weights of 1/2, 1, 1/2";
  double together = 0;
  for (std::size_t i = 0; i < soft.hu.size(); ++i) together += (soft.hu[i] + 1000.0) * (sharp.hu[i] + 1000.0);
  EXPECT_GT(together / double(soft.hu.size()) / (a.sd * b.sd), 0.3);
}

// measure says how much apparatus a field holds; things are refused at other levels and round a patient on the belly.
TEST(PhantomHard, MeasureSaysHowMuchApparatusIsInASurface) {
  phantom::PhantomParams p = hard_phantom();
  p.head.hard.couch = true;
  p.scan.slices_count = 5;
  p.scan.centre_mm = {0, 0, 60};
  ScratchFolder folder;
  phantom::make_phantom(folder.path(), p);
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "truth/things.nrrd"));
  const phantom::Truth truth = phantom::read_truth(folder.path() / "truth/truth.json");
  EXPECT_TRUE(truth.head.params().hard.couch);
  const grid::Mask labels = phantom::truth_labels(truth.head, lattice(p));
  grid::Field body(static_cast<const grid::Lattice&>(labels)), with(static_cast<const grid::Lattice&>(labels));
  double apparatus = 0;
  for (std::size_t i = 0; i < labels.voxels.size(); ++i) {
    body.voxels[i] = labels.voxels[i] > 0 && labels.voxels[i] < 7 ? 1.0f : -1.0f;
    with.voxels[i] = labels.voxels[i] > 0 ? 1.0f : -1.0f;
    apparatus += labels.voxels[i] == 7 ? labels.voxel_volume_mm3() / 1000 : 0;
  }
  const phantom::TruthSurface skin = phantom::truth_surface(truth, phantom::Anatomy::skin);
  EXPECT_EQ(*phantom::measure_against_truth(body, skin, 200).apparatus_ml, 0);
  EXPECT_NEAR(*phantom::measure_against_truth(with, skin, 200).apparatus_ml, apparatus, 1e-6);

  phantom::PhantomParams prone = p;
  prone.scan.position = phantom::Position::head_first_prone;
  EXPECT_THROW(phantom::make_phantom(folder.path(), prone), Error);
  phantom::PhantomParams easy = p;
  easy.head.level = phantom::Level::clinical;
  EXPECT_THROW(phantom::make_phantom(folder.path(), easy), Error);
}
