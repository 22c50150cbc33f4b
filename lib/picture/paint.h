// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "picture/occlusion.h"
#include "picture/raster.h"
#include "picture/shade.h"

namespace trephine::picture::detail {

/// What a picture is made of; the painters share it.
struct Scene {
  Scene(const std::vector<SurfaceView>& s, const RenderParams& p) : surfaces(s), params(p) {}
  const std::vector<SurfaceView>& surfaces;
  const RenderParams& params;
  Camera camera;
  int samples = 1;  ///< of a pixel, in x and in y
  std::vector<Projected> projected;
  std::vector<Light> colours;
  Light warning{};
  // The clip plane in camera coordinates: dot(normal, p) = offset.
  Vec3 plane_normal;
  double plane_offset = 0;
  std::vector<Light> background;  ///< of each row
};

/// Sums over the samples of a pixel: the light that occlusion darkens (of opaque surfaces), and the light that it does
/// not.
struct Pixels {
  std::vector<Light> open, shadowed;
  std::vector<std::uint8_t> painted;  ///< whether anything but the background is seen
  SurfaceBuffer buffer;
};

/// Paints one band of rows after the other.
class BandPainter {
 public:
  BandPainter(const Scene& scene, Pixels& pixels);
  /// The rows of pixels of the band whose first is y, as project() parted them.
  void paint(int band);

 private:
  // What is seen of one surface at one sample.
  struct Fragment {
    float depth;
    int surface;
    std::uint32_t triangle;
    bool inner, cap;
  };
  // A fragment that is lit, once for all samples of its pixel that see the same.
  struct Hit {
    Fragment of;
    bool opaque;
  };

  void paint_row(int y, int begin);
  bool meets(std::size_t at) const;
  void paint_sample(int x, int y, std::size_t at);
  void paint_alone(int x, int y, std::size_t at);
  void collect(int x, int y, std::size_t at);
  std::uint32_t hit_of(const Fragment& f, int x, int y);
  void blend_row(int y);
  bool is_warning(const Fragment& f) const { return f.inner && !f.cap && !s_.params.clip; }

  static constexpr std::uint32_t background = 0xffffffffu;

  const Scene& s_;
  Pixels& pixels_;
  std::vector<Layer> layers_;
  std::vector<std::size_t> seen_;  // those that are not empty
  std::vector<Fragment> found_;    // at a sample, from near to far
  // Of a row of pixels: its hits; those of each sample of each pixel in turn, which end at an opaque one or with the
  // background; and the pixels that have any.
  std::vector<Hit> hits_;
  LitPoints points_;
  std::vector<std::uint32_t> order_;
  std::vector<int> painted_;
  std::size_t first_of_pixel_ = 0;  // of the hits
};

}  // namespace trephine::picture::detail
