// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cases/load_case.h"
#include "drill/bricks.h"
#include "render/renderer.h"
#include "scene/view_params.h"

namespace trephine::render {

/// The volume of a case that rays are cast through, as it is now: what was cut away is not seen.
class CastSource {
 public:
  /// Both must outlive it. `uncut`: the haptic volume's voxels as the case has them; without voxels where it has no CT.
  CastSource(const cases::LoadedCase& loaded, const grid::Grid<std::int16_t>& uncut) : loaded_(loaded), uncut_(uncut) {}
  /// Throws Error 64 where the case has no such volume, or the text is no transfer function; Error 74 as
  /// VolumeRays::show. What was cast before is then cast on, and follows cuts.
  void show(Renderer& renderer, scene::ViewParams::Cast what, const std::string& transfer);
  /// By that function from now on: of what is cast, which must be HU.
  void show(Renderer& renderer, const voxel::TransferFunction& resolved);
  /// The marked bricks of the haptic volume have changed.
  void follow(Renderer& renderer, const std::vector<std::size_t>& marked);
  const std::vector<voxel::TransferFunction>& functions() const { return functions_; }  ///< of what is cast; resolved
  const grid::Grid<std::int16_t>* voxels() const;  ///< the HU that are cast; null where none are
  /// Where shapes are cast, makes each as opaque as its surface is in the state, and gives the state without these
  /// surfaces, whose place the rays take.
  std::optional<scene::SceneState> show_opacities(Renderer& renderer, const scene::SceneData& scene,
                                                  const scene::SceneState& state);

 private:
  void show_shapes(Renderer& renderer);
  grid::Box follow_ct(const grid::Box& haptic_box);  ///< returns the voxels of the CT that it looked at

  const cases::LoadedCase& loaded_;
  const grid::Grid<std::int16_t>& uncut_;
  grid::Grid<std::int16_t> ct_;  // where it is cast
  std::optional<cast::CastShapes> shapes_;
  scene::ViewParams::Cast what_ = scene::ViewParams::Cast::none;
  std::vector<voxel::TransferFunction> functions_;
};

}  // namespace trephine::render
