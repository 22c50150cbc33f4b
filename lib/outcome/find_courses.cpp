// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/find_courses.h"

#include <algorithm>
#include <cmath>

#include "mask/filters.h"
#include "outcome/trace.h"

namespace trephine::outcome {
namespace {

constexpr float dense_hu = 160;    ///< a catheter inside the brain is denser, in thick slices too
constexpr double least_mm = 12;    ///< length of what is followed, of the dense voxels alone
constexpr double straight_mm = 4;  ///< standard deviation across it at most
constexpr double most_width_mm = 6.5;
constexpr double to_bone_mm = 30;  ///< from the end that was seen to the bone at most

std::optional<lesson::OutcomeCourse> course_of(const CaseHead& head, const ScanView& scan, const itk::LinearMap& back,
                                               const Rod& rod) {
  Vec3 from = rod.line.at_mm;
  for (int round = 0; round < 3; ++round) {
    const Section s = section_of(scan, from, Frame(rod.line.way), {});
    if (s.beyond) return {};
    from = s.middle_mm;
  }
  std::vector<Step> middle;
  for (double d = -4; d <= 4; d += 1)
    middle.push_back({{}, section_of(scan, from + rod.line.way * d, Frame(rod.line.way), {})});
  const double reference = median_sum(middle, middle.size());
  if (reference <= 0) return {};
  std::vector<Step> one = followed(scan, from, rod.line.way, reference, {}),
                    other = followed(scan, from, -rod.line.way, reference, {});
  if (one.size() + other.size() < 20) return {};
  // Outwards leads what passes the case's bone, or ends before it; what passes it at both ends is no catheter.
  const auto passes_bone = [&](const std::vector<Step>& steps) {
    return std::any_of(steps.begin(), steps.end(),
                       [&](const Step& s) { return head.decoder.trilinear(head.bone, back(s.at_mm)) >= 0.5; });
  };
  const auto bone_ahead_mm = [&](const std::vector<Step>& steps, Vec3 way) {
    if (steps.empty()) return 1e9;
    const auto passage = passage_of(head, back(steps.back().at_mm), normalized(back.matrix * way), 120);
    return passage ? passage->inner_mm : 1e9;
  };
  const bool one_passes = passes_bone(one), other_passes = passes_bone(other);
  if (one_passes && other_passes) return {};
  if (other_passes || (!one_passes && bone_ahead_mm(one, rod.line.way) > bone_ahead_mm(other, -rod.line.way)))
    std::swap(one, other);
  // `one` leads outwards now.
  std::reverse(one.begin(), one.end());
  if (!other.empty()) one.insert(one.end(), other.begin() + 1, other.end());
  const std::vector<Step>& all = one;  // from outside to the tip
  lesson::OutcomeCourse c;
  std::vector<float> hu, width;
  std::vector<Vec3> in_head;
  for (const Step& s : all) {
    hu.push_back(float(scan(s.at_mm)));
    width.push_back(float(width_mm(s.section)));
  }
  c.mean_hu = double(mask::median(hu, 0));
  c.width_mm = double(mask::median(width, 0));
  c.tip_mm = back(tip_of(scan, all, {}));
  // In the head: what lies on the inner side of the bone, from the tip outwards.
  std::vector<Vec3> points;
  for (const Step& s : all) points.push_back(back(s.at_mm));
  std::reverse(points.begin(), points.end());
  while (points.size() > 2 &&
         dot(points.front() - c.tip_mm, c.tip_mm - points[std::min<std::size_t>(10, points.size() - 1)]) > 0)
    points.erase(points.begin());
  std::size_t first_bone = points.size();
  for (std::size_t n = 0; n < points.size(); ++n)
    if (head.decoder.trilinear(head.bone, points[n]) >= 0.5) {
      first_bone = n;
      break;
    }
  in_head.assign(points.begin(), points.begin() + std::ptrdiff_t(first_bone));
  if (in_head.size() < 20) return {};
  in_head.insert(in_head.begin(), c.tip_mm);
  const Line line = line_through(in_head);
  c.axis = -line.way;
  c.bend_mm = line.off_mm;
  c.seen_mm = norm(in_head.back() - c.tip_mm);
  // To the bone: straight on by the last centimetres.
  const std::size_t last = std::min<std::size_t>(30, in_head.size() - 1);
  const Line outwards = line_through({in_head.end() - std::ptrdiff_t(last), in_head.end()});
  const Vec3 end = in_head.back();
  const auto passage = passage_of(head, end, outwards.way, to_bone_mm + 30);
  const bool to_bone = passage && passage->inner_mm <= to_bone_mm;
  c.inner_mm = to_bone ? end + outwards.way * passage->inner_mm : end;
  c.outer_mm = to_bone ? end + outwards.way * passage->outer_mm : end;
  for (std::size_t n = 0; n < in_head.size(); n += 2) c.course.push_back({in_head[n]});
  if (to_bone) {
    c.course.push_back({c.inner_mm});
    c.course.push_back({c.outer_mm});
  }
  for (std::size_t n = 0; n + 1 < c.course.size() - (to_bone ? 1 : 0); ++n)
    c.length_mm += norm(c.course[n + 1].at_mm - c.course[n].at_mm);
  c.side = head.side_of(c.outer_mm);
  c.confidence = mask::ramp(c.seen_mm, 12, 25) * mask::ramp(c.mean_hu, 100, 220) * (to_bone ? 1 : 0.3) *
                 mask::ramp(c.width_mm, most_width_mm, 4.5) * mask::ramp(c.bend_mm, 12, 7);
  return c;
}

}  // namespace

std::vector<lesson::OutcomeCourse> find_courses(const CaseHead& head, const ScanView& scan, const itk::LinearMap& map,
                                                const Progress& progress) {
  const itk::LinearMap back = itk::inverse(map);
  const grid::Lattice& l = scan.lattice();
  const mask::HuView& hu = scan.voxels();
  const mask::BitMask dense = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i)
      row[i] = hu(i, j, k) >= dense_hu && head.is_inside(back(l.to_world_mm({double(i), double(j), double(k)})));
  });
  progress.report(0.5);
  const mask::Components pieces = mask::components(dense, true);
  std::vector<std::vector<Vec3>> of(pieces.list.size());
  mask::for_each_voxel(pieces, [&](int c, int i, int j, int k) {
    if (pieces.list[std::size_t(c)].voxels >= 8)
      of[std::size_t(c)].push_back(l.to_world_mm({double(i), double(j), double(k)}));
  });
  std::vector<lesson::OutcomeCourse> found;
  for (const std::vector<Vec3>& points : of) {
    if (points.size() < 8) continue;
    progress.check();
    const Rod rod = rod_of(points);
    if (rod.length_mm < least_mm || rod.across_mm > straight_mm) continue;
    const std::optional<lesson::OutcomeCourse> c = course_of(head, scan, back, rod);
    if (!c || c->confidence <= 0.05) continue;
    // Two pieces of one catheter are followed to the same ends.
    if (std::any_of(found.begin(), found.end(),
                    [&](const lesson::OutcomeCourse& f) { return norm(f.tip_mm - c->tip_mm) < 4; }))
      continue;
    found.push_back(*c);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.confidence > b.confidence; });
  progress.report(1);
  return found;
}

}  // namespace trephine::outcome
