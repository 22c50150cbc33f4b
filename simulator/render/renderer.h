// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cast/cast_shapes.h"
#include "render/context.h"
#include "render/surface_parts.h"
#include "scene/picture.h"
#include "scene/scene.h"
#include "scene/tool_solid.h"
#include "scene/view_params.h"
#include "voxel/haptic_volume.h"

namespace trephine::render {

/// How much is spent on a picture.
struct RenderQuality {
  int samples = 4;           ///< a pixel, at edges; at most what the driver has
  bool occlusion = true;     ///< darkens creases and what is near behind something
  double occlusion_mm = 20;  ///< within that distance
  bool grain = true;         ///< a texture on what only an incision cuts
  /// Ask first what is hidden behind the outermost opaque surface, and do not draw it: pays where triangles are dear.
  bool ask_hidden = false;
  /// Samples of the tool's shadow a pixel, 0 to 5; 0: it casts none.
  int shadow_taps = 5;
  Coarseness coarse = {};
  /// While anything moves, rays through a volume take about so long, and they become more from picture to picture while
  /// nothing does; 0: each picture has a ray for every pixel.
  double cast_ms = 0;
};

/// The wall of an incision: what is seen of the surface's own thickness where a ball was taken out of it.
struct IncisionWall {
  scene::CutBall ball;
  int surface = 0;                      ///< in SceneData::surfaces
  grid::Lattice lattice;                ///< around the ball
  std::vector<std::uint8_t> occupancy;  ///< of the surface's shape before the cut, 0 to 255
};

/// The rays through a volume, which a renderer casts after its opaque surfaces (cast/ray_cast.h).
class VolumeRays {
 public:
  virtual ~VolumeRays() = default;
  /// Casts them through the volume, which must outlive the renderer or the next call; null: there are none. Where it is
  /// the volume of the last call, only the table is taken, and what changed of its voxels since must have been
  /// followed. Throws Error 74 where the graphics memory does not suffice, or a side of the volume is longer than
  /// max_ct_side().
  virtual void show(const grid::Grid<std::int16_t>* voxels, const cast::CastTable& table) = 0;
  /// The same of shapes; of those of the last call, only the opacities are taken.
  virtual void show(const cast::CastShapes& shapes) = 0;
  /// Voxels of the box have changed; what of it lies beyond the volume is left out.
  virtual void follow(const grid::Box& box) = 0;
  /// Of the last picture's sides, that share had rays of its own; 0: nothing is cast.
  virtual double scale() const = 0;
};

/// What is seen in each pixel's middle, row by row from the top.
struct LabelPicture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> label;  ///< 0: nothing; n + 1: surface n of the scene; one more than there are: the tool
  std::vector<float> depth_mm;      ///< along the line of sight, from the plane of the eye; 0 where nothing is seen
};

/// Draws a scene with OpenGL 4.3 core into a texture of its own. All calls come from the thread of the context that was
/// current when it was made. Positions are converted to mm from the scene's centre, so that floats are precise.
///
/// Opaque surfaces first; caps where the cut plane passes through solids (stencil); then the darkening; then
/// transparent surfaces, the far sides from the outermost to the innermost and the near sides back, which is the right
/// order for shells that lie within each other, and may be wrong where they cross. Where a surface is cut by a plane
/// the viewer should not stand within the solid: the cap is then not seen.
class Renderer {
 public:
  /// Throws Error 74 where the graphics memory does not suffice, or a shader does not compile.
  Renderer(const scene::SceneData& scene, const RenderQuality& quality);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  void set_quality(const RenderQuality& quality);
  /// Draws that in place of a surface that is not live.
  void set_surface(int surface, std::shared_ptr<const SurfaceParts> shown);
  /// Coarser triangles beside a surface's own, for RenderQuality::coarse: DrawnSurface says of what they are made, and
  /// which are drawn when.
  std::shared_ptr<const SurfaceParts> parts(int surface) const;
  void set_coarse(int surface, std::optional<CoarseParts> coarse, bool keep_those_before = false);
  /// Uploads at most so many bytes of them; returns whether some are left.
  bool upload_coarse(std::size_t max_bytes);
  std::size_t coarse_bytes() const;  ///< of scene_bytes()
  /// Draws a live surface as the shape of the volume, which must outlive the renderer. Throws Error 74 where the
  /// graphics card is to make it (SurfaceBy::graphics) and cannot. Returns who makes it.
  std::string set_live(int surface, const voxel::HapticVolume& volume, int shape, scene::ViewParams::SurfaceBy by);
  /// Makes live surfaces follow the marked bricks; returns how many bricks were made anew.
  std::size_t follow(const std::vector<std::size_t>& marked);
  /// `second`: of the other hand, which casts no shadow.
  void set_tool(const scene::Solid& solid, bool second = false);
  /// Its sides must be at most max_ct_side().
  void set_ct(const grid::Grid<std::int16_t>& ct);
  static int max_ct_side();
  VolumeRays& rays();
  /// Of more than max_incisions the oldest are no longer drawn.
  void add_incision(const IncisionWall& wall);
  void clear_incisions();
  void drop_oldest_incision();
  std::size_t incisions() const;
  static constexpr std::size_t max_incisions = 48;
  void set_background(std::array<float, 3> linear_rgb);

  /// Draws into the renderer's own picture.
  void draw(const scene::EyeView& eye, const scene::SceneState& state, int width, int height);
  /// Copies that picture into a rectangle (from the lower left corner) of the framebuffer that is bound; only the
  /// channels of the mask (1 red, 2 green, 4 blue).
  void present(int x, int y, int width, int height, int mask = 7);

  /// Draws a slice of the CT, if there is one, into a square of the framebuffer that is bound (from its lower left
  /// corner): `half_mm` around the plane's point, which a cross marks. As radiologists look at it: the patient's left
  /// is on the right, front or head up; a sagittal slice is seen from the left.
  void draw_inset(const scene::CtPlane& plane, const scene::SceneState& state, int x, int y, int size, double half_mm);

  /// In the last picture, once each for all its passes. May wait for the graphics card.
  std::size_t drawn_triangles() const;
  std::size_t scene_bytes() const;     ///< of vertices, triangles and textures
  std::size_t graphics_bytes() const;  ///< and of the last picture

 private:
  friend LabelPicture draw_labels(Renderer& renderer, const scene::EyeView& eye, const scene::SceneState& state,
                                  int width, int height);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Which surface or tool is seen in each pixel, and how far away: of the tool and the surfaces that are opaque, whole
/// and with their incisions. Neither planes, markers nor volumes that are cast are seen. The scene has at most 254
/// surfaces.
LabelPicture draw_labels(Renderer& renderer, const scene::EyeView& eye, const scene::SceneState& state, int width,
                         int height);

/// A framebuffer without a window: present() into it, then read.
class OffscreenPicture {
 public:
  OffscreenPicture(int width, int height);
  ~OffscreenPicture();
  void bind();
  scene::Picture read();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Of a picture for both eyes, or of one of two.
enum class Eye { both, left, right };
/// Binds the window's own framebuffer again, for present(): of one eye, where the window has a buffer for each.
void bind_screen(Eye eye = Eye::both);
/// What a window's framebuffer shows, from its lower left corner: of the one that is bound for reading.
scene::Picture read_picture(int width, int height);

}  // namespace trephine::render
