// SPDX-License-Identifier: GPL-3.0-or-later
#include "head/soft_tissue.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/pi.h"
#include "base/refusal.h"
#include "mask/filters.h"
#include "mask/scan_figures.h"
#include "mask/total_variation.h"

namespace trephine::head {
namespace {

constexpr int terms = 10;
using Terms = std::array<double, terms>;
constexpr double unit_mm = 70;     ///< of the quadratic's coordinates: half a head
constexpr double outlier_hu = 12;  ///< values farther from the fit are not tissue
constexpr double max_hu = 30;      ///< largest correction
constexpr double sample_mm = 4;    ///< distance of the voxels used for the fit
constexpr double extend_mm = 0.7;  ///< sigma of the mean for voxels beyond the known ones
constexpr int tv_iterations = 30;

Terms terms_of(Vec3 p) { return {1, p.x, p.y, p.z, p.x * p.x, p.y * p.y, p.z * p.z, p.x * p.y, p.x * p.z, p.y * p.z}; }

double value_of(const Terms& c, const Terms& t) {
  double v = 0;
  for (int i = 0; i < terms; ++i) v += c[i] * t[i];
  return v;
}

/// Of a symmetric, positive definite system.
Terms solved(const std::array<Terms, terms>& a, Terms b) {
  using Matrix = Eigen::Matrix<double, terms, terms, Eigen::RowMajor>;
  Eigen::Map<Eigen::Matrix<double, terms, 1>> x(b.data());
  x = Eigen::Map<const Matrix>(a.front().data()).ldlt().solve(x).eval();
  return b;
}

struct Sample {
  Terms at;
  double hu;
};

Terms fitted(const std::vector<Sample>& samples, double middle) {
  Terms fit{};
  fit[0] = middle;
  for (int round = 0; round < 25; ++round) {
    std::array<Terms, terms> a{};
    Terms b{};
    for (const Sample& s : samples) {
      const double e = (s.hu - value_of(fit, s.at)) / outlier_hu;
      if (std::abs(e) >= 1) continue;
      const double w = (1 - e * e) * (1 - e * e);  // Tukey's biweight
      for (int r = 0; r < terms; ++r) {
        b[r] += w * s.at[r] * (s.hu - middle);
        for (int c = 0; c < terms; ++c) a[r][c] += w * s.at[r] * s.at[c];
      }
    }
    // A small weight on zero slope, because a part of a head does not determine all terms.
    for (int r = 0; r < terms; ++r) a[r][r] += 1e-3 * double(samples.size()) * (r > 0) + 1e-9;
    fit = solved(a, b);
    fit[0] += middle;
  }
  return fit;
}

}  // namespace

TissueLevel level_tissue(grid::Grid<float>& hu, const mask::BitMask& known, const Progress& progress) {
  const grid::Lattice& l = hu;
  const grid::Grid<float> mean = mask::masked_gaussian(hu, known, 1.0, -1000, 0.02, progress);
  const Vec3 centre = l.to_world_mm({0.5 * (l.size[0] - 1), 0.5 * (l.size[1] - 1), 0.5 * (l.size[2] - 1)});
  const auto terms_at = [&](int i, int j, int k) {
    return terms_of((l.to_world_mm({double(i), double(j), double(k)}) - centre) / unit_mm);
  };
  int step[3];
  for (int a = 0; a < 3; ++a) step[a] = std::max(1, int(std::lround(sample_mm / l.spacing_mm[a])));
  std::vector<Sample> samples;
  std::vector<float> values;
  for (int k = step[2] / 2; k < l.size[2]; k += step[2])
    for (int j = step[1] / 2; j < l.size[1]; j += step[1])
      for (int i = step[0] / 2; i < l.size[0]; i += step[0])
        if (known.get(i, j, k)) {
          samples.push_back({terms_at(i, j, k), mean.at(i, j, k)});
          values.push_back(mean.at(i, j, k));
        }
  const double middle = mask::median(values, float(tissue_level_hu));
  TissueLevel level{middle, {}};
  if (samples.size() < 20 * terms) return level;
  const Terms fit = fitted(samples, middle);
  double least = 1e300, most = -1e300;
  for (const Sample& s : samples) {
    least = std::min(least, value_of(fit, s.at));
    most = std::max(most, value_of(fit, s.at));
  }
  level.tissue_slope_hu = most - least;
  parallel_for(0, l.size[2], 2, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < l.size[1]; ++j) {
        // Along a row the quadratic is one in the index.
        const double a = value_of(fit, terms_at(0, j, k)), b = value_of(fit, terms_at(1, j, k)),
                     c = value_of(fit, terms_at(2, j, k));
        const double second = 0.5 * (a + c) - b, first = b - a - second;
        float* row = &hu.at(0, j, k);
        for (int i = 0; i < l.size[0]; ++i)
          row[i] += float(std::clamp(tissue_level_hu - (a + i * (first + i * second)), -max_hu, max_hu));
      }
  });
  return level;
}

namespace {

constexpr double structure_mm3 = 8;               // a cube of 2 mm
constexpr double fine_mm = 1.0, coarse_mm = 2.5;  // sigma of the two means that tissue_noise compares
constexpr double max_smoothing_mm = 2;            // what is smoothed more has no ventricles left

/// Variance of the difference of two Gaussian means of white noise of density 1 that was smoothed before.
double variance_of_means(double smoothed_mm) {
  const double f = fine_mm * fine_mm + smoothed_mm * smoothed_mm, c = coarse_mm * coarse_mm + smoothed_mm * smoothed_mm;
  const auto overlap = [&](double a, double b) { return std::pow(2 * pi * (a + b), -1.5); };
  return overlap(f, f) + overlap(c, c) - 2 * overlap(f, c);
}

void check_cube_noise(double hu, double smoothed_mm) {
  constexpr double max_hu = 23;  // 20 HU in slices of 3 mm are 15
  // Each stage measures noise on its own voxels, by up to a fifth differently.
  constexpr double clear_of_it = 0.75;
  if (!(hu > max_hu)) return;
  const std::string what = fmt::format(
      "noise of {:.0f} HU in a cube of 2 mm, at most {:.0f}: CSF and tissue cannot be distinguished", hu, max_hu);
  const Remedy series{"take a series of a smoother kernel or of thicker slices (`import --list` shows all)"};
  const double s = smoothing_for_noise(hu, smoothed_mm, clear_of_it * max_hu);
  if (!(s <= max_smoothing_mm)) throw refusal("volume", what, series);
  const std::string sigma_mm = fmt::format("{:.1f}", s);
  throw refusal("volume", what,
                {series.text + (", or set `smoothing_sigma_mm` of the stages `brain` and `ventricles` to " + sigma_mm +
                                " (" + Setting{"smoothing_sigma_mm", sigma_mm, "brain.brain"} + " " +
                                Setting{"smoothing_sigma_mm", sigma_mm, "ventricles.ventricles"} +
                                "): narrow horns blur, and the class will be uncertain")});
}

}  // namespace

double smoothing_for_noise(double noise, double smoothed_mm, double wanted) {
  const double share = wanted / noise * std::sqrt(variance_of_means(smoothed_mm));
  for (int tenths = 1; tenths <= 50; ++tenths)
    if (const double s = 0.1 * tenths; s > smoothed_mm && std::sqrt(variance_of_means(s)) <= share) return s;
  return 1e9;
}

void check_noise(double noise, const grid::Lattice& lattice, double smoothed_mm) {
  check_cube_noise(noise / std::sqrt(std::max(structure_mm3, lattice.voxel_volume_mm3())), smoothed_mm);
}

void check_scan_noise(const grid::HuVolume& volume,
                      const std::function<mask::ScanFigures(const Progress& progress)>& measured,
                      const Progress& progress) {
  // In coarser voxels the tissue's own detail looks like noise.
  if (grid::lattice_of(volume).voxel_volume_mm3() > structure_mm3) return;
  const mask::ScanFigures scan = measured ? measured(progress) : mask::measure_scan(volume, progress);
  if (scan.known()) check_cube_noise(scan.cube_noise_hu, 0);
}

double tissue_noise(const grid::Grid<float>& hu, const mask::BitMask& known, const Progress& progress) {
  constexpr double specks_mm = 1.5, off_edges_mm = 6, near_hu = 10, to_sigma = 1.4826;
  const grid::Lattice& l = hu;
  // Strong noise takes single voxels out of what is known.
  const mask::BitMask deep = mask::eroded(mask::closed(known, specks_mm, progress), off_edges_mm, progress);
  const grid::Grid<float> fine = mask::masked_gaussian(hu, known, fine_mm, -1000, 0.02, progress),
                          coarse = mask::masked_gaussian(hu, known, coarse_mm, -1000, 0.02, progress);
  std::vector<float> centres, spread;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; j += 2)
      for (int i = j / 2 % 2; i < l.size[0]; i += 2)
        if (deep.get(i, j, k)) centres.push_back(coarse.at(i, j, k));
  const float tissue = mask::median(centres, float(tissue_level_hu));
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; j += 2)
      for (int i = j / 2 % 2; i < l.size[0]; i += 2)
        if (deep.get(i, j, k) && std::abs(coarse.at(i, j, k) - tissue) < near_hu)
          spread.push_back(std::abs(fine.at(i, j, k) - coarse.at(i, j, k)));
  const double sigma = to_sigma * mask::median(spread, 0.f);
  return sigma / std::sqrt(variance_of_means(0));
}

SoftTissue soft_tissue(grid::Grid<float> hu, const mask::BitMask& known, double strength_ratio, float nowhere,
                       const Progress& progress) {
  const double noise = tissue_noise(hu, known, progress);
  mask::total_variation(hu, known, strength_ratio * noise, tv_iterations, progress);
  // Beside the known voxels, the mean of the known ones.
  const grid::Grid<float> beside = mask::masked_gaussian(hu, known, extend_mm, nowhere, 0.02, progress);
  parallel_for(0, hu.size[2], 4, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < hu.size[1]; ++j)
        for (int i = 0; i < hu.size[0]; ++i)
          if (!known.get(i, j, k)) hu.at(i, j, k) = beside.at(i, j, k);
  });
  return {std::move(hu), noise};
}

}  // namespace trephine::head
