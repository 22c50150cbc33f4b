// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <bitset>
#include <map>

#include "render/cast_pass.h"
#include "render/drawn_planes.h"
#include "render/dust_texture.h"
#include "render/kept_fences.h"
#include "render/picture_targets.h"
#include "render/renderer.h"
#include "render/shaders.h"
#include "render/surface_buffer.h"
#include "render/surface_maker.h"
#include "render/tool_shadow.h"

namespace trephine::render {

// Shared by the sources of the renderer alone.
struct Renderer::Impl {
  Impl(const scene::SceneData& scene, const RenderQuality& quality);

  void make_noise();

  // renderer_theatre.cpp
  int theatre_parts(const scene::SceneState& state) const;  ///< shaders::SurfacePart of a surface in a theatre
  void set_theatre(const GlProgram& program) const;         ///< what is the same for all that it draws
  /// Of what is drawn next: only skin is draped; what lies beneath it, and drops, are wet.
  void set_tissue(bool skin, double wet) const;
  void draw_room(const scene::SceneState& state);

  // renderer_draw.cpp
  void draw(const scene::EyeView& eye, const scene::SceneState& state, int width, int height);
  // renderer_labels.cpp
  LabelPicture draw_labels(const scene::EyeView& eye, const scene::SceneState& state, int width, int height);
  // renderer_draw.cpp
  /// What is drawn from now on, until it is called again, is seen by that eye; `cut` away, or not.
  void begin_surface(const scene::EyeView& eye, const scene::SceneState& state, bool cut = true);
  /// Uses the program with these parts (shaders::SurfacePart), which `surface` is then.
  void surface_with(int parts);
  void draw_surface(std::size_t n, Sight::Faces faces, const std::vector<std::uint8_t>* seen = nullptr);
  void ask_hidden(std::size_t n, const scene::EyeView& eye);
  ~Impl();
  /// `near_dust`: with what dust and water do to its look.
  void use_surface(std::size_t n, const scene::SceneState& state, double opacity, bool near_dust = true);
  void draw_opaque(const scene::EyeView& eye, const scene::SceneState& state);
  void draw_walls(const scene::SceneState& state);
  void draw_caps(const scene::EyeView& eye, const scene::SceneState& state);
  void draw_ct_planes(const scene::EyeView& eye, const scene::SceneState& state);
  void draw_solids(const scene::SceneState& state);
  void draw_tools(const scene::SceneState& state);
  void draw_markers(const scene::SceneState& state, double opacity);
  void draw_ghost(const scene::SceneState& state);
  void draw_transparent(const scene::SceneState& state);
  void set_balls(const GlProgram& program, bool any) const;
  void draw_solid_at(const SolidBuffer& solid, Vec3 place_mm, const Mat3& axes, double opacity);
  Vec3 relative(Vec3 world_mm) const { return world_mm - centre_mm; }

  struct Item {
    std::array<float, 3> colour_rgb;
    bool live, incised, skin;
    std::unique_ptr<DrawnSurface> buffer;
    SurfaceMaker* maker;          // the same, where it is cut
    std::vector<GLuint> queries;  // by chunk
    std::vector<std::uint8_t> seen;
  };
  Vec3 centre_mm;
  double radius_mm;  // of a ball about the scene's centre that holds all of it
  RenderQuality quality;
  std::vector<Item> items;
  SolidBuffer tool, second_tool, room, ball, dot_solid;
  std::shared_ptr<const scene::Room> shown_room;    ///< of which `room` was made
  GlProgram surfaces[shaders::all_parts + 1];       ///< made where they are first needed
  std::bitset<shaders::all_parts + 1> made, begun;  ///< of surfaces
  const GlProgram* surface = nullptr;               ///< in use
  const scene::EyeView* surface_eye = nullptr;
  const scene::SceneState* surface_state = nullptr;
  bool surface_cut = false;
  bool labelling = false;  ///< what is drawn gives its number and its distance, in place of a colour
  GlProgram box;
  GlObject empty_array, noise;
  DrawnPlanes planes;
  struct Rays : VolumeRays {
    void show(const grid::Grid<std::int16_t>* voxels, const cast::CastTable& table) override {
      if (voxels && pass && pass->is_of(*voxels))
        pass->set_table(table);
      else
        pass = voxels ? std::make_unique<CastPass>(*voxels, table) : nullptr;
    }
    void show(const cast::CastShapes& shapes) override {
      if (pass && pass->is_of(shapes))
        pass->follow_opacities();
      else
        pass = std::make_unique<CastPass>(shapes);
    }
    void follow(const grid::Box& box) override {
      if (pass) pass->follow(box);
    }
    double scale() const override { return pass ? pass->scale() : 0; }
    std::unique_ptr<CastPass> pass;
  };
  Rays rays;
  DustTexture dust;
  ToolShadow shadow;
  struct Wall {
    scene::CutBall ball;
    int surface;
    GlObject occupancy;
    scene::Mat4 to_occupancy;
    std::size_t bytes;
  };
  std::vector<Wall> walls;

  std::array<float, 3> background{0.012f, 0.016f, 0.022f};

  // Of the picture that is drawn.
  KeptFences kept;
  Sight sight;
  std::vector<std::pair<std::size_t, DrawList>> lists;  // by item

  PictureTargets targets;
};

/// From mm about the scene's centre to coordinates of a texture on that lattice.
scene::Mat4 to_texture(const grid::Lattice& lattice, Vec3 centre_mm);

}  // namespace trephine::render
