// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/snake_band.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "segmentation/snake_layers.h"
#include "segmentation/snake_motion.h"
#include "segmentation/snake_spacing.h"

namespace trephine::segmentation {
namespace {

/// Iterations over which the motion is taken: what flickers to and fro is none.
constexpr int look_every = 10;

/// The longest steps, mm per unit of speed: `cfl` where the surface moves at speed 1, `longest` ever.
struct StepLimits {
  double cfl = 0, longest = 0;
};

StepLimits step_limits(const SnakeSpacing& s, const BandParams& p) {
  const double sum_inv2 =
      double(s.inv_h[0]) * s.inv_h[0] + double(s.inv_h[1]) * s.inv_h[1] + double(s.inv_h[2]) * s.inv_h[2];
  const double min_inv2 = 1.0 / (double(s.h_max) * s.h_max);
  StepLimits r;
  // Godunov's scheme is monotone up to 1 / sqrt(sum 1/h^2); curvature diffuses along the two finest axes.
  r.cfl = 0.8 / std::sqrt(sum_inv2);
  r.longest = 0.8 / (2 * p.curvature * (sum_inv2 - min_inv2) + 1e-30);
  if (p.propagation != 0)
    r.longest = std::min(r.longest, r.cfl / std::abs(p.propagation));
  else if (p.advection != 0)
    r.longest = std::min(r.longest, r.cfl * s.h_min / std::abs(p.advection));
  return r;
}

class Band {
 public:
  Band(const grid::Grid<float>& speed, grid::Grid<float>& phi, const BandParams& params)
      : l_(phi),
        g_(speed),
        phi_(phi),
        p_(params),
        s_(l_),
        limits_(step_limits(s_, p_)),
        layers_(phi),
        motion_(speed, phi, params, float(limits_.longest)),
        slices_(std::size_t(l_.size[2])) {}

  BandRun run(const Progress& progress) {
    layers_.begin();
    BandRun r;
    for (int since = 0; !ended(r, since);) {
      if (since == 0) remember();
      progress.report(double(r.iterations) / p_.max_iterations_count);
      compute_rates();
      float fastest = 0;
      for (const Slice& s : slices_) fastest = std::max(fastest, s.fastest);
      const double dt = fastest > 0 ? std::min(limits_.longest, limits_.cfl / fastest) : limits_.longest;
      move(float(dt));
      layers_.relayer();
      ++since;
      ++r.iterations;
      r.time_step = dt;
      r.time += dt;
    }
    layers_.finish();
    return r;
  }

 private:
  struct Slice {
    std::vector<float> rates;  ///< of the slice's voxels of layer 0, in their order
    double moved = 0;
    float fastest = 0;
  };

  /// Whether the evolution is at its end, and which; `since` is the iterations since remember(), 0 where it is due.
  bool ended(BandRun& r, int& since) {
    r.inside = layers_.inside_count();
    if (r.inside == 0 || layers_.band_count() == 0) {
      r.end = r.inside == 0 ? BandEnd::vanished : BandEnd::filled;
      return true;
    }
    if (r.inside > p_.max_voxels) {
      r.end = BandEnd::too_large;
      return true;
    }
    if (since == look_every || (since > 0 && r.iterations == p_.max_iterations_count)) {
      r.change_mm = moved() / since;
      since = 0;
      if (r.change_mm < p_.min_change_mm) {
        r.end = BandEnd::converged;
        return true;
      }
    }
    return r.iterations >= p_.max_iterations_count;
  }

  void compute_rates() {
    layers_.for_all_slices([&](int k) {
      Slice& s = slices_[k];
      s.rates.clear();
      s.fastest = 0;
      layers_.for_layer0(k, [&](int j, int w, std::uint64_t bits) {
        BandLayers::for_bits(bits, w, [&](int i, int) {
          const int at[3] = {i, j, k};
          const SnakeMotion::Rate m = motion_.rate(at, l_.index(i, j, k));
          s.rates.push_back(m.rate);
          s.fastest = std::max(s.fastest, std::abs(m.hyperbolic));
        });
      });
    });
  }

  /// Remembers the surface, to see later how far it went.
  void remember() {
    if (then_.count() == 0) {
      then_ = grid::Grid<float>(l_);
      then_band_ = mask::BitMask(l_);
    }
    layers_.for_all_slices([&](int k) {
      layers_.for_all_words([&](int j, int w) {
        const std::uint64_t band = layers_.band(j, w, k);
        then_band_.row(j, k)[w] = band;
        if (!band) return;
        const int i = w * 64, n = std::min(64, l_.size[0] - i);
        std::copy_n(&phi_.at(i, j, k), n, &then_.at(i, j, k));
      });
    });
  }
  /// How far the surface moved since, on the mean, in mm; two voxels where it moved more.
  double moved() {
    const float most = 2 * s_.h_min;
    layers_.for_all_slices([&](int k) {
      Slice& s = slices_[k];
      s.moved = 0;
      layers_.for_layer0(k, [&](int j, int w, std::uint64_t bits) {
        const std::uint64_t known = then_band_.row(j, k)[w];
        BandLayers::for_bits(bits, w, [&](int i, int b) {
          s.moved += known >> b & 1 ? std::min(most, std::abs(phi_.at(i, j, k) - then_.at(i, j, k))) : most;
        });
      });
    });
    double sum = 0;
    for (const Slice& s : slices_) sum += s.moved;
    return sum / double(std::max<std::size_t>(layers_.band_count(), 1));
  }

  void move(float dt) {
    const float most = 0.9f * s_.h_min;
    const bool walls = p_.advection != 0;
    layers_.for_all_slices([&](int k) {
      const Slice& s = slices_[k];
      std::size_t n = 0;
      layers_.for_layer0(k, [&](int j, int w, std::uint64_t bits) {
        std::uint64_t in = layers_.inside(j, w, k);
        BandLayers::for_bits(bits, w, [&](int i, int b) {
          float& f = phi_.at(i, j, k);
          f += std::max(-most, std::min(most, dt * s.rates[n++]));
          f = std::max(-s_.h_max, std::min(s_.h_max, f));
          if (walls && g_.at(i, j, k) <= snake_wall) f = std::min(f, -1e-3f * s_.h_min);
          if (std::abs(f) < 1e-5f * s_.h_min) f = f > 0 ? 1e-5f * s_.h_min : -1e-5f * s_.h_min;
          const std::uint64_t bit = std::uint64_t{1} << b;
          in = f > 0 ? in | bit : in & ~bit;
        });
        layers_.set_inside(j, w, k, in);
      });
    });
  }

  const grid::Lattice l_;
  const grid::Grid<float>& g_;
  grid::Grid<float>& phi_;
  const BandParams& p_;
  const SnakeSpacing s_;
  const StepLimits limits_;
  BandLayers layers_;
  const SnakeMotion motion_;
  std::vector<Slice> slices_;
  grid::Grid<float> then_;  ///< phi some iterations ago, where then_band_ is set
  mask::BitMask then_band_;
};

}  // namespace

BandRun evolve_band(const grid::Grid<float>& speed, grid::Grid<float>& phi, const BandParams& params,
                    const Progress& progress) {
  return Band(speed, phi, params).run(progress);
}

}  // namespace trephine::segmentation
