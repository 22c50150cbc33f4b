// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/stage.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/room.h"
#include "voxel/decode.h"

namespace trephine::render {
namespace {

constexpr double inset_mm = 60;    // half of what an inset shows
constexpr double full_glow_n = 2;  // force at which the contact is lit most

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

// The triangles come when it is known how many the graphics memory holds.
scene::SceneData without_triangles(const scene::SceneData& scene) {
  scene::SceneData out{scene.centre_mm, scene.bounds, {}};
  for (const scene::SceneSurface& s : scene.surfaces)
    out.surfaces.push_back({s.name, s.colour_rgb, s.opacity, s.shape, s.live, s.incised, s.skin, {}, {}});
  return out;
}

}  // namespace

Stage::Stage(const cases::LoadedCase& loaded, const scene::ViewParams& params, const grid::Grid<std::int16_t>* uncut)
    : loaded_(loaded),
      budget_bytes_(std::size_t(params.graphics_budget_mb * 1e6)),
      params_(params),
      driver_(driver_facts()),
      scene_(scene::scene_of(loaded)),
      cast_source_(loaded, before_.voxels) {
  renderer_ = std::make_unique<Renderer>(without_triangles(scene_), quality_of(params));
  bool incised = false;
  for (std::size_t n = 0; n < scene_.surfaces.size(); ++n) {
    const scene::SceneSurface& s = scene_.surfaces[n];
    incised = incised || s.incised;
    if (!s.live) continue;
    surfaces_by_ = renderer_->set_live(int(n), loaded.haptic, s.shape, params.surface_by);
  }
  fit_memory();
  if (loaded.has_ct() || (incised && loaded.haptic.encoding == voxel::HapticEncoding::occupancy)) {
    before_.voxels = uncut ? *uncut : loaded.haptic.voxels;
    before_.shapes = loaded.haptic.shapes;
  }
  state.opacity = scene::opacities_of(scene_, params.opacity);
  set_view(params);
  if (params.cast != scene::ViewParams::Cast::none || !params.transfer.empty()) cast(params.cast, params.transfer);
}

RenderQuality Stage::quality_of(const scene::ViewParams& p) const {
  return {samples_of(p), p.occlusion,      p.occlusion_mm,
          p.grain,       driver_.software, !p.shadow ? 0 : driver_.software ? 1 : 5,
          coarse_,       cast_ms_};
}

void Stage::set_view(const scene::ViewParams& params) {
  params_ = params;
  samples_ = samples_of(params);
  renderer_->set_quality(quality_of(params));
  state.cut = scene::cut_of(params, scene_);
  state.cast_box = scene::cast_box_of(params, scene_);
  state.insets = params.insets;
  state.cut_shows_ct = params.cut_ct;
  state.ct_low_hu = params.ct_low_hu;
  state.ct_high_hu = params.ct_high_hu;
  state.markers = params.places ? scene::places_of(loaded_.manifest) : std::vector<scene::Marker>();
}

void Stage::set_tool(const haptics::ToolParams& own_tool, const std::optional<std::array<float, 3>>& colour_rgb,
                     const std::optional<std::array<float, 3>>& inside_rgb) {
  scene::Solid solid = scene::solid_of(own_tool, inside_rgb);
  if (colour_rgb)
    for (scene::SolidVertex& v : solid.vertices)
      if (!inside_rgb || !std::equal(inside_rgb->begin(), inside_rgb->end(), v.colour_rgb))
        std::copy(colour_rgb->begin(), colour_rgb->end(), v.colour_rgb);
  renderer_->set_tool(solid);
}

std::size_t Stage::follow(drill::DirtyBricks& marks) {
  marked_.clear();
  marks.take(marked_);
  if (marked_.empty()) return 0;
  cast_source_.follow(*renderer_, marked_);
  return renderer_->follow(marked_);
}

void Stage::cast(scene::ViewParams::Cast what, const std::string& transfer) {
  using Cast = scene::ViewParams::Cast;
  const bool of_shapes = what == Cast::haptic && loaded_.haptic.encoding == voxel::HapticEncoding::occupancy;
  const auto opacity = what == Cast::none ? scene::opacities_of(scene_, params_.opacity)
                                          : scene::opacities_beside_rays(scene_, params_.opacity, of_shapes);
  cast_source_.show(*renderer_, what, transfer);
  params_.cast = what;
  params_.transfer = transfer;
  state.opacity = opacity;
}

void Stage::show_incisions(const std::vector<session::IncisionMark>& all, std::size_t count) {
  if (count == shown_incisions_ || before_.voxels.voxels.empty()) return;
  if (loaded_.haptic.encoding != voxel::HapticEncoding::occupancy) return;
  if (count < shown_incisions_) {
    renderer_->clear_incisions();
    shown_incisions_ = 0;
  }
  const voxel::HapticDecoder decoder(before_);
  for (; shown_incisions_ < count; ++shown_incisions_) {
    std::size_t walls = 0;
    for (std::size_t n = 0; n < scene_.surfaces.size(); ++n)
      if (scene_.surfaces[n].incised) {
        renderer_->add_incision(wall_of(all[shown_incisions_], int(n), decoder));
        ++walls;
      }
    fit_incisions(walls);
  }
}

IncisionWall Stage::wall_of(const session::IncisionMark& mark, int surface, const voxel::HapticDecoder& decoder) const {
  IncisionWall wall;
  wall.ball = {mark.point_mm, mark.radius_mm};
  wall.surface = surface;
  grid::Box box;
  for (std::size_t a = 0; a < 3; ++a) {
    const double at = before_.voxels.to_index(mark.point_mm)[int(a)],
                 reach = mark.radius_mm / before_.voxels.spacing_mm[int(a)] + 2;
    const double size = before_.voxels.size[a];
    box.begin[a] = int(std::clamp(std::floor(at - reach), 0.0, size - 1));
    box.end[a] = int(std::clamp(std::ceil(at + reach) + 1, box.begin[a] + 1.0, size));
  }
  wall.lattice = grid::cropped(before_.voxels, box);
  wall.occupancy.reserve(wall.lattice.count());
  const int shape = scene_.surfaces[std::size_t(surface)].shape;
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i)
        wall.occupancy.push_back(std::uint8_t(std::lround(255 * decoder.occupancy(shape, i, j, k))));
  return wall;
}

void Stage::show_frame(const haptics::ServoFrame& f, const haptics::RecordedSecondHand* held,
                       const haptics::ServoFrame* second) {
  state.tool_shown = true;
  state.tip_mm = vec(f.proxy_mm);
  state.axis = normalized(vec(f.axis));
  const Vec3 device = vec(f.tip_mm);
  state.device_mm = norm(device - state.tip_mm) > 0.3 ? std::optional<Vec3>(device) : std::nullopt;
  state.contact_mm = f.touched != 0 ? std::optional<Vec3>(state.tip_mm) : std::nullopt;
  state.contact_strength = std::min(1.0, norm(vec(f.force_n)) / full_glow_n);
  state.second_shown = held && second && !held->switch_only;
  if (!state.second_shown) return;
  if (second_tool_ != held->tool.name) {
    second_tool_ = held->tool.name;
    renderer_->set_tool(scene::solid_of(haptics::own_tool(held->tool)), true);
  }
  state.second_tip_mm = vec(second->proxy_mm);
  state.second_axis = normalized(vec(second->axis));
}

// The picture as a window at `screen_mm` before the camera, seen by an eye that is beside the camera.
scene::EyeView Stage::beside(scene::EyeView e, double screen_mm, Vec3 by_mm) {
  e.eye_mm += e.right * by_mm.x + e.up * by_mm.y + e.toward * by_mm.z;
  const double k = 1 / std::max(1.0, screen_mm + by_mm.z);
  e.left = (e.left * screen_mm - by_mm.x) * k;
  e.right_edge = (e.right_edge * screen_mm - by_mm.x) * k;
  e.bottom = (e.bottom * screen_mm - by_mm.y) * k;
  e.top = (e.top * screen_mm - by_mm.y) * k;
  e.near_mm = std::max(1.0, e.near_mm + by_mm.z);
  e.far_mm += std::max(0.0, by_mm.z);
  return e;
}

void Stage::draw(const scene::OrbitCamera& camera, int width, int height, const std::function<void(Eye)>& bind,
                 Vec3 head_mm) {
  const double screen_mm = params_.convergence_mm > 0 ? params_.convergence_mm : camera.distance_mm;
  const surface::Bounds& drawn_mm = state.room && !state.cut ? state.room->bounds_mm : scene_.bounds;
  const std::optional<scene::SceneState> by_rays = cast_source_.show_opacities(*renderer_, scene_, state);
  const auto one = [&](int x, int y, int w, int h, double offset_mm, int mask, Eye which = Eye::both) {
    const scene::EyeView eye = beside(camera.eye(w, h, drawn_mm), screen_mm, head_mm + Vec3{offset_mm, 0, 0});
    const double scale = picture_scale(w, h);
    renderer_->draw(eye, by_rays ? *by_rays : state, std::max(1, int(w * scale)), std::max(1, int(h * scale)));
    bind(which);
    renderer_->present(x, y, w, h, mask);
  };
  const double half = 0.5 * params_.eye_distance_mm;
  switch (params_.stereo) {
    case scene::ViewParams::Stereo::none:
      one(0, 0, width, height, 0, 7);
      draw_insets(width, height);
      break;
    case scene::ViewParams::Stereo::side_by_side:
      one(0, 0, width / 2, height, -half, 7);
      one(width / 2, 0, width - width / 2, height, half, 7);
      break;
    case scene::ViewParams::Stereo::top_bottom:
      one(0, height / 2, width, height - height / 2, -half, 7);
      one(0, 0, width, height / 2, half, 7);
      break;
    case scene::ViewParams::Stereo::anaglyph:
      one(0, 0, width, height, -half, 1);
      one(0, 0, width, height, half, 6);
      break;
    case scene::ViewParams::Stereo::quad_buffer:
      one(0, 0, width, height, -half, 7, Eye::left);
      one(0, 0, width, height, half, 7, Eye::right);
      bind(Eye::both);
      break;
  }
}

// Sagittal, coronal and axial, from the lower right corner to the left.
void Stage::draw_insets(int width, int height) {
  for (const Inset& at : insets(width, height))
    renderer_->draw_inset({at.axis, state.tip_mm}, state, at.x, height - at.y - at.size, at.size, at.half_mm);
}

std::vector<Inset> Stage::insets(int width, int height) const {
  std::vector<Inset> all;
  if (!state.insets || !state.tool_shown || !loaded_.has_ct()) return all;
  const int size = std::min(width / 5, height / 4), gap = std::max(2, size / 30);
  for (int axis = 0; axis < 3; ++axis)
    all.push_back({axis, width - (axis + 1) * (size + gap), height - gap - size, size, inset_mm});
  return all;
}

}  // namespace trephine::render
