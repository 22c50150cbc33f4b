// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/round_edge.h"

#include <algorithm>
#include <cmath>

namespace trephine::contact {
namespace {

constexpr double near_voxels = 1.9, far_voxels = 3.2;  // from an edge: where normals no longer know of it; and enough
constexpr double steep = 0.42;                         // sine: how steeply a face falls off behind the touch's plane
constexpr double least_turn = 0.87;                    // cosine between two faces
constexpr double faces_away = -0.3;                    // cosine: no face of this edge
constexpr double alike = 0.85;                         // length of the mean of a face's normals
constexpr double convex = 0.05;                        // sine: how far each face lies behind the other
constexpr double cut_off_voxels = 0.6;                 // of an edge, at most, by half occupancy and discs together
constexpr double own_voxels = 0.9;                     // from the other face's plane: where places are one face's own
constexpr double off_voxels = 0.4, most_turn = 0.3;    // of a sample from its plane; tangent, of a plane that is fitted
constexpr double again_voxels = 0.3, again_alike = 0.97;  // cosine: of a touch, where the last one's faces hold
constexpr double centred_voxels = 0.6;                    // about the edge, where the faces are taken
constexpr int least_samples = 3, least_fallen = 2, rounds = 2, looks = 4;

double largest(Vec3 s) { return std::max({s.x, s.y, s.z}); }

// What lies far along the edge counts less, for an edge may be curved.
double weight_along(double along_mm, double voxel_mm) {
  const double off = along_mm / (far_voxels * voxel_mm);
  return std::max(0.02, (1 - off * off) * (1 - off * off));
}

// How far from where it touches a ball's edge may be: where that is cut off by so much, it touches a face first.
double edge_within_mm(double radius_mm, double voxel_mm) {
  return std::max(far_voxels * voxel_mm, std::sqrt(2 * cut_off_voxels * voxel_mm * radius_mm) + voxel_mm);
}

}  // namespace

RoundEdge::RoundEdge(const ContactVolume& contact, double radius_mm)
    : contact_(contact),
      voxel_mm_(largest(contact.volume().voxels.spacing_mm)),
      widest_mm_(edge_within_mm(radius_mm, voxel_mm_)) {
  const Vec3 s = contact.volume().voxels.spacing_mm;
  double voxels = 3;
  for (int a = 0; a < 3; ++a) voxels *= 2 * widest_mm_ / s[a] + 4;
  samples_.resize(std::size_t(std::min(voxels, 20000.0)));
}

void RoundEdge::look(Vec3 place, double reach, int from, int into) {
  const int all = contact_.samples_near(place, place, reach, samples_.data(), int(samples_.size()));
  looked_at_ += all;
  count_ = 0;
  for (int n = 0; n < all; ++n) {
    const SurfaceSample& s = samples_[std::size_t(n)];
    if ((s.low == from && s.high == into) || (s.low == into && s.high == from)) samples_[std::size_t(count_++)] = s;
  }
}

void RoundEdge::forget() {
  for (Found& f : found_) f.radius_mm = 0;
}

bool RoundEdge::find(Vec3 place, Vec3 normal, double radius, int from, int into, KnownNormals& normals, int& computed) {
  looked_at_ = 0;
  for (const Found& f : found_) {
    if (f.radius_mm != radius || f.from != from || f.into != into) continue;
    if (norm(place - f.place_mm) > again_voxels * voxel_mm_ || dot(normal, f.normal) < again_alike) continue;
    std::copy(f.planes, f.planes + 2, planes_);
    return f.edge;
  }
  const bool edge = find_anew(place, normal, radius, from, into, normals, computed);
  last_found_ = (last_found_ + 1) % most_found;
  found_[last_found_] = {place, normal, radius, from, into, edge, {planes_[0], planes_[1]}};
  return edge;
}

bool RoundEdge::find_anew(Vec3 touched, Vec3 normal, double radius, int from, int into, KnownNormals& normals,
                          int& computed) {
  const double least = near_voxels * voxel_mm_;
  look(touched, std::min(widest_mm_, edge_within_mm(radius, voxel_mm_)), from, into);
  int fallen = 0;
  Vec3 sum;
  for (int n = 0; n < count_; ++n) {
    const Vec3 d = samples_[std::size_t(n)].point_mm - touched;
    if (const double far = norm(d); far < least || dot(normal, d) > -steep * far) continue;
    ++fallen;
    sum += d - normal * dot(normal, d);
  }
  if (fallen < least_fallen) return false;
  Vec3 place = touched + sum / double(fallen);
  for (int n = 0; n < looks; ++n) {
    look(place, far_voxels * voxel_mm_, from, into);
    if (!part_faces(take_faces(place, normal, from, normals, computed), place)) {
      if (n > 1) return false;  // one face was seen, or hardly the other: a voxel back, then on
      place += normalized(sum) * ((n == 0 ? -1 : 2) * voxel_mm_);
      continue;
    }
    const Vec3 on_edge = place_on_edge(place);
    if (norm(on_edge - touched) > widest_mm_) return false;
    if (norm(on_edge - place) < centred_voxels * voxel_mm_) break;
    place = on_edge;
  }
  if (!is_convex()) return false;
  for (int round = 0; round < rounds; ++round)
    for (int face = 0; face < 2; ++face) fit(face, place);
  return true;
}

// The normals of some samples around the place, far enough from it to be those of a face; how many.
int RoundEdge::take_faces(Vec3 place, Vec3 normal, int from, KnownNormals& normals, int& computed) {
  const double least = near_voxels * voxel_mm_, most = far_voxels * voxel_mm_;
  const auto is_far = [&](const SurfaceSample& s) { return norm(s.point_mm - place) >= least; };
  const int around = int(std::count_if(samples_.begin(), samples_.begin() + count_, is_far));
  const int each = std::max(1, (around + most_faces - 1) / most_faces);
  int count = 0, seen = 0;
  for (int n = 0; n < count_; ++n) {
    const SurfaceSample& s = samples_[std::size_t(n)];
    if (!is_far(s) || seen++ % each != 0) continue;
    const Vec3 own = normals.of(s, computed), face = s.low == from ? own : -own;
    if (own == Vec3{} || dot(face, normal) < faces_away) continue;
    const double far = norm(s.point_mm - place);
    faces_[count++] = {s.point_mm, face, (far - 0.9 * least) * (1.05 * most - far)};
  }
  return count;
}

// Of the line in which the two planes meet.
Vec3 RoundEdge::place_on_edge(Vec3 place) const {
  const Vec3 a = planes_[0].normal, b = planes_[1].normal;
  const double c = dot(a, b), off_a = dot(a, planes_[0].point_mm - place), off_b = dot(b, planes_[1].point_mm - place);
  return place + (a * (off_a - c * off_b) + b * (off_b - c * off_a)) / (1 - c * c);
}

// Each face lies behind the other.
bool RoundEdge::is_convex() const {
  const Vec3 across = planes_[1].point_mm - planes_[0].point_mm;
  return dot(planes_[0].normal, across) < -convex * norm(across) &&
         dot(planes_[1].normal, across) > convex * norm(across);
}

// Moves and turns a face's plane to where the surface is, which is better known than its normals.
void RoundEdge::fit(int face, Vec3 place) {
  Plane& plane = planes_[face];
  const Plane& other = planes_[1 - face];
  const Vec3 edge = normalized(cross(plane.normal, other.normal)), into = cross(plane.normal, edge);
  double sum = 0, mean[3] = {0, 0, 0};
  struct Place {
    double weight, at[3];  // along the edge, across it, off the plane
  };
  const auto of = [&](const SurfaceSample& s) {
    const Vec3 d = s.point_mm - plane.point_mm;
    Place p{0, {dot(d, edge), dot(d, into), dot(d, plane.normal)}};
    if (std::abs(p.at[2]) > off_voxels * voxel_mm_) return p;
    if (dot(s.point_mm - other.point_mm, other.normal) > -own_voxels * voxel_mm_) return p;
    p.weight = weight_along(dot(edge, s.point_mm - place), voxel_mm_);
    return p;
  };
  int own = 0;
  for (int n = 0; n < count_; ++n) {
    const Place p = of(samples_[std::size_t(n)]);
    own += p.weight > 0;
    sum += p.weight;
    for (int a = 0; a < 3; ++a) mean[a] += p.weight * p.at[a];
  }
  if (own < 2 * least_samples) return;
  for (double& m : mean) m /= sum;
  double uu = 0, uv = 0, vv = 0, uh = 0, vh = 0;
  for (int n = 0; n < count_; ++n) {
    const Place p = of(samples_[std::size_t(n)]);
    if (!(p.weight > 0)) continue;
    const double u = p.at[0] - mean[0], v = p.at[1] - mean[1], h = p.at[2] - mean[2];
    uu += p.weight * u * u;
    uv += p.weight * u * v;
    vv += p.weight * v * v;
    uh += p.weight * u * h;
    vh += p.weight * v * h;
  }
  const double det = uu * vv - uv * uv;
  if (!(det > 0.05 * (uu + vv) * (uu + vv) / 4)) return;
  const double a = (uh * vv - vh * uv) / det, b = (vh * uu - uh * uv) / det;
  if (std::hypot(a, b) > most_turn) return;
  plane.point_mm += edge * mean[0] + into * mean[1] + plane.normal * mean[2];
  plane.normal = normalized(plane.normal - edge * a - into * b);
}

// Into two, about the two that face least alike.
bool RoundEdge::part_faces(int count, Vec3 place) {
  int first = 0, second = 0;
  double least = 1;
  for (int a = 0; a < count; ++a)
    for (int b = a + 1; b < count; ++b)
      if (const double alike_ab = dot(faces_[a].normal, faces_[b].normal); alike_ab < least) {
        least = alike_ab;
        first = a;
        second = b;
      }
  if (least > least_turn) return false;
  Vec3 mean[2] = {faces_[first].normal, faces_[second].normal};
  for (int round = 0; round <= rounds; ++round) {
    const Vec3 along = normalized(cross(mean[0], mean[1]));
    Vec3 normal[2], point[2];
    double sum[2] = {0, 0};
    int own[2] = {0, 0};
    for (int n = 0; n < count; ++n) {
      const Face& f = faces_[n];
      const int side = dot(f.normal, mean[1]) > dot(f.normal, mean[0]) ? 1 : 0;
      const double weight = f.weight * weight_along(dot(along, f.point_mm - place), voxel_mm_);
      normal[side] += f.normal * weight;
      point[side] += f.point_mm * weight;
      sum[side] += weight;
      ++own[side];
    }
    for (int side = 0; side < 2; ++side) {
      if (own[side] < least_samples) return false;
      if (norm(normal[side]) < alike * sum[side]) return false;
      mean[side] = normalized(normal[side]);
      planes_[side] = {point[side] / sum[side], mean[side]};
    }
  }
  return dot(mean[0], mean[1]) <= least_turn;
}

bool RoundEdge::nearest(Vec3 place, Vec3& point) const {
  const Plane inwards[2] = {{planes_[0].point_mm, -planes_[0].normal}, {planes_[1].point_mm, -planes_[1].normal}};
  Nearest found;
  if (!nearest_before(inwards, 2, place, found)) return false;
  point = found.point_mm;
  return norm(place - point) > 1e-6;
}

}  // namespace trephine::contact
