// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/snake_layers.h"

#include <cmath>
#include <limits>
#include <utility>

namespace trephine::segmentation {
namespace {

constexpr float unknown = std::numeric_limits<float>::infinity();

/// For each voxel of a word: is the neighbour in that direction in the mask?
struct Around {
  std::uint64_t side[6];  // x-1, x+1, y-1, y+1, z-1, z+1
  std::uint64_t any() const { return side[0] | side[1] | side[2] | side[3] | side[4] | side[5]; }
};

Around around(const mask::BitMask& m, int w, int j, int k) {
  const grid::Lattice& l = m.lattice();
  const std::uint64_t* row = m.row(j, k);
  const auto word = [&](int jj, int kk) {
    return jj >= 0 && kk >= 0 && jj < l.size[1] && kk < l.size[2] ? m.row(jj, kk)[w] : 0;
  };
  return {{row[w] << 1 | (w > 0 ? row[w - 1] >> 63 : 0), row[w] >> 1 | (w + 1 < m.words() ? row[w + 1] << 63 : 0),
           word(j - 1, k), word(j + 1, k), word(j, k - 1), word(j, k + 1)}};
}

/// The same for the voxel beyond that neighbour.
Around beyond(const mask::BitMask& m, int w, int j, int k) {
  const grid::Lattice& l = m.lattice();
  const std::uint64_t* row = m.row(j, k);
  const auto word = [&](int jj, int kk) {
    return jj >= 0 && kk >= 0 && jj < l.size[1] && kk < l.size[2] ? m.row(jj, kk)[w] : 0;
  };
  return {{row[w] << 2 | (w > 0 ? row[w - 1] >> 62 : 0), row[w] >> 2 | (w + 1 < m.words() ? row[w + 1] << 62 : 0),
           word(j - 2, k), word(j + 2, k), word(j, k - 2), word(j, k + 2)}};
}

/// The distance u that solves sum(w (u - a)^2) = 1, w being 1 / h^2, over the axes whose neighbour `a` is known and
/// nearer than u.
float eikonal(const float a[3], const float w[3]) {
  bool use[3] = {a[0] < unknown, a[1] < unknown, a[2] < unknown};
  const float least = std::min(a[0], std::min(a[1], a[2]));
  for (;;) {
    float sum = 0, first = 0, second = 0, most = -unknown;
    int farthest = 0, n = 0;
    for (int k = 0; k < 3; ++k) {
      if (!use[k]) continue;
      const float d = a[k] - least;  // against cancellation
      sum += w[k];
      first += w[k] * d;
      second += w[k] * d * d;
      ++n;
      if (d > most) {
        most = d;
        farthest = k;
      }
    }
    const float root = first * first - sum * (second - 1);
    const float u = root > 0 ? (first + std::sqrt(root)) / sum : -1;
    if (u >= most || n == 1) return least + u;
    use[farthest] = false;
  }
}

BandLayers::Reach joined(const BandLayers::Reach& a, const BandLayers::Reach& b) {
  return {std::min(a.j0, b.j0), std::max(a.j1, b.j1), std::min(a.k0, b.k0),
          std::max(a.k1, b.k1), std::min(a.w0, b.w0), std::max(a.w1, b.w1)};
}

}  // namespace

BandLayers::BandLayers(grid::Grid<float>& phi)
    : l_(phi), phi_(phi), s_(l_), inside_(l_), layer0_(l_), layer1_(l_), layer2_(l_), next0_(l_) {
  slices_.resize(std::size_t(l_.size[2]));
  everything_ = {0, l_.size[1], 0, l_.size[2], 0, inside_.words()};
}

std::size_t BandLayers::inside_count() const {
  std::size_t n = 0;
  for (const Slice& s : slices_) n += s.inside;
  return n;
}

/// Which voxels of the word lie beside the surface; the lattice's edge is none.
std::uint64_t BandLayers::crossing(int w, int j, int k) const {
  const std::uint64_t in = inside_.row(j, k)[w];
  Around n = around(inside_, w, j, k);
  if (w == 0) n.side[0] |= in & 1;
  const int last = l_.size[0] - 1;
  std::uint64_t valid = ~std::uint64_t{0};
  if (last >> 6 == w) {
    n.side[1] |= in & std::uint64_t{1} << (last & 63);
    valid >>= 63 - (last & 63);
  }
  if (j == 0) n.side[2] = in;
  if (j == l_.size[1] - 1) n.side[3] = in;
  if (k == 0) n.side[4] = in;
  if (k == l_.size[2] - 1) n.side[5] = in;
  std::uint64_t differs = 0;
  for (const std::uint64_t side : n.side) differs |= side ^ in;
  return differs & valid;
}

void BandLayers::begin() {
  for_slices(everything_, [&](int k) {
    std::size_t n = 0;
    for (int j = 0; j < l_.size[1]; ++j) {
      std::uint64_t* row = inside_.row(j, k);
      const float* f = &phi_.at(0, j, k);
      for (int i = 0; i < l_.size[0]; ++i)
        if (f[i] > 0) row[i >> 6] |= std::uint64_t{1} << (i & 63), ++n;
    }
    slices_[k].inside = n;
  });
  std::vector<std::vector<float>> distances(slices_.size());  // of layer 0, before any of them overwrites phi
  for_slices(everything_, [&](int k) {
    for_words(everything_, [&](int j, int w) {
      const std::uint64_t bits = crossing(w, j, k);
      layer0_.row(j, k)[w] = bits;
      for_bits(bits, w, [&](int i, int) { distances[k].push_back(first_distance(i, j, k)); });
    });
  });
  for_slices(everything_, [&](int k) {
    std::size_t n = 0;
    for_words(everything_, [&](int j, int w) {
      for_bits(layer0_.row(j, k)[w], w, [&](int i, int) { phi_.at(i, j, k) = distances[k][n++]; });
    });
  });
  measure_layer0(everything_);
  before_ = reach_;
  rebuild_outer(everything_);
}

/// The distance to the crossings along the axes, as if they lay on a plane; along an axis without one the slope
/// counts, as far as it could not have led to one.
float BandLayers::first_distance(int i, int j, int k) const {
  const std::size_t v = l_.index(i, j, k);
  const float f = phi_.voxels[v];
  const int at[3] = {i, j, k};
  float sum = 0;
  for (int a = 0; a < 3; ++a) {
    float nearest = unknown, other[2] = {f, f};
    for (int side = 0; side < 2; ++side) {
      const int d = side ? 1 : -1;
      if (at[a] + d < 0 || at[a] + d >= l_.size[a]) continue;
      const float o = other[side] = phi_.voxels[std::size_t(std::ptrdiff_t(v) + d * s_.step[a])];
      if ((o > 0) != (f > 0)) nearest = std::min(nearest, s_.h[a] * (std::abs(f) / (std::abs(f) + std::abs(o))));
    }
    if (nearest == unknown) {
      const float slope = 0.5f * s_.inv_h[a] * std::abs(other[1] - other[0]);
      if (slope > 0) nearest = std::max(s_.h[a], std::abs(f) / slope);
    }
    nearest = std::max(nearest, 1e-3f * s_.h_min);
    sum += 1 / (nearest * nearest);
  }
  const float d = 1 / std::sqrt(sum);
  return f > 0 ? d : -d;
}

/// The distances of the voxels `bits` of a word from their neighbours in layer `from`, whose values are known;
/// one-sided differences of second order where the voxel behind the neighbour is known too (in `from` or layer 0), so
/// that curvature survives.
void BandLayers::set_from(const mask::BitMask& from, std::uint64_t bits, int w, int j, int k) {
  const Around next = around(from, w, j, k);
  Around behind = beyond(layer0_, w, j, k);
  if (&from != &layer0_) {
    const Around more = beyond(from, w, j, k);
    for (int side = 0; side < 6; ++side) behind.side[side] |= more.side[side];
  }
  const std::uint64_t in = inside_.row(j, k)[w];
  float* row = &phi_.at(0, j, k);
  for_bits(bits, w, [&](int i, int b) {
    const float sign = in >> b & 1 ? 1.f : -1.f;
    float* f = row + i;
    float a[3], weight[3], least = unknown, bound = unknown;
    for (int axis = 0; axis < 3; ++axis) {
      a[axis] = unknown;
      weight[axis] = s_.inv_h2[axis];
      std::ptrdiff_t to = 0;
      int side = 2 * axis;
      if (next.side[side] >> b & 1) {
        to = -s_.step[axis];
        a[axis] = sign * f[to];
      }
      if (next.side[side + 1] >> b & 1) {
        const float other = sign * f[s_.step[axis]];
        if (other < a[axis]) {
          a[axis] = other;
          to = s_.step[axis];
          ++side;
        }
      }
      if (to == 0) continue;
      least = std::min(least, a[axis]);
      bound = std::min(bound, a[axis] + s_.h[axis]);
      if (!(behind.side[side] >> b & 1)) continue;
      const float second = sign * f[2 * to];
      if (!(second <= a[axis])) continue;
      a[axis] += (a[axis] - second) * (1.f / 3);
      weight[axis] *= 2.25f;
    }
    // Kinks mislead the wider difference: never farther than along one axis, never nearer than the neighbours.
    const float u = std::max(std::min(eikonal(a, weight), bound), std::max(least, 1e-3f * s_.h_min));
    *f = sign * u;
  });
}

void BandLayers::relayer() {
  // What the masks still hold from the step before is overwritten too.
  const Reach cover = grown(joined(reach_, before_));
  before_ = reach_;
  for_slices(cover, [&](int k) {
    for_words(cover, [&](int j, int w) {
      const std::uint64_t was = layer0_.row(j, k)[w], candidates = was | layer1_.row(j, k)[w];
      std::uint64_t now = 0;
      if (candidates) now = crossing(w, j, k);
      next0_.row(j, k)[w] = now;
      const std::uint64_t fresh = now & ~was;
      if (!fresh) return;
      set_from(layer0_, fresh, w, j, k);
    });
  });
  std::swap(layer0_, next0_);
  measure_layer0(cover);
  rebuild_outer(cover);
}

void BandLayers::measure_layer0(const Reach& cover) {
  for_slices(everything_, [&](int k) {
    Slice& s = slices_[k];
    s.any = false;
    s.band = 0;
    if (k < cover.k0 || k >= cover.k1) return;
    for_words(cover, [&](int j, int w) {
      const std::uint64_t bits = layer0_.row(j, k)[w];
      if (!bits) return;
      if (!s.any) s.reach = {j, j + 1, k, k + 1, w, w + 1};
      s.any = true;
      s.band += std::size_t(__builtin_popcountll(bits));
      s.reach.j1 = j + 1;
      s.reach.w0 = std::min(s.reach.w0, w);
      s.reach.w1 = std::max(s.reach.w1, w + 1);
    });
  });
  band_count_ = 0;
  bool first = true;
  for (const Slice& s : slices_) {
    if (!s.any) continue;
    band_count_ += s.band;
    if (first) reach_ = s.reach;
    first = false;
    reach_.j0 = std::min(reach_.j0, s.reach.j0);
    reach_.j1 = std::max(reach_.j1, s.reach.j1);
    reach_.k1 = s.reach.k1;
    reach_.w0 = std::min(reach_.w0, s.reach.w0);
    reach_.w1 = std::max(reach_.w1, s.reach.w1);
  }
}

BandLayers::Reach BandLayers::grown(const Reach& r) const {
  return {std::max(r.j0 - 3, 0),          std::min(r.j1 + 3, l_.size[1]), std::max(r.k0 - 3, 0),
          std::min(r.k1 + 3, l_.size[2]), std::max(r.w0 - 1, 0),          std::min(r.w1 + 1, inside_.words())};
}

/// Layers 1 and 2, and their distances, from layer 0.
void BandLayers::rebuild_outer(const Reach& cover) {
  outer(cover, layer0_, layer0_, layer1_);
  outer(cover, layer1_, layer0_, layer2_);
}

void BandLayers::outer(const Reach& cover, const mask::BitMask& from, const mask::BitMask& innermost,
                       mask::BitMask& to) {
  const int last = l_.size[0] - 1;
  for_slices(cover, [&](int k) {
    for_words(cover, [&](int j, int w) {
      const Around n = around(from, w, j, k);
      std::uint64_t bits = n.any() & ~from.row(j, k)[w] & ~innermost.row(j, k)[w];
      if (last >> 6 == w) bits &= ~std::uint64_t{0} >> (63 - (last & 63));
      to.row(j, k)[w] = bits;
      if (bits) set_from(from, bits, w, j, k);
    });
  });
}

void BandLayers::finish() {
  const float far = 3 * s_.h_max;
  for_slices(everything_, [&](int k) {
    for_words(everything_, [&](int j, int w) {
      const std::uint64_t band = layer0_.row(j, k)[w] | layer1_.row(j, k)[w] | layer2_.row(j, k)[w];
      const std::uint64_t in = inside_.row(j, k)[w];
      for (int b = 0, i = w * 64; b < 64 && i < l_.size[0]; ++b, ++i)
        if (!(band >> b & 1)) phi_.at(i, j, k) = in >> b & 1 ? far : -far;
    });
  });
}

}  // namespace trephine::segmentation
