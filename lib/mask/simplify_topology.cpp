// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/simplify_topology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "mask/bits.h"
#include "mask/filters.h"

namespace trephine::mask {
namespace {

using Word = std::uint64_t;

/// The bit of a neighbour in a neighbourhood: 9 (dk + 1) + 3 (dj + 1) + (di + 1).
constexpr int bit_of(int di, int dj, int dk) { return 9 * (dk + 1) + 3 * (dj + 1) + di + 1; }
constexpr int middle = bit_of(0, 0, 0);

struct Tables {
  std::uint32_t faces = 0, within_edges = 0;        ///< the 6 and the 18 neighbours
  std::array<std::uint32_t, 27> by_face{}, near{};  ///< neighbours of each place within the 27
  std::array<std::uint32_t, 12> squares{};          ///< the three others of the squares at the middle
  std::array<std::uint32_t, 8> cubes{};             ///< the seven others

  Tables() {
    for (int a = 0; a < 27; ++a) {
      const int ai = a % 3 - 1, aj = a / 3 % 3 - 1, ak = a / 9 - 1;
      const int far = std::abs(ai) + std::abs(aj) + std::abs(ak);
      if (far == 1) faces |= 1u << a;
      if (far == 1 || far == 2) within_edges |= 1u << a;
      for (int b = 0; b < 27; ++b) {
        const int di = std::abs(b % 3 - 1 - ai), dj = std::abs(b / 3 % 3 - 1 - aj), dk = std::abs(b / 9 - 1 - ak);
        if (a == b || a == middle || b == middle) continue;
        if (di + dj + dk == 1) by_face[a] |= 1u << b;
        if (std::max({di, dj, dk}) == 1) near[a] |= 1u << b;
      }
    }
    int s = 0, c = 0;
    for (const int k : {-1, 1})
      for (const int j : {-1, 1}) {
        squares[s++] = 1u << bit_of(j, 0, 0) | 1u << bit_of(0, k, 0) | 1u << bit_of(j, k, 0);
        squares[s++] = 1u << bit_of(j, 0, 0) | 1u << bit_of(0, 0, k) | 1u << bit_of(j, 0, k);
        squares[s++] = 1u << bit_of(0, j, 0) | 1u << bit_of(0, 0, k) | 1u << bit_of(0, j, k);
        for (const int i : {-1, 1})
          cubes[c++] = 1u << bit_of(i, 0, 0) | 1u << bit_of(0, j, 0) | 1u << bit_of(0, 0, k) | 1u << bit_of(i, j, 0) |
                       1u << bit_of(i, 0, k) | 1u << bit_of(0, j, k) | 1u << bit_of(i, j, k);
      }
  }
};

const Tables& tables() {
  static const Tables t;
  return t;
}

std::uint32_t three_bits(const BitMask& m, int i, int j, int k) {
  const grid::Lattice& l = m.lattice();
  if (j < 0 || k < 0 || j >= l.size[1] || k >= l.size[2]) return 0;
  const Word* row = m.row(j, k);
  const int at = i & 63, word = i >> 6;
  if (at > 0 && at < 63) return std::uint32_t(row[word] >> (at - 1)) & 7;
  std::uint32_t bits = std::uint32_t(row[word] >> at & 1) << 1;
  if (i > 0) bits |= std::uint32_t(row[(i - 1) >> 6] >> ((i - 1) & 63) & 1);
  if (i + 1 < l.size[0]) bits |= std::uint32_t(row[(i + 1) >> 6] >> ((i + 1) & 63) & 1) << 2;
  return bits;
}

/// The voxel's 27 neighbours and itself; outside of the lattice they are 0.
std::uint32_t neighbourhood(const BitMask& m, int i, int j, int k) {
  std::uint32_t bits = 0;
  for (int dk = -1; dk <= 1; ++dk)
    for (int dj = -1; dj <= 1; ++dj) bits |= three_bits(m, i, j + dj, k + dk) << bit_of(-1, dj, dk);
  return bits;
}

/// Everything that is connected to `seed` within `of`.
std::uint32_t flooded(std::uint32_t seed, std::uint32_t of, const std::array<std::uint32_t, 27>& joined) {
  std::uint32_t reached = seed, fresh = seed;
  while (fresh) {
    std::uint32_t next = 0;
    for (; fresh; fresh &= fresh - 1) next |= joined[__builtin_ctz(fresh)];
    fresh = next & of & ~reached;
    reached |= fresh;
  }
  return reached;
}

/// Whether the middle voxel can be removed, or added, without a change of topology (a simple point).
bool is_simple(std::uint32_t n) {
  const Tables& t = tables();
  const std::uint32_t in = n & t.within_edges, out = ~n & ((1u << 27) - 1) & ~(1u << middle);
  const std::uint32_t at_faces = in & t.faces;
  if (!at_faces || !out) return false;
  if (at_faces & ~flooded(at_faces & -at_faces, in, t.by_face)) return false;
  return !(out & ~flooded(out & -out, out, t.near));
}

/// How much the solid's Euler characteristic grows when the middle voxel is added.
int gain(std::uint32_t n) {
  const Tables& t = tables();
  int chi = 1 - __builtin_popcount(n & t.faces);
  for (const std::uint32_t s : t.squares) chi += (n & s) == s;
  for (const std::uint32_t c : t.cubes) chi -= (n & c) == c;
  return chi;
}

struct Voxel {
  int i, j, k;
};

template <class F>
void for_voxels(const BitMask& m, F&& f) {
  const grid::Lattice& l = m.lattice();
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j) {
      const Word* row = m.row(j, k);
      for (int w = 0; w < m.words(); ++w)
        for (Word bits = row[w]; bits; bits &= bits - 1) f(w * 64 + __builtin_ctzll(bits), j, k);
    }
}

/// The Euler characteristic of the solid: voxels less pairs, plus squares, less cubes.
long euler_characteristic(const BitMask& m) {
  const grid::Lattice& l = m.lattice();
  std::vector<long> of_slice(l.size[2], 0);
  parallel_for(0, l.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int w = 0; w < m.words(); ++w) {
          // a: the row, b: beside it in y, c: in z, d: in both; each also moved by one in x.
          const auto at = [&](int y, int z, Word& moved) {
            moved = 0;
            if (y >= l.size[1] || z >= l.size[2]) return Word{0};
            const Word* row = m.row(y, z);
            moved = row[w] >> 1 | (w + 1 < m.words() ? row[w + 1] << 63 : 0);
            return row[w];
          };
          Word ax, bx, cx, dx;
          const Word a = at(j, k, ax), b = at(j + 1, k, bx), c = at(j, k + 1, cx), d = at(j + 1, k + 1, dx);
          const auto n = [](Word v) { return long(__builtin_popcountll(v)); };
          of_slice[k] += n(a) - n(a & ax) - n(a & b) - n(a & c) + n(a & ax & b & bx) + n(a & ax & c & cx) +
                         n(a & b & c & d) - n(a & ax & b & bx & c & cx & d & dx);
        }
  });
  long chi = 0;
  for (const long v : of_slice) chi += v;
  return chi;
}

/// Peels voxels of `added` off `shape`, layer by layer, where this keeps the topology.
class Peeler {
 public:
  Peeler(BitMask& shape, BitMask& added) : shape_(shape), added_(added), queued_(shape.lattice()) {}

  void peel(const Progress& progress) {
    for_voxels(added_, [&](int i, int j, int k) {
      if (neighbourhood(shape_, i, j, k) != (1u << 27) - 1) push(i, j, k);
    });
    drain(progress);
  }

  /// Removes the voxels that are not wanted: those that make a handle, join two pieces, or are connected to nothing.
  void cut_bridges(const Progress& progress) {
    std::vector<Voxel> all;
    for_voxels(added_, [&](int i, int j, int k) { all.push_back({i, j, k}); });
    for (const Voxel v : all) {
      if (!added_.get(v.i, v.j, v.k)) continue;
      const std::uint32_t n = neighbourhood(shape_, v.i, v.j, v.k);
      if ((n & tables().faces) && gain(n) >= 0) continue;
      remove(v);
      drain(progress);  // what is left of the bridge
    }
  }

 private:
  void drain(const Progress& progress) {
    while (!next_.empty()) {
      progress.check();
      now_.swap(next_);
      next_.clear();
      for (const Voxel v : now_) queued_.clear(v.i, v.j, v.k);
      for (const Voxel v : now_)
        if (added_.get(v.i, v.j, v.k) && is_simple(neighbourhood(shape_, v.i, v.j, v.k))) remove(v);
    }
  }
  void push(int i, int j, int k) {
    if (queued_.get(i, j, k)) return;
    queued_.set(i, j, k);
    next_.push_back({i, j, k});
  }
  void remove(Voxel v) {
    shape_.clear(v.i, v.j, v.k);
    added_.clear(v.i, v.j, v.k);
    std::uint32_t n = neighbourhood(added_, v.i, v.j, v.k);
    for (; n; n &= n - 1) {
      const int b = __builtin_ctz(n);
      push(v.i + b % 3 - 1, v.j + b / 3 % 3 - 1, v.k + b / 9 - 1);
    }
  }

  BitMask &shape_, &added_, queued_;
  std::vector<Voxel> now_, next_;
};

double diagonal_mm(const grid::Lattice& l) { return norm(l.spacing_mm); }

BitMask complement(const BitMask& m) {
  BitMask out = m;
  out.invert();
  return out;
}

/// The components of the complement that do not touch the lattice's faces.
struct Cavities {
  Components all;
  std::vector<char> enclosed;
  std::size_t count = 0;

  explicit Cavities(const BitMask& shape) : all(components(complement(shape), true)) {
    for (const auto& c : all.list) enclosed.push_back(c.faces == 0);
    count = std::size_t(std::count(enclosed.begin(), enclosed.end(), 1));
  }
};

struct Topology3 {
  long euler = 0;
  std::size_t pieces = 0, cavities = 0;
  long handles() const { return long(pieces + cavities) - euler; }
};

Topology3 topology3_of(const BitMask& shape, const Cavities& cavities) {
  return {euler_characteristic(shape), components(shape).list.size(), cavities.count};
}

/// Membranes across the shape's tunnels.
BitMask membranes(const BitMask& shape, double width_mm, const Progress& progress) {
  BitMask closed = mask::closed(shape, width_mm / 2, progress.part(0, 0.5));
  BitMask added = closed;
  added.remove(shape);
  closed |= shape;
  Peeler peeler(closed, added);
  peeler.peel(progress);
  peeler.cut_bridges(progress);
  progress.report(1);
  return added;
}

/// Takes back the membranes that border on a new cavity with more voxels than allowed.
void open_large_cavities(const BitMask& shape, const Cavities& before, double max_voxels, BitMask& added) {
  BitMask sum = shape;
  sum |= added;
  const Cavities now(sum);
  std::vector<char> was_outside(before.enclosed.size());
  for (std::size_t c = 0; c < was_outside.size(); ++c) was_outside[c] = !before.enclosed[c];
  const std::vector<char> fresh = touching(now.all, select(before.all, was_outside));
  std::vector<char> large(now.enclosed.size(), 0);
  for (std::size_t c = 0; c < large.size(); ++c)
    large[c] = now.enclosed[c] && fresh[c] && double(now.all.list[c].voxels) > max_voxels;
  if (std::count(large.begin(), large.end(), 1) == 0) return;
  const BitMask beside = dilated(select(now.all, large), 1.001 * diagonal_mm(shape.lattice()));
  const Components parts = components(added, true);
  added.remove(select(parts, touching(parts, beside)));
}

/// Distance from the voxel's centre to the nearest voxel of the shape, within reach.
double distance_mm(const BitMask& shape, int i, int j, int k, double reach_mm) {
  const grid::Lattice& l = shape.lattice();
  const Vec3 s = l.spacing_mm;
  const int ri = int(reach_mm / s.x) + 1, rj = int(reach_mm / s.y) + 1, rk = int(reach_mm / s.z) + 1;
  double best = reach_mm * reach_mm;
  for (int dk = -rk; dk <= rk; ++dk)
    for (int dj = -rj; dj <= rj; ++dj) {
      const double side = dj * s.y * dj * s.y + dk * s.z * dk * s.z;
      if (side >= best) continue;
      for (int di = -ri; di <= ri; ++di)
        if (const double d = side + di * s.x * di * s.x; d < best && shape.at(i + di, j + dj, k + dk)) best = d;
    }
  return std::sqrt(best);
}

}  // namespace

Outcome<grid::Field, SimplifyResult> simplify_topology(const grid::Field& field, const SimplifyParams& params,
                                                       const Progress& progress) {
  check_finite(field);
  grid::Field out = field;
  const BitMask shape = positive(field, field);
  Warnings warnings;
  if (!shape.any()) warnings.push_back({"nothing_inside", "nothing is inside: there is nothing to simplify", {}});
  const Cavities before(shape);
  const Topology3 was = topology3_of(shape, before);
  progress.report(0.2);
  const double max_voxels = params.close_cavities_ml * 1000 / field.voxel_volume_mm3();
  BitMask added(shape.lattice());
  if (params.close_handles_mm > 0) {
    added = membranes(shape, params.close_handles_mm, progress.part(0.2, 0.6));
    open_large_cavities(shape, before, max_voxels, added);
  }
  BitMask sum = shape;
  sum |= added;
  const std::size_t membranes_count = components(added, true).list.size();
  const Cavities now(sum);
  std::vector<char> fill(now.enclosed.size(), 0);
  for (std::size_t c = 0; c < fill.size(); ++c)
    fill[c] = now.enclosed[c] && double(now.all.list[c].voxels) <= max_voxels;
  const BitMask filled = select(now.all, fill);
  progress.report(0.8);

  double moved = 0;
  for_voxels(added, [&](int i, int j, int k) {
    // The value has the size of its neighbours' values, so the membrane is about one voxel thick.
    float beside = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {-1, 1}) {
        const int x = i + (axis == 0) * side, y = j + (axis == 1) * side, z = k + (axis == 2) * side;
        if (field.contains(x, y, z) && !sum.get(x, y, z)) beside = std::max(beside, std::abs(field.at(x, y, z)));
      }
    float& f = out.at(i, j, k);
    f = std::max({std::abs(f), beside / 2, 1e-6f});
    moved = std::max(moved, distance_mm(shape, i, j, k, params.close_handles_mm / 2 + diagonal_mm(field)));
  });
  for_voxels(filled, [&](int i, int j, int k) {
    float& f = out.at(i, j, k);
    f = std::max(std::abs(f), 1e-6f);
  });
  sum |= filled;
  const Topology3 is = topology3_of(sum, Cavities(sum));
  const std::size_t changed = added.count() + filled.count();

  const SimplifyResult result{std::int64_t{2 * was.euler},
                              std::int64_t{2 * is.euler},
                              std::int64_t{was.handles()},
                              std::int64_t{is.handles()},
                              std::int64_t(was.cavities),
                              std::int64_t(is.cavities),
                              membranes_count,
                              static_cast<std::int64_t>(std::count(fill.begin(), fill.end(), 1)),
                              changed,
                              double(changed) * field.voxel_volume_mm3() / 1000,
                              added.any() ? moved + diagonal_mm(field) / 2 : 0.0};
  progress.report(1);
  return {std::move(out), result, std::move(warnings)};
}

}  // namespace trephine::mask
