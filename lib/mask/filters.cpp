// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/filters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "base/rank.h"

namespace trephine::mask {
namespace {

constexpr float far_mm2 = 1e12f;

/// Lower envelope of parabolas along one line of n samples, `spacing` apart.
class Envelope {
 public:
  Envelope(int n, double spacing) : n_(n), spacing_(spacing), at_(n), from_(n + 1) {}
  void operator()(const float* f, float* out) {
    int top = -1;
    for (int q = 0; q < n_; ++q) {
      if (f[q] >= far_mm2) continue;
      double s = 0;
      while (top >= 0) {
        const int p = at_[top];
        const double xq = q * spacing_, xp = p * spacing_;
        s = ((f[q] + xq * xq) - (f[p] + xp * xp)) / (2 * (xq - xp));
        if (s > from_[top]) break;
        --top;
      }
      ++top;
      at_[top] = q;
      from_[top] = top == 0 ? -std::numeric_limits<double>::infinity() : s;
    }
    if (top < 0) {
      std::fill(out, out + n_, far_mm2);
      return;
    }
    for (int q = 0, e = 0; q < n_; ++q) {
      const double x = q * spacing_;
      while (e < top && from_[e + 1] < x) ++e;
      const double d = x - at_[e] * spacing_;
      out[q] = float(d * d + f[at_[e]]);
    }
  }

 private:
  int n_;
  double spacing_;
  std::vector<int> at_;
  std::vector<double> from_;
};

/// The squared distance along a row of bits to the nearest one that is set.
void squares_along_row(const std::uint64_t* bits, int n, double spacing, float* out) {
  const auto set = [&](int i) { return (bits[i >> 6] >> (i & 63) & 1) != 0; };
  const auto squared = [&](int i, int to) {
    const double d = i * spacing - to * spacing;
    return float(d * d);
  };
  for (int i = 0, last = -1; i < n; ++i) {
    if (set(i)) last = i;
    out[i] = last < 0 ? far_mm2 : squared(i, last);
  }
  for (int i = n - 1, next = -1; i >= 0; --i) {
    if (set(i)) next = i;
    if (next > i && out[i] > 0) out[i] = std::min(out[i], squared(i, next));
  }
}

/// Lines of n samples across the rows, some at a time, so that what lies beside each other in memory is read together.
class Lines {
 public:
  explicit Lines(int n) : n_(std::size_t(n)), in_(together * n_), out_(together * n_) {}
  /// Of `count` lines beside each other, whose samples are `stride` apart, the envelope, with `last` of each sample.
  template <class Last>
  void each(float* first, std::size_t stride, int count, Envelope& envelope, const Last& last) {
    for (std::size_t i = 0; i < std::size_t(count); i += together) {
      const std::size_t some = std::min(together, std::size_t(count) - i);
      for (std::size_t q = 0; q < n_; ++q)
        for (std::size_t c = 0; c < some; ++c) in_[c * n_ + q] = first[q * stride + i + c];
      for (std::size_t c = 0; c < some; ++c) envelope(&in_[c * n_], &out_[c * n_]);
      for (std::size_t q = 0; q < n_; ++q)
        for (std::size_t c = 0; c < some; ++c) first[q * stride + i + c] = last(out_[c * n_ + q]);
    }
  }

 private:
  static constexpr std::size_t together = 16;
  std::size_t n_;
  std::vector<float> in_, out_;
};

}  // namespace

grid::Grid<float> distance_mm(const BitMask& to, const Progress& progress) {
  const grid::Lattice& l = to.lattice();
  grid::Grid<float> d(l);
  const int nx = l.size[0], ny = l.size[1], nz = l.size[2];
  parallel_for(0, nz, 4, [&](std::int64_t from, std::int64_t end) {
    progress.check();
    Envelope along_y(ny, l.spacing_mm.y);
    Lines lines(ny);
    for (int k = int(from); k < end; ++k) {
      for (int j = 0; j < ny; ++j) squares_along_row(to.row(j, k), nx, l.spacing_mm.x, &d.at(0, j, k));
      lines.each(&d.at(0, 0, k), std::size_t(nx), nx, along_y, [](float v) { return v; });
    }
  });
  parallel_for(0, ny, 4, [&](std::int64_t from, std::int64_t end) {
    progress.check();
    Envelope along_z(nz, l.spacing_mm.z);
    Lines lines(nz);
    for (int j = int(from); j < end; ++j)
      lines.each(&d.at(0, j, 0), std::size_t(nx) * ny, nx, along_z, [](float v) { return std::sqrt(v); });
  });
  return d;
}

namespace {

std::vector<float> kernel_of(double sigma_voxels) {
  const int reach = std::max(1, int(std::ceil(3 * sigma_voxels)));
  std::vector<double> k(2 * reach + 1);
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    // The Gaussian's integral over the voxel, which is correct also where sigma is smaller than a voxel.
    const double s = sigma_voxels * std::sqrt(2.0);
    k[i + reach] = std::erf((i + 0.5) / s) - std::erf((i - 0.5) / s);
    sum += k[i + reach];
  }
  std::vector<float> f;
  for (double v : k) f.push_back(float(v / sum));
  return f;
}

/// Convolves `rows` rows of `width` across the rows: in[r] -> out[r].
void across(const std::vector<const float*>& in, const std::vector<float*>& out, int width,
            const std::vector<float>& kernel) {
  const int rows = int(in.size()), reach = int(kernel.size() / 2);
  for (int r = 0; r < rows; ++r) {
    float* o = out[r];
    std::fill(o, o + width, 0.f);
    for (int t = r - reach; t <= r + reach; ++t) {
      const float w = kernel[t - r + reach];
      const float* s = in[std::clamp(t, 0, rows - 1)];
      for (int i = 0; i < width; ++i) o[i] += w * s[i];
    }
  }
}

}  // namespace

void gaussian(grid::Grid<float>& grid, double sigma_mm, const Progress& progress) {
  if (!(sigma_mm > 0)) return;
  const int nx = grid.size[0], ny = grid.size[1], nz = grid.size[2];
  const auto kx = kernel_of(sigma_mm / grid.spacing_mm.x), ky = kernel_of(sigma_mm / grid.spacing_mm.y),
             kz = kernel_of(sigma_mm / grid.spacing_mm.z);
  parallel_for(0, nz, 2, [&](std::int64_t from, std::int64_t end) {
    progress.check();
    const int reach = int(kx.size() / 2);
    std::vector<float> padded(nx + 2 * reach), slice(std::size_t(nx) * ny);
    std::vector<const float*> in(ny);
    std::vector<float*> out(ny);
    for (int k = int(from); k < end; ++k) {
      for (int j = 0; j < ny; ++j) {
        float* o = &slice[std::size_t(j) * nx];
        std::copy_n(&grid.at(0, j, k), nx, padded.begin() + reach);
        std::fill_n(padded.begin(), reach, grid.at(0, j, k));
        std::fill_n(padded.end() - reach, reach, grid.at(nx - 1, j, k));
        for (std::size_t t = 0; t < kx.size(); ++t) {
          const float w = kx[t];
          const float* s = padded.data() + t;
          for (int i = 0; i < nx; ++i) o[i] = (t ? o[i] : 0.f) + w * s[i];
        }
        in[j] = o;
        out[j] = &grid.at(0, j, k);
      }
      across(in, out, nx, ky);
    }
  });
  parallel_for(0, ny, 4, [&](std::int64_t from, std::int64_t end) {
    progress.check();
    std::vector<float> wall(std::size_t(nx) * nz);
    std::vector<const float*> in(nz);
    std::vector<float*> out(nz);
    for (int j = int(from); j < end; ++j) {
      for (int k = 0; k < nz; ++k) {
        float* w = &wall[std::size_t(k) * nx];
        std::copy_n(&grid.at(0, j, k), nx, w);
        in[k] = w;
        out[k] = &grid.at(0, j, k);
      }
      across(in, out, nx, kz);
    }
  });
}

grid::Grid<float> masked_gaussian(grid::Grid<float> values, const BitMask& known, double sigma_mm, float nowhere,
                                  double min_weight, const Progress& progress) {
  const grid::Lattice& l = values;
  grid::Grid<float> weight(l);
  parallel_for(0, l.size[2], 4, [&](std::int64_t from, std::int64_t end) {
    for (int k = int(from); k < end; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const bool in = known.get(i, j, k);
          weight.at(i, j, k) = in;
          if (!in) values.at(i, j, k) = 0;
        }
  });
  gaussian(values, sigma_mm, progress);
  gaussian(weight, sigma_mm, progress);
  parallel_for(0, l.size[2], 4, [&](std::int64_t from, std::int64_t end) {
    for (std::size_t v = l.index(0, 0, int(from)); v < l.index(0, 0, int(end)); ++v) {
      const float w = weight.voxels[v];
      values.voxels[v] = w > min_weight ? values.voxels[v] / w : nowhere;
    }
  });
  return values;
}

grid::Mask flood(const grid::Grid<float>& height, const BitMask& domain, const grid::Mask& seeds,
                 const Progress& progress) {
  constexpr double level_step = 0.05;
  const int nx = height.size[0], ny = height.size[1], nz = height.size[2];
  float highest = 0;
  for (float h : height.voxels) highest = std::max(highest, std::min(h, 1e4f));
  const auto level_of = [&](std::size_t v) {
    return std::size_t(std::clamp(height.voxels[v], 0.f, 1e4f) / level_step);
  };
  std::vector<std::vector<std::uint32_t>> queue(std::size_t(highest / level_step) + 1);
  constexpr std::uint8_t beyond = 255;  // not in the domain, so it is never reached
  grid::Mask label(height, beyond);
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) {
        if (!domain.get(i, j, k)) continue;
        const std::size_t v = height.index(i, j, k);
        label.voxels[v] = seeds.voxels[v];
        if (seeds.voxels[v]) queue[level_of(v)].push_back(std::uint32_t(v));
      }
  const std::uint32_t sy = std::uint32_t(nx), sz = sy * std::uint32_t(ny);
  for (std::size_t level = queue.size(); level-- > 0;) {
    progress.check();
    // The queue of this level grows while it is processed: first in, first out.
    for (std::size_t q = 0; q < queue[level].size(); ++q) {
      const std::uint32_t v = queue[level][q], row = v / sy;
      const int i = int(v - row * sy), j = int(row % std::uint32_t(ny)), k = int(v / sz);
      const auto visit = [&](bool inside, std::uint32_t n) {
        if (!inside || label.voxels[n]) return;
        label.voxels[n] = label.voxels[v];
        queue[std::min(level, level_of(n))].push_back(n);
      };
      visit(i > 0, v - 1);
      visit(i + 1 < nx, v + 1);
      visit(j > 0, v - sy);
      visit(j + 1 < ny, v + sy);
      visit(k > 0, v - sz);
      visit(k + 1 < nz, v + sz);
    }
    std::vector<std::uint32_t>().swap(queue[level]);
  }
  for (std::uint8_t& at : label.voxels)
    if (at == beyond) at = 0;
  return label;
}

float median(std::vector<float>& values, float otherwise) { return values.empty() ? otherwise : median_of(values); }

void check_finite(const grid::Field& f) {
  for (std::size_t n = 0; n < f.voxels.size(); ++n)
    if (!std::isfinite(f.voxels[n])) {
      const std::size_t row = n / f.size[0];
      throw Error(ExitCode::bad_input, "",
                  "voxel " + std::to_string(n % f.size[0]) + " " + std::to_string(row % f.size[1]) + " " +
                      std::to_string(row / f.size[1]),
                  "is not finite");
    }
}

}  // namespace trephine::mask
