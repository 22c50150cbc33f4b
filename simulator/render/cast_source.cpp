// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/cast_source.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "cast/transfer_edit.h"
#include "surface/bounds.h"

namespace trephine::render {
namespace {

using Cast = scene::ViewParams::Cast;

[[noreturn]] void refuse(const std::string& value, const std::string& what) {
  throw Error(ExitCode::usage, "", "--cast", value + ": " + what);
}

// The voxels that a marked brick's triangles read.
grid::Box voxels_of(const drill::BrickLayout& layout, std::size_t brick, const grid::Lattice& lattice) {
  grid::Box box;
  const std::array<int, 3> place = layout.place(brick);
  for (std::size_t a = 0; a < 3; ++a) {
    box.begin[a] = std::max(0, place[a] * layout.side - 2);
    box.end[a] = std::min(lattice.size[a], place[a] * layout.side + layout.side + 1);
  }
  return box;
}

bool holds_nothing(const voxel::HapticVolume& volume, std::int16_t value) {
  return std::none_of(volume.shapes.begin(), volume.shapes.end(),
                      [&](const voxel::HapticShape& s) { return value >= s.window_low && value <= s.window_high; });
}

}  // namespace

void CastSource::show(Renderer& renderer, Cast what, const std::string& transfer) {
  std::vector<voxel::TransferFunction> functions;
  if (!transfer.empty()) functions = {cast::transfer_of(transfer, "--transfer")};
  // Until the new rays are there, the old ones are cast through their own volume, and follow its cuts.
  if (what == Cast::none) {
    renderer.rays().show(nullptr, {});
  } else if (what == Cast::ct) {
    if (!loaded_.has_ct()) refuse("ct", "the case has no CT; a scene asks for it with `ct: {}`");
    if (functions.empty()) functions = {voxel::transfer_from_text("bone", "--transfer")};
    if (what_ != Cast::ct) {  // else it has followed each cut
      ct_ = loaded_.ct;
      if (loaded_.has_haptic()) follow_ct(grid::whole_box(loaded_.haptic.voxels));
    }
    renderer.rays().show(&ct_, cast::CastTable(functions));
  } else {
    if (!loaded_.has_haptic()) refuse("haptic", "the case has no haptic volume");
    if (loaded_.haptic.encoding == voxel::HapticEncoding::occupancy) {
      if (!functions.empty())
        throw Error(ExitCode::usage, "", "--transfer",
                    "is of HU, and the case's haptic volume holds shapes; --opacity says how opaque each of them is");
      show_shapes(renderer);
    } else {
      if (functions.empty()) functions = cast::functions_of(loaded_.manifest.haptic);
      renderer.rays().show(&loaded_.haptic.voxels, cast::CastTable(functions));
    }
  }
  if (what != Cast::ct) ct_ = {};
  if (what != Cast::haptic) shapes_.reset();
  what_ = what;
  functions_ = std::move(functions);
}

void CastSource::show_shapes(Renderer& renderer) {
  if (shapes_) return;  // they have followed each cut
  shapes_.emplace(loaded_.haptic, loaded_.manifest.haptic);
  try {
    renderer.rays().show(*shapes_);
  } catch (...) {
    shapes_.reset();
    throw;
  }
}

std::optional<scene::SceneState> CastSource::show_opacities(Renderer& renderer, const scene::SceneData& scene,
                                                            const scene::SceneState& state) {
  if (!shapes_) return std::nullopt;
  scene::SceneState beside = state;
  bool changed = false;
  for (std::size_t n = 0; n < scene.surfaces.size() && n < state.opacity.size(); ++n) {
    const int shape = scene.surfaces[n].shape;
    if (shape == 0) continue;
    beside.opacity[n] = 0;
    changed = changed || float(state.opacity[n]) != shapes_->entries()[std::size_t(shape)][3];
    shapes_->set_opacity(shape, state.opacity[n]);
  }
  if (changed) renderer.rays().show(*shapes_);
  return beside;
}

void CastSource::show(Renderer& renderer, const voxel::TransferFunction& resolved) {
  renderer.rays().show(voxels(), cast::CastTable({resolved}));
  functions_ = {resolved};
}

const grid::Grid<std::int16_t>* CastSource::voxels() const {
  return what_ == Cast::none || shapes_ ? nullptr : what_ == Cast::ct ? &ct_ : &loaded_.haptic.voxels;
}

void CastSource::follow(Renderer& renderer, const std::vector<std::size_t>& marked) {
  if (what_ == Cast::none || marked.empty()) return;
  const grid::Grid<std::int16_t>& haptic = loaded_.haptic.voxels;
  const drill::BrickLayout layout(haptic);
  for (const std::size_t brick : marked) {
    const grid::Box box = voxels_of(layout, brick, haptic);
    if (what_ == Cast::haptic)
      renderer.rays().follow(shapes_ ? shapes_->follow(loaded_.haptic, box) : box);
    else
      renderer.rays().follow(follow_ct(box));
  }
}

// What was cut away of the haptic volume is air in the CT: of the haptic voxel in which a voxel's middle lies.
grid::Box CastSource::follow_ct(const grid::Box& from) {
  const grid::Grid<std::int16_t>& haptic = loaded_.haptic.voxels;
  surface::Bounds bounds;
  for (int c = 0; c < 8; ++c) {
    Vec3 corner;
    for (int a = 0; a < 3; ++a)
      corner[a] = (c >> a & 1) ? from.end[std::size_t(a)] - 0.5 : from.begin[std::size_t(a)] - 0.5;
    surface::include(bounds, ct_.to_index(haptic.to_world_mm(corner)));
  }
  grid::Box box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.begin[a] = int(std::clamp(std::floor(bounds.min_mm[int(a)]), 0.0, double(ct_.size[a])));
    box.end[a] = int(std::clamp(std::ceil(bounds.max_mm[int(a)]) + 1, 0.0, double(ct_.size[a])));
  }
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) {
        const Vec3 at = haptic.to_index(ct_.to_world_mm({double(i), double(j), double(k)}));
        const int x = int(std::floor(at.x + 0.5)), y = int(std::floor(at.y + 0.5)), z = int(std::floor(at.z + 0.5));
        if (!haptic.contains(x, y, z)) continue;
        const std::int16_t now = __atomic_load_n(&haptic.voxels[haptic.index(x, y, z)], __ATOMIC_RELAXED);
        const bool cut = now != uncut_.at(x, y, z) && holds_nothing(loaded_.haptic, now);
        ct_.at(i, j, k) = cut ? std::int16_t(voxel::haptic_beyond_hu) : loaded_.ct.at(i, j, k);
      }
  return box;
}

}  // namespace trephine::render
