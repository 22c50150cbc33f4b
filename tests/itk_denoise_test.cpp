// SPDX-License-Identifier: GPL-3.0-or-later
// Filters against what they must leave: edges where they are, everything beyond the box, and the same bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/pi.h"
#include "itk/denoise.h"
#include "itk/non_local_means.h"
#include "phantom/random.h"
#include "report_of.h"

using namespace trephine;

namespace {

constexpr double edge_mm = 3.3, radius_mm = 14;

// A ball of CSF in brain, with noise: 8 and 37 HU, blurred over about a millimetre.
grid::Grid<float> noisy_ball(double noise_hu) {
  grid::Lattice l;
  l.size = {44, 40, 36};
  l.spacing_mm = {1, 1, 1.2};
  l.origin_mm = {-21.5, -19.5, -21};
  grid::Grid<float> g(l);
  for (std::size_t n = 0; n < g.voxels.size(); ++n) {
    const int i = static_cast<int>(n % 44), j = static_cast<int>(n / 44 % 40), k = static_cast<int>(n / (44 * 40));
    const double outside = norm(g.to_world_mm({double(i), double(j), double(k)})) - radius_mm;
    float a, b;
    phantom::normal_pair(5, 6, n, a, b);
    g.voxels[n] = static_cast<float>(22.5 + 14.5 * std::tanh(outside / 0.8) + noise_hu * a);
  }
  return g;
}

// Radius of the ball that holds as much CSF as the volume does.
double radius_of(const grid::Grid<float>& g) {
  double volume = 0;
  for (std::size_t n = 0; n < g.voxels.size(); ++n) {
    const int i = static_cast<int>(n % 44), j = static_cast<int>(n / 44 % 40), k = static_cast<int>(n / (44 * 40));
    if (norm(g.to_world_mm({double(i), double(j), double(k)})) < radius_mm + edge_mm)
      volume += (37 - g.voxels[n]) / 29 * g.voxel_volume_mm3();
  }
  return std::cbrt(volume * 3 / (4 * pi));
}

double noise_within(const grid::Grid<float>& g) {
  double sum = 0, square = 0, count = 0;
  for (std::size_t n = 0; n < g.voxels.size(); ++n) {
    const int i = static_cast<int>(n % 44), j = static_cast<int>(n / 44 % 40), k = static_cast<int>(n / (44 * 40));
    if (norm(g.to_world_mm({double(i), double(j), double(k)})) > radius_mm - 4) continue;
    sum += g.voxels[n], square += double(g.voxels[n]) * g.voxels[n], count += 1;
  }
  return std::sqrt(square / count - sum / count * (sum / count));
}

grid::Grid<float> calm(const grid::Grid<float>& g, itk::DenoiseParams p) {
  Report report;
  return std::get<grid::Grid<float>>(value_of(report, itk::denoise(grid::HuVolume(g), nullptr, p)));
}

}  // namespace

TEST(Denoise, CalmsNoiseAndLeavesEdges) {
  const grid::Grid<float> noisy = noisy_ball(10), clean = noisy_ball(0);
  struct Case {
    itk::DenoiseMethod method;
    double sigma_mm, edge_hu, most_noise_hu;
  };
  for (const Case& c :
       {Case{itk::DenoiseMethod::curvature, 0.8, 60, 7}, Case{itk::DenoiseMethod::bilateral, 1.5, 40, 4},
        Case{itk::DenoiseMethod::median, 1.2, 60, 4}, Case{itk::DenoiseMethod::gaussian, 1, 60, 4},
        Case{itk::DenoiseMethod::non_local_means, 1, 20, 4}}) {
    const itk::DenoiseParams p{c.method, c.sigma_mm, c.edge_hu};
    EXPECT_NEAR(noise_within(noisy), 10, 0.5);
    EXPECT_LT(noise_within(calm(noisy, p)), c.most_noise_hu) << static_cast<int>(c.method);
    EXPECT_NEAR(radius_of(calm(clean, p)), radius_of(clean), 0.1) << static_cast<int>(c.method);
    EXPECT_NEAR(radius_of(calm(noisy, p)), radius_of(noisy), 0.1) << static_cast<int>(c.method);
  }
}

TEST(Denoise, LeavesWhatIsBeyondTheBox) {
  grid::Grid<std::int16_t> g(static_cast<const grid::Lattice&>(noisy_ball(0)));
  for (std::size_t n = 0; n < g.voxels.size(); ++n)
    g.voxels[n] = static_cast<std::int16_t>(100 * phantom::uniform(1, 1, n));
  grid::Field within(g, -1.0f);
  within.at(20, 20, 18) = 1;
  Report report;
  const itk::DenoiseParams p{itk::DenoiseMethod::gaussian, 1, 60};
  const auto out = std::get<grid::Grid<std::int16_t>>(value_of(report, itk::denoise(grid::HuVolume(g), &within, p)));
  EXPECT_EQ(std::get<std::int64_t>(*report.find("voxels_count")), 9 * 9 * 9);
  for (int k = 0; k < g.size[2]; ++k)
    for (int j = 0; j < g.size[1]; ++j)
      for (int i = 0; i < g.size[0]; ++i) {
        const bool inside = std::abs(i - 20) <= 4 && std::abs(j - 20) <= 4 && std::abs(k - 18) <= 4;
        if (!inside) {
          ASSERT_EQ(out.at(i, j, k), g.at(i, j, k));
        }
      }
  EXPECT_NE(out.at(20, 20, 18), g.at(20, 20, 18));
  within.at(20, 20, 18) = -1;
  EXPECT_THROW(value_of(report, itk::denoise(grid::HuVolume(g), &within, p)), Error);
}

TEST(Denoise, DoesNotDependOnThreads) {
  const grid::Grid<float> noisy = noisy_ball(10);
  for (const itk::DenoiseMethod m :
       {itk::DenoiseMethod::curvature, itk::DenoiseMethod::bilateral, itk::DenoiseMethod::median,
        itk::DenoiseMethod::gaussian, itk::DenoiseMethod::non_local_means}) {
    set_thread_count(1);
    const grid::Grid<float> one = calm(noisy, {m, 1, 60});
    for (const int threads : {2, 8}) {
      set_thread_count(threads);
      EXPECT_TRUE(calm(noisy, {m, 1, 60}) == one) << static_cast<int>(m) << ", " << threads;
    }
  }
  set_thread_count(0);
}

// Against the mean written out as its definition says it.
TEST(Denoise, NonLocalMeansAreWhatTheyAreDefinedAs) {
  const grid::Grid<float> noisy = noisy_ball(10);
  const itk::NonLocalMeans p{3, 1, 10};
  const grid::Grid<float> own = itk::non_local_means(noisy, p);
  const auto at = [&](int i, int j, int k) {
    return double(noisy.at(std::clamp(i, 0, 43), std::clamp(j, 0, 39), std::clamp(k, 0, 35)));
  };
  for (const auto& v : {std::array<int, 3>{20, 20, 18}, std::array<int, 3>{0, 0, 0}, std::array<int, 3>{43, 20, 7}}) {
    double sum = 0, weight = 0;
    for (int c = -3; c <= 3; ++c)
      for (int b = -3; b <= 3; ++b)
        for (int a = -3; a <= 3; ++a) {
          if (a * a + b * b + 1.44 * c * c > 9) continue;
          double d = 0;
          for (int z = -1; z <= 1; ++z)
            for (int y = -1; y <= 1; ++y)
              for (int x = -1; x <= 1; ++x) {
                const double e = at(v[0] + x, v[1] + y, v[2] + z) - at(v[0] + a + x, v[1] + b + y, v[2] + c + z);
                d += e * e / 27;
              }
          const double t = std::max(0.0, d / 100 - 2), w = t < 8 ? std::pow(1 - t / 8, 8) : 0;
          sum += w * at(v[0] + a, v[1] + b, v[2] + c);
          weight += w;
        }
    EXPECT_NEAR(own.at(v[0], v[1], v[2]), sum / weight, 1e-3);
  }
  EXPECT_EQ(itk::patches_compared(noisy, p), 88u);
}
