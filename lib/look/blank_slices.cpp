// SPDX-License-Identifier: GPL-3.0-or-later
#include "look/blank_slices.h"

#include <algorithm>
#include <functional>
#include <vector>

#include "base/parallel.h"

namespace trephine::look {
namespace {

constexpr double most_even = 0.5;  ///< of neighbours in a row: without noise most of them are equal
constexpr double tissue_hu = -500;

struct Slice {
  bool constant = false, copy = false;
  std::int64_t pairs_count = 0, equal_count = 0;  ///< of neighbours in tissue
};

template <class Sample>
std::vector<Slice> slices_of(const grid::Grid<Sample>& g, const Progress& progress) {
  std::vector<Slice> all(std::size_t(g.size[2]));
  const std::size_t n = std::size_t(g.size[0]) * std::size_t(g.size[1]);
  parallel_for(0, g.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t k = from; k < to; ++k) {
      progress.check();
      const Sample* v = g.voxels.data() + std::size_t(k) * n;
      Slice& s = all[std::size_t(k)];
      s.constant = std::adjacent_find(v, v + n, std::not_equal_to<>()) == v + n;
      s.copy = k > 0 && std::equal(v, v + n, v - n);
      for (std::size_t i = 1; i < n; ++i) {
        if (!(v[i] > tissue_hu) || !(v[i - 1] > tissue_hu)) continue;
        ++s.pairs_count;
        s.equal_count += v[i] == v[i - 1];
      }
    }
  });
  return all;
}

}  // namespace

std::optional<BlankSlices> blank_slices(const grid::HuVolume& volume, const Progress& progress) {
  const std::vector<Slice> all = std::visit([&](const auto& g) { return slices_of(g, progress); }, volume);
  int first = 0, last = int(all.size()) - 1;
  while (first <= last && all[std::size_t(first)].constant) ++first;
  while (last > first && all[std::size_t(last)].constant) --last;
  const grid::Lattice& l = grid::lattice_of(volume);
  BlankSlices found;
  std::int64_t pairs = 0, equal = 0;
  for (int k = first + 1; k <= last; ++k) {
    pairs += all[std::size_t(k)].pairs_count;
    equal += all[std::size_t(k)].equal_count;
    if (!all[std::size_t(k)].constant && !all[std::size_t(k)].copy) continue;
    const double z = l.to_world_mm({0.5 * (l.size[0] - 1), 0.5 * (l.size[1] - 1), double(k)}).z;
    found.from_mm = found.count ? std::min(found.from_mm, z) : z;
    found.to_mm = found.count ? std::max(found.to_mm, z) : z;
    ++found.count;
  }
  if (found.count == 0 || double(equal) > most_even * double(pairs)) return {};
  return found;
}

}  // namespace trephine::look
