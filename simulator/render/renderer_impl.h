// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <bitset>
#include <map>

#include "render/kept_fences.h"
#include "render/renderer.h"
#include "render/shaders.h"
#include "render/surface_buffer.h"
#include "render/surface_maker.h"

namespace trephine::render {

// Shared by the sources of the renderer alone.
struct Renderer::Impl {
  Impl(const scene::SceneData& scene, const RenderQuality& quality);

  // renderer.cpp
  static bool copies_bytes();
  void make_targets(int width, int height);
  void make_noise();
  void upload_ct(const grid::Grid<std::int16_t>& ct);

  // renderer_shadow.cpp
  void make_shadow_map();
  void cast_shadow(const scene::EyeView& eye, const scene::SceneState& state);
  void receive_shadow(const GlProgram& program) const;

  // renderer_theatre.cpp
  int theatre_parts(const scene::SceneState& state) const;  ///< shaders::SurfacePart of a surface in a theatre
  void set_theatre(const GlProgram& program) const;         ///< what is the same for all that it draws
  /// Takes the powder and water of the picture, and whether there is any.
  void take_dust(const scene::SceneState& state);
  void set_dust(const GlProgram& program) const;
  /// By chunk of a surface, whether it lies about the dust, and whether it lies elsewhere; neither where it is not
  /// `seen` (may be null).
  void part_by_dust(std::size_t n, const std::vector<std::uint8_t>* seen);
  /// Of what is drawn next: only skin is draped; what lies beneath it, and drops, are wet.
  void set_tissue(bool skin, double wet) const;

  // renderer_draw.cpp
  void draw(const scene::EyeView& eye, const scene::SceneState& state, int width, int height);
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
  void draw_markers(const scene::SceneState& state, double opacity);
  void draw_ghost(const scene::SceneState& state);
  void draw_transparent(const scene::SceneState& state);
  void darken(const scene::EyeView& eye);
  void set_balls(const GlProgram& program, bool any) const;
  void set_plane(const scene::EyeView& eye) const;
  void draw_plane(Vec3 middle, Vec3 across, Vec3 along) const;
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
  int samples = 1;
  std::vector<Item> items;
  SolidBuffer tool, ball, dot_solid;
  GlProgram surfaces[shaders::all_parts + 1];       ///< made where they are first needed
  std::bitset<shaders::all_parts + 1> made, begun;  ///< of surfaces
  const GlProgram* surface = nullptr;               ///< in use
  const scene::EyeView* surface_eye = nullptr;
  const scene::SceneState* surface_state = nullptr;
  bool surface_cut = false;
  GlProgram plane, box, openness, smoothing, darkening, presenting;
  GlObject plane_array, plane_corners, empty_array, noise, ct;
  bool has_ct = false;
  GlObject dust;
  std::uint64_t dust_version = 0;  ///< of what it holds
  const scene::BoneDust* dust_of = nullptr;
  bool dusty = false;  ///< in this picture
  scene::Mat4 to_dust;
  Vec3 dust_middle_mm;  ///< relative to centre_mm
  std::vector<std::uint8_t> near_dust, far_from_dust;
  scene::Mat4 to_ct;
  grid::Lattice ct_lattice;
  struct Wall {
    scene::CutBall ball;
    int surface;
    GlObject occupancy;
    scene::Mat4 to_occupancy;
    std::size_t bytes;
  };
  std::vector<Wall> walls;

  // The tool's shadow: the tool as the key light sees it, in a map that lies along the tool.
  GlProgram shadow;
  GlObject shadow_frame, shadow_map;
  double tool_radius_mm = 0, tool_low_mm = 0, tool_high_mm = 0;  ///< a cylinder about its axis that holds the tool
  bool casts = false;                                            ///< in this picture
  scene::Mat4 to_shadow;
  float shadow_step[2] = {0, 0};
  std::array<float, 3> background{0.012f, 0.016f, 0.022f};

  // Of the picture that is drawn.
  KeptFences kept;
  Sight sight;
  std::vector<std::pair<std::size_t, DrawList>> lists;  // by item

  bool copies = false;  ///< present() may copy bytes
  // The picture: `many` where a pixel has several samples, `one` with its colour and depth as textures, `half` for the
  // darkening.
  int width = 0, height = 0;
  GlObject many, many_colour, many_depth, one, one_colour, one_depth, half, half_open, half_too, half_smooth;
};

/// From mm about the scene's centre to coordinates of a texture on that lattice.
scene::Mat4 to_texture(const grid::Lattice& lattice, Vec3 centre_mm);

}  // namespace trephine::render
