// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/deep_csf.h"

#include <algorithm>
#include <cmath>

#include "head/brain_box.h"
#include "mask/filters.h"

namespace trephine::head {
namespace {

constexpr double cistern_depth_mm = 8;  ///< CSF this near to the brain's surface belongs to sulci and cisterns
constexpr double core_ml = 0.02;        ///< ventricles hold a core at least this large in one of the boxes below
constexpr double strict_hu = 1;  ///< connections are decided this much below the edge, so that oedema does not join in,
constexpr double wide_depth_mm = 15, wide_mm = 1.2;
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

/// Seeds by boxes about the envelope's centre.
grid::Mask seeds_by_boxes(const mask::BitMask& csf, const grid::Grid<float>& depth, Vec3 centre_mm,
                          const Progress& progress) {
  const grid::Lattice& l = csf.lattice();
  const auto from_centre = [&](int i, int j, int k) {
    return l.to_world_mm({double(i), double(j), double(k)}) - centre_mm;
  };
  mask::BitMask cores(l);
  for (const Core& core : {lateral_ventricles, third_ventricle}) {
    mask::BitMask wide = mask::eroded(csf, core.radius_mm, progress);
    wide &= mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i)
        row[i] = depth.at(i, j, k) >= core.depth_mm && core.box.holds(from_centre(i, j, k));
    });
    cores |= mask::at_least_ml(mask::components(wide), core_ml);
  }
  grid::Mask seeds(l);
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

// In the template, mm. A place is reached where its distance is at most this; heads differ by 3 to 5 mm.
constexpr double lateral_reach_mm = 8, third_reach_mm = 4, other_reach_mm = 2;
constexpr double lateral_depth_mm = 14, third_depth_mm = 12;
constexpr double midline_slack_mm = 8;  ///< so far a mass may shift the third ventricle sideways
constexpr double sheet_mm = 2.2;        ///< the fissure is narrower than twice this

// The third ventricle, mostly a slit that no voxel lies in wholly: darker than both sides by this, over this distance.
constexpr double slit_hu = 6, slit_contrast_hu = 5, slit_beside_mm = 7, slit_reach_mm = 3, slit_ml = 0.15;
constexpr double third_front_mm = -26, third_back_mm = 6;  ///< where it is sought
constexpr double strange_mm = 8, strange_share = 0.5;  ///< a piece of which more than this lies farther off is a cyst

/// The third ventricle may be shifted sideways.
double third_mm(Vec3 p) {
  p.x = std::copysign(std::max(0.0, std::abs(p.x) - midline_slack_mm), p.x);
  return place::place_mm(place::Place::third, p);
}

double lateral_mm(Vec3 p) {
  return std::min(place::place_mm(place::Place::lateral_left, p), place::place_mm(place::Place::lateral_right, p));
}

/// The slit of the third ventricle: dark, between two brighter sides, where it should be; empty where there is none.
mask::BitMask third_slit(const grid::Grid<float>& soft, const mask::BitMask& envelope, const place::HeadPlace& place,
                         double lower_hu, double upper_hu) {
  const grid::Lattice& l = soft;
  const Vec3 aside = transpose_times(l.direction, place.axes.column[0]) * slit_beside_mm;
  const int step[3] = {int(std::lround(aside.x / l.spacing_mm.x)), int(std::lround(aside.y / l.spacing_mm.y)),
                       int(std::lround(aside.z / l.spacing_mm.z))};
  const mask::BitMask dark = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) {
      row[i] = 0;
      const float v = soft.at(i, j, k);
      if (!(v > lower_hu && v < upper_hu + slit_hu) || !envelope.get(i, j, k)) continue;
      const Vec3 p = place.to_template(l.to_world_mm({double(i), double(j), double(k)}));
      if (p.y < third_front_mm || p.y > third_back_mm || third_mm(p) > slit_reach_mm) continue;
      row[i] = 1;
      for (const int side : {-1, 1}) {
        const int a = i + side * step[0], b = j + side * step[1], c = k + side * step[2];
        if (!l.contains(a, b, c) || !envelope.get(a, b, c) || soft.at(a, b, c) < v + slit_contrast_hu) row[i] = 0;
      }
    }
  });
  return mask::at_least_ml(mask::components(dark, true), slit_ml);
}

/// The pieces most of which lies where ventricles do.
mask::BitMask in_place(const mask::BitMask& mask, const place::HeadPlace& place) {
  const mask::Components pieces = mask::components(mask);
  std::vector<double> near(pieces.list.size(), 0);
  mask::for_each_voxel(pieces, [&](int component, int i, int j, int k) {
    const Vec3 p = place.to_template(pieces.lattice.to_world_mm({double(i), double(j), double(k)}));
    near[std::size_t(component)] += std::min(lateral_mm(p), third_mm(p)) <= strange_mm;
  });
  std::vector<char> keep;
  for (std::size_t c = 0; c < near.size(); ++c)
    keep.push_back(near[c] >= strange_share * double(pieces.list[c].voxels));
  return mask::select(pieces, keep);
}

/// What is thin, begins off the ventricles' place and leads far away from it: a streak of a catheter or clip, or a
/// sulcus that touches. A wide ventricle that reaches as far is not thin.
mask::BitMask strands(const mask::BitMask& mask, const place::HeadPlace& place, const Progress& progress) {
  constexpr double thin_mm = 2.5, begins_mm = 6, reaches_mm = 14;
  mask::BitMask thin = mask;
  thin.remove(mask::dilated(mask::eroded(mask, thin_mm, progress), thin_mm + 0.5, progress));
  const auto farther = [&](double mm) {
    return mask::make_mask(mask.lattice(), [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < mask.lattice().size[0]; ++i) {
        row[i] = thin.get(i, j, k);
        if (!row[i]) continue;
        const Vec3 p = place.to_template(mask.lattice().to_world_mm({double(i), double(j), double(k)}));
        row[i] = std::min(lateral_mm(p), third_mm(p)) > mm;
      }
    });
  };
  const mask::Components pieces = mask::components(farther(begins_mm), true);
  return mask::select(pieces, mask::touching(pieces, farther(reaches_mm)));
}

/// y of the calcified pineal gland in the template, which lies behind the third ventricle; 14 where there is none.
double pineal_y(const grid::Grid<float>& soft, const place::HeadPlace& place) {
  constexpr float bone_hu = 55;
  constexpr double usual_y = 14, min_mm3 = 30;
  double sum = 0;
  std::size_t count = 0;
  for (int k = 0; k < soft.size[2]; ++k)
    for (int j = 0; j < soft.size[1]; ++j)
      for (int i = 0; i < soft.size[0]; ++i) {
        const float v = soft.at(i, j, k);
        if (!(v > bone_hu && v < 1000)) continue;
        const Vec3 p = place.to_template(soft.to_world_mm({double(i), double(j), double(k)}));
        if (std::abs(p.x) > 7 || p.y < 2 || p.y > 24 || p.z < 32 || p.z > 52) continue;
        sum += p.y;
        ++count;
      }
  return double(count) * soft.voxel_volume_mm3() < min_mm3 ? usual_y : std::min(usual_y, sum / double(count) + 1);
}

/// Seeds by place: 1 in the cores of the ventricles, 2 in cisterns, fissures and near the brain's surface.
grid::Mask seeds_by_place(const grid::Grid<float>& soft, const mask::BitMask& csf, const mask::BitMask& slit,
                          const grid::Grid<float>& depth, const place::HeadPlace& place, const Progress& progress) {
  const grid::Lattice& l = csf.lattice();
  const auto at = [&](int i, int j, int k) {
    return place.to_template(l.to_world_mm({double(i), double(j), double(k)}));
  };
  mask::BitMask lateral = mask::eroded(csf, lateral_ventricles.radius_mm, progress),
                third = mask::eroded(csf, third_ventricle.radius_mm, progress);
  lateral &= mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i)
      row[i] =
          lateral.get(i, j, k) && depth.at(i, j, k) >= lateral_depth_mm && lateral_mm(at(i, j, k)) <= lateral_reach_mm;
  });
  third &= mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) {
      row[i] = 0;
      if (!third.get(i, j, k) || depth.at(i, j, k) < third_depth_mm) continue;
      const Vec3 p = at(i, j, k);
      row[i] = p.y <= third_back_mm && third_mm(p) <= third_reach_mm;
    }
  });
  mask::BitMask cores = mask::at_least_ml(mask::components(lateral), core_ml);
  cores |= mask::at_least_ml(mask::components(third), core_ml);
  cores |= slit;
  // Narrow in every slice across the midline: the fissure, never a ventricle's body.
  mask::BitMask sheet = csf;
  sheet.remove(mask::dilated(mask::eroded(csf, sheet_mm, progress), sheet_mm + 1, progress));
  const double pineal = pineal_y(soft, place);
  grid::Mask seeds(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        if (!csf.get(i, j, k)) continue;
        const Vec3 p = at(i, j, k);
        const double beside = std::abs(p.x), ventricle = std::min(lateral_mm(p), third_mm(p));
        const bool behind = beside < 14 && p.y > pineal && p.z < 46 && lateral_mm(p) > 4;
        const bool below = p.z < 17 && ventricle > 6;
        const bool basal = place::place_mm(place::Place::basal, p) < other_reach_mm && ventricle > 4;
        const bool before = beside < 4 && p.y < -30 && lateral_mm(p) > 8;
        const bool above = beside < 4 && p.z > 65 && sheet.get(i, j, k);
        const bool other = depth.at(i, j, k) < cistern_depth_mm || behind || below || basal || before || above;
        seeds.at(i, j, k) = other && !(cores.get(i, j, k) && !above && !behind) ? 2 : cores.get(i, j, k) ? 1 : 0;
      }
  return seeds;
}

}  // namespace

mask::BitMask wide_csf(const grid::Grid<float>& soft, const mask::BitMask& envelope, double lower_hu, double upper_hu,
                       const Progress& progress) {
  mask::BitMask outside = envelope;
  outside.invert();
  const grid::Grid<float> depth = mask::distance_mm(outside, progress);
  return mask::eroded(mask::make_mask(soft,
                                      [&](int j, int k, std::uint8_t* row) {
                                        for (int i = 0; i < soft.size[0]; ++i) {
                                          const float v = soft.at(i, j, k);
                                          row[i] = depth.at(i, j, k) > wide_depth_mm && v > lower_hu &&
                                                   v < upper_hu - strict_hu;
                                        }
                                      }),
                      wide_mm, progress);
}

mask::BitMask deep_csf(const grid::Grid<float>& soft, const mask::BitMask& envelope, const place::HeadPlace& place,
                       double lower_hu, double upper_hu, const Progress& progress, mask::BitMask* others,
                       mask::BitMask* cut_off) {
  const grid::Lattice& l = soft;
  const auto fluid = [&](double below) {
    mask::BitMask mask = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i) row[i] = soft.at(i, j, k) > lower_hu && soft.at(i, j, k) < below;
    });
    return mask &= envelope;
  };
  mask::BitMask outside = envelope;
  outside.invert();
  const grid::Grid<float> depth = mask::distance_mm(outside, progress);
  mask::BitMask csf = fluid(upper_hu - strict_hu);
  mask::BitMask slit(l);
  if (place.sure) csf |= slit = third_slit(soft, envelope, place, lower_hu, upper_hu);
  mask::BitMask other = csf;
  other.invert();
  const grid::Mask seeds = place.sure ? seeds_by_place(soft, csf, slit, depth, place, progress)
                                      : seeds_by_boxes(csf, depth, envelope.centre_mm(), progress);
  const grid::Mask labels = mask::flood(mask::distance_mm(other, progress), csf, seeds, progress);
  mask::BitMask mine = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = labels.at(i, j, k) == 1;
  });
  mine = mask::at_least_ml(mask::components(mine), ventricle_speck_ml);
  mask::BitMask strange(l);
  if (place.sure) {
    mine = in_place(mine, place);
    mine.remove(strange = strands(mine, place, progress));
  }
  // Grown back to the edge, but not into the fluid of other spaces.
  mask::BitMask free = fluid(upper_hu);
  mask::BitMask apart = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = labels.at(i, j, k) == 2;
  });
  apart |= strange;
  free.remove(apart);
  if (others) *others = std::move(apart);
  if (cut_off) *cut_off = std::move(strange);
  return mask::grown_within(mine, free, regrow_mm, progress);
}

}  // namespace trephine::head
