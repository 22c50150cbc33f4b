// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/find_screws.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/pi.h"
#include "mask/filters.h"
#include "outcome/line.h"
#include "outcome/metal_edge.h"

namespace trephine::outcome {
namespace {

constexpr double metal_hu = 2000;  ///< denser than any bone
constexpr double edge_hu = 1500, titanium_hu = 8000;
constexpr double clipped_hu = 3050;  ///< a scan whose metal is no brighter than this is not clipped
constexpr double least_seed_mm3 = 30, least_seed_mm = 8;
constexpr double disc_mm = 7.5, shaft_disc_mm = 5.5, grid_mm = 0.3, step_mm = 0.5, head_mm = 5.5;
constexpr double reach_mm = 80;     ///< along the axis from the middle of what was seen
constexpr double head_ratio = 1.6;  ///< of the shaft's area: more is the head
constexpr double core_mm = 1;
constexpr double straight_mm = 0.8;  ///< a middle line that is farther off is none of a screw
constexpr double least_length_mm = 15, least_diameter_mm = 1.5, most_diameter_mm = 10;
constexpr double most_needle_mm = 4.5, least_out_mm = 25, usual_mm = 45;
constexpr double at_pedicle_mm = 12, beside_ratio = 1.5;
constexpr double least_in_bone = 0.4;

/// How much metal lies across an axis there.
struct Across {
  double area_mm2 = 0;
  bool beyond = false;
  Vec3 middle_mm;
};
Across across(const ScanView& scan, Vec3 at, const Frame& f, double radius_mm) {
  Across out;
  const int n = int(radius_mm / grid_mm);
  double weight = 0;
  Vec3 sum;
  for (int i = -n; i <= n; ++i)
    for (int j = -n; j <= n; ++j) {
      const Vec3 off = f.a * (i * grid_mm) + f.b * (j * grid_mm);
      if (norm(off) > radius_mm) continue;
      const double v = scan(at + off);
      if (v <= ScanView::beyond_hu / 2) {
        out.beyond = true;
        continue;
      }
      out.area_mm2 += (v > edge_hu) * grid_mm * grid_mm;
      const double w = std::max(0.0, v - edge_hu);
      weight += w;
      sum += off * w;
    }
  out.middle_mm = weight > 0 ? at + sum * (1 / weight) : at;
  return out;
}

/// A screw in the scan.
struct Shaft {
  Vec3 tip_mm, seat_mm;
  double diameter_mm = 0, off_mm = 0, slice_mm = 0;
  bool has_head = false, tip_beyond = false, head_beyond = false;  ///< the scan ends there
  bool unclear = false;                                            ///< an edge was not seen well enough
};

// The metal's HU and the most that the scan shows: where it clips the metal, that of titanium.
std::pair<double, double> metal_of(const ScanView& scan, const std::vector<Vec3>& seed) {
  std::vector<float> hu;
  for (const Vec3& p : seed) hu.push_back(float(scan(p)));
  std::sort(hu.begin(), hu.end());
  const double most = double(hu[std::size_t(0.9 * double(hu.size() - 1))]);
  const bool clipped = most > clipped_hu && most < 3200;
  return {clipped ? titanium_hu : std::max(4000.0, most), clipped ? most : 1e9};
}

// Across which the scan averages: its slices are those of the coarsest axis, of the third where all are alike.
int slice_axis(const grid::Lattice& l) {
  int axis = 2;
  for (int a = 0; a < 2; ++a)
    if (l.spacing_mm[a] > 1.01 * l.spacing_mm[axis]) axis = a;
  return axis;
}

// The voxels about an axis that leads to the tip, from the lowest to the highest place along it.
std::vector<AxisVoxel> voxels_about(const ScanView& scan, const Line& line, double low, double high, double radius_mm) {
  const grid::Lattice& l = scan.lattice();
  const mask::HuView& hu = scan.voxels();
  const Vec3 a = line.at_mm + line.way * low, b = line.at_mm + line.way * high,
             normal = l.direction.column[slice_axis(l)];
  int from[3], to[3];
  std::fill(from, from + 3, 1 << 30), std::fill(to, to + 3, -1);
  for (int corner = 0; corner < 16; ++corner) {
    Vec3 p = corner & 8 ? a : b;
    for (int x = 0; x < 3; ++x) p[x] += (corner >> x & 1 ? 1 : -1) * radius_mm;
    const Vec3 at = l.to_index(p);
    for (int x = 0; x < 3; ++x) {
      from[x] = std::min(from[x], std::max(0, int(std::floor(at[x]))));
      to[x] = std::max(to[x], std::min(l.size[std::size_t(x)] - 1, int(std::ceil(at[x]))));
    }
  }
  std::vector<AxisVoxel> out;
  for (int k = from[2]; k <= to[2]; ++k)
    for (int j = from[1]; j <= to[1]; ++j)
      for (int i = from[0]; i <= to[0]; ++i) {
        const Vec3 d = l.to_world_mm({double(i), double(j), double(k)}) - line.at_mm;
        const double along = dot(d, line.way), off = norm(d - line.way * along);
        if (along >= low && along <= high && off <= radius_mm)
          out.push_back({along, off, double(hu(i, j, k)), dot(d - line.way * along, normal)});
      }
  return out;
}

// The line through the middle of the metal, about the stretch that lies in the bone.
Line axis_of(const ScanView& scan, const Rod& rod, double low, double high) {
  Line line = rod.line;
  for (int round = 0; round < 4; ++round) {
    const Frame frame(line.way);
    std::vector<Vec3> middles;
    for (double t = low + 1; t <= high - 1; t += step_mm) {
      const Vec3 at = line.at_mm + line.way * t;
      const Across a = across(scan, at, frame, shaft_disc_mm);
      if (a.area_mm2 > 3 && norm(a.middle_mm - at) < (round < 2 ? 3 : 1)) middles.push_back(a.middle_mm);
    }
    if (middles.size() < 8) break;
    const Vec3 way = line.way;
    line = line_through(middles);
    if (dot(line.way, way) < 0) line.way = -line.way;
  }
  return line;
}

/// How far metal goes on along an axis from a place of it, and how thick it becomes.
struct Ahead {
  double end_mm = 0, most_mm2 = 0;
  bool beyond = false;
};
Ahead ahead(const ScanView& scan, const Line& line, double from, double sign) {
  Ahead out{from, 0, false};
  const Frame frame(line.way);
  for (double t = from; t < from + reach_mm; t += step_mm) {
    const Across a = across(scan, line.at_mm + line.way * (sign * t), frame, disc_mm);
    out.beyond = out.beyond || a.beyond;
    if (a.area_mm2 < 2) break;
    out.end_mm = t;
    out.most_mm2 = std::max(out.most_mm2, a.area_mm2);
  }
  return out;
}

std::optional<Shaft> shaft_of(const ScanView& scan, const std::vector<Vec3>& seed) {
  const Rod rod = rod_of(seed);
  if (rod.length_mm < least_seed_mm) return {};
  double low = 0, high = 0;
  for (const Vec3& p : seed) {
    const double t = dot(p - rod.line.at_mm, rod.line.way);
    low = std::min(low, t), high = std::max(high, t);
  }
  const Vec3 begin = rod.line.at_mm + rod.line.way * low, end = rod.line.at_mm + rod.line.way * high;
  Line line = axis_of(scan, rod, low, high);
  low = dot(begin - line.at_mm, line.way), high = dot(end - line.at_mm, line.way);
  std::vector<float> areas;
  for (double t = low + 0.25 * (high - low); t <= high - 0.25 * (high - low); t += step_mm)
    areas.push_back(float(across(scan, line.at_mm + line.way * t, Frame(line.way), disc_mm).area_mm2));
  const double shaft_mm2 = double(mask::median(areas, 0));
  if (shaft_mm2 < 2) return {};
  // The head lies at the end where it is thicker, or else goes on farther. Along the line lies the tip.
  const double middle = 0.5 * (low + high);
  Ahead tip = ahead(scan, line, middle, 1), head = ahead(scan, line, -middle, -1);
  if (tip.most_mm2 > head.most_mm2) {
    std::swap(tip, head);
    line.way = -line.way;
    std::swap(low, high);
    low = -low, high = -high;
  }
  Shaft out;
  out.has_head = head.most_mm2 > head_ratio * shaft_mm2;
  out.tip_beyond = tip.beyond;
  out.head_beyond = head.beyond;
  const std::pair<double, double> metal = metal_of(scan, seed);  // and the most that is shown
  std::vector<std::pair<double, double>> side, ring;
  const double near = 0.25 * (low + high) + 0.5 * low, far = 0.25 * (low + high) + 0.5 * high;
  for (const AxisVoxel& v : voxels_about(scan, line, near, far, disc_mm)) side.emplace_back(v.off_mm, v.hu);
  const Vec3 spacing = scan.lattice().spacing_mm;
  const double core_off = std::max(core_mm, 0.5 * std::max({spacing.x, spacing.y, spacing.z}));
  const auto edge_or = [&](const std::vector<std::pair<double, double>>& hu_at, double otherwise) {
    const auto edge = metal_edge(hu_at, metal.first, metal.second);
    if (!edge) out.unclear = true;
    return edge ? edge->at_mm : otherwise;
  };
  const double radius = edge_or(side, std::sqrt(shaft_mm2 / pi));
  out.diameter_mm = 2 * radius;
  out.slice_mm = spacing[slice_axis(scan.lattice())];
  const auto tip_at =
      tip_end(voxels_about(scan, line, tip.end_mm - 8, tip.end_mm + 6, core_off), radius, out.slice_mm, metal);
  if (!tip_at) out.unclear = true;
  const double end_at = tip_at.value_or(tip.end_mm);
  if (out.has_head) {  // about the shaft, where only the head is of metal
    for (const AxisVoxel& v : voxels_about(scan, line, 4 - head.end_mm, middle, head_mm))
      if (v.off_mm > radius + 1.2) ring.emplace_back(v.along_mm, v.hu);
  } else {
    for (const AxisVoxel& v : voxels_about(scan, line, -head.end_mm - 6, -head.end_mm + 8, core_off))
      ring.emplace_back(-v.along_mm, v.hu);
  }
  const double seat_at = out.has_head ? edge_or(ring, -head.end_mm) : -edge_or(ring, head.end_mm);
  // The axis once more, of the whole shaft.
  std::vector<Vec3> middles;
  for (double t = seat_at + 1.5; t < end_at - 2; t += step_mm) {
    const Across a = across(scan, line.at_mm + line.way * t, Frame(line.way), shaft_disc_mm);
    if (a.area_mm2 > 3) middles.push_back(a.middle_mm);
  }
  if (middles.size() < 8) return {};
  const Line again = line_through(middles);
  out.off_mm = again.off_mm;
  const auto on = [&](double t) {
    return again.at_mm + again.way * dot(line.at_mm + line.way * t - again.at_mm, again.way);
  };
  out.tip_mm = on(end_at);
  out.seat_mm = on(seat_at);
  return out;
}

/// Which pedicle an axis passes, and the next.
struct AtPedicle {
  const cases::CasePedicle* pedicle = nullptr;
  double off_mm = 1e9, next_mm = 1e9;
};

AtPedicle pedicle_of(const CaseSpine& spine, const SpineFit& fit, const Shaft& shaft) {
  AtPedicle out;
  for (const cases::CasePedicle& p : spine.pedicles) {
    const int level = spine.level_of(p);
    if (level < 0 || !fit.is_seen(std::size_t(level))) continue;
    const itk::LinearMap& map = fit.of_level[std::size_t(level)].map;
    const Vec3 at = map(p.entry_mm * 0.6 + p.target_mm * 0.4), way = normalized(shaft.tip_mm - shaft.seat_mm),
               d = at - shaft.seat_mm;
    const double along = std::clamp(dot(d, way), 0.0, norm(shaft.tip_mm - shaft.seat_mm)), off = norm(d - way * along);
    if (off < out.off_mm)
      out.next_mm = out.off_mm, out.off_mm = off, out.pedicle = &p;
    else
      out.next_mm = std::min(out.next_mm, off);
  }
  return out;
}

std::optional<lesson::OutcomeScrew> screw_of(const CaseSpine& spine, const SpineFit& fit, const Shaft& shaft) {
  const AtPedicle at = pedicle_of(spine, fit, shaft);
  if (!at.pedicle) return {};
  const itk::LinearMap back = itk::inverse(fit.of_level[std::size_t(spine.level_of(*at.pedicle))].map);
  lesson::OutcomeScrew s;
  s.pedicle = at.pedicle->name;
  s.tip_mm = back(shaft.tip_mm), s.head_mm = back(shaft.seat_mm);
  s.axis = normalized(s.tip_mm - s.head_mm);
  s.length_mm = norm(s.tip_mm - s.head_mm);
  s.diameter_mm = shaft.diameter_mm;
  s.bend_mm = shaft.off_mm;
  s.pedicle_off_mm = at.off_mm;
  if (s.length_mm < least_length_mm || s.diameter_mm < least_diameter_mm) return {};
  // Where it enters the bone, and how much of it lies there.
  double in_bone = 0, first = 0;
  for (double t = 0.125; t < s.length_mm; t += 0.25) in_bone += spine.is_bone(s.head_mm + s.axis * t) ? 0.25 : 0;
  if (spine.is_bone(s.head_mm))  // the head is sunk
    while (first > -15 && spine.is_bone(s.head_mm + s.axis * (first - 0.1))) first -= 0.1;
  else
    while (first < s.length_mm && !spine.is_bone(s.head_mm + s.axis * first)) first += 0.1;
  s.entry_mm = s.head_mm + s.axis * first;
  const auto doubt = [&](bool holds, const char* why) {
    if (holds) s.doubts.push_back(why);
  };
  if (!shaft.has_head && s.diameter_mm < most_needle_mm && s.length_mm - in_bone > least_out_mm) s.kind = "needle";
  doubt(!shaft.has_head && s.kind != "needle", "no_head");
  doubt(shaft.tip_beyond || (shaft.head_beyond && s.kind != "needle"), "scan_ends");
  doubt(shaft.unclear || shaft.off_mm > straight_mm || s.diameter_mm > most_diameter_mm, "no_rod");
  doubt(shaft.slice_mm > s.diameter_mm, "thick_slices");
  doubt(at.off_mm > at_pedicle_mm || in_bone < least_in_bone * std::min(s.length_mm, usual_mm), "no_pedicle");
  doubt(at.off_mm > 6 && at.next_mm < beside_ratio * at.off_mm, "two_pedicles");
  doubt(dot(s.axis, at.pedicle->forwards()) < 0.5, "backwards");
  return s;
}

}  // namespace

std::vector<lesson::OutcomeScrew> find_screws(const CaseSpine& spine, const ScanView& scan, const SpineFit& fit,
                                              const Progress& progress) {
  std::vector<itk::LinearMap> backs;
  for (const BoneFit& f : fit.of_level) backs.push_back(itk::inverse(f.map));
  // Metal in the bone of the vertebra that is nearest.
  const auto in_bone = [&](Vec3 p) {
    double nearest = 1e9;
    bool inside = false;
    for (std::size_t n = 0; n < backs.size(); ++n) {
      if (!fit.is_seen(n)) continue;
      const Vec3 q = backs[n](p);
      const double off = std::abs(dot(q - spine.levels[n].middle_mm, spine.cranial));
      if (off < nearest) nearest = off, inside = off < spine.pitch_mm && spine.is_bone(q);
    }
    return inside;
  };
  const grid::Lattice& l = scan.lattice();
  const mask::HuView& hu = scan.voxels();
  const mask::BitMask metal = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i)
      row[i] = hu(i, j, k) >= metal_hu && in_bone(l.to_world_mm({double(i), double(j), double(k)}));
  });
  progress.report(0.5);
  const mask::Components pieces = mask::components(metal, true);
  std::vector<std::vector<Vec3>> of(pieces.list.size());
  mask::for_each_voxel(pieces, [&](int c, int i, int j, int k) {
    of[std::size_t(c)].push_back(l.to_world_mm({double(i), double(j), double(k)}));
  });
  const double voxel_mm3 = l.spacing_mm.x * l.spacing_mm.y * l.spacing_mm.z;
  std::vector<lesson::OutcomeScrew> found;
  for (const std::vector<Vec3>& seed : of) {
    if (double(seed.size()) * voxel_mm3 < least_seed_mm3) continue;
    progress.check();
    const std::optional<Shaft> shaft = shaft_of(scan, seed);
    if (!shaft) continue;
    const auto screw = screw_of(spine, fit, *shaft);
    if (!screw) continue;
    // Two pieces of one screw are followed to the same ends.
    if (std::any_of(found.begin(), found.end(),
                    [&](const lesson::OutcomeScrew& f) { return norm(f.tip_mm - screw->tip_mm) < 4; }))
      continue;
    found.push_back(*screw);
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.pedicle < b.pedicle; });
  progress.report(1);
  return found;
}

}  // namespace trephine::outcome
