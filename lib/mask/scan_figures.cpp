// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/scan_figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "base/rank.h"
#include "mask/hu_view.h"

namespace trephine::mask {
namespace {

constexpr double tile_mm = 6, cube_mm = 2;
constexpr double min_tissue_hu = -10, max_tissue_hu = 90, bone_hu = 250;
constexpr double brain_texture_hu = 7;     // grey and white matter, sulci
constexpr double to_sigma = 1.4826;        // of the median of absolute values
constexpr double width_of_sigma = 2.3548;  // full width at half maximum

/// The volume seen slice by slice: axis 2 is the one across the slices.
struct Slices {
  explicit Slices(const grid::HuVolume& volume) : hu(volume) {
    const grid::Lattice& l = hu.lattice();
    for (int a = 0; a < 2; ++a)
      if (l.spacing_mm[a] > 1.01 * l.spacing_mm[axis[2]]) std::swap(axis[2], axis[a]);
    for (int a = 0; a < 3; ++a) size[a] = l.size[axis[a]], spacing[a] = l.spacing_mm[axis[a]];
  }
  float at(int i, int j, int k) const {
    std::array<int, 3> n;
    n[axis[0]] = i, n[axis[1]] = j, n[axis[2]] = k;
    return hu(n[0], n[1], n[2]);
  }
  HuView hu;
  std::array<int, 3> axis{0, 1, 2}, size{};
  std::array<double, 3> spacing{};
};

/// The value that a share of the values does not exceed.
template <class T>
double quantile(std::vector<T>& v, double share) {
  if (v.empty()) return 0;
  return value_at_rank(v, std::min(v.size() - 1, static_cast<std::size_t>(share * double(v.size()))));
}

/// One tile of a slice: a plane is fitted and taken away, so that shading is no noise.
struct Tile {
  double mean = 0, variance = 0;
  double along = 0;   // covariance of neighbours in rows and columns
  double across = 0;  // with the next slice; the variance of both is then in `both`
  double both = 0;
  bool has_next = false;
};

/// What is left of one slice's tile after its plane, row by row.
void detrend(std::vector<double>& v, int nx, int ny, double& mean) {
  double sum = 0, x1 = 0, y1 = 0, xx = 0, yy = 0;
  for (int y = 0; y < ny; ++y)
    for (int x = 0; x < nx; ++x) {
      const double a = v[std::size_t(y) * nx + x], u = x - 0.5 * (nx - 1), w = y - 0.5 * (ny - 1);
      sum += a, x1 += a * u, y1 += a * w, xx += u * u, yy += w * w;
    }
  mean = sum / (double(nx) * ny);
  for (int y = 0; y < ny; ++y)
    for (int x = 0; x < nx; ++x)
      v[std::size_t(y) * nx + x] -= mean + x1 / xx * (x - 0.5 * (nx - 1)) + y1 / yy * (y - 0.5 * (ny - 1));
}

class Measurement {
 public:
  Measurement(const grid::HuVolume& volume, const Progress& progress) : s_(volume), progress_(progress) {
    for (int a = 0; a < 2; ++a) {
      tile_[a] = std::max(4, int(std::lround(tile_mm / s_.spacing[a])));
      tiles_[a] = s_.size[a] / tile_[a];
    }
  }

  ScanFigures measure() {
    ScanFigures out;
    out.pixel_mm = std::max(s_.spacing[0], s_.spacing[1]);
    out.slice_step_mm = s_.spacing[2];
    choose_tiles();
    out.tiles_count = std::int64_t(chosen_.size());
    out.edge_mm = edge_width();
    if (!out.known()) return out;
    read_tiles();
    std::vector<double> variances;
    for (const Tile& t : read_) variances.push_back(t.variance);
    // Less than half: where a tile holds a sulcus or a vessel, that is no noise. 0.9 is that quantile's own bias.
    out.noise_hu = std::sqrt(quantile(variances, 0.35)) / 0.9;
    double along = 0, variance = 0, across = 0, both = 0;
    std::size_t uneven = 0;
    const double most = std::hypot(2 * out.noise_hu, 2 * brain_texture_hu);
    for (const Tile& t : read_) {
      uneven += std::sqrt(t.variance) > most;
      if (std::sqrt(t.variance) > 1.3 * out.noise_hu) continue;
      along += t.along, variance += t.variance;
      if (t.has_next) across += t.across, both += t.both;
    }
    out.artefact_ratio = double(uneven) / double(read_.size());
    if (variance > 0) out.neighbour_correlation_ratio = along / variance;
    if (both > 0) out.slice_correlation_ratio = across / both;
    const double r = out.neighbour_correlation_ratio;
    if (r > 0.05) out.kernel_mm = width_of_sigma * out.pixel_mm / (2 * std::sqrt(-std::log(std::min(r, 0.98))));
    out.cube_noise_hu = cube_noise();
    return out;
  }

 private:
  std::size_t tile_index(int x, int y, int k) const {
    return (std::size_t(k) * std::size_t(tiles_[1]) + std::size_t(y)) * std::size_t(tiles_[0]) + std::size_t(x);
  }

  // Tiles of soft tissue whose four neighbours in the slice are soft tissue too; where a fifth of them have bone around
  // them, only these.
  void choose_tiles() {
    const std::size_t count = std::size_t(tiles_[0]) * std::size_t(tiles_[1]) * std::size_t(s_.size[2]);
    std::vector<float> mean(count), most(count);
    parallel_for(0, s_.size[2], 1, [&](std::int64_t from, std::int64_t to) {
      for (int k = int(from); k < int(to); ++k) {
        progress_.check();
        for (int y = 0; y < tiles_[1]; ++y)
          for (int x = 0; x < tiles_[0]; ++x) {
            // Bone is seen in quarters of a tile, for a table is thinner than a tile.
            double sum[4] = {}, n[4] = {};
            for (int b = 0; b < tile_[1]; ++b)
              for (int a = 0; a < tile_[0]; ++a) {
                const int q = (2 * a / tile_[0]) + 2 * (2 * b / tile_[1]);
                sum[q] += s_.at(x * tile_[0] + a, y * tile_[1] + b, k), n[q] += 1;
              }
            const std::size_t i = tile_index(x, y, k);
            mean[i] = float((sum[0] + sum[1] + sum[2] + sum[3]) / (n[0] + n[1] + n[2] + n[3]));
            most[i] = float(std::max({sum[0] / n[0], sum[1] / n[1], sum[2] / n[2], sum[3] / n[3]}));
          }
      }
    });
    std::vector<std::array<int, 3>> soft, enclosed;
    for (int k = 0; k < s_.size[2]; ++k)
      for (int y = 1; y + 1 < tiles_[1]; ++y)
        for (int x = 1; x + 1 < tiles_[0]; ++x) {
          const auto is_soft = [&](int dx, int dy) {
            const std::size_t i = tile_index(x + dx, y + dy, k);
            return mean[i] > min_tissue_hu && mean[i] < max_tissue_hu && most[i] < bone_hu;
          };
          if (!is_soft(0, 0) || !is_soft(1, 0) || !is_soft(-1, 0) || !is_soft(0, 1) || !is_soft(0, -1)) continue;
          soft.push_back({x, y, k});
          const auto meets_bone = [&](int dx, int dy) {
            for (int u = x + dx, w = y + dy; u >= 0 && w >= 0 && u < tiles_[0] && w < tiles_[1]; u += dx, w += dy)
              if (most[tile_index(u, w, k)] > bone_hu) return true;
            return false;
          };
          if (meets_bone(1, 0) && meets_bone(-1, 0) && meets_bone(0, 1) && meets_bone(0, -1))
            enclosed.push_back({x, y, k});
        }
    chosen_ = enclosed.size() * 5 > soft.size() ? enclosed : soft;
  }

  void read_tiles() {
    read_.resize(chosen_.size());
    parallel_for(0, std::int64_t(chosen_.size()), 64, [&](std::int64_t from, std::int64_t to) {
      std::vector<double> here, next;
      for (std::int64_t n = from; n < to; ++n) {
        const auto [x, y, k] = chosen_[std::size_t(n)];
        Tile& tile = read_[std::size_t(n)];
        double unused;
        fill(here, x, y, k, tile.mean);
        const int nx = tile_[0], ny = tile_[1];
        double along = 0, square = 0;
        std::size_t pairs = 0;
        for (int b = 0; b < ny; ++b)
          for (int a = 0; a < nx; ++a) {
            const double v = here[std::size_t(b) * nx + a];
            square += v * v;
            if (a + 1 < nx) along += v * here[std::size_t(b) * nx + a + 1], ++pairs;
            if (b + 1 < ny) along += v * here[std::size_t(b + 1) * nx + a], ++pairs;
          }
        tile.variance = square / (double(nx) * ny - 3);
        tile.along = along / double(pairs);
        tile.has_next = k + 1 < s_.size[2];
        if (!tile.has_next) continue;
        fill(next, x, y, k + 1, unused);
        double product = 0, other = 0;
        for (std::size_t i = 0; i < here.size(); ++i) product += here[i] * next[i], other += next[i] * next[i];
        // A brighter or more uneven neighbour is another tissue.
        tile.has_next = other < 2 * square && square < 2 * other;
        tile.across = product / double(here.size());
        tile.both = std::sqrt(square * other) / double(here.size());
      }
    });
  }
  void fill(std::vector<double>& v, int x, int y, int k, double& mean) const {
    v.clear();
    for (int b = 0; b < tile_[1]; ++b)
      for (int a = 0; a < tile_[0]; ++a) v.push_back(s_.at(x * tile_[0] + a, y * tile_[1] + b, k));
    detrend(v, tile_[0], tile_[1], mean);
  }

  // From second differences of the means of three cubes in a row, so that slopes do not count.
  double cube_noise() const {
    std::array<int, 3> n;
    for (int a = 0; a < 3; ++a) n[a] = std::max(1, int(std::lround(cube_mm / s_.spacing[a])));
    const double volume = n[0] * s_.spacing[0] * n[1] * s_.spacing[1] * n[2] * s_.spacing[2];
    std::vector<float> differences;
    for (const auto& [x, y, k] : chosen_) {
      if (k + n[2] > s_.size[2]) continue;
      const int i = x * tile_[0] + tile_[0] / 2 - n[0] - n[0] / 2, j = y * tile_[1] + (tile_[1] - n[1]) / 2;
      if (i < 0 || i + 3 * n[0] > s_.size[0] || j + n[1] > s_.size[1]) continue;
      double mean[3] = {};
      for (int c = 0; c < 3; ++c)
        for (int d = 0; d < n[2]; ++d)
          for (int b = 0; b < n[1]; ++b)
            for (int a = 0; a < n[0]; ++a) mean[c] += s_.at(i + c * n[0] + a, j + b, k + d);
      differences.push_back(float(std::fabs(mean[0] - 2 * mean[1] + mean[2]) / (n[0] * n[1] * n[2]) / std::sqrt(6.0)));
    }
    // Larger voxels than the cube are not averaged: their noise is that of a shape of their size.
    return to_sigma * quantile(differences, 0.5) * std::sqrt(std::max(1.0, volume / (cube_mm * cube_mm * cube_mm)));
  }

  // Rows and columns that come from air into tissue: from a quarter of the step to three quarters of it a Gaussian edge
  // takes 1.349 standard deviations, more where it is met aslant.
  double edge_width() const {
    constexpr double air_hu = -900, tissue_hu = -240, low_hu = -750, high_hu = -250;
    std::vector<std::vector<float>> widths(std::size_t(s_.size[2]));
    parallel_for(0, s_.size[2], 1, [&](std::int64_t from, std::int64_t to) {
      for (int k = int(from); k < int(to); ++k)
        for (int a = 0; a < 2; ++a) {
          const int length = s_.size[a], lines = s_.size[1 - a];
          const auto voxels = [&](double mm) { return std::max(2, int(std::lround(mm / s_.spacing[a]))); };
          const int near = voxels(1.5), far = voxels(3), reach = std::max(far, voxels(4));
          for (int line = 0; line < lines; line += 3) {
            const auto v = [&](int i) { return a == 0 ? s_.at(i, line, k) : s_.at(line, i, k); };
            for (const int way : {1, -1}) {
              const auto along = [&](int i) { return double(v(way > 0 ? i : length - 1 - i)); };
              int i = 0;
              while (i < length && along(i) < air_hu + 150) ++i;
              if (i < reach || i + far + reach >= length) continue;
              bool clear = true;  // air before it, tissue behind it: a sheet on the skin is no edge
              for (int b = near; b <= reach; ++b) clear = clear && along(i - b) < air_hu;
              for (int b = far; b <= far + reach; ++b) clear = clear && along(i + b) > tissue_hu;
              if (!clear) continue;
              const auto crossing = [&](double level) {
                int c = i - 1;
                while (along(c + 1) < level) ++c;
                return c + (level - along(c)) / (along(c + 1) - along(c));
              };
              widths[std::size_t(k)].push_back(float((crossing(high_hu) - crossing(low_hu)) * s_.spacing[a]));
            }
          }
        }
    });
    std::vector<float> all;
    for (const auto& w : widths) all.insert(all.end(), w.begin(), w.end());
    return all.size() < 200 ? 0 : width_of_sigma / 1.349 * quantile(all, 0.2);
  }

  Slices s_;
  const Progress& progress_;
  std::array<int, 2> tile_{}, tiles_{};
  std::vector<std::array<int, 3>> chosen_;
  std::vector<Tile> read_;
};

}  // namespace

ScanFigures measure_scan(const grid::HuVolume& volume, const Progress& progress) {
  check_finite(volume);
  return Measurement(volume, progress).measure();
}

}  // namespace trephine::mask
