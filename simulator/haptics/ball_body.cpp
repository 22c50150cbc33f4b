// SPDX-License-Identifier: GPL-3.0-or-later
#include "haptics/ball_body.h"

#include <algorithm>
#include <cmath>

namespace trephine {

BallBody::BallBody(const ContactVolume& contact, double radius_mm) : contact_(contact), radius_mm_(radius_mm) {
  const Vec3 s = contact.volume().voxels.spacing_mm;
  disc_mm_ = 0.6 * std::max({s.x, s.y, s.z});
  margin_mm_ = 0.5 * contact.smallest_side_mm();
  double voxels = 3;
  for (int a = 0; a < 3; ++a) voxels *= 2 * (radius_mm + disc_mm_ + margin_mm_) / s[a] + 4;
  samples_.resize(std::size_t(std::clamp(voxels, 64.0, 200000.0)));
}

void BallBody::look(Vec3 centre_mm) {
  if (known_ && norm(centre_mm - centre_mm_) <= margin_mm_) return;
  count_ = contact_.samples_near(centre_mm, radius_mm_ + disc_mm_ + margin_mm_, samples_.data(), int(samples_.size()));
  centre_mm_ = centre_mm;
  known_ = true;
}

BallBody::Touch BallBody::deepest(Vec3 centre_mm, int inside, const TouchableFaces& faces) {
  look(centre_mm);
  Touch t;
  double nearest = radius_mm_;
  for (int n = 0; n < count_; ++n) {
    SurfaceSample& s = samples_[std::size_t(n)];
    const Vec3 r = centre_mm - s.point_mm;
    const double far = nearest + disc_mm_, squared = dot(r, r);
    if (squared > far * far) continue;
    if (s.normal == Vec3{}) {
      s.normal = contact_.normal_at(s.point_mm, s.low, s.high);
      if (s.normal == Vec3{}) s.normal = normalized(r);
    }
    const double above = dot(r, s.normal);
    const int from = above >= 0 ? s.low : s.high, into = above >= 0 ? s.high : s.low;
    if (from != inside) continue;  // behind another surface
    const bool front = into != 0 && (faces.front >> into & 1);
    if (!front && !(from != 0 && (faces.back >> from & 1))) continue;
    const double across = std::sqrt(std::max(0.0, squared - above * above));
    Vec3 q = s.point_mm + (r - s.normal * above);
    if (across > disc_mm_) q = s.point_mm + (r - s.normal * above) * (disc_mm_ / across);
    const Vec3 d = centre_mm - q;
    const double distance = across > disc_mm_ ? norm(d) : std::abs(above);
    if (!(distance < nearest)) continue;
    nearest = distance;
    t.hit = true;
    t.contact.hit = true;
    t.contact.point_mm = q;
    t.contact.normal = distance > 1e-9 ? d / distance : above >= 0 ? s.normal : -s.normal;
    t.contact.from = from;
    t.contact.into = into;
    t.contact.face = front ? ContactFace::front : ContactFace::back;
    t.contact.shape = front ? into : from;
  }
  t.depth_mm = radius_mm_ - nearest;
  return t;
}

bool BallBody::reaches(Vec3 centre_mm, std::uint64_t shapes) {
  look(centre_mm);
  for (int n = 0; n < count_; ++n) {
    const SurfaceSample& s = samples_[std::size_t(n)];
    if (((shapes >> s.low | shapes >> s.high) & 1) && norm(s.point_mm - centre_mm) < radius_mm_) return true;
  }
  return false;
}

}  // namespace trephine
