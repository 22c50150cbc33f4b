// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/surface_maker.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "base/error.h"
#include "render/context.h"
#include "render/surface_buffer.h"

namespace trephine::render {
namespace {

class ProcessorSurface : public SurfaceMaker {
 public:
  ProcessorSurface(const voxel::HapticVolume& volume, int shape, Vec3 centre_mm)
      : live_(volume, shape), buffer_(live_, volume.voxels.direction, volume.voxels.origin_mm - centre_mm) {}

  std::size_t update(const std::vector<std::size_t>& marked) override {
    const std::vector<std::size_t>& made = live_.update(marked);
    if (!made.empty()) buffer_.update(live_, made);
    return made.size();
  }
  void make(const std::vector<std::size_t>& bricks) override {
    live_.make(bricks);
    buffer_.update(live_, bricks);
  }
  DrawnBrick read(std::size_t brick) const override {
    DrawnBrick out;
    for (const drill::LiveVertex& v : live_.brick(brick).vertices) out.vertices.push_back(packed(v));
    out.indices.assign(live_.brick(brick).indices.begin(), live_.brick(brick).indices.end());
    if (placed().mirrored)
      for (std::size_t n = 0; n + 2 < out.indices.size(); n += 3) std::swap(out.indices[n + 1], out.indices[n + 2]);
    return out;
  }
  const drill::ShadowVolume& shadow() const override { return live_.shadow(); }
  const PlacedChunks& placed() const override { return buffer_.placed(); }
  void list(const Sight& scene, const std::vector<std::uint8_t>* seen, DrawList& out) const override {
    buffer_.list(scene, seen, out);
  }
  void draw(const DrawList& list) const override { buffer_.draw(list); }
  std::shared_ptr<const SurfaceParts> parts() const override { return buffer_.parts(); }
  void set_coarse(std::optional<CoarseParts> coarse, bool keep_those_before) override {
    buffer_.set_coarse(std::move(coarse), keep_those_before);
  }
  bool upload_coarse(std::size_t& max_bytes) override { return buffer_.upload_coarse(max_bytes); }
  std::size_t coarse_bytes() const override { return buffer_.coarse_bytes(); }
  std::size_t triangles(const DrawList& list) const override { return buffer_.triangles(list); }
  std::size_t bytes() const override { return buffer_.bytes(); }

 private:
  drill::LiveSurface live_;
  SurfaceBuffer buffer_;
};

// Bricks of the surface that lie together, as many as a burr of 7 mm changes in a frame at 0.8 mm a voxel.
std::vector<std::size_t> some_bricks(const drill::ShadowVolume& shadow) {
  const std::size_t count = shadow.layout().count();
  std::vector<std::size_t> out;
  for (std::size_t n = 0; n < count && out.size() < 8; ++n)
    if (const std::size_t b = (count / 2 + n) % count; drill::has_triangles(shadow, b)) out.push_back(b);
  std::sort(out.begin(), out.end());
  return out;
}

double best_ms(SurfaceMaker& maker) {
  const std::vector<std::size_t> bricks = some_bricks(maker.shadow());
  double best = 1e9;
  for (int n = 0; n < 6; ++n) {
    wait_for_driver();
    const auto begin = std::chrono::steady_clock::now();
    maker.make(bricks);
    wait_for_driver();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    if (n > 0) best = std::min(best, took.count());  // a shader's first run may compile it
  }
  return best;
}

}  // namespace

std::unique_ptr<SurfaceMaker> processor_maker(const voxel::HapticVolume& volume, int shape, Vec3 centre_mm) {
  return std::make_unique<ProcessorSurface>(volume, shape, centre_mm);
}

std::string MakerChoice::text() const {
  const std::string by = graphics ? "the graphics card" : "the processor";
  if (!(graphics_ms > 0)) return by;
  return fmt::format("{} ({:.2f} ms for a burr's bricks on the processor, {:.2f} on the card)", by, processor_ms,
                     graphics_ms);
}

std::unique_ptr<SurfaceMaker> wanted_maker(scene::ViewParams::SurfaceBy by, bool software,
                                           const voxel::HapticVolume& volume, int shape, Vec3 centre_mm,
                                           MakerChoice& choice) {
  using By = scene::ViewParams::SurfaceBy;
  choice = {by == By::graphics, 0, 0};
  if (by == By::graphics) return compute_maker(volume, shape, centre_mm);
  auto processor = processor_maker(volume, shape, centre_mm);
  if (by == By::processor || software) return processor;
  std::unique_ptr<SurfaceMaker> graphics;
  try {
    graphics = compute_maker(volume, shape, centre_mm);
  } catch (const Error&) {
    return processor;  // the surface is too large for this card
  }
  choice.processor_ms = best_ms(*processor);
  choice.graphics_ms = best_ms(*graphics);
  choice.graphics = choice.graphics_ms < choice.processor_ms;
  return choice.graphics ? std::move(graphics) : std::move(processor);
}

}  // namespace trephine::render
