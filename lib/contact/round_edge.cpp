// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/round_edge.h"

#include <algorithm>
#include <cmath>

#include "contact/edge_weights.h"

namespace trephine::contact {
namespace {

constexpr double near_voxels = 1.9;                       // from an edge: where normals no longer know of it
constexpr double steep = 0.2;                             // sine: how steeply a face falls off behind the touch's plane
constexpr double least_turn = 0.906, least_begun = 0.94;  // cosine between two faces, and between their first means
constexpr double least_corner_turn = 0.87;                // the same of a corner's
constexpr double round_by_turn = 0.12;                    // voxels by radian: a surface so far under its edge is round
constexpr double crest_voxels = 0.7;                      // about the line of an edge: what was rounded off
constexpr double faces_away = -0.3;                       // cosine: no face of this edge
constexpr double alike = 0.85;                            // length of the mean of a face's normals
constexpr double cut_off_voxels = 0.6;                    // of a right angle, at most, by half occupancy and discs
constexpr double corner_off_voxels = 1.3;                 // the same of a corner
constexpr double again_voxels = 0.3, again_alike = 0.97;  // cosine: of a touch, where the last one's faces hold
constexpr double centred_voxels = 0.6;                    // about the edge, where the faces are taken
constexpr double third_turn = 0.7;       // cosine, at most: between a corner's third face and the two others
constexpr double corner_voxels = 4.5;    // how far a third face is looked for
constexpr double third_voxels = 0.7;     // how far behind the others, at least, places are its own
constexpr double own_turn = 0.6;         // cosine, at least: between a sample's normal and its face's
constexpr double most_sharper = 1.75;    // of an edge of 60 degrees; what is more acute was not measured
constexpr double acute_turn = -0.18;     // cosine between two faces, at most
constexpr double least_det = 0.2;        // of a corner's normals
constexpr double least_explained = 0.7;  // of the samples around, where two faces are not all that is there
constexpr int least_on_corner = 12;      // such samples
constexpr int least_fallen = 2, rounds = 3, looks = 6;

double largest(Vec3 s) { return std::max({s.x, s.y, s.z}); }

// How far from where it touches a ball's edge may be: where that is cut off by so much, it touches a face first.
double edge_within_mm(double radius_mm, double voxel_mm) {
  return std::max(edge_far_voxels * voxel_mm, std::sqrt(2 * cut_off_voxels * voxel_mm * radius_mm) + voxel_mm);
}

}  // namespace

RoundEdge::RoundEdge(const ContactVolume& contact, double radius_mm, KnownSamples& known)
    : contact_(contact),
      known_(known),
      voxel_mm_(largest(contact.volume().voxels.spacing_mm)),
      widest_mm_(edge_within_mm(radius_mm, voxel_mm_)) {
  const Vec3 s = contact.volume().voxels.spacing_mm;
  double voxels = 3;
  for (int a = 0; a < 3; ++a) voxels *= 2 * std::max(widest_mm_, corner_voxels * voxel_mm_) / s[a] + 4;
  samples_.resize(std::size_t(std::min(voxels, 20000.0)));
}

void RoundEdge::look(Vec3 place, double reach, int from, int into) {
  const int all = contact_.samples_near(place, place, reach, samples_.data(), int(samples_.size()), &known_);
  looked_at_ += all;
  count_ = 0;
  for (int n = 0; n < all; ++n) {
    const SurfaceSample& s = samples_[std::size_t(n)];
    if ((s.low == from && s.high == into) || (s.low == into && s.high == from)) samples_[std::size_t(count_++)] = s;
  }
}

double RoundEdge::cut_off_mm() const {
  return (faces_.count > 2 ? corner_off_voxels : cut_off_voxels * sharper()) * voxel_mm_;
}

double RoundEdge::sharper() const {
  const double turn = dot(faces_.plane[0].normal, faces_.plane[1].normal);
  return std::clamp(std::sqrt((1 - turn) / std::max(0.1, 1 + turn)), 1.0, most_sharper);
}

void RoundEdge::forget() {
  for (Found& f : found_) f.radius_mm = 0;
}

bool RoundEdge::find(Vec3 place, Vec3 normal, double radius, int from, int into, KnownNormals& normals, int& computed) {
  looked_at_ = 0;
  for (const Found& f : found_) {
    if (f.radius_mm != radius || f.from != from || f.into != into) continue;
    if (norm(place - f.place_mm) > again_voxels * voxel_mm_ || dot(normal, f.normal) < again_alike) continue;
    faces_ = f.faces;
    return f.edge;
  }
  const bool edge = find_anew(place, normal, radius, from, into, normals, computed);
  last_found_ = (last_found_ + 1) % most_found;
  found_[last_found_] = {place, normal, radius, from, into, edge, faces_};
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
  const Vec3 on = sum / double(fallen);
  const bool two = find_two(touched, on, 3, normal, from, into, normals, computed);
  if (two && !is_sharp()) return false;
  const Vec3 place = two ? faces_.at_mm : touched;
  Vec3 end = place;
  look(place, corner_voxels * voxel_mm_, from, into);
  if (two && !ends_near(end)) return true;
  // Two faces do not explain what is there. Three may, and are taken where they explain more.
  const Faces of_two = faces_;
  const bool three = find_three(place, touched, normal, from, into, normals, computed) ||
                     (norm(end - place) > voxel_mm_ && find_three(end, touched, normal, from, into, normals, computed));
  if (!two && !three)
    return find_two(touched, on - normalized(on) * (3 * voxel_mm_), 0, normal, from, into, normals, computed) &&
           is_sharp();
  const Faces of_three = faces_;
  const int all = count_, on_three = three ? count_on_faces() : 0;
  faces_ = of_two;
  const int on_two = two ? count_on_faces() : 0;
  if (on_three <= std::max(on_two, least_on_corner)) return on_two > least_explained * all;
  faces_ = of_three;
  return true;
}

// Two faces, from where the surface falls off steeply.
bool RoundEdge::find_two(Vec3 touched, Vec3 on, int tries, Vec3 normal, int from, int into, KnownNormals& normals,
                         int& computed) {
  Vec3 place = touched + on;
  int missed = 0;
  for (int n = 0; n < looks; ++n) {
    look(place, edge_far_voxels * voxel_mm_, from, into);
    take_samples(place, normal, edge_far_voxels, from, normals, computed);
    if (!part_faces(place, 2, false) && !part_faces(place, 2, true)) {
      // One face was seen, or hardly the other: a voxel back, two, then on.
      constexpr double voxels_on[] = {-1, -1, 3};
      if (missed == tries) return false;
      place += normalized(on) * (voxels_on[missed++] * voxel_mm_);
      continue;
    }
    const Vec3 on_edge = place_on_edge(touched);
    if (norm(on_edge - touched) > widest_mm_) return false;
    if (norm(on_edge - place) < centred_voxels * voxel_mm_) break;
    place = on_edge;
  }
  if (!is_convex()) return false;
  faces_.at_mm = place;
  fit_all();
  return is_convex() && dot(faces_.plane[0].normal, faces_.plane[1].normal) <= least_turn;
}

// Whether the surface comes as near to the line in which the faces meet as it does at an edge. That of a small ball is
// taken for two faces, too, but remains far below their line.
bool RoundEdge::is_sharp() const {
  const Vec3 line = place_on_edge(faces_.at_mm);
  double under = 0;
  int count = 0;
  for (int n = 0; n < count_; ++n) {
    const Vec3 at = samples_[std::size_t(n)].point_mm;
    if (off_line(at, line) > crest_voxels * voxel_mm_) continue;
    under -= off_faces(at);
    ++count;
  }
  const double turn = std::acos(std::clamp(dot(faces_.plane[0].normal, faces_.plane[1].normal), -1.0, 1.0));
  return count > 0 && under < round_by_turn * turn * voxel_mm_ * count;
}

double RoundEdge::off_line(Vec3 place, Vec3 line) const {
  const Vec3 d = place - line;
  return norm(d - faces_.along * dot(faces_.along, d));
}

// Whether samples stand there that are of neither of the two faces, as where an edge ends in a corner; that is about
// the place, then.
bool RoundEdge::ends_near(Vec3& place) const {
  bool ends = false;
  const bool acute = dot(faces_.plane[0].normal, faces_.plane[1].normal) < acute_turn;
  for (int n = 0; n < taken_count_; ++n) {
    // Along an acute edge normals of what was rounded off are like neither face's.
    if (acute && off_line(taken_[n].point_mm, faces_.at_mm) < near_voxels * voxel_mm_) continue;
    ends = ends || std::max(dot(taken_[n].normal, faces_.plane[0].normal),
                            dot(taken_[n].normal, faces_.plane[1].normal)) < own_turn;
  }
  double sum = 0;
  int behind = 0;
  for (int n = 0; n < count_; ++n) {
    const Vec3 at = samples_[std::size_t(n)].point_mm;
    const double off = off_faces(at);
    ends = ends || off > third_voxels * voxel_mm_;
    if (off > -third_voxels * sharper() * voxel_mm_) continue;
    sum += dot(faces_.along, at - faces_.at_mm);
    ++behind;
  }
  if (behind > 0) place = faces_.at_mm + faces_.along * (sum / behind);
  return ends || behind > 0;
}

// Three faces around the place, then around where they meet.
bool RoundEdge::find_three(Vec3 place, Vec3 touched, Vec3 normal, int from, int into, KnownNormals& normals,
                           int& computed) {
  look(place, corner_voxels * voxel_mm_, from, into);
  take_samples(place, normal, corner_voxels, from, normals, computed);
  if (!part_faces(place, 3, false)) return false;
  faces_.at_mm = place;
  fit_all();
  const Plane* p = faces_.plane;
  const Vec3 across = cross(p[1].normal, p[2].normal);
  const double det = dot(p[0].normal, across);
  if (std::abs(det) < least_det) return false;
  const double off[3] = {dot(p[0].normal, p[0].point_mm - place), dot(p[1].normal, p[1].point_mm - place),
                         dot(p[2].normal, p[2].point_mm - place)};
  const Vec3 corner =
      place +
      (across * off[0] + cross(p[2].normal, p[0].normal) * off[1] + cross(p[0].normal, p[1].normal) * off[2]) / det;
  if (norm(corner - touched) > 2 * widest_mm_) return false;
  look(corner, corner_voxels * voxel_mm_, from, into);
  faces_.at_mm = corner;
  fit_all();
  for (int a = 0; a < 3; ++a)
    if (dot(p[a].normal, p[(a + 1) % 3].normal) > least_corner_turn) return false;
  return true;
}

// Some samples around the place, far enough from it to have a face's normal.
void RoundEdge::take_samples(Vec3 place, Vec3 normal, double most_voxels, int from, KnownNormals& normals,
                             int& computed) {
  const double least = near_voxels * voxel_mm_, most = most_voxels * voxel_mm_;
  const auto is_far = [&](const SurfaceSample& s) { return norm(s.point_mm - place) >= least; };
  const int around = int(std::count_if(samples_.begin(), samples_.begin() + count_, is_far));
  const int max = most_voxels > edge_far_voxels ? max_taken : max_taken * 2 / 3;
  const int each = std::max(1, (around + max - 1) / max);
  int seen = 0;
  taken_count_ = 0;
  for (int n = 0; n < count_; ++n) {
    const SurfaceSample& s = samples_[std::size_t(n)];
    if (!is_far(s) || seen++ % each != 0) continue;
    const Vec3 own = normals.of(s, computed), face = s.low == from ? own : -own;
    if (own == Vec3{} || dot(face, normal) < faces_away) continue;
    const double far = norm(s.point_mm - place);
    taken_[taken_count_++] = {s.point_mm, face, (far - 0.9 * least) * (1.05 * most - far)};
  }
}

// The normal that most others are like, and ones that most of the rest are like. Of faces that turn but little (`flat`)
// what lies between them is like both, so alike means more.
bool RoundEdge::first_means(Vec3* mean, int faces, bool flat) const {
  const auto alike_by = [flat](double cosine) {
    if (!(cosine > 0)) return 0.0;
    double by = cosine * cosine;
    for (int n = 0; flat && n < 4; ++n) by *= by;
    return by;
  };
  const double least = faces > 2 ? third_turn : flat ? least_begun : least_turn;
  double left[max_taken];
  std::fill(left, left + taken_count_, 1.0);
  int seed[max_faces];
  for (int face = 0; face < faces; ++face) {
    double most = 0;
    seed[face] = -1;
    for (int a = 0; a < taken_count_; ++a) {
      const Taken& t = taken_[a];
      bool fits = true;
      for (int other = 0; other < face; ++other) {  // each lies behind the others
        const Taken& o = taken_[seed[other]];
        const Vec3 across = t.point_mm - o.point_mm;
        fits = fits && dot(t.normal, o.normal) <= least && dot(o.normal, across) <= 0 && dot(t.normal, across) >= 0;
      }
      if (!fits) continue;
      double sum = 0;
      for (int b = 0; b < taken_count_; ++b) sum += left[b] * alike_by(dot(t.normal, taken_[b].normal));
      if (sum <= most) continue;
      most = sum;
      seed[face] = a;
    }
    if (seed[face] < 0) return false;
    mean[face] = taken_[seed[face]].normal;
    for (int b = 0; b < taken_count_; ++b) left[b] -= std::min(left[b], alike_by(dot(mean[face], taken_[b].normal)));
  }
  return true;
}

// Parts the samples by the face whose normal theirs is most like, some rounds.
bool RoundEdge::part_faces(Vec3 place, int faces, bool flat) {
  Vec3 mean[max_faces];
  if (!first_means(mean, faces, flat)) return false;
  for (int round = 0; round < rounds; ++round) {
    const Vec3 along = normalized(cross(mean[0], mean[1]));
    Vec3 normal[max_faces], point[max_faces];
    double sum[max_faces] = {0, 0, 0};
    int own[max_faces] = {0, 0, 0};
    for (int n = 0; n < taken_count_; ++n) {
      const Taken& t = taken_[n];
      int side = 0;
      for (int other = 1; other < faces; ++other)
        if (dot(t.normal, mean[other]) > dot(t.normal, mean[side])) side = other;
      if (dot(t.normal, mean[side]) < own_turn) continue;
      const double weight = faces > 2 ? 1 : t.weight * weight_along_edge(dot(along, t.point_mm - place), voxel_mm_);
      normal[side] += t.normal * weight;
      point[side] += t.point_mm * weight;
      sum[side] += weight;
      ++own[side];
    }
    for (int side = 0; side < faces; ++side) {
      if (own[side] < least_face_samples) return false;
      if (norm(normal[side]) < (faces > 2 ? 0.7 : alike) * sum[side]) return false;
      mean[side] = normalized(normal[side]);
      faces_.plane[side] = {point[side] / sum[side], mean[side]};
      faces_.bend[side] = 0;
    }
  }
  faces_.count = faces;
  return dot(mean[0], mean[1]) <= (faces > 2 ? least_corner_turn : least_turn);
}

}  // namespace trephine::contact
