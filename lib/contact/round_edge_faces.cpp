// SPDX-License-Identifier: GPL-3.0-or-later
// The faces of an edge or a corner: planes, or arcs along the edge, that are fitted to where the surface is.
#include <algorithm>
#include <cmath>

#include "contact/edge_weights.h"
#include "contact/round_edge.h"

namespace trephine::contact {
namespace {

constexpr double convex = 0.05;      // sine: how far each face lies behind the other
constexpr double own_voxels = 0.9;   // from the other face's plane, at a right angle: where places are one face's own
constexpr double flat_voxels = 1.3;  // along a face that turns but little, from the edge: the same
constexpr double most_turn = 0.5, most_corner_turn = 0.7;  // tangent, of a plane that is fitted
constexpr double tightest_voxels = 1.5;                    // radius of an arc
constexpr double on_voxels = 0.3;                          // from its faces, at most: a sample that they explain

// How far an arc of that bend has left its tangent, divided by the bend.
double arc_by_bend(double bend, double along) {
  const double q = std::min(0.95, std::abs(bend * along));
  return q < 1e-3 ? 0.5 * along * along : (1 - std::sqrt(1 - q * q)) / (bend * bend);
}

}  // namespace

// How far a place lies outside of the faces; below 0: inside.
double RoundEdge::off_faces(Vec3 place) const {
  const double along = faces_.count == 2 ? dot(faces_.along, place - faces_.at_mm) : 0;
  double most = -1e9;
  for (int n = 0; n < faces_.count; ++n) {
    const Plane p = faces_.count == 2 ? tangent(n, along) : faces_.plane[n];
    most = std::max(most, dot(p.normal, place - p.point_mm));
  }
  return most;
}

// How many samples lie on the faces, of those that the last look found.
int RoundEdge::count_on_faces() const {
  int count = 0;
  for (int n = 0; n < count_; ++n)
    count += std::abs(off_faces(samples_[std::size_t(n)].point_mm)) < on_voxels * voxel_mm_;
  return count;
}

// Of the line in which the first two planes meet.
Vec3 RoundEdge::place_on_edge(Vec3 place) const {
  const Plane &p = faces_.plane[0], &q = faces_.plane[1];
  const double c = dot(p.normal, q.normal), off_a = dot(p.normal, p.point_mm - place),
               off_b = dot(q.normal, q.point_mm - place);
  return place + (p.normal * (off_a - c * off_b) + q.normal * (off_b - c * off_a)) / (1 - c * c);
}

// Each face lies behind the other.
bool RoundEdge::is_convex() const {
  const Plane &p = faces_.plane[0], &q = faces_.plane[1];
  const Vec3 across = q.point_mm - p.point_mm;
  return dot(p.normal, across) < -convex * norm(across) && dot(q.normal, across) > convex * norm(across);
}

Plane RoundEdge::tangent(int face, double along) const {
  const Plane& p = faces_.plane[face];
  const double bend = faces_.bend[face], q = std::clamp(bend * along, -0.95, 0.95);
  const Vec3 normal = normalized(p.normal - faces_.along * (q / std::sqrt(1 - q * q)));
  return {p.point_mm + faces_.along * along + p.normal * (bend * arc_by_bend(bend, along)), normal};
}

void RoundEdge::fit_all() {
  static constexpr double edge_within[] = {0.4, 0.4, 0.4}, corner_within[] = {1.5, 1, 0.7, 0.5, 0.4, 0.3};
  const bool corner = faces_.count > 2;
  for (int round = 0; round < (corner ? 6 : 3); ++round)
    for (int face = 0; face < faces_.count; ++face) fit(face, corner ? corner_within[round] : edge_within[round]);
  faces_.along = normalized(cross(faces_.plane[0].normal, faces_.plane[1].normal));
}

// Moves, turns and bends a face to where the surface is, which is better known than its normals.
void RoundEdge::fit(int face, double within_voxels) {
  const bool corner = faces_.count > 2;
  const Vec3 normal = faces_.plane[face].normal, beside = faces_.plane[(face + 1) % faces_.count].normal;
  faces_.along = normalized(cross(normal, beside));
  const Vec3 along = faces_.along, across = cross(normal, along);
  Vec3& origin = faces_.plane[face].point_mm;
  origin += along * dot(faces_.at_mm - origin, along);
  const double bend = faces_.bend[face];
  const int unknowns = corner ? 3 : 4;  // off, turned along and across the edge, bent
  const double turn = dot(normal, beside), sine = std::sqrt(std::max(0.0, 1 - turn * turn));
  const double own_mm = voxel_mm_ * (corner     ? own_voxels
                                     : turn < 0 ? own_voxels * sharper() * sine
                                                : std::min(own_voxels, flat_voxels * sine));
  double m[4][5] = {};
  int own = 0;
  for (int n = 0; n < count_; ++n) {
    const Vec3 place = samples_[std::size_t(n)].point_mm, d = place - origin;
    const double u = dot(d, along), v = dot(d, across), h = dot(d, normal);
    if (std::abs(h - bend * arc_by_bend(bend, u)) > within_voxels * voxel_mm_) continue;
    bool others = false;
    for (int other = 0; other < faces_.count; ++other) {
      if (other == face) continue;
      const Plane p = corner ? faces_.plane[other] : tangent(other, dot(along, place - faces_.at_mm));
      others = others || dot(place - p.point_mm, p.normal) > -own_mm;
    }
    if (others) continue;
    ++own;
    const double weight = corner ? 1 : weight_along_edge(u, voxel_mm_), basis[4] = {1, u, v, arc_by_bend(bend, u)};
    for (int r = 0; r < unknowns; ++r) {
      for (int c = 0; c < unknowns; ++c) m[r][c] += weight * basis[r] * basis[c];
      m[r][4] += weight * basis[r] * h;
    }
  }
  if (own < 2 * least_face_samples) return;
  double is[4] = {0, 0, 0, 0};
  for (int c = 0; c < unknowns; ++c) {
    const double least = 1e-3 * (c == 0 ? 1 : c < 3 ? voxel_mm_ * voxel_mm_ : std::pow(voxel_mm_, 4));
    if (!(m[c][c] > least)) return;
    for (int r = c + 1; r < unknowns; ++r) {
      const double f = m[r][c] / m[c][c];
      for (int k = c; k <= 4; ++k) m[r][k] -= f * m[c][k];
    }
  }
  for (int r = unknowns - 1; r >= 0; --r) {
    is[r] = m[r][4];
    for (int c = r + 1; c < unknowns; ++c) is[r] -= m[r][c] * is[c];
    is[r] /= m[r][r];
  }
  if (std::hypot(is[1], is[2]) > (corner ? most_corner_turn : most_turn)) return;
  origin += normal * is[0];
  faces_.plane[face].normal = normalized(normal - along * is[1] - across * is[2]);
  const double most_bend = 1 / (tightest_voxels * voxel_mm_);
  faces_.bend[face] = std::clamp(is[3], -most_bend, most_bend);
}

// How far along the edge from at_mm, where that bends as its faces do, its nearest point to the place is.
double RoundEdge::along_to(Vec3 place) const {
  const Vec3 a = faces_.plane[0].normal, b = faces_.plane[1].normal;
  const double c = dot(a, b), most = edge_far_voxels * voxel_mm_;
  const auto off = [&](double by_a, double by_b) {
    return (a * (by_a - c * by_b) + b * (by_b - c * by_a)) / (1 - c * c);
  };
  const Vec3 begin = place_on_edge(faces_.at_mm), bend = off(faces_.bend[0], faces_.bend[1]);
  double u = 0;
  for (int n = 0; n < 3; ++n) {
    const Vec3 from = place - begin - faces_.along * u - bend * (0.5 * u * u), way = faces_.along + bend * u;
    u = std::clamp(u + dot(from, way) / std::max(0.2, dot(way, way) - dot(from, bend)), -most, most);
  }
  return u;
}

bool RoundEdge::nearest(Vec3 place, Vec3& point) const {
  const double along = faces_.count == 2 ? along_to(place) : 0;
  Plane inwards[max_faces];
  for (int n = 0; n < faces_.count; ++n) {
    inwards[n] = faces_.count == 2 ? tangent(n, along) : faces_.plane[n];
    inwards[n].normal = -inwards[n].normal;
  }
  Nearest found;
  if (!nearest_before(inwards, faces_.count, place, found)) return false;
  point = found.point_mm;
  return norm(place - point) > 1e-6;
}

}  // namespace trephine::contact
