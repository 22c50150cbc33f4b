// SPDX-License-Identifier: GPL-3.0-or-later
#include "itk/non_local_means.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"

namespace trephine::itk {
namespace {

using Triple = std::array<int, 3>;

constexpr int slab_slices = 8;  ///< of one piece of work: fixed, so that the bytes do not depend on the threads

Triple radius_of(const grid::Lattice& l, double mm) {
  Triple r{};
  for (std::size_t a = 0; a < 3; ++a) r[a] = static_cast<int>(std::lround(mm / l.spacing_mm[static_cast<int>(a)]));
  return r;
}

std::vector<Triple> offsets_of(const grid::Lattice& l, double mm) {
  std::vector<Triple> all;
  Triple most{};
  for (std::size_t a = 0; a < 3; ++a) most[a] = static_cast<int>(mm / l.spacing_mm[static_cast<int>(a)]);
  for (int k = -most[2]; k <= most[2]; ++k)
    for (int j = -most[1]; j <= most[1]; ++j)
      for (int i = -most[0]; i <= most[0]; ++i)
        if ((i || j || k) && norm(Vec3{i * l.spacing_mm.x, j * l.spacing_mm.y, k * l.spacing_mm.z}) <= mm)
          all.push_back({i, j, k});
  return all;
}

/// The grid with a border of its outermost values.
struct Padded {
  Triple pad{}, size{};
  std::vector<float> voxels;
  const float* row(int i, int j, int k) const {
    return voxels.data() +
           (std::size_t(k + pad[2]) * std::size_t(size[1]) + std::size_t(j + pad[1])) * std::size_t(size[0]) +
           std::size_t(i + pad[0]);
  }
};

Padded padded(const grid::Grid<float>& g, const Triple& pad) {
  Padded p;
  p.pad = pad;
  for (std::size_t a = 0; a < 3; ++a) p.size[a] = g.size[a] + 2 * pad[a];
  p.voxels.resize(std::size_t(p.size[0]) * std::size_t(p.size[1]) * std::size_t(p.size[2]));
  std::size_t n = 0;
  for (int k = 0; k < p.size[2]; ++k)
    for (int j = 0; j < p.size[1]; ++j)
      for (int i = 0; i < p.size[0]; ++i)
        p.voxels[n++] = g.at(std::clamp(i - pad[0], 0, g.size[0] - 1), std::clamp(j - pad[1], 0, g.size[1] - 1),
                             std::clamp(k - pad[2], 0, g.size[2] - 1));
  return p;
}

/// Slices [from, to) of the result. Buffers are rows of one slice of differences and of their sums along x and y, in a
/// ring of as many slices as a patch has.
class Slab {
 public:
  Slab(const grid::Grid<float>& grid, const Padded& padded, const Triple& patch, const NonLocalMeans& params)
      : grid_(grid), padded_(padded), patch_(patch), nx_(grid.size[0]), ny_(grid.size[1]) {
    double count = 1;
    for (const int r : patch) count *= 2 * r + 1;
    const double variance = params.noise_hu * params.noise_hu;
    // t = (sum / count - 2 variance) / variance, and 1 - t / 8.
    scale_ = static_cast<float>(-1 / (8 * count * variance));
    shift_ = static_cast<float>(1 + 2.0 / 8);
    wide_.resize(std::size_t(nx_ + 2 * patch[0]) * std::size_t(ny_ + 2 * patch[1]));
    narrow_.resize(std::size_t(nx_) * std::size_t(ny_ + 2 * patch[1]));
    ring_.resize(std::size_t(2 * patch[2] + 1) * std::size_t(nx_) * std::size_t(ny_));
  }

  void run(int from, int to, const std::vector<Triple>& offsets, grid::Grid<float>& out, const Progress& progress) {
    const std::size_t slice = std::size_t(nx_) * std::size_t(ny_), begin = grid_.index(0, 0, from);
    const std::size_t count = slice * std::size_t(to - from);
    weight_.assign(count, 1.0f);
    sum_.assign(grid_.voxels.begin() + static_cast<std::ptrdiff_t>(begin),
                grid_.voxels.begin() + static_cast<std::ptrdiff_t>(begin + count));
    for (const Triple& d : offsets) {
      progress.check();
      for (int k = from - patch_[2]; k < to + patch_[2]; ++k) {
        differences(k, d);
        if (const int done = k - patch_[2]; done >= from)
          add(done, d, sum_.data() + slice * std::size_t(done - from),
              weight_.data() + slice * std::size_t(done - from));
      }
    }
    for (std::size_t n = 0; n < count; ++n) out.voxels[begin + n] = sum_[n] / weight_[n];
  }

 private:
  float* ring(int k) {
    const int slices = 2 * patch_[2] + 1;
    return ring_.data() + std::size_t((k % slices + slices) % slices) * std::size_t(nx_) * std::size_t(ny_);
  }

  // Squared differences of one slice to the shifted one, summed over a patch's rectangle, into the ring.
  void differences(int k, const Triple& d) {
    const int rx = patch_[0], ry = patch_[1], width = nx_ + 2 * rx, height = ny_ + 2 * ry;
    for (int j = 0; j < height; ++j) {
      const float* a = padded_.row(-rx, j - ry, k);
      const float* b = padded_.row(d[0] - rx, j - ry + d[1], k + d[2]);
      float* to = wide_.data() + std::size_t(j) * std::size_t(width);
      for (int i = 0; i < width; ++i) to[i] = (a[i] - b[i]) * (a[i] - b[i]);
      float* n = narrow_.data() + std::size_t(j) * std::size_t(nx_);
      std::copy_n(to, nx_, n);
      for (int s = 1; s <= 2 * rx; ++s)
        for (int i = 0; i < nx_; ++i) n[i] += to[i + s];
    }
    float* into = ring(k);
    for (int j = 0; j < ny_; ++j) {
      float* to = into + std::size_t(j) * std::size_t(nx_);
      std::copy_n(narrow_.data() + std::size_t(j) * std::size_t(nx_), nx_, to);
      for (int s = 1; s <= 2 * ry; ++s) {
        const float* from = narrow_.data() + std::size_t(j + s) * std::size_t(nx_);
        for (int i = 0; i < nx_; ++i) to[i] += from[i];
      }
    }
  }

  void add(int k, const Triple& d, float* sum, float* weight) {
    row_.resize(std::size_t(nx_));
    for (int j = 0; j < ny_; ++j) {
      const std::size_t at = std::size_t(j) * std::size_t(nx_);
      std::copy_n(ring(k - patch_[2]) + at, nx_, row_.data());
      for (int s = 1; s <= 2 * patch_[2]; ++s) {
        const float* from = ring(k - patch_[2] + s) + at;
        for (int i = 0; i < nx_; ++i) row_[std::size_t(i)] += from[i];
      }
      const float* value = padded_.row(d[0], j + d[1], k + d[2]);
      const float scale = scale_, shift = shift_;
      for (int i = 0; i < nx_; ++i) {
        float w = row_[std::size_t(i)] * scale + shift;
        w = w < 0 ? 0.0f : w > 1 ? 1.0f : w;
        w *= w;
        w *= w;
        w *= w;
        sum[at + std::size_t(i)] += w * value[i];
        weight[at + std::size_t(i)] += w;
      }
    }
  }

  const grid::Grid<float>& grid_;
  const Padded& padded_;
  const Triple patch_;
  const int nx_, ny_;
  float scale_ = 0, shift_ = 1;
  std::vector<float> wide_, narrow_, ring_, row_, sum_, weight_;
};

}  // namespace

std::size_t patches_compared(const grid::Lattice& lattice, const NonLocalMeans& params) {
  // So many are counted by their volume: whoever asks refuses them, and a list of them could fill the memory.
  constexpr double many = 1e6, ball_of_radius_1 = 4.18879;
  const double ball = ball_of_radius_1 * std::pow(params.search_mm, 3) / lattice.voxel_volume_mm3();
  return ball > many ? static_cast<std::size_t>(ball) : offsets_of(lattice, params.search_mm).size();
}

grid::Grid<float> non_local_means(const grid::Grid<float>& grid, const NonLocalMeans& params,
                                  const Progress& progress) {
  const std::vector<Triple> offsets = offsets_of(grid, params.search_mm);
  if (offsets.empty())
    throw Error(ExitCode::usage, "", "search_mm",
                "reaches no other voxel: say at least the spacing, " +
                    to_text(std::min({grid.spacing_mm.x, grid.spacing_mm.y, grid.spacing_mm.z})) + " mm");
  const Triple patch = radius_of(grid, params.patch_mm);
  Triple pad = patch;
  for (std::size_t a = 0; a < 3; ++a)
    pad[a] += static_cast<int>(params.search_mm / grid.spacing_mm[static_cast<int>(a)]);
  const Padded source = padded(grid, pad);
  grid::Grid<float> out(static_cast<const grid::Lattice&>(grid));
  std::atomic<int> done{0};
  parallel_for(0, grid.size[2], slab_slices, [&](std::int64_t from, std::int64_t to) {
    progress.report(double(done.load()) / grid.size[2]);
    Slab(grid, source, patch, params).run(static_cast<int>(from), static_cast<int>(to), offsets, out, progress);
    done += static_cast<int>(to - from);
  });
  return out;
}

}  // namespace trephine::itk
