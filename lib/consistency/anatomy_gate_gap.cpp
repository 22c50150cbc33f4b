// SPDX-License-Identifier: GPL-3.0-or-later
#include "consistency/anatomy_gate_gap.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "mask/coarse.h"
#include "mask/filters.h"
#include "surface/point_triangle.h"

namespace trephine::consistency {
namespace {

using Word = std::uint64_t;
constexpr double block_mm = 2;  ///< surfaces are searched in blocks of about this size
constexpr double max_depth_mm = 40;
constexpr double max_gap_mm = 5;
constexpr std::size_t max_exact_count = 4096;

/// The cells (of eight voxels, named by the lowest) through which the surface passes.
mask::BitMask surface_cells(const mask::BitMask& inside) {
  const grid::Lattice& l = inside.lattice();
  mask::BitMask cells(l);
  const int words = inside.words();
  parallel_for(0, l.size[2] - 1, 8, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j + 1 < l.size[1]; ++j) {
        const Word *a = inside.row(j, k), *b = inside.row(j + 1, k), *c = inside.row(j, k + 1),
                   *d = inside.row(j + 1, k + 1);
        Word* out = cells.row(j, k);
        for (int w = 0; w < words; ++w) {
          const bool more = w + 1 < words;
          const Word any = a[w] | b[w] | c[w] | d[w], all = a[w] & b[w] & c[w] & d[w];
          const Word any1 = any >> 1 | (more ? (a[w + 1] | b[w + 1] | c[w + 1] | d[w + 1]) << 63 : 0);
          const Word all1 = all >> 1 | (more ? (a[w + 1] & b[w + 1] & c[w + 1] & d[w + 1]) << 63 : 0);
          out[w] = (any | any1) & ~(all & all1);
        }
        // No cell begins at the last voxel of a row.
        const int last = l.size[0] - 1;
        out[last >> 6] &= ~(Word{1} << (last & 63));
      }
  });
  return cells;
}

/// The surface within a cell: a fan of triangles around the mean of its crossings, in mm along the lattice's axes.
struct Fan {
  Vec3 middle;
  std::array<std::array<Vec3, 2>, 12> edges;
  int count = 0;
};

double value(const grid::Field& f, int i, int j, int k) { return f.contains(i, j, k) ? double(f.at(i, j, k)) : -1.0; }

/// The eight corners of a cell and where the surface crosses its edges, in mm along the lattice's axes.
struct Cell {
  double corner[8];
  int at[3];
  Vec3 spacing;

  Cell(const grid::Field& f, int i, int j, int k) : at{i, j, k}, spacing(f.spacing_mm) {
    if (i >= 0 && j >= 0 && k >= 0 && i + 1 < f.size[0] && j + 1 < f.size[1] && k + 1 < f.size[2]) {
      const std::size_t dy = std::size_t(f.size[0]), dz = dy * f.size[1];
      const float* p = &f.voxels[f.index(i, j, k)];
      for (int c = 0; c < 8; ++c) corner[c] = p[(c & 1) + (c >> 1 & 1) * dy + (c >> 2) * dz];
    } else {
      for (int c = 0; c < 8; ++c) corner[c] = value(f, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
    }
  }
  bool crosses(int a, int b) const { return (corner[a] > 0) != (corner[b] > 0); }
  Vec3 crossing(int a, int b) const {
    const double u = corner[a], v = corner[b], t = u / (u - v);
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      const int from = a >> axis & 1, to = b >> axis & 1;
      p[axis] = at[axis] + from + (to - from) * t;
    }
    return Vec3{p.x * spacing.x, p.y * spacing.y, p.z * spacing.z};
  }
  Vec3 middle() const {
    Vec3 sum;
    int crossings = 0;
    for (int c = 0; c < 8; ++c)
      for (int axis = 0; axis < 3; ++axis) {
        const int d = c | 1 << axis;
        if (d == c || !crosses(c, d)) continue;
        sum += crossing(c, d);
        ++crossings;
      }
    return sum / std::max(1, crossings);
  }
};

Fan fan_of(const grid::Field& f, int i, int j, int k) {
  const Cell cell(f, i, j, k);
  Fan fan;
  fan.middle = cell.middle();
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, c0 = side << axis;
      const int round[5] = {c0, c0 | u, c0 | u | v, c0 | v, c0};
      Vec3 at[4];
      int n = 0;
      for (int e = 0; e < 4; ++e)
        if (cell.crosses(round[e], round[e + 1])) at[n++] = cell.crossing(round[e], round[e + 1]);
      for (int e = 0; e + 1 < n; e += 2) fan.edges[fan.count++] = {at[e], at[e + 1]};
    }
  return fan;
}

/// The cells and the centres of their fans, by rank.
struct Cells {
  mask::BitMask mask;
  std::vector<std::size_t> row_start;
  std::vector<std::array<float, 3>> middle;  ///< mm along the lattice's axes

  std::size_t rank(int i, int j, int k) const {
    const Word* row = mask.row(j, k);
    std::size_t n = row_start[std::size_t(k) * mask.lattice().size[1] + j];
    for (int w = 0; w < i >> 6; ++w) n += std::size_t(__builtin_popcountll(row[w]));
    return n + std::size_t(__builtin_popcountll(row[i >> 6] & ((Word{1} << (i & 63)) - 1)));
  }
};

/// Calls visit(i, j, k, rank) for each cell of the slice.
template <class Visit>
void each_cell(const Cells& cells, int k, const Visit& visit) {
  const int ny = cells.mask.lattice().size[1];
  for (int j = 0; j < ny; ++j) {
    const Word* row = cells.mask.row(j, k);
    std::size_t rank = cells.row_start[std::size_t(k) * ny + j];
    for (int w = 0; w < cells.mask.words(); ++w)
      for (Word bits = row[w]; bits; bits &= bits - 1) visit(w * 64 + __builtin_ctzll(bits), j, k, rank++);
  }
}

/// One of the two fields on the lattice around both.
struct Side {
  const grid::Field* field;
  std::array<int, 3> at;  ///< its first voxel
  Cells cells;

  Vec3 shift_mm() const {
    const Vec3 s = field->spacing_mm;
    return {at[0] * s.x, at[1] * s.y, at[2] * s.z};
  }
  Vec3 middle(int i, int j, int k) const { return Cell(*field, i - at[0], j - at[1], k - at[2]).middle() + shift_mm(); }
  Fan fan(int i, int j, int k) const {
    Fan fan = fan_of(*field, i - at[0], j - at[1], k - at[2]);
    const Vec3 shift = shift_mm();
    fan.middle += shift;
    for (int e = 0; e < fan.count; ++e) fan.edges[e][0] += shift, fan.edges[e][1] += shift;
    return fan;
  }
};

Side side_of(const grid::Field& field, const std::array<int, 3>& at, const mask::BitMask& inside) {
  Side side{&field, at, {surface_cells(inside), {}, {}}};
  Cells& c = side.cells;
  const grid::Lattice& l = inside.lattice();
  std::size_t n = 0;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j) {
      c.row_start.push_back(n);
      for (int w = 0; w < c.mask.words(); ++w) n += std::size_t(__builtin_popcountll(c.mask.row(j, k)[w]));
    }
  c.middle.resize(n);
  parallel_for(0, l.size[2], 1, [&](std::int64_t k0, std::int64_t) {
    each_cell(c, int(k0), [&](int i, int j, int k, std::size_t rank) {
      const Vec3 m = side.middle(i, j, k);
      c.middle[rank] = {float(m.x), float(m.y), float(m.z)};
    });
  });
  return side;
}

/// Calls visit(i, j, k) for the cells whose box lies within `limit()` of the box of cell (i, j, k), roughly the nearest
/// first, until it returns true.
template <class Limit, class Visit>
void visit_near(const mask::BitMask& cells, int ci, int cj, int ck, const Limit& limit, const Visit& visit) {
  const grid::Lattice& l = cells.lattice();
  const Vec3 s = l.spacing_mm;
  const auto gap = [&](int d, int a) { return std::max(0, std::abs(d) - 1) * s[a]; };
  const auto reach = [&](double mm, int a) { return int(std::min(mm / s[a], 1e6)) + 1; };
  for (int dk = 0; std::abs(dk) <= reach(limit(), 2); dk = dk > 0 ? -dk : 1 - dk) {
    const int k = ck + dk;
    if (k < 0 || k >= l.size[2]) continue;
    for (int dj = 0; std::abs(dj) <= reach(limit(), 1); dj = dj > 0 ? -dj : 1 - dj) {
      const int j = cj + dj;
      if (j < 0 || j >= l.size[1]) continue;
      const double left2 = limit() * limit() - gap(dj, 1) * gap(dj, 1) - gap(dk, 2) * gap(dk, 2);
      if (left2 < 0) continue;
      const int ri = reach(std::sqrt(left2), 0), low = std::max(0, ci - ri), high = std::min(l.size[0] - 1, ci + ri);
      const Word* row = cells.row(j, k);
      for (int w = low >> 6; w <= high >> 6; ++w) {
        Word bits = row[w];
        if (w == low >> 6) bits &= ~Word{0} << (low & 63);
        if (w == high >> 6 && (high & 63) != 63) bits &= (Word{2} << (high & 63)) - 1;
        for (; bits; bits &= bits - 1)
          if (visit(w * 64 + __builtin_ctzll(bits), j, k)) return;
      }
    }
  }
}

double to_fan(Vec3 p, const Fan& fan) {
  double best2 = 1e300;
  for (int e = 0; e < fan.count; ++e)
    best2 = std::min(best2, surface::nearest_on_triangle(p, fan.middle, fan.edges[e][0], fan.edges[e][1]).squared_mm2);
  return std::sqrt(best2);
}

/// A lower bound of the distance from the cells of a block to the other surface.
struct Blocks {
  mask::CoarseRaster raster;
  grid::Grid<float> to_other;  ///< from a block's centre to that of the nearest block with the other surface, mm
  double slack_mm;             ///< how much nearer than that two cells of the blocks can be

  double least_mm(int i, int j, int k) const {
    const auto& f = raster.factor;
    return to_other.at(i / f[0], j / f[1], k / f[2]) - slack_mm;
  }
};

Blocks blocks_of(const Cells& other, const Progress& progress) {
  const grid::Lattice& l = other.mask.lattice();
  Blocks b;
  b.raster = mask::coarse_raster(l, block_mm);
  b.slack_mm = norm(b.raster.cells.spacing_mm + l.spacing_mm) + 1e-3;  // a cell reaches a voxel beyond its block
  mask::BitMask with(b.raster.cells);
  const auto& f = b.raster.factor;
  for (int k = 0; k < l.size[2]; ++k)
    each_cell(other, k, [&](int i, int j, int, std::size_t) { with.set(i / f[0], j / f[1], k / f[2]); });
  b.to_other = mask::distance_mm(with, progress);
  return b;
}

/// The box around both fields, in the raster of the other; `at` is where each field begins in it.
grid::Lattice around_both(const grid::Field& one, const grid::Field& other, std::array<int, 3>& one_at,
                          std::array<int, 3>& other_at) {
  const grid::Box at = grid::place_in(one, other);
  grid::Box box;
  for (int a = 0; a < 3; ++a) {
    box.begin[a] = std::min(0, at.begin[a]);
    box.end[a] = std::max(other.size[a], at.end[a]);
    if (std::int64_t(box.end[a]) - box.begin[a] > 1 << 14)
      throw Error(ExitCode::bad_input, "", "origin", "the two fields lie too far from each other");
    one_at[a] = at.begin[a] - box.begin[a];
    other_at[a] = -box.begin[a];
  }
  grid::Lattice l = other;
  l.origin_mm = other.to_world_mm({double(box.begin[0]), double(box.begin[1]), double(box.begin[2])});
  for (int a = 0; a < 3; ++a) l.size[a] = box.end[a] - box.begin[a];
  return l;
}

void measure_wrong(const mask::BitMask& wrong, const mask::BitMask& allowed, Clearance& out, const Progress& progress) {
  const grid::Lattice& l = wrong.lattice();
  out.wrong_ml = double(wrong.count()) * l.voxel_volume_mm3() / 1000;
  if (!(out.wrong_ml > 0)) return;
  const double least = std::min({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z});
  const grid::Box box = grid::grown(wrong.bounds(), int(std::min(max_depth_mm / least, 200.0)), l);
  const mask::BitMask there = mask::crop(wrong, box);
  const grid::Grid<float> depth = mask::distance_mm(mask::crop(allowed, box), progress);
  out.depth_mm = -1;
  for (int k = 0; k < depth.size[2]; ++k)
    for (int j = 0; j < depth.size[1]; ++j)
      for (int i = 0; i < depth.size[0]; ++i)
        if (there.get(i, j, k) && depth.at(i, j, k) > out.depth_mm) {
          out.depth_mm = depth.at(i, j, k);
          out.deepest_mm = depth.to_world_mm({double(i), double(j), double(k)});
        }
  out.depth_mm = std::min(out.depth_mm, max_depth_mm);
}

struct Candidate {
  float mm;
  int i, j, k;
};

/// The cells whose centre is nearest to a centre of the other surface, and all cells within `margin` of the least
/// distance or nearer than `asked`.
std::vector<Candidate> candidates_of(const Side& one, const Side& other, double margin, double asked,
                                     const Progress& progress) {
  const grid::Lattice& l = one.cells.mask.lattice();
  const Blocks blocks = blocks_of(other.cells, progress);
  std::vector<std::vector<Candidate>> slices(l.size[2]);
  std::vector<float> least(l.size[2], float(max_gap_mm));
  parallel_for(0, l.size[2], 1, [&](std::int64_t k0, std::int64_t) {
    progress.check();
    float& best = least[k0];
    each_cell(one.cells, int(k0), [&](int i, int j, int k, std::size_t rank) {
      const double wanted = std::min(max_gap_mm, std::max(best + margin, asked));
      if (blocks.least_mm(i, j, k) > wanted) return;
      const auto& m = one.cells.middle[rank];
      double mine = wanted;
      visit_near(
          other.cells.mask, i, j, k, [&] { return mine; },
          [&](int x, int y, int z) {
            const auto& n = other.cells.middle[other.cells.rank(x, y, z)];
            const double a = m[0] - n[0], b = m[1] - n[1], c = m[2] - n[2], d2 = a * a + b * b + c * c;
            if (d2 < mine * mine) mine = std::sqrt(d2);
            return false;
          });
      if (mine >= wanted) return;
      best = std::min(best, float(mine));
      slices[k0].push_back({float(mine), i, j, k});
    });
  });
  const double keep = std::max(double(*std::min_element(least.begin(), least.end())) + margin, asked);
  std::vector<Candidate> all;
  for (const auto& s : slices)
    for (const Candidate& c : s)
      if (c.mm <= keep) all.push_back(c);
  return all;
}

/// The least distance from points of one surface in that cell to the other's triangles, or `limit` where it is not
/// below `limit`. Stops at the first distance below `enough`.
double exact_mm(const Fan& fan, const Side& other, const Candidate& c, double limit, double enough, Vec3& at) {
  double best = limit;
  visit_near(
      other.cells.mask, c.i, c.j, c.k, [&] { return best; },
      [&](int x, int y, int z) {
        const Fan there = other.fan(x, y, z);
        const auto offer = [&](Vec3 p) {
          const double mm = to_fan(p, there);
          if (mm < best) best = mm, at = p;
        };
        offer(fan.middle);
        for (int e = 0; e < fan.count; ++e) offer(fan.edges[e][0]);
        return best < enough;
      });
  return best;
}

}  // namespace

Clearance clearance(const grid::Field& one, const grid::Field& other, Relation relation, double asked_mm,
                    const NotCompared& not_compared, const Progress& progress) {
  std::array<int, 3> one_at{}, other_at{};
  const grid::Lattice l = around_both(one, other, one_at, other_at);
  const mask::BitMask one_in = mask::positive(one, l), other_in = mask::positive(other, l);
  Clearance out;
  mask::BitMask allowed = other_in;
  if (relation == Relation::apart) allowed.invert();
  mask::BitMask wrong = one_in;
  wrong.remove(allowed);
  accept(wrong, not_compared);
  measure_wrong(wrong, allowed, out, progress);
  if (out.wrong_ml > 0) {
    out.places_mm = covering(points_of(wrong), out.deepest_mm);
    out.gap_mm = 0;
    out.gap_at_mm = out.deepest_mm;
    return out;
  }
  // The box around both fields may end with the volume where one of them does: no surface is made there.
  const Side a = side_of(one, one_at, one_in), b = side_of(other, other_at, other_in);
  const double cell_mm = norm(l.spacing_mm);
  std::vector<Candidate> near =
      candidates_of(a, b, 0.35 * cell_mm, asked_mm > 0 ? asked_mm + 0.35 * cell_mm : 0, progress);
  const auto world_of = [&](Vec3 p) {
    return l.to_world_mm({p.x / l.spacing_mm.x, p.y / l.spacing_mm.y, p.z / l.spacing_mm.z});
  };
  if (not_compared.any())
    near.erase(std::remove_if(near.begin(), near.end(),
                              [&](const Candidate& c) {
                                return is_accepted(l.to_world_mm({c.i + 0.5, c.j + 0.5, c.k + 0.5}), not_compared);
                              }),
               near.end());
  std::stable_sort(near.begin(), near.end(), [](const Candidate& p, const Candidate& q) { return p.mm < q.mm; });
  Vec3 at;
  for (std::size_t n = 0; n < std::min(near.size(), max_exact_count); ++n) {
    const Candidate& c = near[n];
    const double mm = exact_mm(a.fan(c.i, c.j, c.k), b, c, std::min<double>(out.gap_mm, c.mm + 1e-3), -1, at);
    if (mm < out.gap_mm) {
      out.gap_mm = mm;
      out.gap_at_mm = world_of(at);
    }
  }
  if (!(out.gap_mm < asked_mm)) return out;
  const std::size_t step = near.size() / max_exact_count + 1;
  std::vector<Vec3> too_near;
  for (std::size_t n = 0; n < near.size(); n += step) {
    const Candidate& c = near[n];
    const Fan fan = a.fan(c.i, c.j, c.k);
    if (exact_mm(fan, b, c, asked_mm, asked_mm, at) >= asked_mm) continue;
    too_near.push_back(l.to_world_mm({c.i + 0.5, c.j + 0.5, c.k + 0.5}));
    for (int e = 0; e < fan.count; ++e)
      out.near_mm2 += 0.5 * double(step) * norm(cross(fan.edges[e][0] - fan.middle, fan.edges[e][1] - fan.middle));
  }
  out.places_mm = covering(std::move(too_near), out.gap_at_mm);
  return out;
}

}  // namespace trephine::consistency
