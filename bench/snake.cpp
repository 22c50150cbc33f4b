// SPDX-License-Identifier: GPL-3.0-or-later
// The snake beside itk::ThresholdSegmentationLevelSetImageFilter and itk::ParallelSparseFieldLevelSetImageFilter, on
// the brain of a synthetic head: the same region, speed, start and weights for all; voxels are cubes, so that ITK's
// unit, the voxel, is ours but for a factor. ITK's filters are given its speed as the feature image of their threshold
// function, which from 0 up is the identity.
//
//   bench_snake [ITERATIONS] [REPETITIONS] [THREADS]     in turn; the least seconds count
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "phantom/phantom.h"
#include "segmentation/snake.h"
#include "segmentation/speed_image.h"
#ifdef BENCH_ITK
#include <itkImage.h>
#include <itkParallelSparseFieldLevelSetImageFilter.h>
#include <itkThresholdSegmentationLevelSetFunction.h>
#include <itkThresholdSegmentationLevelSetImageFilter.h>
#endif

namespace {

using namespace trephine;

constexpr double voxel_mm = 0.9;
constexpr double curvature_mm = 0.2;

struct Cost {
  double wall = 1e9, cpu = 0;
  int iterations = 0;
  grid::Field field;
};

double cpu_seconds() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  return double(u.ru_utime.tv_sec) + 1e-6 * double(u.ru_utime.tv_usec);
}

template <class F>
void measure(Cost& best, F&& f) {
  const double cpu = cpu_seconds();
  const auto start = std::chrono::steady_clock::now();
  Cost c;
  c.field = f(c.iterations);
  c.wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  c.cpu = cpu_seconds() - cpu;
  if (c.wall < best.wall) best = std::move(c);
}

double dice(const grid::Field& a, const grid::Field& b) {
  const grid::Field c = grid::fit(b, static_cast<const grid::Lattice&>(a), -1.f);
  std::size_t n = 0, m = 0, both = 0;
  for (std::size_t v = 0; v < a.count(); ++v) {
    n += a.voxels[v] > 0;
    m += c.voxels[v] > 0;
    both += a.voxels[v] > 0 && c.voxels[v] > 0;
  }
  return 2.0 * double(both) / double(n + m);
}

#ifdef BENCH_ITK
using Image = ::itk::Image<float, 3>;
using Function = ::itk::ThresholdSegmentationLevelSetFunction<Image, Image>;

Image::Pointer itk_image(const grid::Field& field, float sign) {
  auto image = Image::New();
  image->SetRegions(
      Image::RegionType(Image::SizeType{{Image::SizeValueType(field.size[0]), Image::SizeValueType(field.size[1]),
                                         Image::SizeValueType(field.size[2])}}));
  image->Allocate();
  for (std::size_t v = 0; v < field.count(); ++v) image->GetBufferPointer()[v] = sign * field.voxels[v];
  return image;
}

/// ITK's are negative inside.
grid::Field field_of(const Image* image, const grid::Lattice& lattice) {
  grid::Field field(lattice);
  for (std::size_t v = 0; v < field.count(); ++v) field.voxels[v] = -image->GetBufferPointer()[v];
  return field;
}

grid::Field itk_threshold(const grid::Field& speed, const grid::Field& start, int iterations, int& done) {
  auto filter = ::itk::ThresholdSegmentationLevelSetImageFilter<Image, Image>::New();
  filter->SetInput(itk_image(start, -1));
  filter->SetFeatureImage(itk_image(speed, 1));
  filter->SetLowerThreshold(0);
  filter->SetUpperThreshold(10);
  filter->SetEdgeWeight(0);
  filter->SetPropagationScaling(1);
  filter->SetCurvatureScaling(float(curvature_mm / voxel_mm));
  filter->SetAdvectionScaling(0);
  filter->SetIsoSurfaceValue(0);
  filter->SetMaximumRMSError(0);
  filter->SetNumberOfIterations(unsigned(iterations));
  filter->Update();
  done = int(filter->GetElapsedIterations());
  return field_of(filter->GetOutput(), speed);
}

grid::Field itk_parallel(const grid::Field& speed, const grid::Field& start, int iterations, int& done) {
  auto function = Function::New();
  function->SetFeatureImage(itk_image(speed, 1));
  function->SetLowerThreshold(0);
  function->SetUpperThreshold(10);
  function->SetEdgeWeight(0);
  function->Initialize(::itk::Size<3>{{1, 1, 1}});  // sets the weights to its own: before ours
  function->SetPropagationWeight(1);
  function->SetCurvatureWeight(float(curvature_mm / voxel_mm));
  function->SetAdvectionWeight(0);
  function->AllocateSpeedImage();
  function->CalculateSpeedImage();
  auto filter = ::itk::ParallelSparseFieldLevelSetImageFilter<Image, Image>::New();
  filter->SetInput(itk_image(start, -1));
  filter->SetDifferenceFunction(function);
  filter->SetIsoSurfaceValue(0);
  filter->SetMaximumRMSError(0);
  filter->SetNumberOfIterations(unsigned(iterations));
  filter->SetNumberOfWorkUnits(unsigned(thread_count()));
  filter->Update();
  done = int(filter->GetElapsedIterations());
  return field_of(filter->GetOutput(), speed);
}
#endif

grid::Field ours(const grid::Field& speed, const grid::Field& start, segmentation::SnakeParams params, int& done) {
  auto made = segmentation::evolve_snake(speed, start, params);
  done = int(made.result.iterations_count);
  return std::move(made.value);
}

}  // namespace

int main(int argc, char** argv) {
  const int iterations = argc > 1 ? std::atoi(argv[1]) : 300, repetitions = argc > 2 ? std::atoi(argv[2]) : 3;
  set_thread_count(argc > 3 ? std::atoi(argv[3]) : 2);
  phantom::HeadParams head;
  head.level = phantom::Level::simple;
  phantom::ScanParams scan;
  scan.columns_count = 200;
  scan.rows_count = 240;
  scan.slices_count = 120;
  scan.pixel_mm = scan.slice_step_mm = scan.slice_thickness_mm = voxel_mm;
  scan.centre_mm = {0, -5, 55};
  const grid::HuVolume volume = phantom::volume_of(phantom::scan(phantom::Head(head), scan));
  segmentation::PresegmentParams window;
  window.lower_hu = 15;
  window.upper_hu = 75;
  window.smoothing_sigma_mm = 1;
  const grid::Field speed = segmentation::presegment(volume, {}, window).value;
  grid::Field start(static_cast<const grid::Lattice&>(speed));
  for (int k = 0; k < start.size[2]; ++k)
    for (int j = 0; j < start.size[1]; ++j)
      for (int i = 0; i < start.size[0]; ++i) {
        const Vec3 p = start.to_world_mm({double(i), double(j), double(k)}) - Vec3{0, -5, 60};
        start.at(i, j, k) = float((1 - norm({p.x / 45, p.y / 60, p.z / 40})) * 45 / voxel_mm);
      }

  segmentation::SnakeParams all;
  all.curvature = curvature_mm;
  all.max_iterations_count = iterations;
  all.coarse_levels_count = 0;
  all.min_change_mm = 0;
  segmentation::SnakeParams usual;
  usual.curvature = curvature_mm;
  usual.max_iterations_count = iterations;
  Cost full, converged, threshold, parallel;
  for (int i = 0; i < repetitions; ++i) {
    measure(converged, [&](int& done) { return ours(speed, start, usual, done); });
    measure(full, [&](int& done) { return ours(speed, start, all, done); });
#ifdef BENCH_ITK
    measure(parallel, [&](int& done) { return itk_parallel(speed, start, iterations, done); });
    measure(threshold, [&](int& done) { return itk_threshold(speed, start, iterations, done); });
#endif
  }
  std::printf("%d x %d x %d voxels, %d threads\n", speed.size[0], speed.size[1], speed.size[2], thread_count());
  const auto line = [&](const char* name, const Cost& c) {
    std::size_t inside = 0;
    for (const float f : c.field.voxels) inside += f > 0;
    std::printf("%-44s %7.3f s  cpu %7.3f s  %4d iterations  %7.1f ml", name, c.wall, c.cpu, c.iterations,
                double(inside) * voxel_mm * voxel_mm * voxel_mm / 1000);
    if (threshold.wall < 1e9)
      std::printf("  x%.1f x%.1f  Dice %.4f %.4f", threshold.wall / c.wall, parallel.wall / c.wall,
                  dice(c.field, threshold.field), dice(c.field, parallel.field));
    std::printf("\n");
  };
  if (threshold.wall < 1e9) {
    std::printf("(faster than the threshold and the parallel filter; Dice with each)\n");
    line("ITK threshold segmentation", threshold);
    line("ITK parallel sparse field", parallel);
  }
  line("trephine, all iterations at one resolution", full);
  line("trephine, as by default", converged);
  return 0;
}
