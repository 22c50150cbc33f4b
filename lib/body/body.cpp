// SPDX-License-Identifier: GPL-3.0-or-later
#include "body/body.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "body/board.h"
#include "body/pressed_strands.h"
#include "mask/bits.h"
#include "mask/coarse.h"
#include "mask/hu_view.h"

namespace trephine::body {
namespace {

constexpr float air_hu = -1000;  ///< and 1 HU more in every second voxel, so that it is not taken for padding
constexpr double coarse_mm = 2;
constexpr double min_core_ml = 50;   ///< the inside of a body is larger
constexpr double other_core_ml = 2;  ///< of a holder or a cushion: smaller pieces are thin parts of the body
constexpr double shell_mm = 3;       ///< the skin around the inside, which coarse cells leave out
constexpr double hollow_mm = 15;  ///< hollows of the body narrower than twice this are filled to judge what stands out
constexpr double plate_cores_mm[] = {1.5, 2, 2.5};  ///< plates of an apparatus are thicker than twice this
constexpr double plate_rim_mm = 0.75;               ///< of a plate, beyond what opening gives back
constexpr double dense_hu = 250;                    ///< of plates of plastic and metal; cartilage and skin have less
constexpr double min_dense_ml = 5;
constexpr double dense_rim_mm = 1.5;  ///< the blurred edge of a dense plate
constexpr double skin_mm = 4;         ///< a plate pressed against the body reaches no deeper
constexpr double piece_ml = 0.05;     ///< smaller pieces of apparatus are not counted
constexpr double sheet_ml = 1;        ///< more thin apparatus than this means that there is a mask or a table
constexpr double rim_ml = 0.5;        ///< a thin part of the body (rim of an ear) is smaller
constexpr double outlet_mm = 5;       ///< nostrils and ear canals are narrower than twice this
constexpr double max_cavity_ml = 1000;

double ml_of(const mask::BitMask& mask) { return mask.count() * mask.lattice().voxel_volume_mm3() / 1000; }

/// The body's inside, the insides of thick apparatus, and the body with its hollows (eyes, nose and cheek) filled.
struct Cores {
  mask::BitMask body, others, hull, near;
};

Cores cores_of(const mask::BitMask& tissue, const BodyParams& p, const Progress& progress) {
  const mask::CoarseRaster raster = mask::coarse_raster(tissue.lattice(), coarse_mm);
  const mask::BitMask cells = mask::coarse_mask(tissue, raster, 0.5);
  const mask::Components pieces = mask::components(mask::eroded(cells, p.core_mm, progress));
  mask::BitMask body = mask::dilated(mask::largest(pieces), p.core_mm, progress);
  body &= cells;
  mask::BitMask others = mask::at_least_ml(pieces, other_core_ml);
  others.remove(body);
  others = mask::dilated(others, p.core_mm, progress);
  others &= cells;
  others.remove(body);
  Cores out{mask::fine_mask(body, raster), mask::fine_mask(others, raster),
            mask::fine_mask(mask::closed(body, hollow_mm, progress), raster),
            mask::fine_mask(mask::dilated(body, p.reach_mm, progress), raster)};
  out.body &= tissue;
  out.others &= tissue;
  return out;
}

/// What of `piece` (apparatus that touches the body) is the body's: what is left of it beside the apparatus' own dense
/// or thick parts, touches the body, and is as small as an ear; and what lies in the body's hollows. How thick a plate
/// is, is not known: of the choices that recognize any of it, the one is taken that leaves most to the body. Where
/// `only_dense`, none but the dense parts are the apparatus' own.
mask::BitMask left_beside(const mask::BitMask& piece, const mask::BitMask& dense, const mask::BitMask& body,
                          const Cores& cores, const BodyParams& p, bool only_dense, const Progress& progress) {
  const grid::Lattice& l = piece.lattice();
  const double voxel_ml = l.voxel_volume_mm3() / 1000;
  const grid::Box box = grid::grown(piece.bounds(), 2, l);
  const mask::BitMask here = mask::crop(piece, box), near = mask::crop(cores.near, box),
                      beside = mask::dilated_6(mask::crop(body, box));
  const mask::BitMask beyond = mask::without(here, near), hull = mask::crop(cores.hull, box);
  // The apparatus' own parts: those of the core that are large, or go on beyond what an ear reaches.
  const auto own_parts = [&](const mask::BitMask& core, double rim_mm, double least_ml) {
    const mask::Components parts = mask::components(core);
    std::vector<char> own = mask::touching(parts, beyond);
    for (std::size_t c = 0; c < own.size(); ++c) own[c] = own[c] || parts.list[c].voxels * voxel_ml > least_ml;
    return mask::dilated(mask::select(parts, own), rim_mm, progress);
  };
  std::vector<mask::BitMask> recognized;
  if (!only_dense)
    for (const double core_mm : plate_cores_mm)
      recognized.push_back(
          own_parts(mask::eroded(here, core_mm, progress), core_mm + plate_rim_mm, p.most_part_ml / 4));
  recognized.push_back(own_parts(mask::both(mask::crop(dense, box), here), dense_rim_mm, min_dense_ml));
  recognized.erase(
      std::remove_if(recognized.begin(), recognized.end(), [](const mask::BitMask& m) { return !m.any(); }),
      recognized.end());
  if (recognized.empty()) recognized.emplace_back(here.lattice());
  mask::BitMask best(here.lattice());
  std::size_t most = 0;
  for (const mask::BitMask& apparatus : recognized) {
    const mask::BitMask outside = mask::without(here, apparatus);
    const mask::Components rest = mask::components(mask::both(mask::without(outside, hull), near));
    std::vector<char> keep(rest.list.size());
    for (std::size_t c = 0; c < keep.size(); ++c) keep[c] = rest.list[c].voxels * voxel_ml <= p.most_part_ml;
    mask::BitMask left = mask::select(rest, keep);
    left |= mask::both(outside, hull);
    const mask::Components joined = mask::components(left);
    left = mask::select(joined, mask::touching(joined, beside));
    if (const std::size_t count = left.count(); count > most) {
      most = count;
      best = std::move(left);
    }
  }
  return mask::placed(best, l);
}

/// How much of each component lies outside of the mask.
std::vector<double> ml_outside(const mask::Components& parts, const mask::BitMask& mask) {
  std::vector<double> ml(parts.list.size());
  mask::for_each_voxel(parts, [&](int component, int i, int j, int k) { ml[component] += !mask.get(i, j, k); });
  for (double& v : ml) v *= parts.lattice.voxel_volume_mm3() / 1000;
  return ml;
}

/// The pieces of the dense mask that do not reach into the body's depth, as the bones of nose and cheek do.
mask::BitMask apart_from(const mask::BitMask& depth, const mask::BitMask& dense) {
  const mask::Components pieces = mask::components(dense);
  std::vector<char> apart = mask::touching(pieces, depth);
  for (char& c : apart) c = !c;
  return mask::select(pieces, apart);
}

/// Tissue of the body alone: its inside, and what grows out of it as ears and nose do.
mask::BitMask body_tissue(const mask::HuView& hu, const mask::BitMask& tissue, const BodyParams& p, double& thin_ml,
                          const Progress& progress) {
  const Cores cores = cores_of(tissue, p, progress);
  if (ml_of(cores.body) < min_core_ml) return mask::BitMask(tissue.lattice());
  progress.report(0.4);
  const double voxel_ml = tissue.lattice().voxel_volume_mm3() / 1000;
  mask::BitMask thick =
      mask::both(mask::dilated(mask::eroded(tissue, p.thinnest_mm / 2, progress), p.thinnest_mm / 2, progress), tissue);
  thick.remove(cores.others);
  thick |= cores.body;
  mask::BitMask body = mask::grown_within(cores.body, thick, shell_mm, progress);
  // Ears and nose are small, end within reach and hold no dense plate of their own; a plate or a frame is large, or
  // goes on, or is dense.
  const mask::Components parts = mask::components(mask::without(thick, body));
  const std::vector<char> beside = mask::touching(parts, mask::dilated_6(body));
  const std::vector<char> far = mask::touching(parts, mask::without(thick, cores.near));
  const std::vector<double> outside_ml = ml_outside(parts, cores.hull);
  const mask::BitMask dense = mask::above(hu, dense_hu);
  const mask::BitMask plates = apart_from(mask::eroded(cores.body, skin_mm, progress), dense);
  mask::BitMask no_plate = plates;
  no_plate.invert() |= cores.hull;
  const std::vector<double> plate_ml = ml_outside(parts, no_plate);
  std::vector<char> keep(parts.list.size()), part(keep), plate(keep);
  for (std::size_t c = 0; c < keep.size(); ++c) {
    const bool large = far[c] || outside_ml[c] > p.most_part_ml;
    const bool apparatus = large || plate_ml[c] > min_dense_ml;
    keep[c] = beside[c] && !apparatus;
    part[c] = beside[c] && large;
    plate[c] = beside[c] && apparatus && !large;
  }
  const mask::BitMask before = body;
  for (const bool only_dense : {false, true})
    if (const mask::BitMask pieces = mask::select(parts, only_dense ? plate : part); pieces.any())
      body |= left_beside(pieces, only_dense ? plates : dense, before, cores, p, only_dense, progress);
  body |= mask::select(parts, keep);
  progress.report(0.6);

  // Thin tissue: the rim of an ear where nothing else is thin; strands of a mask where there are sheets.
  const mask::Components thin = mask::components(mask::without(mask::without(tissue, body), cores.others), true);
  thin_ml = 0;
  const mask::BitMask around = mask::dilated_6(body);
  const std::vector<char> on_body = mask::touching(thin, around);
  std::vector<char> rim(thin.list.size());
  for (std::size_t c = 0; c < rim.size(); ++c) {
    const double ml = thin.list[c].voxels * voxel_ml;
    rim[c] = on_body[c] && ml < rim_ml;
    if (!rim[c]) thin_ml += ml;
  }
  if (thin_ml < sheet_ml)
    body |= mask::select(thin, rim);
  else
    body |= mask::both(mask::both(around, tissue), mask::dilated(cores.body, shell_mm, progress));
  return body;
}

/// The skin's blurred edge: from the body outwards, as long as the HU fall.
mask::BitMask with_edge(const mask::BitMask& body, const mask::HuView& hu, const BodyParams& p,
                        const Progress& progress) {
  const grid::Lattice& l = body.lattice();
  const mask::BitMask reach = mask::dilated(body, p.edge_mm, progress);
  mask::BitMask out = body;
  const int steps = int(std::ceil(p.edge_mm / std::min({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z})));
  for (int step = 0; step < steps; ++step) {
    const mask::BitMask rim = mask::both(mask::without(mask::dilated_6(out), out), reach);
    const mask::BitMask next = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
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

Outcome<grid::HuVolume, BodyResult> keep_body(const grid::HuVolume& volume, const BodyParams& p,
                                              const Progress& progress) {
  BodyResult result;
  mask::check_finite(volume);
  const mask::HuView hu(volume);
  const mask::BitMask tissue = mask::above(hu, p.tissue_hu);
  double thin_ml = 0;
  // A board that the field cuts behind may be joined with the body as widely as a neck.
  mask::BitMask off_board = tissue;
  const bool along_slices = std::abs(hu.lattice().direction.column[2].z) > 0.7;
  if (const Board board = along_slices ? find_board(hu, progress) : Board(); board.voxels.any()) {
    off_board.remove(board.voxels);
    result.board_thickness_mm = board.thickness_mm;
  }
  const mask::BitMask found = body_tissue(hu, off_board, p, thin_ml, progress);
  if (!found.any())
    return {volume,
            std::move(result),
            {{"no_body",
              "no body was found, and nothing was taken off: no tissue above {tissue_hu} HU in which a ball of "
              "{core_mm} mm fits (tissue_hu, core_mm)",
              {{"tissue_hu", p.tissue_hu}, {"core_mm", p.core_mm}}}}};
  mask::BitMask whole = found;
  whole |= mask::holes(found, mask::FillRule{outlet_mm, max_cavity_ml, true}, progress);
  mask::BitMask body = with_edge(whole, hu, p, progress);
  if (p.strand_mm > 0 && thin_ml > sheet_ml) {
    const PressedStrands pressed = find_pressed_strands(hu, whole, body, p.strand_mm, progress);
    if (pressed.found) {
      result.strands_on_skin_ml = ml_of(mask::both(pressed.strands, tissue));
      body.remove(pressed.strands);
    }
  }
  progress.report(0.9);
  const mask::BitMask apparatus = mask::without(tissue, body);
  const double apparatus_ml = ml_of(apparatus);
  const mask::Components pieces = mask::components(apparatus, true);
  const double voxel_ml = hu.lattice().voxel_volume_mm3() / 1000;
  const std::int64_t pieces_count =
      std::count_if(pieces.list.begin(), pieces.list.end(),
                    [&](const mask::Component& c) { return c.voxels * voxel_ml >= piece_ml; });
  result.found = ApparatusFigures{ml_of(whole), apparatus_ml, std::min(thin_ml, apparatus_ml), pieces_count};
  if (apparatus_ml < p.least_ml) return {volume, std::move(result), {}};
  grid::HuVolume out = volume;
  std::visit(
      [&](auto& grid) {
        using Sample = typename std::decay_t<decltype(grid)>::Sample;
        parallel_for(0, grid.size[2], 1, [&](std::int64_t from, std::int64_t to) {
          for (int k = int(from); k < to; ++k)
            for (int j = 0; j < grid.size[1]; ++j) {
              Sample* row = &grid.at(0, j, k);
              const std::uint64_t* kept = body.row(j, k);
              for (int i = 0; i < grid.size[0]; ++i)
                if (!(kept[i >> 6] >> (i & 63) & 1) && row[i] > p.air_hu)
                  row[i] = Sample(air_hu + float((i + j + k) & 1));
            }
        });
      },
      out);
  return {std::move(out), std::move(result), {}};
}

}  // namespace trephine::body
