// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/snake_band.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/parallel.h"
#include "mask/bits.h"

namespace trephine::segmentation {
namespace {

/// Iterations over which the motion is taken: what flickers to and fro is none.
constexpr int look_every = 10;
constexpr float unknown = std::numeric_limits<float>::infinity();
constexpr float wall = -1;  ///< the speed where the surface must not go

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

/// The same for the voxel beyond that neighbour.
Around beyond(const BitMask& m, int w, int j, int k) {
  const Lattice& l = m.lattice();
  const std::uint64_t* row = m.row(j, k);
  const auto word = [&](int jj, int kk) {
    return jj >= 0 && kk >= 0 && jj < l.size[1] && kk < l.size[2] ? m.row(jj, kk)[w] : 0;
  };
  return {{row[w] << 2 | (w > 0 ? row[w - 1] >> 62 : 0), row[w] >> 2 | (w + 1 < m.words() ? row[w + 1] << 62 : 0),
           word(j - 2, k), word(j + 2, k), word(j, k - 2), word(j, k + 2)}};
}

template <class F>
void for_bits(std::uint64_t bits, int w, F&& f) {
  for (; bits; bits &= bits - 1) {
    const int b = __builtin_ctzll(bits);
    f(w * 64 + b, b);
  }
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

struct Vec3f {
  float v[3];
};

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
      inv_h2_[a] = inv_h_[a] * inv_h_[a];
    }
    finest_ = int(std::min_element(h_, h_ + 3) - h_);
    h_min_ = h_[finest_];
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
    longest_ = float(longest);
    for (int since = 0;;) {
      r.inside = count_inside();
      if (r.inside == 0 || band_count_ == 0) {
        r.end = r.inside == 0 ? BandEnd::vanished : BandEnd::filled;
        break;
      }
      if (r.inside > p_.max_voxels) {
        r.end = BandEnd::too_large;
        break;
      }
      if (since == look_every || (since > 0 && r.iterations == p_.max_iterations_count)) {
        r.change_mm = moved() / since;
        since = 0;
        if (r.change_mm < p_.min_change_mm) {
          r.end = BandEnd::converged;
          break;
        }
      }
      if (r.iterations >= p_.max_iterations_count) break;
      if (since == 0) remember();
      progress.report(double(r.iterations) / p_.max_iterations_count);
      compute_rates();
      float fastest = 0;
      for (const Slice& s : slices_) fastest = std::max(fastest, s.fastest);
      const double dt = fastest > 0 ? std::min(longest, cfl / fastest) : longest;
      move(float(dt));
      relayer();
      ++since;
      ++r.iterations;
      r.time_step = dt;
      r.time += dt;
    }
    finish();
    return r;
  }

 private:
  struct Slice {
    std::vector<float> rates;  ///< of the slice's voxels of layer 0, in their order
    double moved = 0;
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

  /// Central differences of the speed, per mm. A wall is no edge that pulls: the speed goes on as it is before it.
  Vec3f speed_slope(const int at[3], std::size_t v) const {
    Vec3f s{{0, 0, 0}};
    const float* g = g_.voxels.data() + v;
    if (*g <= wall) return s;
    const auto beside = [&](std::ptrdiff_t to) { return g[to] > wall ? g[to] : *g; };
    for (int a = 0; a < 3; ++a)
      s.v[a] = 0.5f * inv_h_[a] * (beside(at[a] + 1 < l_.size[a] ? step_[a] : 0) - beside(at[a] > 0 ? -step_[a] : 0));
    return s;
  }

  /// How fast the surface next to voxel v is driven. The surface point is taken as the mean of the crossings along the
  /// axes, by their nearness (on a plane it is the foot of the voxel's perpendicular), so that the voxels on both sides
  /// of a crossing agree. `inwards` is the unit normal. Where the speed falls outwards, so that the surface comes to
  /// rest, it is the mean over the step (the linearly implicit Euler step): no overshooting however steep the fall.
  template <bool Advection>
  float driven(const int at[3], std::size_t v, const float weight[3], const float inwards[3]) const {
    const float* f = phi_.voxels.data() + v;
    const float* g = g_.voxels.data() + v;
    const float c = *f, inv_c = 1 / c;
    float sum = 0, total = 0, fall = 0;
    for (int a = 0; a < 3; ++a) {
      // One over the share of the way to the neighbour at which the crossing lies.
      float nearness = 0;
      std::ptrdiff_t to = 0;
      if (at[a] > 0 && (f[-step_[a]] > 0) != (c > 0)) {
        to = -step_[a];
        nearness = (c - f[to]) * inv_c;
      }
      if (at[a] + 1 < l_.size[a] && (f[step_[a]] > 0) != (c > 0)) {
        const float other = (c - f[step_[a]]) * inv_c;
        if (other > nearness) {
          to = step_[a];
          nearness = other;
        }
      }
      if (to == 0) continue;
      float here = weight[0] * *g, there = weight[0] * g[to];
      if (Advection) {
        int next[3] = {at[0], at[1], at[2]};
        next[a] += to > 0 ? 1 : -1;
        const Vec3f p = speed_slope(at, v), q = speed_slope(next, std::size_t(std::ptrdiff_t(v) + to));
        for (int b = 0; b < 3; ++b) {
          here += weight[2] * inwards[b] * p.v[b];
          there += weight[2] * inwards[b] * q.v[b];
        }
      }
      nearness = std::min(nearness, 1000.f);
      const float w = nearness * inv_h2_[a];
      sum += w * (nearness * here + there - here);
      fall += w * (c > 0 ? here - there : there - here);
      total += w * nearness;
    }
    if (!(total > 0)) return 0;
    const float steepness = std::sqrt(total);
    return sum / (total + longest_ * std::max(0.f, fall) * steepness);
  }

  struct Motion {
    float rate, hyperbolic;
  };

  template <bool Advection>
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
      second[a] = inv_h2_[a] * (p - 2 * c + m);
      const float up = std::max(0.f, std::max(m, p) - c) * inv_h_[a];
      const float down = std::max(0.f, c - std::min(m, p)) * inv_h_[a];
      larger += up * up;
      smaller += down * down;
    }
    const float length2 = first[0] * first[0] + first[1] * first[1] + first[2] * first[2] + 1e-6f;
    const float inv_length = 1 / std::sqrt(length2), inv_length2 = inv_length * inv_length;
    const float inwards[3] = {first[0] * inv_length, first[1] * inv_length, first[2] * inv_length};
    Motion m;
    m.hyperbolic = driven<Advection>(at, v, weight, inwards);
    m.rate = m.hyperbolic * std::sqrt(m.hyperbolic > 0 ? larger : smaller);
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
      const float most = 2 * inv_h_[finest_] * length2 * inv_length;
      bend = std::max(-most, std::min(most, bend));
      // From the level set through the voxel to the surface, as if that were a ball.
      bend /= std::max(0.5f, std::min(2.f, 1 - 0.5f * c * bend * inv_length2));
      m.rate += weight[1] * bend;
    }
    return m;
  }

  void compute_rates() {
    if (p_.advection != 0)
      compute_rates<true>();
    else
      compute_rates<false>();
  }
  template <bool Advection>
  void compute_rates() {
    const float weight[3] = {float(p_.propagation), float(p_.curvature), float(p_.advection)};
    for_slices(everything_, [&](int k) {
      Slice& s = slices_[k];
      s.rates.clear();
      s.fastest = 0;
      if (!s.any) return;
      for_words(s.reach, [&](int j, int w) {
        for_bits(layer0_.row(j, k)[w], w, [&](int i, int) {
          const int at[3] = {i, j, k};
          const Motion m = motion<Advection>(at, l_.index(i, j, k), weight);
          s.rates.push_back(m.rate);
          s.fastest = std::max(s.fastest, std::abs(m.hyperbolic));
        });
      });
    });
  }

  /// Remembers the surface, to see later how far it went.
  void remember() {
    if (then_.count() == 0) {
      then_ = Grid<float>(l_);
      then_band_ = BitMask(l_);
    }
    for_slices(everything_, [&](int k) {
      for_words(everything_, [&](int j, int w) {
        const std::uint64_t band = layer0_.row(j, k)[w] | layer1_.row(j, k)[w] | layer2_.row(j, k)[w];
        then_band_.row(j, k)[w] = band;
        if (!band) return;
        const int i = w * 64, n = std::min(64, l_.size[0] - i);
        std::copy_n(&phi_.at(i, j, k), n, &then_.at(i, j, k));
      });
    });
  }
  /// How far the surface moved since, on the mean, in mm; two voxels where it moved more.
  double moved() {
    const float most = 2 * h_min_;
    for_slices(everything_, [&](int k) {
      Slice& s = slices_[k];
      s.moved = 0;
      if (!s.any) return;
      for_words(s.reach, [&](int j, int w) {
        const std::uint64_t known = then_band_.row(j, k)[w];
        for_bits(layer0_.row(j, k)[w], w, [&](int i, int b) {
          s.moved += known >> b & 1 ? std::min(most, std::abs(phi_.at(i, j, k) - then_.at(i, j, k))) : most;
        });
      });
    });
    double sum = 0;
    for (const Slice& s : slices_) sum += s.moved;
    return sum / double(std::max<std::size_t>(band_count_, 1));
  }

  void move(float dt) {
    const float most = 0.9f * h_min_;
    const bool walls = p_.advection != 0;
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
          if (walls && g_.at(i, j, k) <= wall) f = std::min(f, -1e-3f * h_min_);
          if (std::abs(f) < 1e-5f * h_min_) f = f > 0 ? 1e-5f * h_min_ : -1e-5f * h_min_;
          const std::uint64_t bit = std::uint64_t{1} << b;
          in = f > 0 ? in | bit : in & ~bit;
        });
        s.inside += std::size_t(__builtin_popcountll(in)) - std::size_t(__builtin_popcountll(before));
      });
    });
  }

  /// The distances of the voxels `bits` of a word from their neighbours in layer `from`, whose values are known;
  /// one-sided differences of second order where the voxel behind the neighbour is known too (in `from` or layer 0), so
  /// that curvature survives.
  void set_from(const BitMask& from, std::uint64_t bits, int w, int j, int k) {
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
        weight[axis] = inv_h2_[axis];
        std::ptrdiff_t to = 0;
        int side = 2 * axis;
        if (next.side[side] >> b & 1) {
          to = -step_[axis];
          a[axis] = sign * f[to];
        }
        if (next.side[side + 1] >> b & 1) {
          const float other = sign * f[step_[axis]];
          if (other < a[axis]) {
            a[axis] = other;
            to = step_[axis];
            ++side;
          }
        }
        if (to == 0) continue;
        least = std::min(least, a[axis]);
        bound = std::min(bound, a[axis] + h_[axis]);
        if (!(behind.side[side] >> b & 1)) continue;
        const float second = sign * f[2 * to];
        if (!(second <= a[axis])) continue;
        a[axis] += (a[axis] - second) * (1.f / 3);
        weight[axis] *= 2.25f;
      }
      // Kinks mislead the wider difference: never farther than along one axis, never nearer than the neighbours.
      const float u = std::max(std::min(eikonal(a, weight), bound), std::max(least, 1e-3f * h_min_));
      *f = sign * u;
    });
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
        set_from(layer0_, fresh, w, j, k);
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
        if (bits) set_from(from, bits, w, j, k);
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
  Grid<float> then_;  ///< phi some iterations ago, where then_band_ is set
  const BandParams& p_;
  BitMask inside_, layer0_, layer1_, layer2_, next0_, then_band_;
  std::vector<Slice> slices_;
  Reach everything_, reach_, before_;  ///< of layer 0, now and a step ago
  std::size_t band_count_ = 0;
  int finest_ = 0;
  float h_[3], inv_h_[3], inv_h2_[3], h_min_ = 0, h_max_ = 0, longest_ = 0;
  std::ptrdiff_t step_[3];
};

}  // namespace

BandRun evolve_band(const Grid<float>& speed, Grid<float>& phi, const BandParams& params, const Progress& progress) {
  return Band(speed, phi, params).run(progress);
}

}  // namespace trephine::segmentation
