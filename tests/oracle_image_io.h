// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>
#include <itkImageIOBase.h>

#include <filesystem>
#include <vector>

#include "grid/grid.h"

namespace trephine {

/// Reads the file with a reader of ITK, and compares size, spacing, place and directions with the grid's, and the
/// voxels, whose component is checked. `ras`: ITK hands over what counts to the right and to the front.
template <class IO, class T>
void expect_itk_reads(const std::filesystem::path& file, const grid::Grid<T>& grid, double tolerance,
                      bool ras = false) {
  auto io = IO::New();
  io->SetFileName(file.string());
  ASSERT_TRUE(io->CanReadFile(file.c_str()));
  io->ReadImageInformation();
  ::itk::ImageIORegion region(3);
  for (unsigned a = 0; a < 3; ++a) {
    region.SetSize(a, io->GetDimensions(a));
    ASSERT_EQ(io->GetDimensions(a), static_cast<unsigned>(grid.size[a]));
    EXPECT_NEAR(io->GetSpacing(a), grid.spacing_mm[static_cast<int>(a)], tolerance);
    EXPECT_NEAR(io->GetOrigin(a), (ras && a < 2 ? -1 : 1) * grid.origin_mm[static_cast<int>(a)], 10 * tolerance);
    for (unsigned b = 0; b < 3; ++b)
      EXPECT_NEAR(io->GetDirection(a)[b], (ras && b < 2 ? -1 : 1) * grid.direction.column[a][static_cast<int>(b)],
                  tolerance);
  }
  io->SetIORegion(region);
  ASSERT_EQ(io->GetComponentType(), ::itk::ImageIOBase::MapPixelType<T>::CType);
  std::vector<T> voxels(grid.voxels.size());
  io->Read(voxels.data());
  EXPECT_EQ(voxels, grid.voxels);
}

}  // namespace trephine
