// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel/voxelize.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "voxel/cut.h"
#include "voxel/raw_voxel.h"
#include "voxel/shape_field.h"
#include "voxel/shape_occupancy.h"

namespace trephine::voxel {
namespace {

constexpr std::int64_t voxels_a_piece = 1 << 16;

// The shares of a voxel that the shapes so far have, of 255: the two largest ones, their sum, and what of it solids
// have, which are no shells.
struct Shares {
  std::uint8_t first = 0, first_share = 0, second = 0, second_share = 0, sum = 0, solid = 0;

  void add(int number, int share, bool shell) {
    sum = std::uint8_t(sum + share);
    if (!shell) solid = std::uint8_t(solid + share);
    if (share > first_share) {
      second = first;
      second_share = first_share;
      first = std::uint8_t(number);
      first_share = std::uint8_t(share);
    } else if (share > second_share) {
      second = std::uint8_t(number);
      second_share = std::uint8_t(share);
    }
  }
  // Whether the second shape should get all the rest: that is less wrong than giving it nothing, and no shape grows by
  // more than a sliver.
  bool rest_is_seconds() const {
    const int rest = haptic_full - first_share;
    return 2 * second_share > rest && rest - second_share <= haptic_full / 4 + 1;
  }
};

template <class Each>
void for_each_piece(std::size_t count, const Progress& progress, const Each& each) {
  parallel_for(0, std::int64_t(count), voxels_a_piece, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    each(std::size_t(from), std::size_t(to), std::size_t(from / voxels_a_piece));
  });
}

// Adds a shape to the shares, after those before it; returns the sum of what they had taken already, of 255 each.
std::int64_t add_shape(std::vector<Shares>& shares, int number, bool shell, const grid::Grid<std::uint8_t>& occupancy,
                       const Progress& progress) {
  std::vector<std::int64_t> taken((shares.size() + voxels_a_piece - 1) / voxels_a_piece, 0);
  for_each_piece(shares.size(), progress, [&](std::size_t from, std::size_t to, std::size_t piece) {
    for (std::size_t i = from; i < to; ++i) {
      const int asked = occupancy.voxels[i];
      if (asked == 0) continue;
      const int share = std::min(asked, haptic_full - shares[i].sum);
      taken[piece] += asked - share;
      if (share > 0) shares[i].add(number, share, shell);
    }
  });
  return std::accumulate(taken.begin(), taken.end(), std::int64_t{0});
}

// Calls each(index) for the neighbours of a voxel: 6, or 26.
template <class Each>
void for_each_neighbour(const grid::Lattice& l, std::size_t at, bool corners, const Each& each) {
  const int i = int(at % std::size_t(l.size[0])), j = int(at / std::size_t(l.size[0]) % std::size_t(l.size[1])),
            k = int(at / std::size_t(l.size[0]) / std::size_t(l.size[1]));
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        if ((corners || std::abs(x) + std::abs(y) + std::abs(z) == 1) && l.contains(i + x, j + y, k + z))
          each(l.index(i + x, j + y, k + z));
}

// Undoes the clearing behind a wall: what cannot be reached from the solid through cleared voxels that earlier shapes
// fill to less than half stays (the scalp outside a thin temporal bone). Walls are cleared on the side that was
// reached. A membrane is no wall: what lies between dura and bone is no scalp.
void keep_behind_walls(detail::Clearance& clear, const grid::Grid<std::uint8_t>& wanted,
                       const std::vector<Shares>& shares, const Progress& progress) {
  const auto open = [&](std::size_t at) {
    return wanted.voxels[at] && clear.left.voxels[at] < haptic_full && shares[at].solid <= haptic_full / 2;
  };
  grid::Grid<std::uint8_t> reached(wanted, 0);
  std::vector<std::size_t> front;
  const auto reach = [&](std::size_t at) {
    if (reached.voxels[at] || !open(at)) return;
    reached.voxels[at] = 1;
    front.push_back(at);
  };
  for (std::size_t at = 0; at < wanted.voxels.size(); ++at)
    if (wanted.voxels[at] && open(at)) {
      bool beside = clear.inside.voxels[at] != 0;
      for_each_neighbour(wanted, at, false, [&](std::size_t n) { beside = beside || clear.inside.voxels[n]; });
      if (beside) reach(at);
    }
  while (!front.empty()) {
    if (front.size() % 65536 == 0) progress.check();
    const std::size_t at = front.back();
    front.pop_back();
    for_each_neighbour(wanted, at, false, reach);
  }
  for_each_piece(shares.size(), progress, [&](std::size_t from, std::size_t to, std::size_t) {
    for (std::size_t at = from; at < to; ++at) {
      if (!wanted.voxels[at] || clear.left.voxels[at] == haptic_full) continue;
      bool cleared = reached.voxels[at];
      if (!cleared && shares[at].solid > haptic_full / 2)
        for_each_neighbour(wanted, at, true, [&](std::size_t n) { cleared = cleared || reached.voxels[n]; });
      if (!cleared) clear.left.voxels[at] = haptic_full;
    }
  });
}

// The share that the shape claims. `largest`: its largest share of a voxel before its clearance and other shapes.
grid::Grid<std::uint8_t> occupancy_of(const VoxelizeShape& shape, const grid::Lattice& lattice,
                                      const std::vector<Shares>& shares, int& largest, const Progress& progress) {
  const bool clear = shape.clear_of != nullptr;
  const Progress solid = progress.part(0, clear ? 0.6 : 1);
  grid::Grid<std::uint8_t> own = shape.surface ? detail::solid_occupancy(*shape.surface, lattice, solid)
                                               : detail::solid_occupancy(*shape.field, shape.turned, lattice, solid);
  if (shape.shell_mm > 0) detail::keep_shell(*shape.surface, shape.shell_mm, own, progress);
  largest = own.voxels.empty() ? 0 : *std::max_element(own.voxels.begin(), own.voxels.end());
  if (!clear) return own;
  // The distance to the other surface is needed only where the shape would get something.
  grid::Grid<std::uint8_t> wanted(lattice, 0);
  for_each_piece(shares.size(), progress, [&](std::size_t from, std::size_t to, std::size_t) {
    for (std::size_t i = from; i < to; ++i) wanted.voxels[i] = own.voxels[i] > 0 && shares[i].sum < haptic_full;
  });
  detail::Clearance clearance = detail::clear_occupancy(*shape.clear_of, shape.clear_mm, wanted, progress.part(0.6, 1));
  keep_behind_walls(clearance, wanted, shares, progress);
  for_each_piece(shares.size(), progress, [&](std::size_t from, std::size_t to, std::size_t) {
    for (std::size_t i = from; i < to; ++i)
      if (wanted.voxels[i]) own.voxels[i] = std::min(own.voxels[i], clearance.left.voxels[i]);
  });
  return own;
}

// The raw values. The form (plain or bare) of a voxel does not change what its neighbours read, so that the second pass
// may run over them in any order.
grid::Grid<std::int16_t> encode(const grid::Lattice& lattice, const std::vector<Shares>& shares,
                                const Progress& progress) {
  grid::Grid<std::int16_t> voxels(lattice, haptic_empty);
  for_each_piece(shares.size(), progress, [&](std::size_t from, std::size_t to, std::size_t) {
    for (std::size_t i = from; i < to; ++i) {
      const Shares& s = shares[i];
      if (s.first_share == 0) continue;
      // A sliver of a gap between two shapes closes at one half, so that neither shape reads as more than that.
      const int share = s.rest_is_seconds() ? std::max<int>(s.first_share, haptic_full / 2 + 1) : s.first_share;
      voxels.voxels[i] = detail::join(s.first, share, false);
    }
  });
  parallel_for(0, lattice.size[2], 1, [&](std::int64_t from, std::int64_t) {
    progress.check();
    const int k = int(from);
    for (int j = 0; j < lattice.size[1]; ++j)
      for (int i = 0; i < lattice.size[0]; ++i) {
        const std::size_t at = lattice.index(i, j, k);
        const Shares& s = shares[at];
        if (s.first_share == 0 || s.first_share == haptic_full) continue;
        const int other = detail::other_shape(voxels, s.first, i, j, k);
        if (other == 0 || (other == s.second && s.rest_is_seconds())) continue;
        const int share = detail::split(detail::load_voxel(voxels.voxels[at])).share;
        __atomic_store_n(&voxels.voxels[at], detail::join(s.first, share, true), __ATOMIC_RELAXED);
      }
  });
  return voxels;
}

void check_shapes(const grid::Lattice& lattice, const std::vector<VoxelizeShape>& shapes) {
  for (const int n : lattice.size)
    if (n < 1) throw Error(ExitCode::bad_input, "", "haptic", "the region holds no voxel");
  if (shapes.empty() || shapes.size() > std::size_t(haptic_max_shapes))
    throw Error(ExitCode::bad_config, "", "haptic.shapes",
                std::to_string(shapes.size()) + ", must be 1 to " + std::to_string(haptic_max_shapes));
  for (const VoxelizeShape& s : shapes)
    if (!s.surface && (!s.field || s.shell_mm > 0))
      throw Error(ExitCode::internal, "", "haptic." + s.name, "has no surface");
}

bool is_half(int share) { return 2 * share >= haptic_full; }

[[noreturn]] void refuse_unfelt(const VoxelizeShape& shape, int largest) {
  std::string why = "no voxel in the region";
  if (is_half(largest))
    why = shape.clear_of ? "shapes before it, or the rule to keep clear, take all that it has of the region"
                         : "shapes before it take all that it has of the region";
  else if (largest > 0)
    why = "fills no voxel of the region to one half: it is too thin for the voxels, or lies at the region's edge";
  throw refusal("haptic." + shape.name, why,
                {"leave it out of `shapes`, set a smaller `spacing_mm`, or change the order of the `shapes`"})
      .finds_fault_with({shape.name})
      .because(Cause::refused_output);
}

}  // namespace

Outcome<HapticVolume, VoxelizeResult> voxelize(const grid::Lattice& lattice, const std::vector<VoxelizeShape>& shapes,
                                               const Progress& progress) {
  check_shapes(lattice, shapes);
  HapticVolume volume;
  const double ml = lattice.voxel_volume_mm3() / 1000;
  std::vector<double> overlap_ml;
  std::vector<int> largest(shapes.size(), 0);
  {
    std::vector<Shares> shares(lattice.count());
    for (std::size_t n = 0; n < shapes.size(); ++n) {
      const Progress part =
          progress.part(0.9 * double(n) / double(shapes.size()), 0.9 * double(n + 1) / double(shapes.size()));
      with_field("haptic." + shapes[n].name, [&] {
        const grid::Grid<std::uint8_t> occupancy = occupancy_of(shapes[n], lattice, shares, largest[n], part);
        overlap_ml.push_back(double(add_shape(shares, int(n + 1), shapes[n].shell_mm > 0, occupancy, part)) /
                             haptic_full * ml);
      });
      volume.shapes.push_back(occupancy_shape(shapes[n].name, int(n + 1)));
    }
    volume.voxels = encode(lattice, shares, progress);
  }
  check_haptic_volume(volume);
  std::vector<std::size_t> voxels(shapes.size() + 1, 0), half = voxels;
  for (const std::int16_t raw : volume.voxels.voxels) {
    const detail::RawVoxel v = detail::split(raw);
    ++voxels[std::size_t(v.number)];
    half[std::size_t(v.number)] += is_half(v.share);
  }
  VoxelizeResult result;
  const auto mm3 = shape_volumes_mm3(volume);
  for (std::size_t n = 0; n < shapes.size(); ++n) {
    const std::string& name = shapes[n].name;
    if (half[n + 1] == 0) refuse_unfelt(shapes[n], largest[n]);
    result.shapes.emplace_back(name, ShapeVoxels{mm3[n + 1] / 1000, voxels[n + 1], overlap_ml[n]});
  }
  progress.report(1);
  return {std::move(volume), std::move(result), {}};
}

}  // namespace trephine::voxel
