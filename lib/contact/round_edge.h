// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "contact/constraints.h"
#include "contact/known_normals.h"

namespace trephine::contact {

/// The two faces of a sharp edge that a round tool touches, or the three of a corner. Voxels round an edge off, and the
/// discs that stand there face one way or another; but some voxels away from it, on either side, discs are the faces'
/// own. There planes are taken, and the edge is where they meet; a face that curves along the edge, as the wall of a
/// hole does at its rim, is taken as an arc. Only the constructor allocates.
class RoundEdge {
 public:
  /// `radius_mm`: at most, of a tool. `known`: the samples that it knows already.
  RoundEdge(const ContactVolume& contact, double radius_mm, KnownSamples& known);

  /// Whether the surface between these two shapes (`from`: on the tool's side) has an edge near the place at which a
  /// tool of that radius touches: it falls off steeply behind the plane with that normal. Then the faces are looked up,
  /// a face's normal towards the tool; an edge that is hollow, or no two faces, is none. `computed`: see KnownNormals.
  /// What was found a little beside is taken again until forget(), for a tool slides on.
  bool find(Vec3 place_mm, Vec3 normal, double radius_mm, int from, int into, KnownNormals& normals, int& computed);
  /// Voxels may have changed.
  void forget();
  /// The point of the edge or its faces that is nearest to a place outside; false where that is inside.
  bool nearest(Vec3 place_mm, Vec3& point_mm) const;
  /// How much, at most, voxels cut off of what was found: a tool comes so much nearer to it than to discs.
  double cut_off_mm() const;
  /// How many samples the last find() looked at.
  int looked_at() const { return looked_at_; }

 private:
  static constexpr int max_faces = 3, max_taken = 36;
  struct Taken {  // a sample far enough from the edge to have its face's own normal
    Vec3 point_mm, normal;
    double weight;
  };
  struct Faces {
    int count = 0;
    Plane plane[max_faces];              // its point: at at_mm, along the edge
    double bend[max_faces] = {0, 0, 0};  // 1/mm, along the edge, towards the normal; 0 in a corner
    Vec3 at_mm, along;                   // of two: the edge's direction
  };
  bool find_anew(Vec3 place_mm, Vec3 normal, double radius_mm, int from, int into, KnownNormals& normals,
                 int& computed);
  bool find_two(Vec3 touched_mm, Vec3 on_mm, int tries, Vec3 normal, int from, int into, KnownNormals& normals,
                int& computed);
  bool find_three(Vec3 place_mm, Vec3 touched_mm, Vec3 normal, int from, int into, KnownNormals& normals,
                  int& computed);
  double sharper() const;  // than a right angle, of what voxels cut off: at least 1
  bool is_sharp() const;
  double off_line(Vec3 place_mm, Vec3 line_mm) const;
  bool ends_near(Vec3& place_mm) const;
  double off_faces(Vec3 place_mm) const;
  int count_on_faces() const;
  void look(Vec3 place_mm, double reach_mm, int from, int into);
  void take_samples(Vec3 place_mm, Vec3 normal, double most_voxels, int from, KnownNormals& normals, int& computed);
  Vec3 place_on_edge(Vec3 place_mm) const;
  bool is_convex() const;
  bool part_faces(Vec3 place_mm, int faces, bool flat);
  bool first_means(Vec3* mean, int faces, bool flat) const;
  void fit_all();
  void fit(int face, double within_voxels);
  Plane tangent(int face, double along_mm) const;
  double along_to(Vec3 place_mm) const;

  const ContactVolume& contact_;
  KnownSamples& known_;
  const double voxel_mm_, widest_mm_;
  std::vector<SurfaceSample> samples_;
  int count_ = 0, looked_at_ = 0, taken_count_ = 0;
  Taken taken_[max_taken];
  Faces faces_;
  struct Found {
    Vec3 place_mm, normal;
    double radius_mm = 0;  // 0: nothing was
    int from, into;
    bool edge;
    Faces faces;
  };
  static constexpr int most_found = 12;
  Found found_[most_found];
  int last_found_ = 0;
};

}  // namespace trephine::contact
