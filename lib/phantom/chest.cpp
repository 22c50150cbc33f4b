// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/chest.h"

#include <algorithm>

namespace trephine::phantom {
namespace {

constexpr double soft_hu = 50, bone_hu = 600, clavicle_hu = 700, blood_hu = 42, lung_hu = -850;
constexpr double joint_mm = 1.5;  // radius of the bone between clavicle and sternum, clavicle and acromion
constexpr double far = -1e3;

double ellipse(double x, double y, double rx, double ry) {
  const double k = std::hypot(x / rx, y / ry), g = std::hypot(x / (rx * rx), y / (ry * ry));
  return k < 1e-9 ? std::min(rx, ry) : k * (1 - k) / g;
}

double ball(Vec3 d, Vec3 r) {
  const Vec3 s{d.x / r.x, d.y / r.y, d.z / r.z};
  const double k = norm(s), g = norm({s.x / r.x, s.y / r.y, s.z / r.z});
  return k < 1e-9 ? std::min({r.x, r.y, r.z}) : k * (1 - k) / g;
}

double box(Vec3 d, Vec3 half) {
  return std::min({half.x - std::abs(d.x), half.y - std::abs(d.y), half.z - std::abs(d.z)});
}

std::vector<Vec3> clavicle_points(double side) {
  std::vector<Vec3> line;
  for (int n = 0; n <= 50; ++n) {
    const double t = n / 50.0;
    line.push_back({side * (18 + 105 * t), -60 + 45 * t - 7 * std::sin(2 * M_PI * t), 10 + 22 * t});
  }
  return line;
}

// Behind and below the clavicle; beyond its medial end downwards and to the middle.
std::vector<Vec3> vein_points(double side) {
  const std::vector<Vec3> c = clavicle_points(side);
  std::vector<Vec3> line;
  const Vec3 first = c.front() + Vec3{0, 13, -4};
  for (double s = 30; s > 0.5; s -= 2) line.push_back(first + Vec3{side * -0.6, 0.1, -0.75} * s);
  for (int n = 0; n < 30; ++n) {
    const double t = n / 30.0;
    line.push_back(c[std::size_t(n)] + Vec3{0, 13 - 4 * t, -4 - 9 * t});
  }
  return line;
}

// Behind and above the vein.
std::vector<Vec3> artery_points(double side) {
  std::vector<Vec3> line = vein_points(side);
  line.erase(line.begin(), line.begin() + 10);
  for (Vec3& p : line) p += {0, 12, 6};
  return line;
}

}  // namespace

Chest::Line::Line(std::vector<Vec3> all) : points(std::move(all)), low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9} {
  for (const Vec3& p : points)
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], p[a]);
      high[a] = std::max(high[a], p[a]);
    }
}

double Chest::Line::to(Vec3 p, double reach) const {
  for (int a = 0; a < 3; ++a)
    if (p[a] < low[a] - reach || p[a] > high[a] + reach) return reach;
  double best = reach * reach;
  for (std::size_t n = 1; n < points.size(); ++n) {
    const Vec3 from = points[n - 1], way = points[n] - from;
    const Vec3 d = p - from - way * std::clamp(dot(p - from, way) / dot(way, way), 0.0, 1.0);
    best = std::min(best, dot(d, d));
  }
  return std::sqrt(best);
}

Chest::Chest(const ChestParams& params) : params_(params), turn_(params.chest_turned_deg * M_PI / 180) {
  for (const bool left : {false, true}) {
    const double side = left ? 1 : -1;
    clavicles_[left] = Line(clavicle_points(side));
    veins_[left] = Line(vein_points(side));
    arteries_[left] = Line(artery_points(side));
    joints_[left] = Line({clavicles_[left].points.front(), {0, -62, 5}});
    const Vec3 end = clavicles_[left].points.back();
    outer_joints_[left] = Line({end, end + Vec3{side * 14, 0, 0}});
  }
}

Vec3 Chest::rotated(Vec3 p, double a) const {
  return {p.x * std::cos(a) - p.y * std::sin(a), p.x * std::sin(a) + p.y * std::cos(a), p.z};
}

std::vector<Vec3> Chest::turned(std::vector<Vec3> all) const {
  for (Vec3& p : all) p = rotated(p, turn_);
  return all;
}

double Chest::rod(const std::array<Line, 2>& lines, Vec3 p, double radius) const {
  const double reach = radius + 4;
  return radius - std::min(lines[0].to(p, reach), lines[1].to(p, reach));
}

double Chest::skin(Vec3 world) const {
  const Vec3 p = unturned(world);
  return ellipse(p.x, p.y + 5, 150, 85);
}
double Chest::clavicle(Vec3 p) const { return rod(clavicles_, unturned(p), params_.clavicle_half_width_mm); }
double Chest::vein(Vec3 p) const { return rod(veins_, unturned(p), params_.vein_half_width_mm); }
double Chest::artery(Vec3 p) const { return rod(arteries_, unturned(p), params_.artery_half_width_mm); }

double Chest::lung(Vec3 world) const {
  const Vec3 p = unturned(world);
  return ball({std::abs(p.x) - 30, p.y + 2, p.z + 62}, {24, 42, 50});
}

double Chest::bone_unturned(Vec3 p) const {
  double best = std::max(box(p - Vec3{0, -62, -46}, {11, 6, 54}), 14 - std::hypot(p.x, p.y - 45));  // sternum, spine
  for (int r = 0; r < 6; ++r) {                                                                     // ribs
    const double a = 45 + 12 * r, b = 62, z = -8 - 22 * r + 0.3 * p.y;
    if (std::abs(p.z - z) > 8) continue;
    const double ring = (std::hypot(p.x / a, (p.y + 5) / b) - 1) * std::min(a, b);
    if (p.y > -58 || std::abs(p.x) > 11) best = std::max(best, 4 - std::hypot(ring, p.z - z));
  }
  for (const bool left : {false, true}) {
    const double side = left ? 1 : -1;
    const Vec3 end = clavicles_[left].points.back();
    best = std::max(best, box(p - end - Vec3{side * 16, 0, 0}, {7, 12, 8}));  // acromion
  }
  return std::max({best, rod(joints_, p, joint_mm), rod(outer_joints_, p, joint_mm), far});
}

double Chest::other_bone(Vec3 world) const { return std::min(bone_unturned(unturned(world)), -clavicle(world)); }

double Chest::hu(Vec3 p, double width) const {
  const auto share = [&](double inside_mm) { return std::clamp(0.5 + inside_mm / width, 0.0, 1.0); };
  const double skin_mm = skin(p);
  if (skin_mm < -width) return -1000;
  double hu = soft_hu;
  const auto over = [&](double inside_mm, double with) { hu += share(inside_mm) * (with - hu); };
  over(lung(p), lung_hu);
  over(artery(p), blood_hu);
  over(vein(p), params_.vein_contrast_hu > 0 ? soft_hu + params_.vein_contrast_hu : blood_hu);
  over(bone_unturned(unturned(p)), bone_hu);
  over(clavicle(p), clavicle_hu);
  return -1000 + share(skin_mm) * (hu + 1000);
}

Vec3 Chest::notch_mm() const {
  return rotated((clavicles_[0].points.front() + clavicles_[1].points.front()) / 2, turn_);
}

}  // namespace trephine::phantom
