// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/deep_csf.h"

#include "head/brain_box.h"
#include "mask/filters.h"

namespace trephine::segmentation {
namespace {

constexpr double cistern_depth_mm = 8;  ///< CSF this near to the brain's surface belongs to sulci and cisterns
constexpr double core_ml = 0.02;        ///< ventricles hold a core at least this large in one of the boxes below
constexpr double strict_hu = 1;  ///< connections are decided this much below the edge, so that oedema does not join in,
constexpr double regrow_mm = 2;  ///< and the result is then grown to the edge by at most this

/// The core of a ventricle: a ball of that radius fits in, at that depth under the brain's surface.
struct Core {
  double radius_mm, depth_mm;
  BrainBox box;
};
// Cysts, old defects and oedema mostly lie beside these boxes.
constexpr Core lateral_ventricles{1.5, 25, {{-15, -70, -10}, {15, 70, 20}}};
constexpr Core third_ventricle{0.5, 12, {{-12, -30, -18}, {12, 5, 5}}};
constexpr BrainBox behind_the_third{{-20, 11, -1000}, {20, 1000, -10}};    ///< quadrigeminal, cerebellar cisterns
constexpr BrainBox below_the_third{{-20, -1000, -1000}, {20, 1000, -28}};  ///< fourth ventricle, basal cisterns

/// Seeds for the watershed in the CSF: 1 in the cores of the ventricles, 2 in cisterns and near the brain's surface.
Mask seeds_of(const BitMask& csf, const Grid<float>& depth, Vec3 centre_mm, const Progress& progress) {
  const Lattice& l = csf.lattice();
  const auto from_centre = [&](int i, int j, int k) {
    return l.to_world_mm({double(i), double(j), double(k)}) - centre_mm;
  };
  BitMask cores(l);
  for (const Core& core : {lateral_ventricles, third_ventricle}) {
    BitMask wide = eroded(csf, core.radius_mm, progress);
    wide &= make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i)
        row[i] = depth.at(i, j, k) >= core.depth_mm && core.box.holds(from_centre(i, j, k));
    });
    cores |= at_least_ml(components(wide), core_ml);
  }
  Mask seeds(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        if (!csf.get(i, j, k)) continue;
        const Vec3 p = from_centre(i, j, k);
        const bool other =
            depth.at(i, j, k) < cistern_depth_mm || behind_the_third.holds(p) || below_the_third.holds(p);
        seeds.at(i, j, k) = cores.get(i, j, k) ? 1 : other ? 2 : 0;
      }
  return seeds;
}

}  // namespace

BitMask deep_csf(const Grid<float>& soft, const BitMask& envelope, double lower_hu, double upper_hu,
                 const Progress& progress, BitMask* others) {
  const Lattice& l = soft;
  const auto fluid = [&](double below) {
    BitMask mask = make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i) row[i] = soft.at(i, j, k) > lower_hu && soft.at(i, j, k) < below;
    });
    return mask &= envelope;
  };
  BitMask outside = envelope;
  outside.invert();
  const Grid<float> depth = distance_mm(outside, progress);
  const BitMask csf = fluid(upper_hu - strict_hu);
  BitMask other = csf;
  other.invert();
  const Mask labels =
      flood(distance_mm(other, progress), csf, seeds_of(csf, depth, envelope.centre_mm(), progress), progress);
  BitMask mine = make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = labels.at(i, j, k) == 1;
  });
  mine = at_least_ml(components(mine), ventricle_speck_ml);
  // Grown back to the edge, but not into the fluid of other spaces.
  BitMask free = fluid(upper_hu);
  BitMask apart = make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = labels.at(i, j, k) == 2;
  });
  free.remove(apart);
  if (others) *others = std::move(apart);
  return grown_within(mine, free, regrow_mm, progress);
}

}  // namespace trephine::segmentation
