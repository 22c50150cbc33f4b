// SPDX-License-Identifier: GPL-3.0-or-later
#include <itkBilateralImageFilter.h>
#include <itkCurvatureAnisotropicDiffusionImageFilter.h>
#include <itkMedianImageFilter.h>
#include <itkSmoothingRecursiveGaussianImageFilter.h>

#include <cmath>

#include "base/child.h"
#include "base/error.h"
#include "base/parallel.h"
#include "itk/denoise.h"
#include "itk/denoise_message.h"
#include "itk/itk_child.h"
#include "itk_image.h"

namespace trephine::itk {
namespace {

using Filter = ::itk::ImageToImageFilter<Image, Image>;

Filter::Pointer filter_of(const DenoiseTask& task, const grid::Lattice& lattice) {
  switch (static_cast<DenoiseMethod>(task.method)) {
    case DenoiseMethod::curvature: {
      auto f = ::itk::CurvatureAnisotropicDiffusionImageFilter<Image, Image>::New();
      f->SetUseImageSpacing(true);
      f->SetTimeStep(task.step);
      f->SetNumberOfIterations(static_cast<::itk::IdentifierType>(task.iterations));
      // The edge in HU a mm is ours, and not a multiple of what the image's mean gradient happens to be.
      f->SetConductanceParameter(1);
      f->SetFixedAverageGradientMagnitude(task.edge_hu / task.sigma_mm);
      return f.GetPointer();
    }
    case DenoiseMethod::bilateral: {
      auto f = ::itk::BilateralImageFilter<Image, Image>::New();
      f->SetDomainSigma(task.sigma_mm);
      f->SetRangeSigma(task.edge_hu);
      return f.GetPointer();
    }
    case DenoiseMethod::median: {
      auto f = ::itk::MedianImageFilter<Image, Image>::New();
      Image::SizeType radius;
      for (unsigned a = 0; a < 3; ++a)
        radius[a] =
            static_cast<::itk::SizeValueType>(std::lround(task.sigma_mm / lattice.spacing_mm[static_cast<int>(a)]));
      f->SetRadius(radius);
      return f.GetPointer();
    }
    case DenoiseMethod::non_local_means:  // ours (non_local_means.h)
      break;
    case DenoiseMethod::gaussian: {
      auto f = ::itk::SmoothingRecursiveGaussianImageFilter<Image, Image>::New();
      f->SetSigma(task.sigma_mm);
      return f.GetPointer();
    }
  }
  throw Error(ExitCode::internal, "", denoise_worker_name, "no such method");
}

const ChildWorker worker(denoise_worker_name, [](ChildRequest& request) {
  // Every voxel is computed by itself, so these filters may have all threads.
  ::itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(static_cast<::itk::ThreadIdType>(thread_count()));
  ::itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(static_cast<::itk::ThreadIdType>(thread_count()));
  MessageReader in = itk_child::opened(denoise_worker_name, request.request());
  const auto task = in.value<DenoiseTask>();
  const grid::Grid<float> grid = itk_child::take_grid(in, denoise_worker_name);
  const Filter::Pointer filter = filter_of(task, grid);
  filter->SetInput(image_of(grid));
  filter->Update();
  const Image& out = *filter->GetOutput();
  const std::size_t count = out.GetBufferedRegion().GetNumberOfPixels();
  if (count != grid.voxels.size()) throw Error(ExitCode::internal, "", denoise_worker_name, "another number of voxels");
  request.write(out.GetBufferPointer(), count * sizeof(float));
});

}  // namespace
}  // namespace trephine::itk
