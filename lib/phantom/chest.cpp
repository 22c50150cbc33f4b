// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/chest.h"

#include <algorithm>

#include "base/splitmix64.h"

namespace trephine::phantom {
namespace {

constexpr double soft_hu = 50, bone_hu = 600, clavicle_hu = 700, blood_hu = 42, lung_hu = -850;
constexpr double joint_mm = 1.5;  // radius of the bone between clavicle and sternum, clavicle and acromion
constexpr double far = -1e3;
constexpr double metal_hu = 8000, electrode_mm = 2;  // radius
constexpr double free_mm = 20;                       // of a line before the skin
constexpr double bend_mm = 10, bent_step_mm = 2;
constexpr double wall_x_mm = 150, wall_y_mm = 85, wall_back_mm = 5, medial_mm = 18;  // medial: of a clavicle's end

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

// Behind and below the clavicle; beyond its medial end downwards and to the middle.
std::vector<Vec3> vein_points(double side, const std::vector<Vec3>& c) {
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
std::vector<Vec3> artery_points(std::vector<Vec3> line) {
  line.erase(line.begin(), line.begin() + 10);
  for (Vec3& p : line) p += {0, 12, 6};
  return line;
}

double length_of(const std::vector<Vec3>& line) {
  double sum = 0;
  for (std::size_t n = 1; n < line.size(); ++n) sum += norm(line[n] - line[n - 1]);
  return sum;
}

// The place so far along a line; before and beyond it, its ends.
Vec3 along(const std::vector<Vec3>& line, double at) {
  for (std::size_t n = 1; n < line.size(); ++n) {
    const double step = norm(line[n] - line[n - 1]);
    if (at <= step) return line[n - 1] + (line[n] - line[n - 1]) * std::max(0.0, at / step);
    at -= step;
  }
  return line.back();
}

// Bent as a line is: each place is the mean of what lies up to so far before and behind it.
std::vector<Vec3> bent(const std::vector<Vec3>& line, double reach) {
  std::vector<Vec3> out;
  const double length = length_of(line);
  for (double at = 0; at < length; at += bent_step_mm) {
    const double by = std::min({reach, at, length - at});
    Vec3 sum;
    constexpr int parts = 16;
    for (int n = 0; n <= parts; ++n) sum += along(line, at + by * (2.0 * n / parts - 1));
    out.push_back(sum / (parts + 1));
  }
  out.push_back(line.back());
  return out;
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
  take_own();
  for (const bool left : {false, true}) {
    const double side = left ? 1 : -1;
    clavicles_[left] = Line(clavicle_points(left));
    veins_[left] = Line(vein_points(side, clavicles_[left].points));
    arteries_[left] = Line(artery_points(veins_[left].points));
    joints_[left] = Line({clavicles_[left].points.front(), {0, -62, 5}});
    const Vec3 end = clavicles_[left].points.back();
    outer_joints_[left] = Line({end, end + Vec3{side * 14, 0, 0}});
  }
  put_in_lines();
}

void Chest::take_own() {
  if (params_.chest_seed == 0) return;
  std::uint64_t random = splitmix64_mixed(std::uint64_t(params_.chest_seed) * splitmix64_step);
  const auto drawn = [&](double most) {
    return most * (2 * unit_of_bits(random = splitmix64_mixed(random + splitmix64_step)) - 1);
  };
  spine_x_ = drawn(4);
  for (Own& own : own_) {
    own.length *= 1 + drawn(0.06);
    own.slope += drawn(5), own.bow += drawn(2.5), own.rise += drawn(6);
    own.rib += drawn(0.7);
    own.wide = 1 + drawn(0.05);
    own.acromion += Vec3{drawn(1.5), drawn(2.5), drawn(1.5)};
    for (double& up : own.rib_up) up = drawn(3);
  }
}

std::vector<Vec3> Chest::clavicle_points(bool left) const {
  const Own& own = own_[left];
  const double side = left ? 1 : -1, raised = params_.shoulders_raised_deg * M_PI / 180;
  std::vector<Vec3> line;
  for (int n = 0; n <= 50; ++n) {
    const double t = n / 50.0, out = own.length * t, up = own.rise * t;
    line.push_back({side * (medial_mm + out * std::cos(raised) - up * std::sin(raised)),
                    -60 + own.slope * t - own.bow * std::sin(2 * M_PI * t),
                    10 + out * std::sin(raised) + up * std::cos(raised)});
  }
  return line;
}

void Chest::put_in_lines() {
  const ChestLine& is = params_.line;
  using Sides = ChestLine::Sides;
  for (const bool left : {false, true}) {
    if (is.sides != Sides::both && is.sides != (left ? Sides::left : Sides::right)) continue;
    const double side = left ? 1 : -1, steep = is.steep_deg * M_PI / 180, down = is.down_deg * M_PI / 180;
    const Vec3 out{side * std::cos(steep) * std::cos(down), -std::sin(steep), -std::cos(steep) * std::sin(down)};
    const std::vector<Vec3>& vein = veins_[left].points;
    const double medial = length_of({vein.begin(), vein.begin() + 16}), in = medial + is.enters_mm;
    const Vec3 meets = along(vein, in);
    double free = 0;
    while (skin(rotated(meets + out * free, turn_)) > 0) free += 0.05;
    const double radius = 0.5 * is.wide_mm;
    std::vector<Vec3> course = {meets + out * (free + free_mm), meets};
    if (is.ends == ChestLine::Ends::lung) {
      course.push_back({side * 30, -2, -36});
    } else {
      for (double at = in - 4; at > 0; at -= 2) course.push_back(along(vein, at));
      course.push_back(vein.front() + normalized(vein[0] - vein[1]) * bend_mm);
    }
    for (std::size_t n = 1; n < course.size(); ++n) course[n].y += is.aside_mm;
    std::vector<Vec3> all = bent(course, bend_mm);
    if (is.ends == ChestLine::Ends::vein) {  // to where its tip's middle lies
      double beyond = bend_mm + is.tip_mm + radius;
      while (all.size() > 2 && norm(all.back() - all[all.size() - 2]) < beyond) {
        beyond -= norm(all.back() - all[all.size() - 2]);
        all.pop_back();
      }
      all.back() -= normalized(all.back() - all[all.size() - 2]) * beyond;
    }
    lines_.emplace_back(all);
  }
  for (int n = 0; n < is.electrodes_count; ++n) {  // beside the shoulders and below
    Vec3 at{n % 2 ? 112.0 : -112.0, 0, n < 2 ? 6.0 : -45.0};
    at.y = -5 - 85 * std::sqrt(1 - at.x * at.x / (150 * 150));
    electrodes_.push_back(at);
  }
}

std::vector<Chest::PutIn> Chest::put_in() const {
  std::vector<PutIn> all;
  for (const Line& of : lines_) {
    PutIn one;
    one.course_mm = turned(of.points);
    one.left = of.points.front().x > 0;
    const std::vector<Vec3>& c = one.course_mm;
    one.tip_mm = c.back() + normalized(c.back() - c[c.size() - 2]) * (0.5 * params_.line.wide_mm);
    constexpr double step = 0.05;
    bool in_skin = false, in_vein = false;
    const double length = length_of(c);
    for (double at = 0; at < length; at += step) {
      const Vec3 p = along(c, at);
      if (!in_skin && skin(p) > 0) in_skin = true, one.skin_mm = p;
      if (!in_vein && vein(p) > 0) in_vein = true, one.vein_mm = p;
      one.in_lung_mm += lung(p) > 0 ? step : 0;
    }
    one.course_mm.push_back(one.tip_mm);
    all.push_back(one);
  }
  return all;
}

std::vector<Vec3> Chest::electrodes_mm() const { return turned(electrodes_); }

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

// From the clavicles up, skin lies close before them, with a dent at the notch and a hollow above each: they are seen
// and palpated. Below, it goes over into the wall of the chest.
double Chest::skin(Vec3 world) const {
  const Vec3 p = unturned(world);
  const double wall = ellipse(p.x, p.y + wall_back_mm, wall_x_mm, wall_y_mm);
  if (p.y > 0) return wall;
  const bool left = p.x > 0;
  const std::vector<Vec3>& line = clavicles_[left].points;
  const double from = std::abs(line.front().x), span = std::abs(line.back().x) - from;
  const double t = std::clamp((std::abs(p.x) - from) / span, 0.0, 1.0), at = t * double(line.size() - 1);
  const std::size_t n = std::min(std::size_t(at), line.size() - 2);
  const Vec3 step = line[n + 1] - line[n], c = line[n] + step * (at - double(n));
  const double lateral = std::clamp(5 * t - 4, 0.0, 1.0), up = p.z - c.z;  // before the acromion, which is thicker
  const auto bell = [](double off, double width) { return std::exp(-off * off / (width * width)); };
  const double close = c.y - params_.clavicle_half_width_mm - 6 - 10 * lateral + 6 * bell(p.x, 10) * bell(up - 14, 9) +
                       5 * bell(up - 20, 9) * (1 - lateral);
  const double below = std::clamp((-8 - up) / 52, 0.0, 1.0), share = below * below * (3 - 2 * below);
  const double x = p.x / wall_x_mm, front = -wall_back_mm - wall_y_mm * std::sqrt(std::max(0.0, 1 - x * x));
  const double slope = 6 * below * (1 - below) / 52 * (front - close), aslant = (1 - share) * step.y / step.x;
  return std::min(wall, (p.y - close - share * (front - close)) / norm({1, slope, aslant}));
}
double Chest::clavicle(Vec3 p) const { return rod(clavicles_, unturned(p), params_.clavicle_half_width_mm); }
double Chest::vein(Vec3 p) const { return rod(veins_, unturned(p), params_.vein_half_width_mm); }
double Chest::artery(Vec3 p) const { return rod(arteries_, unturned(p), params_.artery_half_width_mm); }

double Chest::line(Vec3 world) const {
  const Vec3 p = unturned(world);
  const double radius = 0.5 * params_.line.wide_mm;
  double best = far;
  for (const Line& one : lines_) best = std::max(best, radius - one.to(p, radius + 4));
  return best;
}

double Chest::lung(Vec3 world) const {
  const Vec3 p = unturned(world);
  return ball({std::abs(p.x) - 30, p.y + 2, p.z + 62}, {24, 42, 50});
}

double Chest::bone_unturned(Vec3 p) const {
  // sternum and spine, then ribs
  double best = std::max(box(p - Vec3{0, -62, -46}, {11, 6, 54}), 14 - std::hypot(p.x - spine_x_, p.y - 45));
  const Own& own = own_[p.x > 0];
  for (int r = 0; r < 6; ++r) {
    const double a = (45 + 12 * r) * own.wide, b = 62, z = -8 - 22 * r + 0.3 * p.y + own.rib_up[std::size_t(r)];
    if (std::abs(p.z - z) > 8) continue;
    const double ring = (std::hypot(p.x / a, (p.y + 5) / b) - 1) * std::min(a, b);
    if (p.y > -58 || std::abs(p.x) > 11) best = std::max(best, own.rib - std::hypot(ring, p.z - z));
  }
  for (const bool left : {false, true}) {
    const double side = left ? 1 : -1;
    const Vec3 end = clavicles_[left].points.back();
    best = std::max(best, box(p - end - Vec3{side * 16, 0, 0}, own_[left].acromion));
  }
  return std::max({best, rod(joints_, p, joint_mm), rod(outer_joints_, p, joint_mm), far});
}

double Chest::other_bone(Vec3 world) const { return std::min(bone_unturned(unturned(world)), -clavicle(world)); }

double Chest::hu(Vec3 p, double width) const {
  const auto share = [&](double inside_mm) { return std::clamp(0.5 + inside_mm / width, 0.0, 1.0); };
  const double skin_mm = skin(p);
  const bool free = lines_.empty() && electrodes_.empty();
  if (skin_mm < -width && (free || skin_mm < -free_mm - 4)) return -1000;
  double hu = soft_hu;
  const auto over = [&](double inside_mm, double with) { hu += share(inside_mm) * (with - hu); };
  over(lung(p), lung_hu);
  over(artery(p), blood_hu);
  over(vein(p), params_.vein_contrast_hu > 0 ? soft_hu + params_.vein_contrast_hu : blood_hu);
  over(bone_unturned(unturned(p)), bone_hu);
  over(clavicle(p), clavicle_hu);
  hu = -1000 + share(skin_mm) * (hu + 1000);
  if (free) return hu;
  over(line(p), params_.line.line_hu);
  for (const Vec3& at : electrodes_) over(electrode_mm - norm(unturned(p) - at), metal_hu);
  return hu;
}

Vec3 Chest::notch_mm() const {
  return rotated((clavicles_[0].points.front() + clavicles_[1].points.front()) / 2, turn_);
}

}  // namespace trephine::phantom
