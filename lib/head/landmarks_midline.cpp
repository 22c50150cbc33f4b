// SPDX-License-Identifier: GPL-3.0-or-later
// Nasion, inion and vertex, from the midline's profile.
#include <algorithm>
#include <cmath>

#include "base/pi.h"
#include "head/landmarks_parts.h"
#include "mask/filters.h"

namespace trephine::head {
namespace {

constexpr double step_mm = 0.5;
constexpr double vertices_agree_mm = 6, max_vertices_apart_mm = 15;  ///< 2 and 6 degrees of another level

/// How far each point of the curve stands out of the chord between the points `arm_mm` before and after it along the
/// curve; negative where it is sunk. 0 near the ends.
std::vector<double> standing_out(const std::vector<Vec3>& curve, double arm_mm, Vec3 middle) {
  std::vector<double> out(curve.size(), 0);
  const int arm = int(std::lround(arm_mm / step_mm)), n = int(curve.size());
  for (int i = arm; i + arm < n; ++i) {
    const Vec3 chord = normalized(curve[i + arm] - curve[i - arm]);
    Vec3 outwards = curve[i] - middle;
    outwards = normalized(outwards - chord * dot(outwards, chord));
    out[i] = dot(curve[i] - curve[i - arm], outwards);
  }
  return out;
}

/// The vertex of the parabola through the three values about i, as a part of a step.
double peak_offset(const std::vector<double>& v, int i) {
  if (i < 1 || i + 1 >= int(v.size())) return 0;
  const double bend = v[i - 1] - 2 * v[i] + v[i + 1];
  return bend == 0 ? 0 : std::clamp(0.5 * (v[i - 1] - v[i + 1]) / bend, -0.5, 0.5);
}

Vec3 at_step(const std::vector<Vec3>& curve, int i, double offset) {
  const Vec3 next = offset < 0 ? curve[std::max(0, i - 1)] : curve[std::min(int(curve.size()) - 1, i + 1)];
  return curve[i] + (next - curve[i]) * std::abs(offset);
}

/// The scan's depth that a landmark's surroundings need to be judged by.
double in_scan(const craniometry::FieldView& view, Vec3 p) { return mask::ramp(view.depth_in_scan_mm(p), 1, 10); }

}  // namespace

std::vector<Vec3> midline_profile(const craniometry::FieldView& view, const HeadFrame& head, bool front,
                                  double sigma_mm) {
  const craniometry::Outline curve =
      craniometry::outline(view, {head.origin_mm, head.up, front ? -head.back : head.back, 10, 150});
  return craniometry::evenly_spaced(curve.points_mm, step_mm, sigma_mm);
}

std::optional<FoundPoint> find_nasion(const craniometry::FieldView& skin, const craniometry::FieldView& skull,
                                      const HeadFrame& head) {
  const std::vector<Vec3> curve = midline_profile(skin, head, true, 1.5);
  constexpr double arm_mm = 10, fine_arm_mm = 6, min_depth_mm = 0.8, min_nose_mm = 6, nose_reach_mm = 55;
  const std::vector<double> stands = standing_out(curve, arm_mm, head.origin_mm);
  const int n = int(curve.size());
  const auto radius = [&](int i) { return norm(curve[i] - head.origin_mm); };
  for (int i = 1; i + 1 < n; ++i) {
    const Vec3 way = curve[i] - head.origin_mm;
    const double from_up_deg = std::acos(std::clamp(dot(way, head.up) / norm(way), -1.0, 1.0)) * 180 / pi;
    if (from_up_deg < 50) continue;
    // The first hollow below the forehead that a nose follows.
    if (stands[i] > -min_depth_mm || stands[i] > stands[i - 1] || stands[i] > stands[i + 1]) continue;
    double nose_mm = 0;
    for (int k = i; k < std::min(n, i + int(nose_reach_mm / step_mm)); ++k)
      nose_mm = std::max(nose_mm, radius(k) - radius(i));
    if (nose_mm < min_nose_mm) continue;
    // A wider hollow may have several dents: the deepest within the arm's reach.
    int deepest = i;
    for (int k = i; k < std::min(n, i + int(arm_mm / step_mm)); ++k)
      if (stands[k] < stands[deepest]) deepest = k;
    // Within it the place where it bends most.
    const std::vector<double> bends = standing_out(curve, fine_arm_mm, head.origin_mm);
    const int reach = int(4 / step_mm);
    int sharpest = deepest;
    for (int k = std::max(0, deepest - reach); k <= std::min(n - 1, deepest + reach); ++k)
      if (bends[k] < bends[sharpest]) sharpest = k;
    FoundPoint found;
    found.position_mm = at_step(curve, sharpest, peak_offset(bends, sharpest));
    const Vec3 inwards = normalized(head.origin_mm - found.position_mm);
    if (const auto exact = skin.enter(found.position_mm - inwards * 5, inwards, 12, 0.4)) found.position_mm = *exact;
    // Bone lies 3 to 9 mm below; where a face was taken away it is bare, or far.
    const auto bone = skull.enter(found.position_mm - inwards, inwards, 40, 0.4);
    const double soft_mm = bone ? norm(*bone - found.position_mm) : 40;
    found.confidence =
        std::min({mask::ramp(-stands[deepest], 0.5, 1.5), mask::ramp(nose_mm, 5, 15), mask::ramp(soft_mm, 0.5, 2),
                  mask::ramp(soft_mm, 25, 14), in_scan(skin, found.position_mm)});
    return found;
  }
  return {};
}

std::optional<FoundPoint> find_inion(const craniometry::FieldView& skin, const craniometry::FieldView& skull,
                                     const HeadFrame& head, std::array<double, 2> level_mm) {
  const std::vector<Vec3> curve = midline_profile(skull, head, false, 2.0);
  constexpr double arm_mm = 15;
  const std::vector<double> stands = standing_out(curve, arm_mm, head.origin_mm);
  int best = -1;
  double mean = 0;
  std::size_t count = 0;
  for (int i = 1; i + 1 < int(curve.size()); ++i) {
    const Vec3 way = curve[i] - head.origin_mm;
    const double level = dot(way, head.up);
    if (dot(way, head.back) <= 0 || stands[i] == 0) continue;
    mean += stands[i], ++count;
    if (level < level_mm[0] || level > level_mm[1]) continue;
    if (stands[i] >= stands[i - 1] && stands[i] >= stands[i + 1] && (best < 0 || stands[i] > stands[best])) best = i;
  }
  if (best < 0) return {};
  mean /= double(count);
  const Vec3 bone = at_step(curve, best, peak_offset(stands, best));
  // The skin straight behind it, where a finger finds it: a ray from the head's centre runs down along the nape, and
  // leaves the skin 8 to 10 mm lower (seen on four real heads).
  const Vec3 outwards = head.back;
  const auto on_skin = skin.enter(bone + outwards * 50, -outwards, 55, 0.4);
  if (!on_skin) return {};
  FoundPoint found;
  found.position_mm = *on_skin;
  found.confidence = std::min({mask::ramp(stands[best] - mean, 0, 1), mask::ramp(stands[best], 0.5, 2),
                               mask::ramp(norm(*on_skin - bone), 40, 20), in_scan(skin, *on_skin),
                               mask::ramp(skull.depth_in_scan_mm(bone), 2, 13)});
  return found;
}

std::optional<FoundPoint> find_vertex(const craniometry::FieldView& skin, const HeadFrame& head) {
  const craniometry::Outline curve = craniometry::outline(skin, {head.origin_mm, head.up, head.back, 50, 50});
  const std::vector<Vec3> even = craniometry::evenly_spaced(curve.points_mm, step_mm, 3);
  if (even.empty()) return {};
  std::size_t best = 0;
  for (std::size_t i = 1; i < even.size(); ++i)
    if (dot(even[i] - even[best], head.up) > 0) best = i;
  const double depth = skin.depth_in_scan_mm(even[best]);
  // The flat top of a scan that ends below the vertex is no vertex.
  if (best == 0 || best + 1 == even.size() || depth < 1) return {};
  return FoundPoint{even[best], mask::ramp(depth, 0.5, 3)};
}

double confidence_of_vertices_apart(double apart_mm) {
  return 1 - (1 - of_contradicted_vertices) * mask::ramp(apart_mm, vertices_agree_mm, max_vertices_apart_mm);
}

}  // namespace trephine::head
