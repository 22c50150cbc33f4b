// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "contact/contact.h"
#include "touch/mesh_surfaces.h"
#include "touch/stiffness_ramp.h"

namespace trephine::touch {

/// What a hand feels of a case beside its haptic volume as such; either may be null.
struct Beside {
  const MeshSurfaces* meshes = nullptr;
  const StiffnessRamps* ramps = nullptr;
  std::uint64_t line_lock =
      0;  ///< shapes that hold a tool on the line by which it entered (EnteredLine), bit n: shape n
};

/// A haptic volume, and surfaces beside it, as one: of a way, the first contact with either counts. Where nothing is
/// beside the volume, every answer is the volume's own, to the bit. A contact with a surface has a shape of is_mesh(),
/// and the volume's shape there before and behind it.
///
/// What it refers to must outlive it.
class FeltSpace {
 public:
  FeltSpace(const contact::ContactVolume& volume, Beside beside = {}) : volume_(volume), beside_(beside) {}

  const contact::ContactVolume& contact() const { return volume_; }
  const voxel::HapticVolume& volume() const { return volume_.volume(); }
  const contact::ContactParams& params() const { return volume_.params(); }
  double smallest_side_mm() const { return volume_.smallest_side_mm(); }
  int shape_at(Vec3 place_mm) const { return volume_.shape_at(place_mm); }
  /// As ContactVolume says, with no surface within that distance either.
  void clear_mm(Vec3 tip_mm, const Mat3& frame, const std::vector<Vec3>& points_mm,
                const std::vector<std::uint8_t>& shapes, std::vector<double>& out) const {
    volume_.clear_mm(tip_mm, frame, points_mm, shapes, out);
    for (std::size_t n = 0; beside_.meshes && n < points_mm.size(); ++n)
      out[n] = nearer_mesh(out[n], tip_mm + frame * points_mm[n]);
  }
  double clear_beside_mm(Vec3 place_mm, int shape) const {
    return nearer_mesh(volume_.clear_beside_mm(place_mm, shape), place_mm);
  }
  const MeshSurfaces* meshes() const { return beside_.meshes; }
  std::uint64_t line_lock() const { return beside_.line_lock; }

  contact::Contact intersect(Vec3 start_mm, Vec3 end_mm, int start_shape, const contact::TouchableFaces& faces) const {
    const contact::Contact felt = volume_.intersect(start_mm, end_mm, start_shape, faces);
    return may_meet(start_mm, felt) ? nearer(felt, start_mm, start_shape, faces) : felt;
  }
  contact::Contact cross(Vec3 start_mm, Vec3 end_mm, int start_shape, const contact::TouchableFaces& faces,
                         contact::ContactBox* known = nullptr) const {
    const contact::Contact felt = volume_.cross(start_mm, end_mm, start_shape, faces, known);
    return may_meet(start_mm, felt) ? nearer(felt, start_mm, start_shape, faces) : felt;
  }
  Vec3 normal_of(const contact::Contact& contact, Vec3 way) const {
    return is_mesh(contact.shape) ? contact.normal : volume_.normal_of(contact, way);
  }
  Vec3 exact_normal(const contact::Contact& contact, Vec3 way) const {
    return is_mesh(contact.shape) ? contact.normal : volume_.exact_normal(contact, way);
  }
  /// Whether the place lies within a closed surface.
  bool inside_mesh(Vec3 place_mm, const contact::TouchableFaces& faces) const {
    return beside_.meshes && beside_.meshes->inside(place_mm, faces.front);
  }
  /// What of its shape's stiffness a contact has (StiffnessRamps).
  double stiffness_ratio(const contact::Contact& contact) const {
    return beside_.ramps ? beside_.ramps->ratio_at(volume_, contact) : 1;
  }

 private:
  double nearer_mesh(double clear_mm, Vec3 place_mm) const {
    return beside_.meshes && clear_mm > 0 ? std::min(clear_mm, beside_.meshes->clear_mm(place_mm)) : clear_mm;
  }
  bool may_meet(Vec3 start_mm, const contact::Contact& felt) const {
    return beside_.meshes && beside_.meshes->may_meet(start_mm, felt.point_mm);
  }
  contact::Contact nearer(const contact::Contact& felt, Vec3 start_mm, int start_shape,
                          const contact::TouchableFaces& faces) const;
  const contact::ContactVolume& volume_;
  Beside beside_;
};

}  // namespace trephine::touch
