// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "render/cast_source.h"
#include "render/coarse_worker.h"
#include "render/renderer.h"
#include "scene/view_params.h"
#include "session/playback.h"
#include "texts/note.h"
#include "voxel/decode.h"

namespace trephine::render {

/// A slice of the CT in a corner, through the tip: where its plane lies (0 sagittal, 1 coronal, 2 axial), where it is
/// in the picture (pixels from the upper left corner), and half of what it shows.
struct Inset {
  int axis = 0, x = 0, y = 0, size = 0;
  double half_mm = 0;
};

/// A case on stage: the scene, its live surfaces and the renderer, as a window and the pictures of a recording use
/// them. In the thread of the current context.
class Stage {
 public:
  /// `loaded` must outlive it; where voxels are cut meanwhile, they are not yet when it is made. Where some were cut
  /// before, `uncut` has them as the case has them, for the walls of incisions; it is copied.
  Stage(const cases::LoadedCase& loaded, const scene::ViewParams& params,
        const grid::Grid<std::int16_t>* uncut = nullptr);

  /// The parameters of pictures from now on; not those of the camera, nor who makes surfaces.
  void set_view(const scene::ViewParams& params);
  const scene::ViewParams& view() const { return params_; }
  /// How good pictures are from now on, without another view; `scale` below 1: so many pixels less in each direction.
  /// Coarser triangles are made in a thread of their own; until follow_coarse() has taken them, surfaces are drawn as
  /// they were. `cast_ms` as in RenderQuality.
  void set_quality(const scene::ViewParams& params, double scale, const Coarseness& coarse = {}, double cast_ms = 0);
  /// Takes what was made of coarser triangles, and uploads a part that holds no picture up. The notes say of each
  /// surface that becomes coarser by how much. Throws what making them threw. To be called for each picture.
  void follow_coarse();
  /// Whether more of them is to come. While pictures are drawn with what there is, they say nothing of the quality.
  bool coarse_comes() const { return worker_.busy() || uploading_; }
  /// Until all of them are there.
  void wait_for_coarse();
  /// `colour_rgb`: of all of it but what is in a syringe (`inside_rgb`), in place of its own.
  void set_tool(const haptics::ToolParams& own_tool, const std::optional<std::array<float, 3>>& colour_rgb = {},
                const std::optional<std::array<float, 3>>& inside_rgb = {});
  /// Makes live surfaces and a volume that is cast follow the marked bricks; returns how many surfaces' were made anew.
  std::size_t follow(drill::DirtyBricks& marks);
  /// Casts rays through a volume of the case, and draws what `opacity` of the view names of the anatomies alone. Where
  /// the rays show shapes, state.opacity is theirs.
  /// Throws as CastSource::show.
  void cast(scene::ViewParams::Cast what, const std::string& transfer);
  /// By that function from now on, what is cast; it must be HU.
  void cast(const voxel::TransferFunction& resolved) { cast_source_.show(*renderer_, resolved); }
  const CastSource& cast_source() const { return cast_source_; }
  /// The incisions that are shown: `count` of them, from the first. Of more than Renderer::max_incisions the oldest
  /// look closed.
  void show_incisions(const std::vector<session::IncisionMark>& all, std::size_t count);
  void set_dust(bool shown) { params_.dust = shown; }
  /// Where the parameters of pictures want it.
  void show_dust(std::shared_ptr<const scene::BoneDust> dust) { state.dust = params_.dust ? std::move(dust) : nullptr; }
  /// Tool, hand and contact as they are in that frame, and what the other hand held as it is in `second`; null, or a
  /// switch alone: none is shown.
  void show_frame(const haptics::ServoFrame& frame, const haptics::RecordedSecondHand* held = nullptr,
                  const haptics::ServoFrame* second = nullptr);

  /// Draws, and copies the picture into the framebuffer that `bind` binds, from its lower left corner; with two eyes
  /// as the parameters say. `bind` is asked for one eye alone where each has a framebuffer (quad_buffer). `head_mm`
  /// moves the eyes from where the camera stands (right, up, towards the viewer).
  void draw(const scene::OrbitCamera& camera, int width, int height, const std::function<void(Eye)>& bind,
            Vec3 head_mm = {});

  /// The slices that a picture of that size shows; none where they are switched off, or the case has no CT.
  std::vector<Inset> insets(int width, int height) const;

  scene::SceneState state;
  const scene::SceneData& scene() const { return scene_; }
  const cases::LoadedCase& loaded() const { return loaded_; }
  Renderer& renderer() { return *renderer_; }
  const Renderer& renderer() const { return *renderer_; }
  const DriverFacts& driver() const { return driver_; }
  /// What was left out, for want of graphics memory or because pictures took too long; may grow.
  const std::vector<texts::Note>& notes() const { return notes_; }
  /// Who makes the surfaces that are cut; empty where none is.
  const std::string& surfaces_by() const { return surfaces_by_; }

  /// What an eye sees that is beside (right, up, towards the viewer) the one given, through the same window at that
  /// distance.
  static scene::EyeView beside(scene::EyeView eye, double screen_mm, Vec3 by_mm);

 private:
  void draw_insets(int width, int height);
  // stage_memory.cpp
  void fit_memory();
  void show_ct(int halvings);
  // stage_coarse.cpp
  void begin_coarse();
  void put_back();
  void show_coarse(CoarseMade made);
  void fit_incisions(std::size_t of_newest);
  double picture_scale(int width, int height);
  int samples_of(const scene::ViewParams& params) const;
  bool fits(std::size_t bytes) const;
  RenderQuality quality_of(const scene::ViewParams& params) const;
  IncisionWall wall_of(const session::IncisionMark& mark, int surface, const voxel::HapticDecoder& decoder) const;

  const cases::LoadedCase& loaded_;
  std::size_t budget_bytes_ = 0;  ///< 0: any
  int max_samples_ = 64;
  std::vector<texts::Note> notes_;
  scene::ViewParams params_;
  DriverFacts driver_;
  scene::SceneData scene_;
  std::string surfaces_by_;
  voxel::HapticVolume before_;  ///< as it was, for the walls of incisions and what is cut of a CT; else empty
  CastSource cast_source_;
  std::unique_ptr<Renderer> renderer_;
  std::vector<std::size_t> marked_;
  std::size_t shown_incisions_ = 0;
  std::string second_tool_;
  bool told_incisions_ = false, told_over_ = false;
  std::pair<int, int> told_picture_{0, 0};
  /// By surface, the coarsening in mm: what memory demands, and the present one. 0: full resolution.
  std::vector<double> needed_mm_, shown_mm_;
  /// By surface, the triangles as coarse as memory demands, and those that the worker was given to coarsen.
  std::vector<std::shared_ptr<const SurfaceParts>> needed_, given_;
  double scale_ = 1, cast_ms_ = 0;
  int samples_ = 1;  ///< of the pictures that are drawn now
  Coarseness coarse_;
  bool uploading_ = false;
  std::map<std::string, texts::Note> told_coarse_;  ///< by surface the last note of it
  CoarseWorker worker_;                             // reads scene_: it ends first
};

}  // namespace trephine::render
