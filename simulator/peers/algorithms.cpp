// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "peers/contact_algorithm.h"
#include "peers/depth_buffer.h"
#include "peers/feedback_buffer.h"
#include "peers/god_object.h"
#include "peers/round_proxy.h"
#include "peers/scalar_surface.h"
#include "peers/tangent_plane.h"
#include "peers/volume_proxy.h"

namespace trephine::peers {
namespace {

template <class A>
AlgorithmKind kind(const std::string& name, const std::string& title, const std::string& from, bool feels_mesh) {
  return {name, title, from, feels_mesh, [](const PeerScene& scene, const PeerParams& params) {
            return std::unique_ptr<ContactAlgorithm>(std::make_unique<A>(scene, params));
          }};
}

}  // namespace

std::vector<AlgorithmKind> all_algorithms() {
  std::vector<AlgorithmKind> all = {
      kind<VolumeProxy>("ours", "Trephine", "docs/explanation/contact-and-force.md", false),
      kind<SteppedProxy>("stepped", "IR, as in chapter 3", "Rizzi, chapter 3", false),
      kind<ScalarSurface>("scalar_surface", "scalar surface (VHTK)", "Lundin2002", false),
      kind<GodObject>("god_object", "god-object, bare", "Zilles1995", true),
      kind<RoundProxy>("ruspini", "Ruspini", "Ruspini1997", true),
      kind<DepthBuffer>("depth_buffer", "depth buffer", "OpenHaptics", true),
      kind<FeedbackBuffer>("feedback_buffer", "feedback buffer", "OpenHaptics", true),
      kind<TangentPlane>("tangent_planes", "intermediate planes", "Adachi1995, Mark1996", true)};
  AlgorithmKind lifted = kind<GodObject>("god_object_lifted", "god-object, lifted", "Zilles1995", true);
  lifted.make = [](const PeerScene& scene, const PeerParams& params) {
    PeerParams own = params;
    own.god_object_lift_mm = std::max(1e-6, params.god_object_lift_mm);
    return std::unique_ptr<ContactAlgorithm>(std::make_unique<GodObject>(scene, own));
  };
  all.insert(all.begin() + 4, std::move(lifted));
  return all;
}

void answer(haptics::HapticState& state, const haptics::HapticInput& given, Vec3 proxy_mm, bool is_held, Vec3 normal,
            int shape, double spring_n_per_mm) {
  state.proxy_mm = is_held ? proxy_mm : given.tip_mm;
  state.axis = given.axis;
  state.across = given.across;
  state.force_n = is_held ? (proxy_mm - given.tip_mm) * spring_n_per_mm : Vec3{};
  state.normal = is_held ? normal : Vec3{};
  state.touched = is_held ? shape : 0;
  state.face = is_held ? 1 : 0;
  state.held_by = is_held ? 1 : 0;
}

}  // namespace trephine::peers
