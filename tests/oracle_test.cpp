// SPDX-License-Identifier: GPL-3.0-or-later
// Our filters beside ITK's: what both compute must be the same, to the tolerance that each test states.
#include <gtest/gtest.h>
#include <itkAffineTransform.h>
#include <itkConnectedComponentImageFilter.h>
#include <itkDiscreteGaussianImageFilter.h>
#include <itkNrrdImageIO.h>
#include <itkResampleImageFilter.h>
#include <itkSignedMaurerDistanceMapImageFilter.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>

#include "base/splitmix64.h"
#include "grid/nrrd.h"
#include "itk/program/itk_image.h"
#include "itk/registration.h"
#include "mask/bits.h"
#include "mask/filters.h"
#include "oracle_image_io.h"
#include "scratch_folder.h"

using namespace trephine;
using namespace trephine::mask;
using namespace trephine::grid;

namespace {

using Bytes = ::itk::Image<unsigned char, 3>;

double random_unit(std::uint64_t seed, std::uint64_t n) {
  return unit_of_bits(splitmix64_mixed(seed * 1000003 + n * splitmix64_step));
}

Lattice lattice_of_test() {
  Lattice l;
  l.size = {90, 70, 61};
  l.spacing_mm = {0.5, 0.7, 1.25};
  l.origin_mm = {-10, 20, 5};
  const double c = 0.8, s = 0.6;
  l.direction = {{Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}}};
  return l;
}

// Noise that was smoothed a little, so that there are blobs.
Grid<float> blobs(std::uint64_t seed) {
  Grid<float> g(lattice_of_test());
  for (std::size_t n = 0; n < g.voxels.size(); ++n) g.voxels[n] = static_cast<float>(random_unit(seed, n) - 0.5);
  gaussian(g, 0.8);
  return g;
}

BitMask mask_above(const Grid<float>& g, float value) {
  BitMask mask(g);
  for (int k = 0; k < g.size[2]; ++k)
    for (int j = 0; j < g.size[1]; ++j)
      for (int i = 0; i < g.size[0]; ++i)
        if (g.at(i, j, k) > value) mask.set(i, j, k);
  return mask;
}

Bytes::Pointer image_of_mask(const BitMask& mask) {
  const Lattice& l = mask.lattice();
  auto image = Bytes::New();
  Bytes::RegionType region;
  Bytes::SpacingType spacing;
  for (unsigned a = 0; a < 3; ++a) {
    region.SetSize(a, static_cast<::itk::SizeValueType>(l.size[a]));
    spacing[a] = l.spacing_mm[static_cast<int>(a)];
  }
  image->SetRegions(region);
  image->SetSpacing(spacing);
  image->Allocate();
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) image->GetBufferPointer()[l.index(i, j, k)] = mask.get(i, j, k);
  return image;
}

// Runs both and says how long each took.
template <class Own, class Other>
void timed(const char* what, Own&& own, Other&& other) {
  const auto seconds = [](auto&& f) {
    const auto start = std::chrono::steady_clock::now();
    f();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const double ours = seconds(own), itk = seconds(other);
  std::printf("%s: %.1f ms, ITK %.1f ms\n", what, 1000 * ours, 1000 * itk);
}

}  // namespace

TEST(Oracle, ComponentsAreItks) {
  for (const bool diagonal : {false, true})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const BitMask mask = mask_above(blobs(seed), 0.03f);
      auto filter = ::itk::ConnectedComponentImageFilter<Bytes, ::itk::Image<unsigned, 3>>::New();
      filter->SetInput(image_of_mask(mask));
      filter->SetFullyConnected(diagonal);
      Components own;
      timed(
          "components", [&] { own = components(mask, diagonal); }, [&] { filter->Update(); });
      ASSERT_EQ(own.list.size(), filter->GetObjectCount());
      std::map<unsigned, int> own_of;
      for_each_voxel(own, [&](int c, int i, int j, int k) {
        const unsigned label = filter->GetOutput()->GetBufferPointer()[mask.lattice().index(i, j, k)];
        ASSERT_NE(label, 0u);
        ASSERT_EQ(own_of.emplace(label, c).first->second, c);
      });
      EXPECT_EQ(own_of.size(), own.list.size());
    }
}

TEST(Oracle, DistancesAndBallsAreItks) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const BitMask mask = mask_above(blobs(seed), 0.16f);
    ASSERT_TRUE(mask.any());
    auto filter = ::itk::SignedMaurerDistanceMapImageFilter<Bytes, trephine::itk::Image>::New();
    filter->SetInput(image_of_mask(mask));
    filter->SetUseImageSpacing(true);
    filter->SetSquaredDistance(false);
    Grid<float> own;
    timed(
        "distance", [&] { own = distance_mm(mask); }, [&] { filter->Update(); });
    const float* itk = filter->GetOutput()->GetBufferPointer();
    BitMask ball = dilated(mask, 2.1);
    const Lattice& l = mask.lattice();
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const double d = std::max(0.0f, itk[l.index(i, j, k)]);
          ASSERT_NEAR(own.at(i, j, k), d, 1e-4) << i << " " << j << " " << k;
          if (std::fabs(d - 2.1) > 1e-4) {
            ASSERT_EQ(ball.get(i, j, k), d < 2.1) << d;
          }
        }
  }
}

// ITK takes Lindeberg's discrete kernel, of the same variance, and does not cut it at 3 sigma: the same on what is
// smooth beside the voxels.
TEST(Oracle, GaussianIsItksToOnePercent) {
  Grid<float> own = blobs(7);
  gaussian(own, 2);
  const auto [low, high] = std::minmax_element(own.voxels.begin(), own.voxels.end());
  const float from = *low, scale = 1000 / (*high - *low);
  for (float& v : own.voxels) v = (v - from) * scale;
  const Grid<float> input = own;
  auto filter = ::itk::DiscreteGaussianImageFilter<trephine::itk::Image, trephine::itk::Image>::New();
  filter->SetInput(trephine::itk::image_of(input));
  filter->SetVariance(1.5 * 1.5);
  filter->SetMaximumError(0.001);
  filter->SetMaximumKernelWidth(64);
  filter->SetUseImageSpacing(true);
  timed(
      "Gaussian", [&] { gaussian(own, 1.5); }, [&] { filter->Update(); });
  const float* itk = filter->GetOutput()->GetBufferPointer();
  double worst = 0;
  for (std::size_t n = 0; n < own.voxels.size(); ++n)
    worst = std::max(worst, std::fabs(double(own.voxels[n]) - itk[n]));
  EXPECT_LT(worst, 10) << "of values from 0 to 1000";
}

TEST(Oracle, ResamplingIsItks) {
  const Grid<float> input = blobs(4);
  const trephine::itk::LinearMap map =
      trephine::itk::rigid_map({12, -7, 30}, {3, -2, 4}, input.to_world_mm({45, 35, 30}));
  Lattice to;
  to.size = {60, 64, 70};
  to.spacing_mm = {0.8, 0.6, 0.9};
  to.origin_mm = input.to_world_mm({5, 0, 0});
  auto transform = ::itk::AffineTransform<double, 3>::New();
  ::itk::AffineTransform<double, 3>::MatrixType matrix;
  ::itk::AffineTransform<double, 3>::OutputVectorType offset;
  trephine::itk::Image::SizeType size;
  trephine::itk::Image::SpacingType spacing;
  trephine::itk::Image::PointType origin;
  for (unsigned r = 0; r < 3; ++r) {
    for (unsigned c = 0; c < 3; ++c) matrix(r, c) = map.matrix.column[c][static_cast<int>(r)];
    offset[r] = map.offset_mm[static_cast<int>(r)];
    size[r] = static_cast<::itk::SizeValueType>(to.size[r]);
    spacing[r] = to.spacing_mm[static_cast<int>(r)];
    origin[r] = to.origin_mm[static_cast<int>(r)];
  }
  transform->SetMatrix(matrix);
  transform->SetOffset(offset);
  auto filter = ::itk::ResampleImageFilter<trephine::itk::Image, trephine::itk::Image>::New();
  filter->SetInput(trephine::itk::image_of(input));
  filter->SetTransform(transform);
  filter->SetSize(size);
  filter->SetOutputSpacing(spacing);
  filter->SetOutputOrigin(origin);
  filter->SetDefaultPixelValue(-9);
  HuVolume own;
  timed(
      "resampling", [&] { own = trephine::itk::resample_onto(HuVolume(input), to, map, -9); },
      [&] { filter->Update(); });
  const auto& grid = std::get<Grid<float>>(own);
  const float* itk = filter->GetOutput()->GetBufferPointer();
  std::size_t compared = 0, edges = 0;
  for (std::size_t n = 0; n < grid.voxels.size(); ++n) {
    edges += (grid.voxels[n] == -9) != (itk[n] == -9);
    if (grid.voxels[n] == -9 || itk[n] == -9) continue;
    ASSERT_NEAR(grid.voxels[n], itk[n], 1e-5);
    ++compared;
  }
  EXPECT_GT(compared, grid.voxels.size() / 5);
  EXPECT_LT(edges, 20u) << "places that lie on the last half voxel's edge";
}

TEST(Oracle, ItkReadsOurNrrd) {
  const Grid<float> g = blobs(5);
  const ScratchFolder folder;
  for (const NrrdEncoding encoding : {NrrdEncoding::raw, NrrdEncoding::gzip}) {
    const auto file = folder.path() / "f.nrrd";
    write_nrrd(file, Field(g), {}, encoding);
    expect_itk_reads<::itk::NrrdImageIO>(file, g, 1e-12);
  }
}
