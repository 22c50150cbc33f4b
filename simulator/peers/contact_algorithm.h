// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Other people's haptic algorithms, to compare ours with [Rizzi, chapter 4]. Nothing of the runtime includes this room:
// only the command `compare` and tests do.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/params.h"
#include "contact/contact.h"
#include "haptics/proxy.h"
#include "touch/felt_mesh.h"

namespace trephine::peers {

using touch::FeltMesh;

/// One point that feels one shape. The interface is that of our own Proxy: a pose and a step in, proxy and force out.
class ContactAlgorithm {
 public:
  virtual ~ContactAlgorithm() = default;
  /// One tick of the servo loop. The force is that of a spring between device and proxy, without limits, friction and
  /// damping, so that algorithms differ by nothing else than the contact that they find. Those of a shared library may
  /// throw.
  virtual const haptics::HapticState& update(const haptics::HapticInput& given) = 0;
  /// What the thread of the pictures does for it, once a picture, with the device as it is then.
  virtual void client(Vec3 device_mm) { static_cast<void>(device_mm); }
  /// Starts again: the next update places the proxy at the device.
  virtual void reset() = 0;
};

/// What there is to feel: the same shape as triangles and as voxels. Both outlive the algorithms.
struct PeerScene {
  const FeltMesh* mesh = nullptr;
  const contact::ContactVolume* contact = nullptr;
  int shape = 1;  ///< its number in the volume
};

/// Parameters that the algorithms' papers leave open.
struct PeerParams {
  double spring_n_per_mm = 0.5;
  double god_object_lift_mm = 0;
  double proxy_radius_mm = 1, local_set_mm = 15, look_ahead_ratio = 3;
  int depth_pixels = 512;
  double depth_side_mm = 40, depth_lift_mm = 0.2;
  double feedback_side_mm = 40;
  int feedback_vertices = 1000000;
  double most_strength_n = 5;
  double plane_reach_mm = 10, recovery_s = 0.02;
  template <class V>
  static void describe(V& v) {
    using P = PeerParams;
    v.number(&P::spring_n_per_mm, "spring_n_per_mm", Range{0.001, 10},
             "Spring between device and proxy, of all algorithms.");
    v.number(&P::god_object_lift_mm, "god_object_lift_mm", Range{0, 0.1},
             "How far above its facets the bare god-object is put against rounding as well; 0: not at all.");
    v.number(&P::proxy_radius_mm, "proxy_radius_mm", Range{0.01, 20}, "Radius of Ruspini's proxy.");
    v.number(&P::local_set_mm, "local_set_mm", Range{0.1, 100},
             "Ruspini's proxy feels the triangles that were this near to its way when the last picture was made.");
    v.number(&P::look_ahead_ratio, "look_ahead_ratio", Range{0, 100},
             "How many pictures ahead that way goes, at the speed since the picture before.");
    v.integer(&P::depth_pixels, "depth_pixels", Range{16, 4096}, "Side of the depth picture, in pixels.");
    v.number(&P::depth_side_mm, "depth_side_mm", Range{1, 500}, "Side of what the depth picture shows.");
    v.number(&P::depth_lift_mm, "depth_lift_mm", Range{0, 10},
             "Where a new depth picture shows the proxy less deep than this, it is lifted onto the surface.");
    v.number(&P::feedback_side_mm, "feedback_side_mm", Range{1, 500},
             "Side of the box about the tool in which the feedback buffer captures triangles.");
    v.integer(&P::feedback_vertices, "feedback_vertices", Range{3, 1e8},
              "How many corners of triangles that buffer holds; what comes later is lost.");
    v.number(&P::most_strength_n, "most_strength_n", Range{0.01, 100},
             "Strength of the scalar surface's plane primitive where the voxel is full.");
    v.number(&P::plane_reach_mm, "plane_reach_mm", Range{0.1, 500},
             "Farthest surface that becomes an intermediate plane.");
    v.number(&P::recovery_s, "recovery_s", Range{0, 1},
             "Time over which the force follows a new intermediate plane; 0: at once.");
  }
};

/// An algorithm that can be compared.
struct AlgorithmKind {
  std::string name;        ///< for tables: a-z and _
  std::string title;       ///< for people
  std::string from;        ///< its source, as docs/developers/bibliography.md names it
  bool feels_mesh = true;  ///< triangles; else voxels, and the number of polygons is that of what is shown alone
  std::function<std::unique_ptr<ContactAlgorithm>(const PeerScene&, const PeerParams&)> make;
};
/// Ours, ours as the dissertation has it (`stepped`), and the peers, in the order of the tables.
std::vector<AlgorithmKind> all_algorithms();

/// The answer of a tick in which the proxy is held at `proxy_mm`, or with `is_held` false free at the device.
void answer(haptics::HapticState& state, const haptics::HapticInput& given, Vec3 proxy_mm, bool is_held, Vec3 normal,
            int shape, double spring_n_per_mm);

}  // namespace trephine::peers
