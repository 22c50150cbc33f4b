// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "cast/ray_cast.h"
#include "render/gl_object.h"
#include "render/kept_fences.h"
#include "render/picture_targets.h"

namespace trephine::render {

/// A volume as rays see it, over the surfaces of a picture: cast/ray_cast.h in GLSL.
class CastPass {
 public:
  /// `voxels` must outlive it. Throws Error 74 where the graphics memory does not suffice or a side is too long.
  CastPass(const grid::Grid<std::int16_t>& voxels, cast::CastTable table);
  /// Shapes, which must outlive it.
  explicit CastPass(const cast::CastShapes& shapes);
  /// Of HU.
  void set_table(cast::CastTable table);
  /// Of the shapes, as they are now.
  void follow_opacities();
  bool is_of(const grid::Grid<std::int16_t>& voxels) const { return hu_ == &voxels; }
  bool is_of(const cast::CastShapes& shapes) const { return shapes_ == &shapes; }
  /// Voxels of the box have changed; what of it lies beyond the volume is left out.
  void follow(const grid::Box& changed);
  /// Over what the targets' frame shows. `ms` above 0: while anything moves, a cast has so many pixels that it takes
  /// about that long, and it becomes finer from picture to picture while nothing does; 0: each picture is whole.
  void draw(const PictureTargets& targets, KeptFences& kept, const scene::EyeView& eye, const scene::SceneState& state,
            int width, int height, double ms);
  std::size_t bytes() const;
  /// Of the last picture's sides, that share had rays of its own.
  double scale() const { return scale_; }

 private:
  /// What a cast is of; where that is the same, it is too.
  struct Sight {
    scene::EyeView eye;
    std::optional<scene::CutPlane> cut;
    std::optional<surface::Bounds> box;
    std::vector<double> opacity;
    Vec3 tip_mm, axis;
    bool tool = false;
    int width = 0, height = 0;
  };
  static bool same(const Sight& a, const Sight& b);
  void make_target(int width, int height);
  void cast(const PictureTargets& targets, KeptFences& kept, const Sight& sight, double step_mm);
  void lay_over(const PictureTargets& targets, KeptFences& kept, const Sight& sight);
  CastPass(const grid::Lattice& lattice, bool shapes);
  void upload_table(int width, int height, const cast::CastTable::Entry* entries);
  void upload_bricks();
  template <class Voxel, class Read>
  void upload_voxels(const grid::Box& box, GLenum layout, GLenum kind, const Read& read);

  const grid::Lattice& lattice_;
  const grid::Grid<std::int16_t>* hu_ = nullptr;  // it, or
  const cast::CastShapes* shapes_ = nullptr;      // these
  cast::CastTable table_;
  cast::CastBricks bricks_;
  GlProgram casting_, over_, depth_;
  GlObject empty_array_, voxels_texture_, bricks_texture_, table_texture_;
  GlObject frame_, colour_, hides_;
  int width_ = 0, height_ = 0;
  Sight sight_;
  bool changed_ = true;
  double scale_ = 0, moving_scale_ = 0.5;
};

}  // namespace trephine::render
