// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "segmentation/filters.h"
#include "segmentation/methods.h"
#include "segmentation/surface_field.h"

namespace trephine::segmentation {
namespace {

constexpr double default_sigma_mm = 1.0;
constexpr double cistern_depth_mm = 8;  ///< CSF this near to the brain's surface is sulci and cisterns
constexpr double core_depth_mm = 25;    ///< ventricles hold a core at least this deep,
constexpr double core_radius_mm = 1.5;  ///< this wide,
constexpr double core_ml = 0.05;        ///< this large,
constexpr double core_below_mm = 10;    ///< and no lower than this under the brain's centre (the cisterns are)
constexpr double speck_ml = 0.2;        ///< pieces of ventricle smaller than this are noise
constexpr double cut_sigma_mm = 1.0;
constexpr double cut_scale_hu = 8;
constexpr double edge_may_move_hu = 5;

double or_default(double value, double otherwise) { return value > 0 ? value : otherwise; }

/// Seeds for the watershed in the CSF: 1 in the cores of the ventricles, 2 near the brain's surface.
Mask seeds_of(const BitMask& csf, const Grid<float>& depth, double centre_z_mm, const Progress& progress) {
  const Lattice& l = csf.lattice();
  const BitMask deep = make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i)
      row[i] = depth.at(i, j, k) >= core_depth_mm &&
               l.to_world_mm({double(i), double(j), double(k)}).z >= centre_z_mm - core_below_mm;
  });
  BitMask cores = eroded(csf, core_radius_mm, progress);
  cores &= deep;
  const Components pieces = components(cores);
  std::vector<char> keep;
  for (const Component& c : pieces.list) keep.push_back(c.voxels * l.voxel_volume_mm3() / 1000 >= core_ml);
  cores = select(pieces, keep);
  Mask seeds(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        seeds.at(i, j, k) = cores.get(i, j, k) ? 1 : depth.at(i, j, k) < cistern_depth_mm ? 2 : 0;
  return seeds;
}

double centre_z_mm(const BitMask& brain) {
  const Lattice& l = brain.lattice();
  double sum = 0;
  std::size_t n = 0;
  for (int k = 0; k < l.size[2]; k += 2)
    for (int j = 0; j < l.size[1]; j += 4)
      for (int i = 0; i < l.size[0]; i += 4)
        if (brain.get(i, j, k)) {
          sum += l.to_world_mm({double(i), double(j), double(k)}).z;
          ++n;
        }
  return n ? sum / double(n) : 0;
}

/// Halfway between the middle HU inside the shape and that of the tissue around it.
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
  const double half = 0.5 * (median(inside, 0) + median(around, 0));
  return std::clamp(half, otherwise - edge_may_move_hu, otherwise + edge_may_move_hu);
}

}  // namespace

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
  allowed &= brain;
  if (masks.without) allowed.remove(positive(*masks.without, l));

  const Grid<float> raw = crop(hu, box);
  BitMask known = make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = raw.at(i, j, k) > -60 && raw.at(i, j, k) < 100;
  });
  known &= brain;
  Field soft = masked_gaussian(raw, known, or_default(p.smoothing_sigma_mm, default_sigma_mm), 1000, 0.02, progress);
  progress.report(0.3);
  double lower = p.lower_hu, upper = p.upper_hu;
  const auto fluid = [&] {
    BitMask mask = make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i) row[i] = soft.at(i, j, k) > lower && soft.at(i, j, k) < upper;
    });
    return mask &= allowed;
  };

  BitMask outside = brain;
  outside.invert();
  const Grid<float> depth = distance_mm(outside, progress);
  const double middle_z = centre_z_mm(brain);
  const auto find = [&] {
    const BitMask csf = fluid();
    BitMask other = csf;
    other.invert();
    const Mask labels = flood(distance_mm(other, progress), csf, seeds_of(csf, depth, middle_z, progress), progress);
    BitMask mine = make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i) row[i] = labels.at(i, j, k) == 1;
    });
    const Components pieces = components(mine);
    std::vector<char> keep;
    for (const Component& c : pieces.list)
      keep.push_back(c.voxels * l.voxel_volume_mm3() / 1000 >= std::max(speck_ml, p.min_component_ml));
    return select(pieces, keep);
  };
  BitMask shape = find();
  progress.report(0.6);
  if (p.edge == SegmentEdge::half_maximum && shape.any()) {
    upper = half_of_both_sides(raw, shape, brain, upper, progress);
    shape = find();
  }
  report.add("upper_hu", upper);
  if (p.close_mm > 0) shape = closed(shape, p.close_mm, progress);
  shape |= holes(shape, {p.fill_close_mm, 5, false}, progress);  // choroid plexus, calcified or not
  shape &= brain;
  if (!shape.any()) check_mask(shape, hu.lattice().count(), report);
  progress.report(0.8);
  for (float& v : soft.voxels) v = std::min(v - float(lower), float(upper) - v);
  const Box cut = grown(shape.bounds(), 3, l);
  Field field = trephine::crop(soft, cut);
  const std::size_t cut_count = place_surface(field, crop(shape, cut), cut_sigma_mm, cut_scale_hu, progress);
  report.add("cut_voxels_count", cut_count);
  const double ml = double(shape.count()) * l.voxel_volume_mm3() / 1000;
  if (ml < 3 || ml > 200) report.warn("the ventricles found are not of the size of an adult's");
  return field;
}

}  // namespace trephine::segmentation
