// SPDX-License-Identifier: GPL-3.0-or-later
#include "body/body.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "body/pressed_strands.h"
#include "mask/bits.h"
#include "mask/coarse.h"
#include "mask/hu_view.h"

namespace trephine {
namespace {

using namespace segmentation;

constexpr float air_hu = -1000;
constexpr double coarse_mm = 2;
constexpr double least_core_ml = 50;  ///< the inside of a body is larger
constexpr double other_core_ml = 2;   ///< of a holder or a cushion: smaller pieces are thin parts of the body
constexpr double shell_mm = 3;        ///< the skin around the inside, which coarse cells leave out
constexpr double hollow_mm = 15;  ///< hollows of the body narrower than twice this are filled to judge what stands out
constexpr double plate_cores_mm[] = {1.5, 2, 2.5};  ///< plates of an apparatus are thicker than twice this
constexpr double plate_rim_mm = 0.75;               ///< of a plate, beyond what opening gives back
constexpr double dense_hu = 250;                    ///< of plates of plastic and metal; cartilage and skin have less
constexpr double least_dense_ml = 5;
constexpr double dense_rim_mm = 1.5;  ///< the blurred edge of a dense plate
constexpr double skin_mm = 4;         ///< a plate pressed against the body reaches no deeper
constexpr double piece_ml = 0.05;     ///< smaller pieces of apparatus are not counted
constexpr double sheet_ml = 1;        ///< more thin apparatus than this means that there is a mask or a table
constexpr double rim_ml = 0.5;        ///< a thin part of the body (rim of an ear) is smaller
constexpr double outlet_mm = 5;       ///< nostrils and ear canals are narrower than twice this
constexpr double most_cavity_ml = 1000;

double ml_of(const BitMask& mask) { return mask.count() * mask.lattice().voxel_volume_mm3() / 1000; }

/// The body's inside, the insides of thick apparatus, and the body with its hollows (eyes, nose and cheek) filled.
struct Cores {
  BitMask body, others, hull, near;
};

Cores cores_of(const BitMask& tissue, const BodyParams& p, const Progress& progress) {
  const CoarseRaster raster = coarse_raster(tissue.lattice(), coarse_mm);
  const BitMask cells = coarse_mask(tissue, raster, 0.5);
  const Components pieces = components(eroded(cells, p.core_mm, progress));
  BitMask body = dilated(largest(pieces), p.core_mm, progress);
  body &= cells;
  BitMask others = at_least_ml(pieces, other_core_ml);
  others.remove(body);
  others = dilated(others, p.core_mm, progress);
  others &= cells;
  others.remove(body);
  Cores out{fine_mask(body, raster), fine_mask(others, raster), fine_mask(closed(body, hollow_mm, progress), raster),
            fine_mask(dilated(body, p.reach_mm, progress), raster)};
  out.body &= tissue;
  out.others &= tissue;
  return out;
}

/// What of `piece` (apparatus that touches the body) is the body's: what is left of it beside the apparatus' own dense
/// or thick parts, touches the body, and is as small as an ear; and what lies in the body's hollows. How thick a plate
/// is, is not known: of the choices that recognize any of it, the one is taken that leaves most to the body. Where
/// `only_dense`, none but the dense parts are the apparatus' own.
BitMask left_beside(const BitMask& piece, const BitMask& dense, const BitMask& body, const Cores& cores,
                    const BodyParams& p, bool only_dense, const Progress& progress) {
  const Lattice& l = piece.lattice();
  const double voxel_ml = l.voxel_volume_mm3() / 1000;
  const Box box = grown(piece.bounds(), 2, l);
  const BitMask here = crop(piece, box), near = crop(cores.near, box), beside = dilated_6(crop(body, box));
  const BitMask beyond = without(here, near), hull = crop(cores.hull, box);
  // The apparatus' own parts: those of the core that are large, or go on beyond what an ear reaches.
  const auto own_parts = [&](const BitMask& core, double rim_mm, double least_ml) {
    const Components parts = components(core);
    std::vector<char> own = touching(parts, beyond);
    for (std::size_t c = 0; c < own.size(); ++c) own[c] = own[c] || parts.list[c].voxels * voxel_ml > least_ml;
    return dilated(select(parts, own), rim_mm, progress);
  };
  std::vector<BitMask> recognized;
  if (!only_dense)
    for (const double core_mm : plate_cores_mm)
      recognized.push_back(own_parts(eroded(here, core_mm, progress), core_mm + plate_rim_mm, p.most_part_ml / 4));
  recognized.push_back(own_parts(both(crop(dense, box), here), dense_rim_mm, least_dense_ml));
  recognized.erase(std::remove_if(recognized.begin(), recognized.end(), [](const BitMask& m) { return !m.any(); }),
                   recognized.end());
  if (recognized.empty()) recognized.emplace_back(here.lattice());
  BitMask best(here.lattice());
  std::size_t most = 0;
  for (const BitMask& apparatus : recognized) {
    const BitMask outside = without(here, apparatus);
    const Components rest = components(both(without(outside, hull), near));
    std::vector<char> keep(rest.list.size());
    for (std::size_t c = 0; c < keep.size(); ++c) keep[c] = rest.list[c].voxels * voxel_ml <= p.most_part_ml;
    BitMask left = select(rest, keep);
    left |= both(outside, hull);
    const Components joined = components(left);
    left = select(joined, touching(joined, beside));
    if (const std::size_t count = left.count(); count > most) {
      most = count;
      best = std::move(left);
    }
  }
  return placed(best, l);
}

/// How much of each component lies outside of the mask.
std::vector<double> ml_outside(const Components& parts, const BitMask& mask) {
  std::vector<double> ml(parts.list.size());
  for_each_voxel(parts, [&](int component, int i, int j, int k) { ml[component] += !mask.get(i, j, k); });
  for (double& v : ml) v *= parts.lattice.voxel_volume_mm3() / 1000;
  return ml;
}

/// The pieces of the dense mask that do not reach into the body's depth, as the bones of nose and cheek do.
BitMask apart_from(const BitMask& depth, const BitMask& dense) {
  const Components pieces = components(dense);
  std::vector<char> apart = touching(pieces, depth);
  for (char& c : apart) c = !c;
  return select(pieces, apart);
}

/// Tissue of the body alone: its inside, and what grows out of it as ears and nose do.
BitMask body_tissue(const HuView& hu, const BitMask& tissue, const BodyParams& p, double& thin_ml,
                    const Progress& progress) {
  const Cores cores = cores_of(tissue, p, progress);
  if (ml_of(cores.body) < least_core_ml) return BitMask(tissue.lattice());
  progress.report(0.4);
  const double voxel_ml = tissue.lattice().voxel_volume_mm3() / 1000;
  BitMask thick = both(dilated(eroded(tissue, p.thinnest_mm / 2, progress), p.thinnest_mm / 2, progress), tissue);
  thick.remove(cores.others);
  thick |= cores.body;
  BitMask body = grown_within(cores.body, thick, shell_mm, progress);
  // Ears and nose are small, end within reach and hold no dense plate of their own; a plate or a frame is large, or
  // goes on, or is dense.
  const Components parts = components(without(thick, body));
  const std::vector<char> beside = touching(parts, dilated_6(body));
  const std::vector<char> far = touching(parts, without(thick, cores.near));
  const std::vector<double> outside_ml = ml_outside(parts, cores.hull);
  const BitMask dense = above(hu, dense_hu);
  const BitMask plates = apart_from(eroded(cores.body, skin_mm, progress), dense);
  BitMask no_plate = plates;
  no_plate.invert() |= cores.hull;
  const std::vector<double> plate_ml = ml_outside(parts, no_plate);
  std::vector<char> keep(parts.list.size()), part(keep), plate(keep);
  for (std::size_t c = 0; c < keep.size(); ++c) {
    const bool large = far[c] || outside_ml[c] > p.most_part_ml;
    const bool apparatus = large || plate_ml[c] > least_dense_ml;
    keep[c] = beside[c] && !apparatus;
    part[c] = beside[c] && large;
    plate[c] = beside[c] && apparatus && !large;
  }
  const BitMask before = body;
  for (const bool only_dense : {false, true})
    if (const BitMask pieces = select(parts, only_dense ? plate : part); pieces.any())
      body |= left_beside(pieces, only_dense ? plates : dense, before, cores, p, only_dense, progress);
  body |= select(parts, keep);
  progress.report(0.6);

  // Thin tissue: the rim of an ear where nothing else is thin; strands of a mask where there are sheets.
  const Components thin = components(without(without(tissue, body), cores.others), true);
  thin_ml = 0;
  const BitMask around = dilated_6(body);
  const std::vector<char> on_body = touching(thin, around);
  std::vector<char> rim(thin.list.size());
  for (std::size_t c = 0; c < rim.size(); ++c) {
    const double ml = thin.list[c].voxels * voxel_ml;
    rim[c] = on_body[c] && ml < rim_ml;
    if (!rim[c]) thin_ml += ml;
  }
  if (thin_ml < sheet_ml)
    body |= select(thin, rim);
  else
    body |= both(both(around, tissue), dilated(cores.body, shell_mm, progress));
  return body;
}

/// The skin's blurred edge: from the body outwards, as long as the HU fall.
BitMask with_edge(const BitMask& body, const HuView& hu, const BodyParams& p, const Progress& progress) {
  const Lattice& l = body.lattice();
  const BitMask reach = dilated(body, p.edge_mm, progress);
  BitMask out = body;
  const int steps = int(std::ceil(p.edge_mm / std::min({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z})));
  for (int step = 0; step < steps; ++step) {
    const BitMask rim = both(without(dilated_6(out), out), reach);
    const BitMask next = make_mask(l, [&](int j, int k, std::uint8_t* row) {
      const std::uint64_t* bits = rim.row(j, k);
      for (int i = 0; i < l.size[0]; ++i) {
        row[i] = 0;
        if (!(bits[i >> 6] >> (i & 63) & 1)) continue;
        const float v = hu(i, j, k);
        const auto falls = [&](int x, int y, int z) { return out.at(x, y, z) && hu(x, y, z) >= v; };
        row[i] = falls(i - 1, j, k) || falls(i + 1, j, k) || falls(i, j - 1, k) || falls(i, j + 1, k) ||
                 falls(i, j, k - 1) || falls(i, j, k + 1);
      }
    });
    out |= next;
  }
  return out;
}

}  // namespace

HuVolume keep_body(const HuVolume& volume, const BodyParams& p, Report& report, const Progress& progress) {
  check_finite(volume);
  const HuView hu(volume);
  const BitMask tissue = above(hu, p.tissue_hu);
  double thin_ml = 0;
  const BitMask found = body_tissue(hu, tissue, p, thin_ml, progress);
  if (!found.any()) {
    report.warn(
        fmt::format("no body was found, and nothing was taken off: no tissue above {} HU in which a ball of {} "
                    "mm fits (tissue_hu, core_mm)",
                    p.tissue_hu, p.core_mm));
    return volume;
  }
  BitMask whole = found;
  whole |= holes(found, FillRule{outlet_mm, most_cavity_ml, true}, progress);
  BitMask body = with_edge(whole, hu, p, progress);
  if (p.strand_mm > 0 && thin_ml > sheet_ml) {
    const PressedStrands pressed = find_pressed_strands(hu, whole, body, p.strand_mm, progress);
    if (pressed.found) {
      report.add("strands_on_skin_ml", ml_of(both(pressed.strands, tissue)));
      body.remove(pressed.strands);
    }
  }
  progress.report(0.9);
  const BitMask apparatus = without(tissue, body);
  const double apparatus_ml = ml_of(apparatus);
  const Components pieces = components(apparatus, true);
  const double voxel_ml = hu.lattice().voxel_volume_mm3() / 1000;
  report.add("body_ml", ml_of(whole));
  report.add("apparatus_ml", apparatus_ml);
  report.add("thin_apparatus_ml", std::min(thin_ml, apparatus_ml));
  report.add("apparatus_pieces_count",
             std::int64_t(std::count_if(pieces.list.begin(), pieces.list.end(),
                                        [&](const Component& c) { return c.voxels * voxel_ml >= piece_ml; })));
  if (apparatus_ml < p.least_ml) return volume;
  HuVolume out = volume;
  std::visit(
      [&](auto& grid) {
        using Sample = typename std::decay_t<decltype(grid)>::Sample;
        parallel_for(0, grid.size[2], 1, [&](std::int64_t from, std::int64_t to) {
          for (int k = int(from); k < to; ++k)
            for (int j = 0; j < grid.size[1]; ++j) {
              Sample* row = &grid.at(0, j, k);
              const std::uint64_t* kept = body.row(j, k);
              for (int i = 0; i < grid.size[0]; ++i)
                if (!(kept[i >> 6] >> (i & 63) & 1) && row[i] > p.air_hu) row[i] = Sample(air_hu);
            }
        });
      },
      out);
  return out;
}

}  // namespace trephine
