// SPDX-License-Identifier: GPL-3.0-or-later
// The walk through the cells of a sub-voxel surface.
#include <limits>

#include "contact/cell_walk.h"
#include "contact/contact_cell.h"
#include "contact/crossing.h"

namespace trephine::contact {

bool walk_cell(const ContactCell& cell, const Segment& s, const int* at, double t0, double t1,
               const TouchableFaces& faces, Crossing& c) {
  const Vec3 p = detail::within_cell(detail::between(s.begin, s.end, t0), at[0], at[1], at[2]);
  const Vec3 q = detail::within_cell(detail::between(s.begin, s.end, t1), at[0], at[1], at[2]);
  const int all = cell.shape_along(p, q);
  if (all >= 0) return all != c.into && c.change(all, t0, faces);
  double breaks[ContactCell::max_breaks + 1];
  int count = cell.breaks(p, q, breaks);
  breaks[count++] = 1;
  double before = 0;
  for (int n = 0; n < count; ++n) {
    const int now = cell.shape_at(detail::between(p, q, 0.5 * (before + breaks[n])));
    if (now != c.into && c.change(now, t0 + (t1 - t0) * before, faces)) return true;
    before = breaks[n];
  }
  return false;
}

namespace {

/// A walk through cells. It skips cells that hold nothing which could stop the way, once it is known that the way has
/// passed a face. In which shape the last skipped cell ends is looked up only where that matters (look_back).
class CellWalk {
 public:
  CellWalk(const FeltLattice& felt, const Segment& segment, int shape, const TouchableFaces& faces)
      : felt_(felt), segment_(segment), faces_(faces), touch_(std::uint32_t((faces.front | faces.back) >> 1)) {
    crossing_.from = crossing_.into = shape;
  }

  Crossing run() {
    walk_over_cells<KnownBlocks::block_bits>(
        segment_.begin, segment_.end,
        [&](int i, int j, int k, double t0, double t1) { return visit(i, j, k, t0, t1); });
    look_back();
    return crossing_;
  }

 private:
  WalkStep visit(int i, int j, int k, double t0, double t1) {
    const int bi = i >> KnownBlocks::block_bits, bj = j >> KnownBlocks::block_bits, bk = k >> KnownBlocks::block_bits;
    if (((bi ^ block_of_[0]) | (bj ^ block_of_[1]) | (bk ^ block_of_[2])) != 0) look_up(bi, bj, bk);
    if (block_.shape < KnownBlocks::mixed_block) return enter(block_.shape, t0) ? WalkStep::end : WalkStep::block;
    if (block_.shape == KnownBlocks::mixed_block && block_.details_known) {
      const int uniform = felt_.blocks.cell_shape(block_, i, j, k);
      if (uniform >= 0) return enter(uniform, t0) ? WalkStep::end : WalkStep::cell;
    }
    const bool may_leave = crossing_.passed && (left_ || !touches(crossing_.into));
    if (may_leave && (block_.near & touch_) == 0) return leave(i, j, k, t0, t1);
    const ContactCell cell(felt_, i, j, k, may_leave ? touch_ : KnownBlocks::all_shapes);
    if (cell.uniform()) return enter(cell.shape(), t0) ? WalkStep::end : WalkStep::cell;
    if (!cell.touched()) return leave(i, j, k, t0, t1);
    look_back();
    const int at[3] = {i, j, k};
    return walk_cell(cell, segment_, at, t0, t1, faces_, crossing_) ? WalkStep::end : WalkStep::cell;
  }

  void look_up(int bi, int bj, int bk) {
    block_of_[0] = bi, block_of_[1] = bj, block_of_[2] = bk;
    block_ = felt_.blocks.block(bi, bj, bk);
  }

  bool touches(int number) const { return number != 0 && (touch_ >> (number - 1) & 1); }

  bool enter(int number, double t) {
    if (touches(number)) look_back();
    if (left_) crossing_.into = number;
    left_ = false;
    return number != crossing_.into && crossing_.change(number, t, faces_);
  }

  WalkStep leave(int i, int j, int k, double t0, double t1) {
    left_ = true;
    last_[0] = i, last_[1] = j, last_[2] = k;
    last_t0_ = t0;
    last_t1_ = t1;
    return WalkStep::cell;
  }

  void look_back() {
    if (!left_) return;
    left_ = false;
    const ContactCell cell(felt_, last_[0], last_[1], last_[2]);
    Crossing c;
    if (cell.uniform())
      c.into = cell.shape();
    else
      walk_cell(cell, segment_, last_, last_t0_, last_t1_, {0, 0}, c);
    crossing_.into = c.into;
  }

  const FeltLattice& felt_;
  const Segment& segment_;
  const TouchableFaces faces_;
  const std::uint32_t touch_;
  Crossing crossing_;
  int block_of_[3] = {std::numeric_limits<int>::min(), 0, 0};
  KnownBlocks::Block block_;
  int last_[3];
  double last_t0_, last_t1_;
  bool left_ = false;
};

}  // namespace

Crossing walk_cells(const FeltLattice& felt, const Segment& s, int shape, const TouchableFaces& faces) {
  return CellWalk(felt, s, shape, faces).run();
}

}  // namespace trephine::contact
