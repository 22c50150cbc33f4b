// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/felt_lattice.h"

#include <algorithm>
#include <cmath>

#include "contact/contact_cell.h"
#include "contact/crossing.h"
#include "voxel/raw_voxel.h"

namespace trephine::contact {

FeltLattice::FeltLattice(voxel::HapticVolume& volume_, const ContactParams& params_)
    : volume(volume_),
      params(params_),
      table(volume_),
      blocks(volume_, table, !boxes()),
      clear(volume_, table, blocks) {
  const grid::Lattice& l = volume.voxels;
  smallest_side_mm = std::min({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z});
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      index_of_world.column[std::size_t(b)][a] = l.direction.column[std::size_t(a)][b] / l.spacing_mm[a];
}

int FeltLattice::shape_of_voxel(int i, int j, int k) const {
  if (!volume.voxels.contains(i, j, k)) return 0;
  const std::uint32_t e = table.of(voxel::detail::load_voxel(volume.voxels.at(i, j, k)));
  return 2 * entry_filled(e) > voxel::haptic_full ? entry_shape(e) : 0;
}

int FeltLattice::shape_of(Vec3 index) const {
  const auto& size = volume.voxels.size;
  for (int a = 0; a < 3; ++a)
    if (!(index[a] >= -1 && index[a] <= size[std::size_t(a)])) return 0;
  if (boxes()) {
    const int i = int(std::floor(index.x + 0.5)), j = int(std::floor(index.y + 0.5)),
              k = int(std::floor(index.z + 0.5));
    const int block = blocks.shape_of_block(i, j, k);
    return block != KnownBlocks::mixed_block ? block : shape_of_voxel(i, j, k);
  }
  const int i = int(std::floor(index.x)), j = int(std::floor(index.y)), k = int(std::floor(index.z));
  constexpr int bits = KnownBlocks::block_bits;
  const KnownBlocks::Block block = blocks.block(i >> bits, j >> bits, k >> bits);
  if (block.shape < KnownBlocks::mixed_block) return block.shape;
  const int uniform =
      block.shape == KnownBlocks::mixed_block && block.details_known ? blocks.cell_shape(block, i, j, k) : -1;
  if (uniform >= 0) return uniform;
  return ContactCell(*this, i, j, k).shape_at(detail::within_cell(index, i, j, k));
}

}  // namespace trephine::contact
