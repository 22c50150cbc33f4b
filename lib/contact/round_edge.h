// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "contact/constraints.h"
#include "contact/known_normals.h"

namespace trephine::contact {

/// The two faces of a sharp edge that a round tool touches. Voxels round an edge off, and the discs that stand there
/// face one way or another; but some voxels away from it, on either side, discs are the faces' own. There two planes
/// are taken, and the edge is where they meet. Only the constructor allocates.
class RoundEdge {
 public:
  /// `radius_mm`: at most, of a tool.
  RoundEdge(const ContactVolume& contact, double radius_mm);

  /// Whether the surface between these two shapes (`from`: on the tool's side) has an edge near the place at which a
  /// tool of that radius touches: it falls off steeply behind the plane with that normal. Then the faces are looked up,
  /// a face's normal towards the tool; an edge that is hollow, or no two faces, is none. `computed`: see KnownNormals.
  /// What was found a little beside is taken again until forget(), for a tool slides on.
  bool find(Vec3 place_mm, Vec3 normal, double radius_mm, int from, int into, KnownNormals& normals, int& computed);
  /// Voxels may have changed.
  void forget();
  /// The point of the edge or its faces that is nearest to a place outside; false where that is inside.
  bool nearest(Vec3 place_mm, Vec3& point_mm) const;
  /// How many samples the last find() looked at.
  int looked_at() const { return looked_at_; }

 private:
  struct Face {
    Vec3 point_mm, normal;
    double weight;
  };
  bool find_anew(Vec3 place_mm, Vec3 normal, double radius_mm, int from, int into, KnownNormals& normals,
                 int& computed);
  void look(Vec3 place_mm, double reach_mm, int from, int into);
  int take_faces(Vec3 place_mm, Vec3 normal, int from, KnownNormals& normals, int& computed);
  Vec3 place_on_edge(Vec3 place_mm) const;
  bool is_convex() const;
  bool part_faces(int count, Vec3 place_mm);
  void fit(int face, Vec3 place_mm);

  static constexpr int most_faces = 24;
  const ContactVolume& contact_;
  const double voxel_mm_, widest_mm_;
  std::vector<SurfaceSample> samples_;
  int count_ = 0, looked_at_ = 0;
  Face faces_[most_faces];
  Plane planes_[2];
  struct Found {
    Vec3 place_mm, normal;
    double radius_mm = 0;  // 0: nothing was
    int from, into;
    bool edge;
    Plane planes[2];
  };
  static constexpr int most_found = 12;
  Found found_[most_found];
  int last_found_ = 0;
};

}  // namespace trephine::contact
