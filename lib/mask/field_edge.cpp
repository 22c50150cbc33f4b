// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/field_edge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "mask/coarse.h"

namespace trephine::mask {
namespace {

constexpr float padding_below_hu = -500, air_below_hu = -700;
constexpr double least_side_share = 0.005, least_region_ml = 1, clear_of_tissue_mm = 4, least_measured_share = 0.03;
constexpr double cell_mm = 4, least_edge_share = 0.8;

/// The commonest value of air on the volume's sides, where it is common.
std::optional<float> commonest_at_sides(const HuView& hu) {
  const grid::Lattice& l = hu.lattice();
  std::vector<float> values;
  std::size_t all = 0;
  for (int a = 0; a < 3; ++a)
    for (const int at : {0, l.size[std::size_t(a)] - 1}) {
      grid::Box side = grid::whole_box(l);
      side.begin[a] = at, side.end[a] = at + 1;
      for (int k = side.begin[2]; k < side.end[2]; ++k)
        for (int j = side.begin[1]; j < side.end[1]; ++j)
          for (int i = side.begin[0]; i < side.end[0]; ++i, ++all)
            if (const float v = hu(i, j, k); v < padding_below_hu) values.push_back(v);
    }
  std::sort(values.begin(), values.end());
  std::size_t most = 0;
  float commonest = 0;
  for (std::size_t from = 0, to = 0; from < values.size(); from = to) {
    while (to < values.size() && values[to] == values[from]) ++to;
    if (to - from > most) most = to - from, commonest = values[from];
  }
  if (double(most) < least_side_share * double(all)) return std::nullopt;
  return commonest;
}

/// Whole neighbourhoods of that value which reach the volume's sides. One step to the face neighbours, whatever the
/// spacing: in thick slices, too, padding may be one slice thick.
BitMask regions_of(const BitMask& same) {
  BitMask other = same;
  BitMask inner = dilated_6(other.invert());
  const Components parts = components(inner.invert());
  std::vector<char> keep(parts.list.size());
  for (std::size_t c = 0; c < keep.size(); ++c)
    keep[c] = parts.list[c].faces > 0 &&
              double(parts.list[c].voxels) * same.lattice().voxel_volume_mm3() > 1000 * least_region_ml;
  return both(dilated_6(select(parts, keep)), same);
}

/// Whether there is air about the body that was measured, so that the regions are not simply all air: it reaches the
/// volume's sides, as lungs and foam do not, and is not what keep_body puts in the place of apparatus (1 HU off).
bool has_measured_air(const HuView& hu, float value, const BitMask& padding, const BitMask& tissue,
                      const Progress& progress) {
  BitMask air = above(hu, air_below_hu);
  air.invert();
  air.remove(dilated(tissue, clear_of_tissue_mm, progress));
  const grid::Lattice& l = hu.lattice();
  const BitMask noisy = make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = air.get(i, j, k) && std::abs(hu(i, j, k) - value) > 1;
  });
  const Components parts = components(noisy);
  std::size_t measured = 0;
  for (const Component& c : parts.list)
    if (c.faces > 0 && double(c.voxels) * l.voxel_volume_mm3() > 1000 * least_region_ml) measured += c.voxels;
  const std::size_t all = measured + both(air, padding).count();
  return measured > 0 && double(measured) >= least_measured_share * double(all);
}

/// Of `outermost`, which are tissue, the voxels in those cells in which nearly all of `rim` are of them.
BitMask where_most_are(const BitMask& outermost, const BitMask& rim) {
  const CoarseRaster raster = coarse_raster(rim.lattice(), cell_mm);
  const grid::Lattice &l = rim.lattice(), &c = raster.cells;
  std::vector<std::array<int, 2>> counts(c.count(), {0, 0});
  const auto cell = [&](int i, int j, int k) {
    return c.index(i / raster.factor[0], j / raster.factor[1], k / raster.factor[2]);
  };
  const auto each = [&](const BitMask& mask, const auto& visit) {
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int w = 0; w < mask.words(); ++w)
          for (std::uint64_t bits = mask.row(j, k)[w]; bits; bits &= bits - 1)
            visit(w * 64 + __builtin_ctzll(bits), j, k);
  };
  each(rim, [&](int i, int j, int k) { ++counts[cell(i, j, k)][0]; });
  each(outermost, [&](int i, int j, int k) { ++counts[cell(i, j, k)][1]; });
  BitMask out(l);
  each(outermost, [&](int i, int j, int k) {
    const auto& [all, at_padding] = counts[cell(i, j, k)];
    if (at_padding >= least_edge_share * all) out.set(i, j, k);
  });
  return out;
}

}  // namespace

FieldEdge field_edge(const HuView& hu, const Progress& progress) {
  const FieldEdge none{BitMask(hu.lattice()), BitMask(hu.lattice())};
  const std::optional<float> value = commonest_at_sides(hu);
  if (!value) return none;
  const grid::Lattice& l = hu.lattice();
  FieldEdge out{regions_of(make_mask(l,
                                     [&](int j, int k, std::uint8_t* row) {
                                       for (int i = 0; i < l.size[0]; ++i) row[i] = hu(i, j, k) == *value;
                                     })),
                {}};
  if (!out.padding.any()) return none;
  const BitMask tissue = above(hu, FieldEdge::tissue_above_hu);
  const BitMask outermost = both(tissue, dilated_6(out.padding));
  if (!outermost.any() || !has_measured_air(hu, *value, out.padding, tissue, progress)) return none;
  BitMask other = tissue;
  const BitMask rim = both(tissue, dilated_6(other.invert()));
  out.tissue = where_most_are(outermost, rim);
  return out;
}

}  // namespace trephine::mask
