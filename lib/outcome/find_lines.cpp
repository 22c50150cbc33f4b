// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/find_lines.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "mask/filters.h"
#include "outcome/trace.h"

namespace trephine::outcome {
namespace {

constexpr float dense_hu = 300;                 ///< a line is denser, in thick slices too
constexpr double off_bone_mm = 1.6;             ///< from the case's bone, whose edge is blurred
constexpr double at_bone_mm = 0.9;              ///< nearer to it nothing counts
constexpr double least_seed_mm = 10;            ///< of what is dense alone
constexpr double local_mm = 8;                  ///< about the seed, where it is taken for straight
constexpr double most_across_mm = 2.2;          ///< standard deviation across it there: thicker is no line
constexpr double least_mm = 25, short_mm = 50;  ///< in the patient
constexpr double most_width_mm = 6;
constexpr double below_skin_from_mm = 5, below_skin_to_mm = 15;
constexpr double fades_mm = 6;  ///< so far below the skin, where tissue and air lie about it
constexpr double metal_mm = 4, metal_on_skin_hu = 2600;
constexpr double end_mm = 1;            ///< before the tip it is as thick as elsewhere
constexpr double deep_in_lung_mm = 10;  ///< with less of it there it may go on unseen
constexpr double lung_hu = -300;
constexpr double there_before_ratio = 0.6;
constexpr double same_mm = 4;
constexpr double sure = 0.5;
constexpr double faint_hu = 350;  ///< before its tip above what lies about it

// What is dense and no bone of the case, on the scan's voxels.
mask::BitMask dense_of(const CaseChest& chest, const ScanView& scan, const itk::LinearMap& back,
                       const Progress& progress) {
  const grid::Lattice& l = scan.lattice();
  const mask::HuView& hu = scan.voxels();
  const auto denser = [&](float least, const std::function<bool(Vec3)>& holds) {
    return mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i)
        row[i] = hu(i, j, k) >= least && holds(back(l.to_world_mm({double(i), double(j), double(k)})));
    });
  };
  mask::BitMask things = denser(dense_hu, [&](Vec3 p) { return chest.is_patient(p); });
  things.remove(mask::dilated(denser(dense_hu / 2, [&](Vec3 p) { return chest.is_bone(p); }), off_bone_mm, progress));
  return things;
}

/// From one end to the other, in scan coordinates.
std::vector<Step> traced(const ScanView& scan, const std::vector<Vec3>& seed, const TraceParams& params) {
  Vec3 middle;
  for (const Vec3& p : seed) middle += p * (1.0 / double(seed.size()));
  const Vec3 begin = *std::min_element(
      seed.begin(), seed.end(), [&](const Vec3& a, const Vec3& b) { return norm(a - middle) < norm(b - middle); });
  std::vector<Vec3> local;
  for (const Vec3& p : seed)
    if (norm(p - begin) < local_mm) local.push_back(p);
  if (local.size() < 4) return {};
  const Rod rod = rod_of(local);
  if (rod.across_mm > most_across_mm) return {};
  Vec3 from = rod.line.at_mm;
  std::vector<Step> about;
  for (int round = 0; round < 3; ++round) {
    const Section s = section_of(scan, from, Frame(rod.line.way), params);
    if (s.beyond) return {};
    from = s.middle_mm;
  }
  for (double d = -3; d <= 3; d += 0.5)
    about.push_back({{}, section_of(scan, from + rod.line.way * d, Frame(rod.line.way), params)});
  const double reference = median_sum(about, about.size());
  if (reference <= 0) return {};
  std::vector<Step> one = followed(scan, from, rod.line.way, reference, params),
                    other = followed(scan, from, -rod.line.way, reference, params);
  std::reverse(one.begin(), one.end());
  if (!other.empty()) one.insert(one.end(), other.begin() + 1, other.end());
  return one;
}

// At the skin the air beside it pulls at the middle: there it goes on as it comes from below.
void straighten_to_skin(const CaseChest& chest, std::vector<Vec3>& course) {
  const Vec3 skin = course.back();
  std::vector<Vec3> below;
  for (std::size_t n = course.size(); n-- > 1;) {
    const double deep = norm(course[n] - skin);
    if (deep > below_skin_to_mm) break;
    if (deep >= below_skin_from_mm) below.push_back(course[n]);
  }
  if (below.size() < 8) return;
  const Line line = line_through(below);  // leads inwards
  while (course.size() > 1 && norm(course.back() - skin) < below_skin_from_mm) course.pop_back();
  const Vec3 from = line.at_mm + line.way * dot(course.back() - line.at_mm, line.way);
  double out = 0;
  while (out < 3 * below_skin_from_mm && chest.is_patient(from - line.way * (out + 0.1))) out += 0.1;
  for (double t = 0.5; t < out; t += 0.5) course.push_back(from - line.way * t);
  course.push_back(from - line.way * out);
}

// An electrode there pulls at it as well.
double most_about(const ScanView& scan, Vec3 at) {
  double most = -1000;
  for (double x = -metal_mm; x <= metal_mm; x += 1)
    for (double y = -metal_mm; y <= metal_mm; y += 1)
      for (double z = -metal_mm; z <= metal_mm; z += 1) most = std::max(most, scan(at + Vec3{x, y, z}));
  return most;
}

std::optional<lesson::OutcomeLine> line_of(const CaseChest& chest, const ScanView& scan, const itk::LinearMap& back,
                                           std::vector<Step> steps, const TraceParams& params) {
  if (steps.size() < 20) return {};
  // The tip lies in the patient; where both ends do, it is the one that lies in the vein.
  const auto out_of_patient = [&](const Step& s) { return !chest.is_patient(back(s.at_mm)); };
  const auto ends_outside = [&](const Step& end, const Step& before) {
    return !chest.is_patient(back(end.at_mm + normalized(end.at_mm - before.at_mm) * fades_mm));
  };
  if (ends_outside(steps.back(), steps[steps.size() - 10]) && !ends_outside(steps.front(), steps[9]))
    std::reverse(steps.begin(), steps.end());
  lesson::OutcomeLine line;
  const bool to_skin = ends_outside(steps.front(), steps[9]);
  if (!to_skin && chest.vein != 0) {  // or at the end that lies in the vein
    if (chest.holds(chest.vein, back(steps.front().at_mm)) && !chest.holds(chest.vein, back(steps.back().at_mm)))
      std::reverse(steps.begin(), steps.end());
  }
  std::size_t skin = 0;  // the last step before the patient, from outside
  while (skin + 1 < steps.size() && out_of_patient(steps[skin + 1])) ++skin;
  if (!to_skin) skin = 0;
  const std::vector<Step> inside(steps.begin() + std::ptrdiff_t(skin), steps.end());
  if (inside.size() < 20) return {};
  Vec3 tip = tip_of(scan, inside, params);
  const Vec3 way = normalized(inside.back().at_mm - inside[inside.size() - 10].at_mm);
  if (const Section last = section_of(scan, tip - way * end_mm, Frame(way), params); !last.beyond) {  // it bends
    const Vec3 moved = last.middle_mm - (tip - way * end_mm), off = moved - way * dot(moved, way);
    if (norm(off) < params.most_aside_mm) tip += off;
  }
  const bool ends = section_of(scan, tip + way * 3, Frame(way), params).beyond;
  // What is too faint in a lung ends at its edge.
  int in_air = 0;
  for (std::size_t n = inside.size() - 10; n < inside.size(); ++n) in_air += inside[n].section.around_hu < lung_hu;
  bool before_air = false;
  for (const double d : {3.0, 5.0, 7.0})
    before_air = before_air || (in_air < 9 && section_of(scan, tip + way * d, Frame(way), params).around_hu < lung_hu);
  std::vector<float> hu, width, before, peak;
  for (std::size_t n = inside.size() - 14; n < inside.size() - 4; ++n) peak.push_back(float(inside[n].section.peak));
  for (const Step& s : inside) {
    hu.push_back(float(scan(s.at_mm)));
    width.push_back(float(width_mm(s.section)));
    if (chest.loaded.has_ct())
      before.push_back(
          float(grid::sampled(chest.loaded.ct, chest.loaded.ct.to_index(back(s.at_mm)), grid::value_beyond(-1000))));
  }
  line.mean_hu = double(mask::median(hu, 0));
  line.width_mm = double(mask::median(width, 0));
  if (double(mask::median(before, -1000)) > there_before_ratio * line.mean_hu) return {};
  std::vector<Vec3> course = {back(tip)};
  for (std::size_t n = inside.size(); n-- > 0;) {
    const Vec3 p = back(inside[n].at_mm);
    if (course.size() == 1 && dot(p - course.front(), back.matrix * way) > -0.5) continue;
    course.push_back(p);
  }
  if (course.size() < 20) return {};
  if (to_skin) straighten_to_skin(chest, course);
  line.tip_mm = course.front(), line.skin_mm = course.back();
  line.side = chest.is_left(line.skin_mm) ? "left" : "right";
  bool met = false;
  line.vein_mm = line.tip_mm;
  for (std::size_t n = course.size(); n-- > 1;) {
    const Vec3 a = course[n], d = course[n - 1] - a;
    const double length = norm(d);
    line.length_mm += length;
    constexpr int parts = 4;
    for (int k = 0; k < parts; ++k) {
      const Vec3 p = a + d * ((k + 0.5) / parts);
      if (chest.holds(chest.vein, p)) {
        line.in_vein_mm += length / parts;
        if (!met) met = true, line.vein_mm = p;
      }
      if (chest.holds(chest.lung, p) || chest.holds(chest.pleura, p)) line.in_lung_mm += length / parts;
    }
  }
  if (line.length_mm < least_mm) return {};
  line.axis = normalized(line.vein_mm - line.skin_mm);
  for (std::size_t n = 0; n < course.size(); n += 2) line.course.push_back({course[n]});
  if (course.size() % 2 == 0) line.course.push_back({course.back()});
  line.confidence = mask::ramp(line.length_mm, least_mm, 45) * mask::ramp(line.mean_hu, 250, 400) *
                    (to_skin ? 1 : 0.6) * mask::ramp(line.width_mm, most_width_mm, 4.5);
  const auto doubt = [&](bool holds, const char* why) {
    if (holds) line.doubts.push_back(why);
  };
  doubt(!to_skin, "not_to_the_skin");
  doubt(to_skin && most_about(scan, inside.front().at_mm) > metal_on_skin_hu, "metal");
  doubt(ends, "scan_ends");
  doubt(!chest.loaded.has_ct(), "no_ct");  // it may have been there before
  const bool just_in_lung = line.in_lung_mm > 0 && line.in_lung_mm < deep_in_lung_mm &&
                            (chest.holds(chest.lung, line.tip_mm) || chest.holds(chest.pleura, line.tip_mm));
  doubt(before_air || just_in_lung, "before_air");
  doubt(line.length_mm < short_mm, "short");
  doubt(line.confidence < sure || double(mask::median(peak, 0)) < faint_hu, "faint");
  return line;
}

}  // namespace

std::vector<lesson::OutcomeLine> find_lines(const CaseChest& chest, const ScanView& scan, const itk::LinearMap& map,
                                            const Progress& progress) {
  const itk::LinearMap back = itk::inverse(map);
  const mask::BitMask dense = dense_of(chest, scan, back, progress.part(0, 0.5));
  const grid::Lattice& l = scan.lattice();
  TraceParams params;
  params.disc_mm = 2.8, params.ring_from_mm = 3.2, params.ring_to_mm = 4.2;  // a vein's wall is 5 mm from its middle
  params.most_around_hu = 250;                                               // contrast medium in it
  params.in_air = true, params.thick_ratio = 4;                              // a lung about it
  params.bridged_steps = 28;                                                 // at bone and at the lung's edge
  params.tip_steps = 10;                                                     // it bends
  params.is_other = [&](Vec3 p) {
    const Vec3 q = back(p);
    if (chest.is_bone(q)) return true;
    for (int axis = 0; axis < 3; ++axis)
      for (const double d : {-at_bone_mm, at_bone_mm}) {
        Vec3 beside = q;
        beside[axis] += d;
        if (chest.is_bone(beside)) return true;
      }
    return false;
  };
  const mask::Components pieces = mask::components(dense, true);
  std::vector<std::vector<Vec3>> of(pieces.list.size());
  mask::for_each_voxel(pieces, [&](int c, int i, int j, int k) {
    of[std::size_t(c)].push_back(l.to_world_mm({double(i), double(j), double(k)}));
  });
  progress.report(0.7);
  std::vector<lesson::OutcomeLine> found;
  for (const std::vector<Vec3>& seed : of) {
    if (seed.size() < 8 || rod_of(seed).length_mm < least_seed_mm) continue;
    progress.check();
    auto line = line_of(chest, scan, back, traced(scan, seed, params), params);
    if (!line || line->confidence <= 0.05) continue;
    // Two pieces of one line are followed to the same tip.
    if (std::any_of(found.begin(), found.end(),
                    [&](const lesson::OutcomeLine& f) { return norm(f.tip_mm - line->tip_mm) < same_mm; }))
      continue;
    found.push_back(std::move(*line));
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.confidence > b.confidence; });
  progress.report(1);
  return found;
}

}  // namespace trephine::outcome
