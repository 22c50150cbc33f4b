// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <itkImage.h>

#include "grid/grid.h"

namespace trephine::itk {

using Image = ::itk::Image<float, 3>;

/// The grid as an image of ITK, with the same voxels in the same memory: the grid must outlive it, and nothing may
/// write to the image.
inline Image::Pointer image_of(const grid::Grid<float>& grid) {
  auto image = Image::New();
  Image::RegionType region;
  Image::SpacingType spacing;
  Image::PointType origin;
  Image::DirectionType direction;
  for (unsigned a = 0; a < 3; ++a) {
    region.SetSize(a, static_cast<::itk::SizeValueType>(grid.size[a]));
    spacing[a] = grid.spacing_mm[static_cast<int>(a)];
    origin[a] = grid.origin_mm[static_cast<int>(a)];
    for (unsigned b = 0; b < 3; ++b) direction(a, b) = grid.direction.column[b][static_cast<int>(a)];
  }
  image->SetRegions(region);
  image->SetSpacing(spacing);
  image->SetOrigin(origin);
  image->SetDirection(direction);
  image->GetPixelContainer()->SetImportPointer(const_cast<float*>(grid.voxels.data()), grid.voxels.size(), false);
  return image;
}

}  // namespace trephine::itk
