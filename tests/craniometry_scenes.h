// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Phantoms with the fields that pipelines/ventriculostomy.yaml makes of them.
#include <cmath>

#include "base/pi.h"
#include "head/brain.h"
#include "head/landmarks.h"
#include "head/ventricles.h"
#include "head_recipe.h"
#include "phantom/head.h"
#include "phantom/scan.h"
#include "segmentation/segment.h"

namespace trephine {

struct LandmarkScene : head_recipe::Fields {
  phantom::Head head{phantom::HeadParams{}};
  grid::HuVolume volume;

  head::LandmarkInputs inputs() const {
    head::LandmarkInputs in;
    in.skin = &skin;
    in.skull = &skull;
    in.ventricles = &ventricles;
    return in;
  }
};

inline void segment_scene(LandmarkScene& s) {
  static_cast<head_recipe::Fields&>(s) = head_recipe::fields_of(s.volume, 24);
}

inline LandmarkScene make_scene(const phantom::HeadParams& who, const phantom::ScanParams& how) {
  LandmarkScene s;
  s.head = phantom::Head(who);
  s.volume = phantom::volume_of(phantom::scan(s.head, how));
  segment_scene(s);
  return s;
}

/// A turn about x, then y, then z, degrees.
inline Mat3 turn_deg(double x, double y, double z) {
  const double k = pi / 180;
  Mat3 m;
  for (Vec3& c : m.column) {
    c = {c.x, c.y * std::cos(x * k) - c.z * std::sin(x * k), c.y * std::sin(x * k) + c.z * std::cos(x * k)};
    c = {c.x * std::cos(y * k) + c.z * std::sin(y * k), c.y, -c.x * std::sin(y * k) + c.z * std::cos(y * k)};
    c = {c.x * std::cos(z * k) - c.y * std::sin(z * k), c.x * std::sin(z * k) + c.y * std::cos(z * k), c.z};
  }
  return m;
}

/// The same voxels in a head that is turned about the origin and moved.
inline void turn(grid::Lattice& l, const Mat3& m, Vec3 move) {
  l.origin_mm = m * l.origin_mm + move;
  for (Vec3& c : l.direction.column) c = m * c;
}
inline LandmarkScene turned(LandmarkScene s, const Mat3& m, Vec3 move) {
  std::visit([&](auto& g) { turn(g, m, move); }, s.volume);
  for (grid::Field* f : {&s.skin, &s.skull, &s.brain, &s.ventricles}) turn(*f, m, move);
  return s;
}

/// What a scan of a part of the head would have given: the volume and the fields within the world's box.
inline LandmarkScene cut(LandmarkScene s, Vec3 low, Vec3 high) {
  const auto box_of = [&](const grid::Lattice& l) {
    grid::Box b = grid::whole_box(l);
    const Vec3 from = l.to_index(low), to = l.to_index(high);
    for (int a = 0; a < 3; ++a) {
      b.begin[a] = std::max(b.begin[a], int(std::ceil(from[a])));
      b.end[a] = std::min(b.end[a], int(std::floor(to[a])) + 1);
    }
    return b;
  };
  std::visit([&](auto& g) { g = grid::crop(g, box_of(g)); }, s.volume);
  for (grid::Field* f : {&s.skin, &s.skull, &s.brain, &s.ventricles})
    if (!box_of(*f).empty()) *f = grid::crop(*f, box_of(*f));
  return s;
}

}  // namespace trephine
