// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "drill/live_surface.h"
#include "render/drawn_surface.h"
#include "scene/view_params.h"

namespace trephine::render {

/// What is drawn of a brick, as it lies in the graphics memory. Positions and normals are along the lattice's axes.
struct DrawnBrick {
  std::vector<scene::SceneVertex> vertices;
  std::vector<std::uint32_t> indices;
};

/// A shape's surface that follows while the shape is cut, made and kept where it is drawn: the triangles of
/// drill/live_surface.h, by whichever maker. In the thread of the context that was current when it was made.
class SurfaceMaker : public DrawnSurface {
 public:
  /// Looks at the marked bricks, and makes those anew that read a changed voxel. Returns how many.
  virtual std::size_t update(const std::vector<std::size_t>& marked) = 0;
  /// Makes these bricks anew, whatever changed.
  virtual void make(const std::vector<std::size_t>& bricks) = 0;
  /// For tests: waits for the driver.
  virtual DrawnBrick read(std::size_t brick) const = 0;
  virtual const drill::ShadowVolume& shadow() const = 0;
};

/// The processor makes the triangles, and they are uploaded. `volume` must outlive it; its first voxel lies at
/// origin_mm - centre_mm.
std::unique_ptr<SurfaceMaker> processor_maker(const voxel::HapticVolume& volume, int shape, Vec3 centre_mm);

/// Room that a compute_maker() keeps for bricks that are made anew, before it makes the whole surface again.
struct ComputeRoom {
  std::size_t bricks = 256, slots = 4096;
};
/// The graphics card makes them (section 6.3 of the dissertation): only voxels that changed are uploaded. A work group
/// of a compute shader makes a brick, straight into the buffers that indirect draws read; nothing is read back but,
/// once in some 256 bricks, how full they are. Throws Error 74 where the volume is too large for a texture, or the
/// surface for a storage buffer.
std::unique_ptr<SurfaceMaker> compute_maker(const voxel::HapticVolume& volume, int shape, Vec3 centre_mm,
                                            const ComputeRoom& room = {});

/// Which was taken, and where both were measured, how long each took for the bricks of a burr (ms, the best of five).
struct MakerChoice {
  bool graphics = false;
  double processor_ms = 0, graphics_ms = 0;
  std::string text() const;
};
/// The maker that is wanted; for SurfaceBy::measured the faster one, measured here and now, except that where the
/// processor draws (`software`) it makes the triangles as well.
std::unique_ptr<SurfaceMaker> wanted_maker(scene::ViewParams::SurfaceBy by, bool software,
                                           const voxel::HapticVolume& volume, int shape, Vec3 centre_mm,
                                           MakerChoice& choice);

}  // namespace trephine::render
