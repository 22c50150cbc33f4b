// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/round_body.h"

#include <algorithm>
#include <cmath>

#include "contact/contact_samples.h"

namespace trephine::haptics {
namespace {

constexpr int frames_known = 16;      // after which it looks again, for another thread may have cut
constexpr double together = 0.05;     // of a voxel: contacts of a rod that touch as deep as the deepest
constexpr double beside = 0.25;       // of a voxel: how much less deep another shape may be and still be felt
constexpr double faces_alike = 0.8;   // cosine between the normals of two shapes that are felt together
constexpr double no_edge = 0.94;      // cosine: discs that face the way of the touch, as those of a smooth surface do
constexpr double same_side = 0.95;    // cosine between their normals
constexpr double certain = 1e-9;      // mm: far beyond rounding
constexpr double rounding_mm = 0.01;  // the same of floats
constexpr double most_samples = 200000;
constexpr std::size_t most_wide = 50000;  // where there are more, each look is taken from the voxels
constexpr double wider = 6;  // of the way after which a look is taken again: how much further a wide one reaches

// A disc in space, and the nearest of its points to another.
struct Disc {
  Vec3 middle, normal;
  double radius;
  Vec3 nearest(Vec3 p) const {
    const Vec3 r = p - middle;
    const double above = dot(r, normal), across = std::sqrt(std::max(0.0, dot(r, r) - above * above));
    const Vec3 flat = r - normal * above;
    return middle + (across > radius ? flat * (radius / across) : flat);
  }
};

// The place on the line from lo to hi that is nearest to the disc. Above the disc the distance changes linearly, so it
// is least where the line ends, meets the plane or leaves the disc; beside it, by projecting to the disc and back.
double nearest_on_line(const Disc& disc, Vec3 begin, Vec3 axis, double lo, double hi) {
  const Vec3 r = begin - disc.middle;
  const double above = dot(r, disc.normal), slope = dot(axis, disc.normal);
  const Vec3 flat = r - disc.normal * above, way = axis - disc.normal * slope;
  const double a = dot(way, way), b = dot(flat, way), c = dot(flat, flat) - disc.radius * disc.radius;
  double from = lo, to = hi, at = std::clamp(-dot(r, axis), lo, hi);
  const double root = b * b - a * c;
  bool over = c <= 0;
  if (a > 1e-12) {
    over = root >= 0;
    if (over) {
      from = std::max(lo, (-b - std::sqrt(root)) / a);
      to = std::min(hi, (-b + std::sqrt(root)) / a);
      over = from <= to;
    }
  }
  if (over) at = std::abs(slope) > 1e-12 ? std::clamp(-above / slope, from, to) : std::clamp(at, from, to);
  if (over && at > from && at < to) return at;
  for (int n = 0; n < 3; ++n) at = std::clamp(dot(disc.nearest(begin + axis * at) - begin, axis), lo, hi);
  return at;
}

double largest_radius(const std::vector<RoundPart>& parts) {
  double most = 0;
  for (const RoundPart& p : parts) most = std::max(most, p.radius_mm);
  return most;
}

}  // namespace

RoundBody::RoundBody(const contact::ContactVolume& contact, std::vector<RoundPart> parts)
    : contact_(contact),
      parts_(std::move(parts)),
      centre_mm_(parts_[0].from_mm),
      normals_(contact),
      edge_(contact, largest_radius(parts_), known_) {
  const Vec3 s = contact.volume().voxels.spacing_mm;
  disc_mm_ = 0.6 * std::max({s.x, s.y, s.z});
  margin_mm_ = 0.5 * contact.smallest_side_mm();
  smallest_radius_mm_ = largest_radius_mm_ = parts_[0].radius_mm;
  for (RoundPart& p : parts_) {
    p.from_mm -= centre_mm_;
    p.to_mm -= centre_mm_;
    length_mm_ = std::max(length_mm_, p.to_mm);
    smallest_radius_mm_ = std::min(smallest_radius_mm_, p.radius_mm);
    largest_radius_mm_ = std::max(largest_radius_mm_, p.radius_mm);
  }
  reach_mm_ = largest_radius_mm_ + disc_mm_ + margin_mm_;
  wider_mm_ = wider * margin_mm_;
  const auto room_for = [&](double reach) {
    double voxels = 3;
    for (int a = 0; a < 3; ++a) voxels *= (2 * reach + (a == 0 ? 2 * length_mm_ : 0)) / s[a] + 4;
    return std::size_t(std::clamp(voxels, 64.0, most_samples));
  };
  samples_.resize(room_for(reach_mm_));
  wide_.resize(std::min(most_wide, room_for(reach_mm_ + wider_mm_)));
  near_.resize(samples_.at.size());
  within_.resize(samples_.at.size());
  squares_.resize(std::max(samples_.at.size(), wide_.at.size()));
}

void RoundBody::begin_frame() {
  known_.begin_frame();
  calls_ = 0;
  spent_ = 0;
  const std::uint32_t now = contact_.loosened();
  // What an edge remembers changes what is felt, so it depends on nothing that a replay would not do in the same frame.
  if (now != seen_ || ++edge_frames_ >= frames_known) {
    edge_.forget();
    edge_frames_ = 0;
  }
  if (now != seen_ || ++frames_ >= frames_known) samples_.known = false;
  if (!samples_.known) frames_ = 0;
  if (!samples_.known && now != 0) {  // nothing can have changed before the first loosening
    normals_.forget();
    wide_.known = false;
    looks_ = 0;
  }
  seen_ = now;
}

void RoundBody::Samples::resize(std::size_t size) {
  at.resize(size);
  for (std::vector<float>& p : place) p.resize(size);
}

void RoundBody::Samples::found(int number, Vec3 from, Vec3 end) {
  count = number;
  from_mm = from;
  end_mm = end;
  known = true;
  for (std::size_t n = 0; n < std::size_t(count); ++n)
    for (int a = 0; a < 3; ++a) place[a][n] = float(at[n].point_mm[a] - from[a]);
}

bool RoundBody::Samples::around(Vec3 from, Vec3 end, double reach_mm) const {
  return known && norm(from - from_mm) <= reach_mm && norm(end - end_mm) <= reach_mm;
}

void RoundBody::Samples::squares_from_line(Vec3 from, Vec3 axis, double begin, double end, float* out) const {
  const Vec3 moved = from - from_mm;
  const float cx = float(moved.x), cy = float(moved.y), cz = float(moved.z);
  const float ax = float(axis.x), ay = float(axis.y), az = float(axis.z), low = float(begin), high = float(end);
  const float *const px = place[0].data(), *const py = place[1].data(), *const pz = place[2].data();
  for (int n = 0; n < count; ++n) {
    float x = px[n] - cx, y = py[n] - cy, z = pz[n] - cz;
    float along = x * ax + y * ay + z * az;
    along = along < low ? low : along;
    along = along > high ? high : along;
    x -= along * ax;
    y -= along * ay;
    z -= along * az;
    out[n] = x * x + y * y + z * z;
  }
}

void RoundBody::look(Vec3 centre_mm, Vec3 axis) {
  const Vec3 end = centre_mm + axis * length_mm_;
  if (samples_.around(centre_mm, end, margin_mm_)) return;
  // Where voxels change in each frame, a wide look would serve only once.
  const bool in_wide = looks_++ > 0 && look_in_wide(centre_mm, end);
  if (!in_wide)
    samples_.found(
        contact_.samples_near(centre_mm, end, reach_mm_, samples_.at.data(), int(samples_.at.size()), &known_),
        centre_mm, end);
  spent_ += std::min(in_wide ? spent_in_wide : spent_by_look, 7 * samples_.count);  // in air it is soon done
}

// Takes from the wide look, in the same order, what samples_near() would find; false where that holds too much.
bool RoundBody::look_in_wide(Vec3 centre_mm, Vec3 end_mm) {
  const int most = int(wide_.at.size());
  if (!wide_.around(centre_mm, end_mm, wider_mm_ * (1 - 1e-6))) {
    spent_ += spent_by_look;
    wide_.found(contact_.samples_near(centre_mm, end_mm, reach_mm_ + wider_mm_, wide_.at.data(), most, &known_),
                centre_mm, end_mm);
  }
  if (wide_.count == most) return false;
  const Vec3 axis = length_mm_ > 0 ? (end_mm - centre_mm) / length_mm_ : Vec3{};
  wide_.squares_from_line(centre_mm, axis, 0, length_mm_, squares_.data());
  const double reach_squared = reach_mm_ * reach_mm_;
  const auto square = [](double x) { return float(x * x); };
  const float surely = square(reach_mm_ - rounding_mm), maybe = square(reach_mm_ + rounding_mm);
  int count = 0;
  for (std::size_t n = 0; n < std::size_t(wide_.count); ++n) {
    if (squares_[n] > maybe) continue;
    const contact::SurfaceSample& s = wide_.at[n];
    if (squares_[n] > surely && contact::squared_from_line(s.point_mm, centre_mm, end_mm) > reach_squared) continue;
    if (count == int(samples_.at.size())) break;
    samples_.at[std::size_t(count++)] = s;
  }
  samples_.found(count, centre_mm, end_mm);
  return true;
}

// Which samples are so near to a part that their discs may touch it; some more, because floats round.
void RoundBody::find_within(Vec3 centre_mm, Vec3 axis) {
  for (std::size_t m = 0; m < parts_.size(); ++m) {
    samples_.squares_from_line(centre_mm, axis, parts_[m].from_mm, parts_[m].to_mm, squares_.data());
    const double far = parts_[m].radius_mm + disc_mm_ + rounding_mm;
    const float far_squared = float(far * far);
    const int before = (1 << m) - 1;
    for (std::size_t n = 0; n < std::size_t(samples_.count); ++n)
      within_[n] = char((within_[n] & before) | int(squares_[n] <= far_squared) << m);
  }
}

Vec3 RoundBody::normal_of(const contact::SurfaceSample& s) {
  int computed = 0;
  const Vec3 normal = normals_.of(s, computed);
  spent_ += computed * spent_by_normal;
  return normal;
}

RoundBody::Touch RoundBody::deepest(Vec3 centre_mm, Vec3 axis, int inside, const contact::TouchableFaces& faces) {
  look(centre_mm, axis);
  ++calls_;
  spent_ += samples_.count / 16;
  find_within(centre_mm, axis);
  near_count_ = 0;
  Touch t;
  const bool alone = is_ball();
  int within = 0, discs = 0;
  for (int n = 0; n < samples_.count; ++n) {
    if (within_[std::size_t(n)] == 0) continue;
    ++within;
    contact::SurfaceSample& s = samples_.at[std::size_t(n)];
    for (std::size_t m = 0; m < parts_.size(); ++m) {
      if (!(within_[std::size_t(n)] >> m & 1)) continue;
      const RoundPart& p = parts_[m];
      const bool rod = p.to_mm > p.from_mm;
      double at = rod ? std::clamp(dot(s.point_mm - centre_mm, axis), p.from_mm, p.to_mm) : p.from_mm;
      Vec3 middle = centre_mm + axis * at, r = middle - s.point_mm;
      // Less deep places than these are of no use below.
      const double useless = std::max(0.0, t.depth_mm - beside * 2 * margin_mm_);
      const double far = p.radius_mm - useless + disc_mm_;
      if (dot(r, r) > far * far) continue;
      if (s.normal == Vec3{}) {
        s.normal = normal_of(s);
        if (s.normal == Vec3{}) s.normal = normalized(r);
      }
      // The line lies behind the plane through its nearest place to the disc's middle, and towards it the disc reaches
      // as far as it leans.
      const double squared = dot(r, r), to_plane = dot(r, s.normal), length = std::sqrt(squared);
      const double off = length - (p.radius_mm - useless) - certain;
      if (off > 0 && off * length >= disc_mm_ * std::sqrt(std::max(0.0, squared - to_plane * to_plane))) continue;
      ++discs;
      const Disc disc{s.point_mm, s.normal, disc_mm_};
      if (rod) {
        at = nearest_on_line(disc, centre_mm, axis, p.from_mm, p.to_mm);
        middle = centre_mm + axis * at;
        r = middle - s.point_mm;
      }
      const double above = dot(r, s.normal);
      const int from = above >= 0 ? s.low : s.high, into = above >= 0 ? s.high : s.low;
      if (alone && from != inside) continue;  // behind another surface
      const bool front = into != 0 && (faces.front >> into & 1);
      if (!front && !(from != 0 && (faces.back >> from & 1))) continue;
      const Vec3 q = disc.nearest(middle), d = middle - q;
      const double distance = norm(d), depth = p.radius_mm - distance;
      if (!(depth > 0)) continue;
      const Vec3 normal = distance > 1e-9 ? d / distance : above >= 0 ? s.normal : -s.normal;
      if (near_count_ == 0 || near_[std::size_t(near_count_ - 1)].sample != n) {
        near_[std::size_t(near_count_++)] = {
            n, depth, at, normal, above >= 0 ? s.normal : -s.normal, std::uint8_t(from), std::uint8_t(into), front};
      } else if (Near& near = near_[std::size_t(near_count_ - 1)]; depth > near.depth_mm) {
        near = {n, depth, at, normal, above >= 0 ? s.normal : -s.normal, std::uint8_t(from), std::uint8_t(into), front};
      }
      if (!(depth > t.depth_mm)) continue;
      t.hit = t.contact.hit = true;
      t.depth_mm = depth;
      t.radius_mm = p.radius_mm;
      t.along_mm = t.pressed_mm = at;
      t.contact.point_mm = q;
      t.contact.normal = normal;
      t.contact.from = from;
      t.contact.into = into;
      t.contact.face = front ? contact::ContactFace::front : contact::ContactFace::back;
      t.contact.shape = front ? into : from;
    }
  }
  spent_ += within / 4 + 2 * discs;
  if (t.hit) {
    find_beside(t);
    smooth_normal(t);
  }
  if (!t.hit || alone) return t;
  // A rod that lies on a surface presses between the first and the last place where it touches.
  double first = t.along_mm, last = t.along_mm;
  for (int n = 0; n < near_count_; ++n) {
    const Near& near = near_[std::size_t(n)];
    if (near.depth_mm < t.depth_mm - together * 2 * margin_mm_ || near.depth_mm <= 0) continue;
    if (dot(near.normal, t.contact.normal) < same_side) continue;
    first = std::min(first, near.along_mm);
    last = std::max(last, near.along_mm);
  }
  t.pressed_mm = 0.5 * (first + last);
  return t;
}

// Of a surface without an edge the discs around the deepest place are its tangent planes. Their mean leans less than
// the way to the one disc that is deepest, which a few hundredths of a voxel decide. At an edge the way itself is
// right.
void RoundBody::smooth_normal(Touch& t) const {
  const double room = beside * 2 * margin_mm_;
  Vec3 sum;
  int count = 0;
  for (int n = 0; n < near_count_; ++n) {
    const Near& near = near_[std::size_t(n)];
    const double weight = near.depth_mm > 0 ? 1 - (t.depth_mm - near.depth_mm) / room : 0;
    if (!(weight > 0) || std::abs(near.along_mm - t.along_mm) > 4 * margin_mm_) continue;
    if (dot(near.face, t.contact.normal) < no_edge) return;
    sum += near.face * weight;
    ++count;
  }
  if (count < 2) return;
  const Vec3 normal = normalized(sum);
  t.contact.point_mm += (t.contact.normal - normal) * (t.radius_mm - t.depth_mm);
  t.contact.normal = normal;
}

// The depth stays that of the discs: they keep the tool outside, and only the way in which it is pressed changes.
void RoundBody::set_on_edge(Touch& t, Vec3 axis) {
  constexpr double alike = 0.6;
  if (double(spent_) > most_spent) return;  // a frame that took long already goes on without
  const contact::Contact& c = t.contact;
  int computed = 0;
  const bool edge = edge_.find(c.point_mm, c.normal, t.radius_mm, c.from, c.into, normals_, computed);
  spent_ += 2 * edge_.looked_at() + computed * spent_by_normal;
  if (!edge) return;
  const double gap = t.radius_mm - t.depth_mm;
  const Vec3 middle = c.point_mm + c.normal * gap;
  double lo = 0, hi = 0;  // how far the middle line goes on from there
  for (const RoundPart& p : parts_)
    if (p.radius_mm == t.radius_mm && p.from_mm <= t.along_mm && t.along_mm <= p.to_mm) {
      lo = p.from_mm - t.along_mm;
      hi = p.to_mm - t.along_mm;
    }
  double at = 0;
  Vec3 on_edge;
  for (int n = 0; n < 4; ++n) {
    if (!edge_.nearest(middle + axis * at, on_edge)) return;
    if (!(hi > lo)) break;
    at = std::clamp(dot(on_edge - middle, axis), lo, hi);
  }
  const Vec3 way = middle + axis * at - on_edge;
  const double distance = norm(way);
  if (std::abs(distance - gap) > edge_.cut_off_mm() || dot(way, c.normal) < alike * distance) return;
  t.contact.normal = way / distance;
  t.contact.point_mm = middle + axis * at - t.contact.normal * gap;
  t.along_mm += at;
  t.pressed_mm += at;
}

void RoundBody::find_beside(Touch& t) const {
  const double room = beside * 2 * margin_mm_;
  double deepest = std::max(0.0, t.depth_mm - room);
  for (int n = 0; n < near_count_; ++n) {
    const Near& near = near_[std::size_t(n)];
    const int shape = near.front ? near.into : near.from;
    if (!(near.depth_mm > deepest) || shape == t.contact.shape || dot(near.normal, t.contact.normal) < faces_alike)
      continue;
    deepest = near.depth_mm;
    t.beside.hit = true;
    t.beside.normal = near.normal;
    t.beside.from = near.from;
    t.beside.into = near.into;
    t.beside.face = near.front ? contact::ContactFace::front : contact::ContactFace::back;
    t.beside.shape = shape;
    const double weight = 1 - (t.depth_mm - near.depth_mm) / room;
    t.beside_share = weight / (1 + weight);
  }
}

bool RoundBody::reaches(Vec3 centre_mm, Vec3 axis, std::uint64_t shapes) {
  look(centre_mm, axis);
  for (int n = 0; n < samples_.count; ++n) {
    const contact::SurfaceSample& s = samples_.at[std::size_t(n)];
    if (((shapes >> s.low | shapes >> s.high) & 1) == 0) continue;
    for (const RoundPart& p : parts_) {
      const double at = std::clamp(dot(s.point_mm - centre_mm, axis), p.from_mm, p.to_mm);
      if (norm(s.point_mm - centre_mm - axis * at) < p.radius_mm) return true;
    }
  }
  return false;
}

}  // namespace trephine::haptics
