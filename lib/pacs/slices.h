// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"
#include "surface/trimesh.h"

namespace trephine::pacs {

/// Parallel slices of one matrix: those of a scan as it was made, tilted and uneven ones too, or those of a volume.
/// Objects lie on them, and refer to the images on them where these are known.
struct SliceSet {
  int columns = 0, rows = 0;
  double dx_mm = 1, dy_mm = 1;
  Vec3 u{1, 0, 0}, v{0, 1, 0};  ///< orthonormal: direction of rising columns, and of rising rows
  double thickness_mm = 1;
  std::vector<Vec3> origins_mm;  ///< of each slice's first voxel; ascending along the normal

  struct Image {
    std::string instance_uid;
    int frame = 0;  ///< from 1, of an image of several frames; 0: of one
  };
  std::vector<Image> images;          ///< one for each slice, or empty: there is nothing to refer to
  std::string class_uid, series_uid;  ///< of the images

  Vec3 normal() const { return cross(u, v); }
  std::size_t pixels() const { return std::size_t(columns) * std::size_t(rows); }
  grid::Lattice lattice_of(std::size_t slice) const;
  /// The distance of neighbours where it is the same throughout, to 1 um; 0 where it is not.
  double uniform_step_mm() const;
};

/// The slices of a volume, along its third axis.
SliceSet slices_of(const grid::Lattice& lattice);

/// One bit a pixel, row by row, the first in the lowest bit, for each slice; empty where nothing lies on the slice.
using SliceBits = std::vector<std::string>;
/// The bits of one slice from one byte a pixel.
std::string packed(const std::vector<std::uint8_t>& pixels);

/// Which pixels' middles lie inside of a closed surface (surface/inside.h). Throws as voxelize_inside does.
SliceBits bits_inside(const surface::TriMesh& mesh, const SliceSet& slices, const Progress& progress = {});

/// A volume on a slice: a voxel as it is where a pixel's middle lies within 0.001 voxels of its middle, else
/// interpolated linearly, and `outside` beyond the outermost voxels' middles.
std::vector<std::int16_t> resampled_on(const grid::Grid<std::int16_t>& volume, const SliceSet& slices,
                                       std::size_t slice, std::int16_t outside);

}  // namespace trephine::pacs
