// SPDX-License-Identifier: GPL-3.0-or-later
// On a ball, a step and a ramp of HU what is seen, what is touched and what a drill leaves lie at the same place.
#include <gtest/gtest.h>

#include <random>

#include "cast_phantoms.h"
#include "contact/contact.h"
#include "voxel/cut.h"

namespace trephine::casting {
namespace {

constexpr double spacing = 0.8, near_mm = 0.05 * spacing;
constexpr int segments = 1000, bone = 1;

struct Phantom {
  const char* name;
  grid::Grid<std::int16_t> voxels;
  std::function<double(Vec3)> above_mm;  // of the surface where the HU are `hu`, along its normal; grows outwards
  double hu;
};

std::vector<Phantom> phantoms(double hu) {
  const grid::Lattice l = lattice(40, spacing);
  const Vec3 middle = middle_of(l), normal = normalized(Vec3{0.4, 0.3, 0.87});
  std::vector<Phantom> all;
  all.push_back({"ball", ball(l, 11, 100), [=](Vec3 p) { return norm(p - middle) - (11 - hu / 100); }, hu});
  for (const auto& [name, hu_per_mm] : {std::pair{"step", 500.0}, {"ramp", 60.0}})
    all.push_back({name,
                   filled(l, [=](Vec3 p) { return std::clamp(hu_per_mm * dot(normal, middle - p), -990.0, 1000.0); }),
                   [=](Vec3 p) { return dot(normal, p - middle) + hu / hu_per_mm; }, hu});
  return all;
}

// `in_soft`: what has fewer HU is another shape's, down to -900.
voxel::HapticVolume volume_of(const Phantom& p, int low, bool in_soft) {
  voxel::HapticVolume v;
  v.encoding = voxel::HapticEncoding::hu;
  v.voxels = p.voxels;
  v.shapes = {{"bone", bone, std::int16_t(low), 3071}};
  if (in_soft) v.shapes.push_back({"soft", 2, -900, std::int16_t(low - 1)});
  return v;
}

// Where a ray towards that place first sees something, and where a segment along it first touches.
struct Met {
  double seen_mm = 0, touched_mm = 0;
  bool both = false;
  Vec3 at_mm, eye_mm, along, normal;
};

class Meeting {
 public:
  Meeting(voxel::HapticVolume& v, const voxel::TransferFunction& f)
      : volume_(v), contact_(v), table_({f}), bricks_(v.voxels, table_) {}
  /// Of the shape `bone` alone.
  Met meet(Vec3 from, Vec3 to) const {
    scene::EyeView eye = eye_at(volume_.voxels, {0, 0, 1}, 1);
    eye.eye_mm = from;
    eye.toward = normalized(from - to);
    eye.right = normalized(cross(Vec3{0.1, 0.2, 1}, eye.toward));
    eye.up = cross(eye.toward, eye.right);
    const cast::CastPicture p = cast::cast_rays(volume_.voxels, table_, bricks_, eye, 1, 1);
    const contact::Contact c = contact_.intersect(from, to, {1u << bone, 1u << bone});
    Met m{double(p.begins_mm[0]), norm(c.point_mm - from), false, c.point_mm, from, normalized(to - from), c.normal};
    m.both = c.hit && m.seen_mm <= norm(to - from);
    return m;
  }

 private:
  const voxel::HapticVolume& volume_;
  contact::ContactVolume contact_;
  cast::CastTable table_;
  cast::CastBricks bricks_;
};

// 1,000 segments from outside to about the middle; of each the way along the surface's normal counts.
void expect_agreement(const Phantom& p, voxel::HapticVolume& v, const voxel::TransferFunction& f, bool whole) {
  std::mt19937_64 rng(9);
  const Meeting meeting(v, f);
  const Vec3 middle = middle_of(p.voxels);
  int met = 0, apart = 0, astray = 0;
  for (int n = 0; n < segments; ++n) {
    const auto some = [&] { return double(rng() >> 11) * 0x1p-53 * 2 - 1; };
    const Vec3 side = normalized(Vec3{some(), some(), some()}), to = middle + Vec3{some(), some(), some()} * 2;
    const Vec3 from = middle + (p.above_mm(middle + side * 9) > 0 ? side : -side) * 100;
    const Met m = meeting.meet(from, middle + normalized(to - from) * 8);
    if (!m.both || p.above_mm(m.at_mm + m.along * -1) < 0) continue;  // it came in by the volume's border
    const double across = std::abs(dot(m.normal, m.along));
    if (across < 0.3) continue;
    ++met;
    apart += std::abs(m.seen_mm - m.touched_mm) * across > near_mm;
    astray += whole && (std::abs(p.above_mm(m.at_mm)) > near_mm ||
                        std::abs(p.above_mm(m.eye_mm + m.along * m.seen_mm)) > near_mm);
  }
  EXPECT_GT(met, segments / 3) << p.name;
  EXPECT_EQ(apart, 0) << p.name << " of " << met;
  EXPECT_EQ(astray, 0) << p.name << " of " << met;
}

}  // namespace

TEST(CastTouch, SightTouchAndDrillAgreeOnTheSurface) {
  for (const double opacity : {0.25, 0.5, 0.75}) {
    // Opacity rises from 0 at 100 HU to 1 at 300: what is touched begins at the HU where it is that opaque.
    voxel::TransferFunction f = ramp(100, 300);
    f.touched_from_opacity = opacity;
    const int low = (*voxel::touched_hu(f))[0];
    EXPECT_EQ(low, int(100 + 200 * opacity));
    for (const Phantom& p : phantoms(low)) {
      SCOPED_TRACE(opacity);
      for (const bool in_soft : {false, true}) {
        SCOPED_TRACE(in_soft);
        voxel::HapticVolume v = volume_of(p, low, in_soft);
        const voxel::TransferFunction seen = voxel::window_function(low, 3071, {1, 1, 1});
        expect_agreement(p, v, seen, true);
        if (in_soft) continue;  // beside what was cut some cells are felt as boxes
        // What a ball leaves of it is touched and seen at one place, too.
        const Vec3 at = middle_of(p.voxels) + normalized(Vec3{0.4, 0.3, 0.87}) * 6;
        voxel::cut_volume(v, [at](Vec3 q) { return norm(q - at) - 5; }, {at - Vec3{5, 5, 5}, at + Vec3{5, 5, 5}}, {1});
        expect_agreement(p, v, seen, false);
      }
    }
  }
}

}  // namespace trephine::casting
