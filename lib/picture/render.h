// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "picture/image.h"
#include "surface/trimesh.h"

namespace trephine::picture {

/// From where the patient is seen: `left` shows the patient's left side. The oblique ones look down a little.
enum class View { front, back, left, right, top, bottom, oblique_left, oblique_right };

struct SurfaceView {
  const surface::TriMesh* mesh = nullptr;
  Rgb colour_rgb{0.8, 0.8, 0.8};
  double opacity = 1;  ///< below 1, the nearest layer is seen, and through it what lies behind
};

/// Removes everything where dot(normal, p - point) > 0. Closed surfaces look solid there: their cut is filled with
/// their colour, and a surface later in the list covers an earlier one.
struct ClipPlane {
  Vec3 point_mm, normal{0, -1, 0};
};

struct RenderParams {
  View view = View::oblique_left;
  int width = 800, height = 800;
  int supersampling = 2;                 ///< 1 to 4 samples a pixel, in x and in y
  double field_of_view_deg = 20;         ///< 0: orthographic
  std::optional<surface::Bounds> frame;  ///< what must fit into the picture; the surfaces' bounds where not given
  std::optional<ClipPlane> clip;
  Rgb background_top{1, 1, 1}, background_bottom{0.90, 0.92, 0.94};
  bool marks = true;      ///< orientation letters and a scale bar (of the plane through the frame's centre)
  bool occlusion = true;  ///< darkens creases (screen-space obscurance)
  std::string title;      ///< upper left; may be empty
};

/// A z-buffer picture with smooth shading by the mesh's normals (computed where it has none) and three lights. Inner
/// sides of triangles that are seen, through a hole or because a triangle is flipped, are bright magenta. The same
/// bytes whatever the thread count. Throws Error 65 for a damaged mesh; Cancelled.
Image render_surfaces(const std::vector<SurfaceView>& surfaces, const RenderParams& params,
                      const Progress& progress = {});

/// Gives the mesh the normals that render_surfaces computes where it has none: once, for many pictures of it.
void give_normals(surface::TriMesh& mesh);

}  // namespace trephine::picture
