// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/disjoint_sets.h"
#include "mask/bits.h"

namespace trephine::mask {
namespace {

using Word = std::uint64_t;

/// Calls f(begin, end) for each run of set bits of a row.
template <class F>
void for_runs(const Word* row, int size, F&& f) {
  int i = 0;
  while (i < size) {
    Word w = row[i >> 6] >> (i & 63);
    if (!w) {
      i = (i | 63) + 1;
      continue;
    }
    i += __builtin_ctzll(w);
    const int begin = i;
    while (i < size) {
      w = ~row[i >> 6] >> (i & 63);
      if (w) {
        i = std::min(size, i + __builtin_ctzll(w));
        break;
      }
      i = (i | 63) + 1;
    }
    f(begin, std::min(i, size));
  }
}

void unite_rows(const Components& c, DisjointSets& sets, std::size_t row_a, std::size_t row_b, int reach) {
  std::size_t a = c.row_start[row_a], b = c.row_start[row_b];
  const std::size_t a_end = c.row_start[row_a + 1], b_end = c.row_start[row_b + 1];
  while (a < a_end && b < b_end) {
    if (c.runs[a].begin < c.runs[b].end + reach && c.runs[b].begin < c.runs[a].end + reach)
      sets.unite(std::uint32_t(a), std::uint32_t(b));
    if (c.runs[a].end < c.runs[b].end)
      ++a;
    else
      ++b;
  }
}

}  // namespace

Components components(const BitMask& mask, bool diagonal) {
  Components c;
  c.lattice = mask.lattice();
  const int nx = c.lattice.size[0], ny = c.lattice.size[1], nz = c.lattice.size[2];
  c.row_start.reserve(std::size_t(ny) * nz + 1);
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j) {
      c.row_start.push_back(c.runs.size());
      for_runs(mask.row(j, k), nx, [&](int begin, int end) { c.runs.push_back({begin, end, -1}); });
    }
  c.row_start.push_back(c.runs.size());

  DisjointSets sets(c.runs.size());
  const int reach = diagonal ? 1 : 0;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j) {
      const std::size_t row = std::size_t(k) * ny + j;
      if (j > 0) unite_rows(c, sets, row, row - 1, reach);
      if (k > 0) unite_rows(c, sets, row, row - ny, reach);
      if (diagonal && k > 0 && j > 0) unite_rows(c, sets, row, row - ny - 1, reach);
      if (diagonal && k > 0 && j + 1 < ny) unite_rows(c, sets, row, row - ny + 1, reach);
    }

  std::size_t r = 0;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (; r < c.row_start[std::size_t(k) * ny + j + 1]; ++r) {
        auto& run = c.runs[r];
        const std::uint32_t root = sets.find(std::uint32_t(r));
        if (root == r) {
          run.component = std::int32_t(c.list.size());
          Component fresh;
          fresh.box.begin = {nx, ny, nz};
          c.list.push_back(fresh);
        } else {
          run.component = c.runs[root].component;
        }
        Component& comp = c.list[run.component];
        comp.voxels += run.end - run.begin;
        auto& box = comp.box;
        box.begin = {std::min(box.begin[0], run.begin), std::min(box.begin[1], j), std::min(box.begin[2], k)};
        box.end = {std::max(box.end[0], run.end), std::max(box.end[1], j + 1), std::max(box.end[2], k + 1)};
      }
  for (Component& comp : c.list)
    for (int axis = 0; axis < 3; ++axis)
      comp.faces += (comp.box.begin[axis] == 0) + (comp.box.end[axis] == c.lattice.size[axis]);
  return c;
}

BitMask select(const Components& c, const std::vector<char>& keep) {
  BitMask mask(c.lattice);
  const int ny = c.lattice.size[1];
  for (std::size_t row = 0; row + 1 < c.row_start.size(); ++row) {
    Word* out = mask.row(int(row % ny), int(row / ny));
    for (std::size_t r = c.row_start[row]; r < c.row_start[row + 1]; ++r) {
      const auto& run = c.runs[r];
      if (!keep[run.component]) continue;
      const int first = run.begin >> 6, last = (run.end - 1) >> 6;
      const Word from = ~Word{0} << (run.begin & 63), to = ~Word{0} >> (63 - ((run.end - 1) & 63));
      if (first == last) {
        out[first] |= from & to;
      } else {
        out[first] |= from;
        for (int w = first + 1; w < last; ++w) out[w] = ~Word{0};
        out[last] |= to;
      }
    }
  }
  return mask;
}

BitMask at_least_ml(const Components& components, double ml) {
  std::vector<char> keep;
  for (const Component& c : components.list)
    keep.push_back(c.voxels * components.lattice.voxel_volume_mm3() / 1000 >= ml);
  return select(components, keep);
}

BitMask largest(const Components& c) {
  std::vector<char> keep(c.list.size());
  const auto best = std::max_element(c.list.begin(), c.list.end(),
                                     [](const Component& a, const Component& b) { return a.voxels < b.voxels; });
  if (best != c.list.end()) keep[best - c.list.begin()] = 1;
  return select(c, keep);
}

std::vector<char> touching(const Components& c, const BitMask& other) {
  std::vector<char> keep(c.list.size());
  const int ny = c.lattice.size[1];
  for (std::size_t row = 0; row + 1 < c.row_start.size(); ++row)
    for (std::size_t r = c.row_start[row]; r < c.row_start[row + 1]; ++r) {
      const auto& run = c.runs[r];
      if (keep[run.component]) continue;
      for (int i = run.begin; i < run.end && !keep[run.component]; ++i)
        keep[run.component] = other.get(i, int(row % ny), int(row / ny));
    }
  return keep;
}

}  // namespace trephine::mask
