// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "peers/contact_algorithm.h"
#include "peers/god_object.h"

namespace trephine::peers {

/// Haptics of a feedback buffer, as in OpenHaptics (its programmer's guide, shapes of the feedback buffer): with each
/// picture all triangles pass through OpenGL, which cuts them at the sides of the haptic camera's view, here a box
/// about the tool, and gives their corners back in the single precision of window coordinates. They are put one after
/// the other into a buffer that holds so many corners as the program said beforehand: what comes later is lost. The
/// servo loop feels what was captured as a god-object does, until the next picture; beyond the box there is nothing.
class FeedbackBuffer : public ContactAlgorithm {
 public:
  FeedbackBuffer(const PeerScene& scene, const PeerParams& params);
  const haptics::HapticState& update(const haptics::HapticInput& given) override;
  void client(Vec3 device_mm) override;
  void reset() override;
  /// Triangles that were captured with the last picture, and how many corners the buffer had no room for.
  std::size_t captured() const { return mesh_ ? mesh_->mesh().triangles.size() : 0; }
  std::size_t lost() const { return lost_; }

 private:
  const PeerScene scene_;
  const PeerParams params_;
  std::unique_ptr<FeltMesh> mesh_;  // what was captured; null: nothing
  GodObject god_;
  haptics::HapticState state_;
  std::size_t lost_ = 0;
};

/// The part of a triangle within the cube of that half side about the middle, as a convex polygon; empty where there is
/// none.
std::vector<Vec3> clipped_to_cube(const std::array<Vec3, 3>& triangle, Vec3 middle, double half_mm);

}  // namespace trephine::peers
