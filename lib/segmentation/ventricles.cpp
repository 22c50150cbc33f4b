// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "segmentation/along_surface.h"
#include "segmentation/filters.h"
#include "segmentation/horns.h"
#include "segmentation/methods.h"
#include "segmentation/soft_tissue.h"
#include "segmentation/surface_field.h"

namespace trephine::segmentation {
namespace {

constexpr double strength_ratio = 0.4;   ///< of denoising to the noise, mm^-0.5
constexpr double envelope_close_mm = 8;  ///< sulci narrower than twice this do not count as the brain's outside
constexpr double shell_mm = 4;           ///< so near to it no ventricle is looked for
constexpr double cistern_depth_mm = 8;   ///< CSF this near to the brain's surface is sulci and cisterns
constexpr double core_ml = 0.02;         ///< ventricles hold a core at least this large in one of the boxes below

constexpr double strict_hu = 1;   ///< what is connected is decided this much below the edge, lest oedema joins in,
constexpr double regrow_mm = 2;   ///< and then grown to the edge by at most this
constexpr double speck_ml = 0.2;  ///< pieces of ventricle smaller than this are noise
constexpr double cut_sigma_mm = 1.0;
constexpr double cut_scale_hu = 8;
constexpr int rounds = 2;
constexpr double reach_mm = 2.5;
constexpr double beside_sigma_mm = 5;
constexpr double edge_may_move_hu = 5;
constexpr double edge_share = 0.5;
constexpr double horns_reach_mm = 45;  ///< beyond the ventricles found, horns are looked for
constexpr float horn_hu_per_mm = 6;    ///< of their field at the edge

/// A box about the brain's centre, LPS, in an adult; heads lie straight to about 15 degrees.
struct Place {
  double radius_mm;  ///< of a ball that fits in
  double depth_mm;   ///< under the brain's surface
  Vec3 from, to;
  bool holds(Vec3 p) const {
    return p.x >= from.x && p.y >= from.y && p.z >= from.z && p.x <= to.x && p.y <= to.y && p.z <= to.z;
  }
};
// Cysts, old defects and oedema mostly lie beside the first two.
constexpr Place lateral_ventricles{1.5, 25, {-15, -70, -10}, {15, 70, 20}};
constexpr Place third_ventricle{0.5, 12, {-12, -30, -18}, {12, 5, 5}};
constexpr Place behind_the_third{0, 0, {-20, 11, -1000}, {20, 1000, -10}};    ///< quadrigeminal, cerebellar cisterns
constexpr Place below_the_third{0, 0, {-20, -1000, -1000}, {20, 1000, -28}};  ///< fourth ventricle, basal cisterns

/// Seeds for the watershed in the CSF: 1 in the cores of the ventricles, 2 in cisterns and near the brain's surface.
Mask seeds_of(const BitMask& csf, const Grid<float>& depth, Vec3 centre_mm, const Progress& progress) {
  const Lattice& l = csf.lattice();
  const auto from_centre = [&](int i, int j, int k) {
    return l.to_world_mm({double(i), double(j), double(k)}) - centre_mm;
  };
  BitMask cores(l);
  for (const Place& place : {lateral_ventricles, third_ventricle}) {
    BitMask wide = eroded(csf, place.radius_mm, progress);
    wide &= make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i)
        row[i] = depth.at(i, j, k) >= place.depth_mm && place.holds(from_centre(i, j, k));
    });
    const Components pieces = components(wide);
    std::vector<char> keep;
    for (const Component& c : pieces.list) keep.push_back(c.voxels * l.voxel_volume_mm3() / 1000 >= core_ml);
    cores |= select(pieces, keep);
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

Vec3 centre_of(const BitMask& brain) {
  const Lattice& l = brain.lattice();
  Vec3 sum;
  std::size_t n = 0;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; j += 2)
      for (int i = 0; i < l.size[0]; i += 2)
        if (brain.get(i, j, k)) {
          sum += {double(i), double(j), double(k)};
          ++n;
        }
  return l.to_world_mm(sum / double(std::max<std::size_t>(n, 1)));
}

/// The mean of the middle half: as robust as a median, finer than a unit on integers.
double middle_of(std::vector<float>& v) {
  const auto from = v.begin() + std::ptrdiff_t(v.size() / 4), to = v.begin() + std::ptrdiff_t(v.size() - v.size() / 4);
  std::sort(v.begin(), v.end());
  double sum = 0;
  for (auto i = from; i < to; ++i) sum += *i;
  return sum / double(to - from);
}

/// Halfway between the HU inside the shape and those of the tissue around it, as far as `otherwise` allows.
double half_of_both_sides(const Grid<float>& hu, const BitMask& shape, const BitMask& brain, double otherwise,
                          const Progress& progress) {
  const BitMask inner = eroded(shape, 1.0, progress);
  BitMask outer = dilated(shape, 4.0, progress);
  outer.remove(dilated(shape, 2.0, progress));
  outer &= brain;
  std::vector<float> inside, around;
  for (int k = 0; k < hu.size[2]; ++k)
    for (int j = 0; j < hu.size[1]; ++j)
      for (int i = 0; i < hu.size[0]; ++i) {
        if (inner.get(i, j, k))
          inside.push_back(hu.at(i, j, k));
        else if (outer.get(i, j, k))
          around.push_back(hu.at(i, j, k));
      }
  if (inside.size() < 100 || around.size() < 100) return otherwise;
  const double low = middle_of(inside), high = middle_of(around);
  return std::clamp(low + edge_share * (high - low), otherwise - edge_may_move_hu, otherwise + edge_may_move_hu);
}

/// The surface where the mean along it is halfway between CSF and the tissue beside: `shape` is where to look. Returns
/// the field, positive inside, on the shape's lattice, and moves the shape with it.
Field placed_halfway(const Grid<float>& hu, BitMask& shape, const BitMask& brain, double noise,
                     const Progress& progress) {
  const Lattice& l = hu;
  Field field(l);
  // The more noise, the larger the patch that places a point: about the same error.
  const double patch_mm = std::clamp(1.2 + 0.05 * noise, 1.2, 4.0), shape_sigma_mm = 0.4 * patch_mm;
  for (int round = 0; round < rounds; ++round) {
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) field.at(i, j, k) = shape.get(i, j, k) ? 0.5f : -0.5f;
    gaussian(field, shape_sigma_mm, progress);
    Grid<float> distance = signed_distance_mm(field, progress);
    for (float& d : distance.voxels) d = std::clamp(d, -8.f, 8.f);
    gaussian(distance, shape_sigma_mm, progress);
    const Grid<float> mean = averaged_along(hu, distance, reach_mm, patch_mm, progress);
    std::vector<float> inside;
    BitMask beside(l);
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const float d = distance.at(i, j, k);
          if (d > 1.2f) inside.push_back(hu.at(i, j, k));
          if (d < -1.5f && d > -5 && brain.get(i, j, k) && hu.at(i, j, k) < 100) beside.set(i, j, k);
        }
    if (inside.size() < 100 || !beside.any()) return field;
    const float low = float(middle_of(inside));
    const Grid<float> high = masked_gaussian(hu, beside, beside_sigma_mm, 30, 0.0005, progress);
    BitMask next(l);
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const std::size_t v = l.index(i, j, k);
          const float d = distance.voxels[v];
          float& f = field.voxels[v];
          f = 0.5f * (low + high.voxels[v]) - mean.voxels[v];
          if (std::abs(d) >= reach_mm) f = d > 0 ? std::max(f, 5.f) : std::min(f, -5.f);
          if (f > 0 && brain.get(i, j, k)) next.set(i, j, k);
        }
    const Components pieces = components(next);
    std::vector<char> keep;
    for (const Component& c : pieces.list) keep.push_back(c.voxels * l.voxel_volume_mm3() / 1000 >= speck_ml / 2);
    shape = select(pieces, keep);
  }
  return field;
}

}  // namespace

BitMask find_ventricles(const Grid<float>& soft, const BitMask& envelope, double lower_hu, double upper_hu,
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
      flood(distance_mm(other, progress), csf, seeds_of(csf, depth, centre_of(envelope), progress), progress);
  BitMask mine = make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = labels.at(i, j, k) == 1;
  });
  const Components pieces = components(mine);
  std::vector<char> keep;
  for (const Component& c : pieces.list) keep.push_back(c.voxels * l.voxel_volume_mm3() / 1000 >= speck_ml);
  mine = select(pieces, keep);
  // Back to the edge, but not into the fluid of others.
  BitMask free = fluid(upper_hu);
  BitMask apart = make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = labels.at(i, j, k) == 2;
  });
  free.remove(apart);
  if (others) *others = std::move(apart);
  return grown_within(mine, free, regrow_mm, progress);
}

Field segment_ventricles(const HuView& hu, const SegmentMasks& masks, const SegmentParams& p, Report& report,
                         const Progress& progress) {
  if (!masks.within) throw Error(ExitCode::usage, "", "within", "method ventricles needs the field of the brain");
  const Box brain_box = grown(positive(*masks.within, *masks.within).bounds(), 1, *masks.within);
  if (brain_box.empty()) throw Error(ExitCode::quality, "", "within", "the mask is empty: 0 voxels");
  const Lattice l = cropped(*masks.within, brain_box);
  Box box = place_in(l, hu.lattice());
  for (int a = 0; a < 3; ++a)
    if (box.begin[a] < 0 || box.end[a] > hu.lattice().size[a])
      throw Error(ExitCode::bad_input, "", "within", "the field reaches beyond the volume");
  BitMask brain = positive(*masks.within, l);
  const Box roi = region_of_interest(hu.lattice(), p);
  BitMask allowed(cropped(hu.lattice(), roi));
  allowed = placed(allowed.invert(), l);
  if (masks.without) allowed.remove(positive(*masks.without, l));

  // The brain's surface with its sulci closed: how deep something lies is meant from there.
  BitMask envelope = closed(brain, envelope_close_mm, progress);
  envelope |= holes(envelope, {0, 1000, true}, progress);
  BitMask known = eroded(envelope, shell_mm, progress);
  Grid<float> raw = crop(hu, box);
  known &= make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = raw.at(i, j, k) > -100 && raw.at(i, j, k) < 160;
  });
  if (p.smoothing_sigma_mm > 0)
    raw = masked_gaussian(std::move(raw), known, p.smoothing_sigma_mm, 1000, 0.02, progress);
  if (p.edge == SegmentEdge::half_maximum) level_tissue(raw, known, report, progress);
  Field soft = soft_tissue(raw, known, false, strength_ratio, 1000, report, progress);
  const double noise = tissue_noise(raw, known, progress);
  progress.report(0.4);
  const double lower = p.lower_hu;
  double upper = p.upper_hu;
  envelope &= allowed;
  BitMask others;
  BitMask shape = find_ventricles(soft, envelope, lower, upper, progress, &others);
  progress.report(0.6);
  if (p.edge == SegmentEdge::half_maximum && shape.any()) {
    upper = half_of_both_sides(soft, shape, brain, upper, progress);
    shape = find_ventricles(soft, envelope, lower, upper, progress, &others);
  }
  report.add("upper_hu", upper);
  if (p.close_mm > 0) shape = closed(shape, p.close_mm, progress);
  shape |= holes(shape, {p.fill_close_mm, 5, false}, progress);  // choroid plexus, calcified or not
  shape &= brain;
  if (!shape.any()) check_mask(shape, hu.lattice().count(), report);
  progress.report(0.8);
  const auto margin = [&](double mm) {
    return int(std::ceil(mm / std::min({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z})));
  };
  Field horns;
  int horns_count = 0;
  BitMask course(l);
  if (p.edge == SegmentEdge::half_maximum) {
    const Box around = grown(shape.bounds(), margin(horns_reach_mm), l);
    horns = find_horns(trephine::crop(raw, around), crop(known, around), crop(envelope, around), crop(others, around),
                       crop(shape, around), centre_of(envelope), noise, horns_count, progress);
    report.add("horns_count", horns_count);
    course = positive(horns, l);
    course &= brain;
  }
  BitMask both = shape;
  both |= course;
  const Box cut = grown(both.bounds(), margin(6), l);
  shape = crop(shape, cut);
  Field field;
  if (p.edge == SegmentEdge::half_maximum) {
    field = placed_halfway(trephine::crop(raw, cut), shape, crop(brain, cut), noise, progress);
    const Grid<float> tubes = fit(horns, field, -4.f);
    for (std::size_t v = 0; v < tubes.voxels.size() && horns_count > 0; ++v)
      field.voxels[v] = std::max(field.voxels[v], horn_hu_per_mm * tubes.voxels[v]);
    shape |= crop(course, cut);
    shape |= holes(shape, {p.fill_close_mm, 5, false}, progress);
    if (!shape.any()) check_mask(shape, hu.lattice().count(), report);
  } else {
    for (float& v : soft.voxels) v = std::min(v - float(lower), float(upper) - v);
    field = trephine::crop(soft, cut);
  }
  const std::size_t cut_count = place_surface(field, shape, cut_sigma_mm, cut_scale_hu, progress);
  report.add("cut_voxels_count", cut_count);
  const double ml = double(shape.count()) * l.voxel_volume_mm3() / 1000;
  if (ml < 3 || ml > 200) report.warn("the ventricles found are not of the size of an adult's");
  return field;
}

}  // namespace trephine::segmentation
