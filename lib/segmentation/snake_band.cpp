// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/snake_band.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/parallel.h"
#include "segmentation/bits.h"

namespace trephine::segmentation {
namespace {

constexpr float unknown = std::numeric_limits<float>::infinity();

/// For each voxel of a word: is the neighbour in that direction in the mask?
struct Around {
  std::uint64_t side[6];  // x-1, x+1, y-1, y+1, z-1, z+1
  std::uint64_t any() const { return side[0] | side[1] | side[2] | side[3] | side[4] | side[5]; }
};

Around around(const BitMask& m, int w, int j, int k) {
  const Lattice& l = m.lattice();
  const std::uint64_t* row = m.row(j, k);
  const auto word = [&](int jj, int kk) {
    return jj >= 0 && kk >= 0 && jj < l.size[1] && kk < l.size[2] ? m.row(jj, kk)[w] : 0;
  };
  return {{row[w] << 1 | (w > 0 ? row[w - 1] >> 63 : 0), row[w] >> 1 | (w + 1 < m.words() ? row[w + 1] << 63 : 0),
           word(j - 1, k), word(j + 1, k), word(j, k - 1), word(j, k + 1)}};
}

template <class F>
void for_bits(std::uint64_t bits, int w, F&& f) {
  for (; bits; bits &= bits - 1) {
    const int b = __builtin_ctzll(bits);
    f(w * 64 + b, b);
  }
}

/// The distance u that solves sum((u - a)^2 / h^2) = 1 over the axes whose neighbour `a` is known and nearer.
float eikonal(float a, float b, float c, float ha, float hb, float hc) {
  const auto order = [](float& p, float& q, float& hp, float& hq) {
    if (q < p) {
      std::swap(p, q);
      std::swap(hp, hq);
    }
  };
  order(a, b, ha, hb);
  order(b, c, hb, hc);
  order(a, b, ha, hb);
  float u = a + ha;
  if (u <= b) return u;
  const float wa = 1 / (ha * ha), wb = 1 / (hb * hb);
  float w = wa + wb, d = b - a;
  float root = w - wa * wb * d * d;
  if (root < 0) return u;
  u = a + (wb * d + std::sqrt(root)) / w;
  if (u <= c) return u;
  // Measured from a, against cancellation.
  const float wc = 1 / (hc * hc), e = c - a;
  w += wc;
  const float s = wb * d + wc * e;
  root = s * s - w * (wb * d * d + wc * e * e - 1);
  return root < 0 ? u : a + (s + std::sqrt(root)) / w;
}

/// The rows and words that the band covers.
struct Reach {
  int j0 = 0, j1 = 0, k0 = 0, k1 = 0, w0 = 0, w1 = 0;
};

class Band {
 public:
  Band(const Grid<float>& speed, Grid<float>& phi, const BandParams& params)
      : l_(phi), g_(speed), phi_(phi), p_(params), inside_(l_), layer0_(l_), layer1_(l_), layer2_(l_), next0_(l_) {
    for (int a = 0; a < 3; ++a) {
      h_[a] = float(l_.spacing_mm[a]);
      inv_h_[a] = 1 / h_[a];
    }
    h_min_ = std::min({h_[0], h_[1], h_[2]});
    h_max_ = std::max({h_[0], h_[1], h_[2]});
    step_[0] = 1;
    step_[1] = l_.size[0];
    step_[2] = std::ptrdiff_t(l_.size[0]) * l_.size[1];
    slices_.resize(std::size_t(l_.size[2]));
    everything_ = {0, l_.size[1], 0, l_.size[2], 0, inside_.words()};
  }

  BandRun run(const Progress& progress) {
    begin();
    BandRun r;
    const double sum_inv2 =
        double(inv_h_[0]) * inv_h_[0] + double(inv_h_[1]) * inv_h_[1] + double(inv_h_[2]) * inv_h_[2];
    const double least_inv2 = 1.0 / (double(h_max_) * h_max_);
    // Godunov's scheme is monotone up to 1 / sqrt(sum 1/h^2); curvature diffuses along the two finest axes.
    const double cfl = 0.8 / std::sqrt(sum_inv2);
    double longest = 0.8 / (2 * p_.curvature * (sum_inv2 - least_inv2) + 1e-30);
    if (p_.propagation != 0)
      longest = std::min(longest, cfl / std::abs(p_.propagation));
    else if (p_.advection != 0)
      longest = std::min(longest, cfl * h_min_ / std::abs(p_.advection));
    int quiet = 0;
    for (;;) {
      r.inside = count_inside();
      if (r.inside == 0 || band_count_ == 0) {
        r.end = r.inside == 0 ? BandEnd::vanished : BandEnd::filled;
        break;
      }
      if (r.inside > p_.max_voxels) {
        r.end = BandEnd::too_large;
        break;
      }
      if (r.iterations >= p_.max_iterations_count) break;
      progress.report(double(r.iterations) / p_.max_iterations_count);
      compute_rates();
      double fastest = 0, sum = 0;
      std::size_t n = 0;
      for (const Slice& s : slices_) {
        fastest = std::max(fastest, double(s.fastest));
        sum += s.sum_squares;
        n += s.rates.size();
      }
      const double dt = fastest > 0 ? std::min(longest, cfl / fastest) : longest;
      move(float(dt));
      relayer();
      ++r.iterations;
      r.time_step = dt;
      r.time += dt;
      r.change_mm = dt * std::sqrt(sum / double(std::max<std::size_t>(n, 1)));
      quiet = r.change_mm < p_.min_change_mm ? quiet + 1 : 0;
      if (quiet >= 3) {
        r.end = BandEnd::converged;
        r.inside = count_inside();
        if (r.inside > 0 && band_count_ > 0) break;
      }
    }
    finish();
    return r;
  }

 private:
  struct Slice {
    std::vector<float> rates;  ///< of the slice's voxels of layer 0, in their order
    double sum_squares = 0;
    float fastest = 0;
    std::size_t inside = 0, band = 0;
    Reach reach;
    bool any = false;
  };

  template <class F>
  void for_slices(const Reach& r, F&& f) {
    parallel_for(r.k0, r.k1, 1, [&](std::int64_t from, std::int64_t to) {
      for (int k = int(from); k < int(to); ++k) f(k);
    });
  }
  template <class F>
  static void for_words(const Reach& r, F&& f) {
    for (int j = r.j0; j < r.j1; ++j)
      for (int w = r.w0; w < r.w1; ++w) f(j, w);
  }

  std::size_t count_inside() const {
    std::size_t n = 0;
    for (const Slice& s : slices_) n += s.inside;
    return n;
  }

  /// Which voxels of the word lie beside the surface; the lattice's edge is none.
  std::uint64_t crossing(int w, int j, int k) const {
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

  void begin() {
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
    for_slices(everything_, [&](int k) {
      Slice& s = slices_[k];
      for_words(everything_, [&](int j, int w) {
        const std::uint64_t bits = crossing(w, j, k);
        layer0_.row(j, k)[w] = bits;
        for_bits(bits, w, [&](int i, int) { s.rates.push_back(first_distance(i, j, k)); });
      });
    });
    for_slices(everything_, [&](int k) {
      Slice& s = slices_[k];
      std::size_t n = 0;
      for_words(everything_, [&](int j, int w) {
        for_bits(layer0_.row(j, k)[w], w, [&](int i, int) { phi_.at(i, j, k) = s.rates[n++]; });
      });
    });
    measure_layer0(everything_);
    before_ = reach_;
    rebuild_outer(everything_);
  }

  /// The distance to the crossings along the axes, as if they lay on a plane; along an axis without one the slope
  /// counts, as far as it could not have led to one.
  float first_distance(int i, int j, int k) const {
    const std::size_t v = l_.index(i, j, k);
    const float f = phi_.voxels[v];
    const int at[3] = {i, j, k};
    float sum = 0;
    for (int a = 0; a < 3; ++a) {
      float nearest = unknown, other[2] = {f, f};
      for (int side = 0; side < 2; ++side) {
        const int d = side ? 1 : -1;
        if (at[a] + d < 0 || at[a] + d >= l_.size[a]) continue;
        const float o = other[side] = phi_.voxels[std::size_t(std::ptrdiff_t(v) + d * step_[a])];
        if ((o > 0) != (f > 0)) nearest = std::min(nearest, h_[a] * (std::abs(f) / (std::abs(f) + std::abs(o))));
      }
      if (nearest == unknown) {
        const float slope = 0.5f * inv_h_[a] * std::abs(other[1] - other[0]);
        if (slope > 0) nearest = std::max(h_[a], std::abs(f) / slope);
      }
      nearest = std::max(nearest, 1e-3f * h_min_);
      sum += 1 / (nearest * nearest);
    }
    const float d = 1 / std::sqrt(sum);
    return f > 0 ? d : -d;
  }

  /// The speed at a place given by its offset in voxels, at most 1, from voxel (i, j, k).
  float speed_at(const int at[3], const float offset[3]) const {
    std::ptrdiff_t base = 0, up[3];
    float t[3];
    for (int a = 0; a < 3; ++a) {
      int low = at[a] + (offset[a] < 0 ? -1 : 0);
      t[a] = offset[a] < 0 ? offset[a] + 1 : offset[a];
      if (low < 0) {
        low = 0;
        t[a] = 0;
      }
      up[a] = low + 1 < l_.size[a] ? step_[a] : 0;
      base += low * step_[a];
    }
    const float* g = g_.voxels.data() + base;
    const auto along_x = [&](std::ptrdiff_t o) { return g[o] + t[0] * (g[o + up[0]] - g[o]); };
    const float y0 = along_x(0), y1 = along_x(up[1]), z0 = along_x(up[2]), z1 = along_x(up[1] + up[2]);
    const float z = y0 + t[1] * (y1 - y0);
    return z + t[2] * (z0 + t[1] * (z1 - z0) - z);
  }

  struct Motion {
    float rate, normal, hyperbolic;
  };

  Motion motion(const int at[3], std::size_t v, const float weight[3]) const {
    const float* f = phi_.voxels.data() + v;
    std::ptrdiff_t lo[3], hi[3];
    float first[3], second[3];
    const float c = *f;
    float larger = 0, smaller = 0;
    for (int a = 0; a < 3; ++a) {
      lo[a] = at[a] > 0 ? -step_[a] : 0;
      hi[a] = at[a] + 1 < l_.size[a] ? step_[a] : 0;
      const float m = f[lo[a]], p = f[hi[a]];
      first[a] = 0.5f * inv_h_[a] * (p - m);
      second[a] = inv_h_[a] * inv_h_[a] * (p - 2 * c + m);
      const float up = std::max(0.f, std::max(m, p) - c) * inv_h_[a];
      const float down = std::max(0.f, c - std::min(m, p)) * inv_h_[a];
      larger += up * up;
      smaller += down * down;
    }
    const float length2 = first[0] * first[0] + first[1] * first[1] + first[2] * first[2] + 1e-6f;
    const float inv_length2 = 1 / length2;
    const float length = std::sqrt(length2);

    // The surface next to the voxel, and how fast it is driven there.
    float offset[3];
    for (int a = 0; a < 3; ++a) offset[a] = std::max(-1.f, std::min(1.f, -c * first[a] * inv_length2 * inv_h_[a]));
    float driven = 0;
    if (weight[0] != 0) driven = weight[0] * speed_at(at, offset);
    if (weight[2] != 0) {
      // Down the slope of the speed across the surface, seen over a voxel to both sides.
      float voxels2 = 0;
      for (int a = 0; a < 3; ++a) voxels2 += first[a] * first[a] * inv_h_[a] * inv_h_[a] * inv_length2;
      const float reach = 0.5f / std::sqrt(voxels2 + 1e-12f);
      float in[3], out[3];
      for (int a = 0; a < 3; ++a) {
        const float d = reach * first[a] / length * inv_h_[a];
        in[a] = std::max(-1.f, std::min(1.f, offset[a] + d));
        out[a] = std::max(-1.f, std::min(1.f, offset[a] - d));
      }
      driven += weight[2] * (speed_at(at, in) - speed_at(at, out)) / (2 * reach);
    }
    Motion m;
    m.hyperbolic = driven;
    m.rate = driven * std::sqrt(driven > 0 ? larger : smaller);
    m.normal = driven;
    if (weight[1] != 0) {
      const auto cross = [&](int a, int b) {
        return 0.25f * inv_h_[a] * inv_h_[b] *
               (f[hi[a] + hi[b]] - f[hi[a] + lo[b]] - f[lo[a] + hi[b]] + f[lo[a] + lo[b]]);
      };
      const float x = first[0], y = first[1], z = first[2];
      float bend = ((y * y + z * z) * second[0] + (x * x + z * z) * second[1] + (x * x + y * y) * second[2] -
                    2 * (x * y * cross(0, 1) + x * z * cross(0, 2) + y * z * cross(1, 2))) *
                   inv_length2;
      // No surface on the grid bends more than a voxel does.
      const float most = 2 / h_min_ * length;
      bend = std::max(-most, std::min(most, bend));
      m.rate += weight[1] * bend;
      m.normal += weight[1] * bend / length;
    }
    return m;
  }

  void compute_rates() {
    const float weight[3] = {float(p_.propagation), float(p_.curvature), float(p_.advection)};
    for_slices(everything_, [&](int k) {
      Slice& s = slices_[k];
      s.rates.clear();
      s.sum_squares = 0;
      s.fastest = 0;
      if (!s.any) return;
      for_words(s.reach, [&](int j, int w) {
        for_bits(layer0_.row(j, k)[w], w, [&](int i, int) {
          const int at[3] = {i, j, k};
          const Motion m = motion(at, l_.index(i, j, k), weight);
          s.rates.push_back(m.rate);
          s.fastest = std::max(s.fastest, std::abs(m.hyperbolic));
          s.sum_squares += double(m.normal) * m.normal;
        });
      });
    });
  }

  void move(float dt) {
    const float most = 0.9f * h_min_;
    for_slices(everything_, [&](int k) {
      Slice& s = slices_[k];
      if (!s.any) return;
      std::size_t n = 0;
      for_words(s.reach, [&](int j, int w) {
        const std::uint64_t bits = layer0_.row(j, k)[w];
        if (!bits) return;
        std::uint64_t& in = inside_.row(j, k)[w];
        const std::uint64_t before = in;
        for_bits(bits, w, [&](int i, int b) {
          float& f = phi_.at(i, j, k);
          f += std::max(-most, std::min(most, dt * s.rates[n++]));
          f = std::max(-h_max_, std::min(h_max_, f));
          if (std::abs(f) < 1e-5f * h_min_) f = f > 0 ? 1e-5f * h_min_ : -1e-5f * h_min_;
          const std::uint64_t bit = std::uint64_t{1} << b;
          in = f > 0 ? in | bit : in & ~bit;
        });
        s.inside += std::size_t(__builtin_popcountll(in)) - std::size_t(__builtin_popcountll(before));
      });
    });
  }

  /// A voxel's distance from its neighbours in layer `from`, whose values are known; one-sided differences of second
  /// order where the voxel behind the neighbour is known too (in `from` or layer 0), so that curvature survives.
  float from_layer(int i, int j, int k, const Around& n, int bit, const BitMask& from) const {
    const std::size_t v = l_.index(i, j, k);
    const float sign = inside_.row(j, k)[i >> 6] >> bit & 1 ? 1.f : -1.f;
    float nearest[3] = {unknown, unknown, unknown}, h[3] = {h_[0], h_[1], h_[2]};
    for (int side = 0; side < 6; ++side) {
      if (!(n.side[side] >> bit & 1)) continue;
      const int a = side / 2, d = side & 1 ? 1 : -1;
      const float next = sign * phi_.voxels[std::size_t(std::ptrdiff_t(v) + d * step_[a])];
      if (!(next < nearest[a])) continue;
      nearest[a] = next;
      h[a] = h_[a];
    }
    float slope_h[3], a2[3];
    for (int a = 0; a < 3; ++a) {
      slope_h[a] = h[a];
      a2[a] = nearest[a];
      if (nearest[a] == unknown) continue;
      int at[3] = {i, j, k};
      // The side that was nearer.
      const int d =
          n.side[2 * a] >> bit & 1 && sign * phi_.voxels[std::size_t(std::ptrdiff_t(v) - step_[a])] == nearest[a] ? -1
                                                                                                                  : 1;
      at[a] += 2 * d;
      if (!l_.contains(at[0], at[1], at[2])) continue;
      if (!layer0_.get(at[0], at[1], at[2]) && !from.get(at[0], at[1], at[2])) continue;
      const float behind = sign * phi_.voxels[std::size_t(std::ptrdiff_t(v) + 2 * d * step_[a])];
      if (!(behind <= nearest[a])) continue;
      a2[a] = nearest[a] + (nearest[a] - behind) / 3;
      slope_h[a] = h_[a] * (2.f / 3);
    }
    const float plain = eikonal(nearest[0], nearest[1], nearest[2], h_[0], h_[1], h_[2]);
    const float u = eikonal(a2[0], a2[1], a2[2], slope_h[0], slope_h[1], slope_h[2]);
    // Kinks mislead the wider difference: never far from the plain one.
    return std::max(std::max(0.5f * plain, std::min(u, 1.5f * plain)), 1e-3f * h_min_);
  }

  void set_from(int i, int j, int k, const Around& n, int bit, const BitMask& from) {
    const float d = from_layer(i, j, k, n, bit, from);
    phi_.at(i, j, k) = inside_.get(i, j, k) ? d : -d;
  }

  void relayer() {
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
        const Around n = around(layer0_, w, j, k);
        for_bits(fresh, w, [&](int i, int b) { set_from(i, j, k, n, b, layer0_); });
      });
    });
    std::swap(layer0_, next0_);
    measure_layer0(cover);
    rebuild_outer(cover);
  }

  void measure_layer0(const Reach& cover) {
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

  static Reach joined(const Reach& a, const Reach& b) {
    return {std::min(a.j0, b.j0), std::max(a.j1, b.j1), std::min(a.k0, b.k0),
            std::max(a.k1, b.k1), std::min(a.w0, b.w0), std::max(a.w1, b.w1)};
  }
  Reach grown(const Reach& r) const {
    return {std::max(r.j0 - 3, 0),          std::min(r.j1 + 3, l_.size[1]), std::max(r.k0 - 3, 0),
            std::min(r.k1 + 3, l_.size[2]), std::max(r.w0 - 1, 0),          std::min(r.w1 + 1, inside_.words())};
  }

  /// Layers 1 and 2, and their distances, from layer 0.
  void rebuild_outer(const Reach& cover) {
    outer(cover, layer0_, layer0_, layer1_);
    outer(cover, layer1_, layer0_, layer2_);
  }
  void outer(const Reach& cover, const BitMask& from, const BitMask& innermost, BitMask& to) {
    const int last = l_.size[0] - 1;
    for_slices(cover, [&](int k) {
      for_words(cover, [&](int j, int w) {
        const Around n = around(from, w, j, k);
        std::uint64_t bits = n.any() & ~from.row(j, k)[w] & ~innermost.row(j, k)[w];
        if (last >> 6 == w) bits &= ~std::uint64_t{0} >> (63 - (last & 63));
        to.row(j, k)[w] = bits;
        if (!bits) return;
        for_bits(bits, w, [&](int i, int b) { set_from(i, j, k, n, b, from); });
      });
    });
  }

  void finish() {
    const float far = 3 * h_max_;
    for_slices(everything_, [&](int k) {
      for_words(everything_, [&](int j, int w) {
        const std::uint64_t band = layer0_.row(j, k)[w] | layer1_.row(j, k)[w] | layer2_.row(j, k)[w];
        const std::uint64_t in = inside_.row(j, k)[w];
        for (int b = 0, i = w * 64; b < 64 && i < l_.size[0]; ++b, ++i)
          if (!(band >> b & 1)) phi_.at(i, j, k) = in >> b & 1 ? far : -far;
      });
    });
  }

  const Lattice l_;
  const Grid<float>& g_;
  Grid<float>& phi_;
  const BandParams& p_;
  BitMask inside_, layer0_, layer1_, layer2_, next0_;
  std::vector<Slice> slices_;
  Reach everything_, reach_, before_;  ///< of layer 0, now and a step ago
  std::size_t band_count_ = 0;
  float h_[3], inv_h_[3], h_min_ = 0, h_max_ = 0;
  std::ptrdiff_t step_[3];
};

}  // namespace

BandRun evolve_band(const Grid<float>& speed, Grid<float>& phi, const BandParams& params, const Progress& progress) {
  return Band(speed, phi, params).run(progress);
}

}  // namespace trephine::segmentation
