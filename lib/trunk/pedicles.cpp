// SPDX-License-Identifier: GPL-3.0-or-later
#include "trunk/pedicles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/rank.h"
#include "base/refusal.h"
#include "mask/filters.h"
#include "trunk/pedicle_parts.h"

namespace trephine::trunk {
namespace {

constexpr double raster_mm = 0.6;
constexpr double aside_mm = 50, before_mm = 60, behind_mm = 60;  // how far from the canal bone is looked at
constexpr double walk_mm = 0.25;
constexpr double sure = 0.5;               // confidence
constexpr double least_level_ratio = 0.4;  // a given lumbar spine has 0.67, the phantom 0.55
constexpr double max_height_mm = 30;       // from here on the confidence is 0, whatever the axis

// The part of the bone that lies beside the canal.
grid::Lattice raster_about(const grid::Field& bone, const grid::Field& canal) {
  Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
  const auto grow = [](const grid::Lattice& l, Vec3& a, Vec3& b) {
    for (int n = 0; n < 8; ++n) {
      const Vec3 p =
          l.to_world_mm({n & 1 ? l.size[0] - 1.0 : 0, n & 2 ? l.size[1] - 1.0 : 0, n & 4 ? l.size[2] - 1.0 : 0});
      for (int c = 0; c < 3; ++c) a[c] = std::min(a[c], p[c]), b[c] = std::max(b[c], p[c]);
    }
  };
  grow(canal, low, high);
  Vec3 bone_low{1e9, 1e9, 1e9}, bone_high{-1e9, -1e9, -1e9};
  grow(bone, bone_low, bone_high);
  low = low - Vec3{aside_mm, before_mm, 20};
  high = high + Vec3{aside_mm, behind_mm, 20};
  grid::Lattice l;
  l.spacing_mm = {raster_mm, raster_mm, raster_mm};
  for (int c = 0; c < 3; ++c) {
    l.origin_mm[c] = std::max(low[c], bone_low[c] - 2);
    l.size[std::size_t(c)] = std::max(2, int((std::min(high[c], bone_high[c] + 2) - l.origin_mm[c]) / raster_mm) + 1);
  }
  return l;
}

constexpr const char* give_them =
    "give both ends of each in the case's configuration, in mm, LPS: `landmarks: {pedicle_1_left_entry: [x, y, z], "
    "pedicle_1_left_target: [x, y, z], ...}`";

// Where all that stands beside the canal is so high that none can have a confidence above 0, no axis is looked for.
void require_low_enough(const std::vector<PediclePlace>& places) {
  double lowest_mm = 1e9;
  for (const PediclePlace& place : places)
    if (!place.cut) lowest_mm = std::min(lowest_mm, place.height_mm);
  if (lowest_mm < max_height_mm || lowest_mm > 1e8) return;
  throw refusal(
      "pedicles",
      fmt::format("the bone beside the canal is nowhere less than {:.0f} mm high, and a pedicle is less than "
                  "{:.0f}: is this a spine, and are its slices thin enough to part one vertebra from the next?",
                  lowest_mm, max_height_mm),
      {std::string("take a series of a spine, or thinner slices, or ") + give_them +
       "; of a neck configs/ct_chest_bone.yaml makes skin and bone"});
}

// From `from` until the bone is left for good: gaps narrower than `gap_mm` are vessels.
Vec3 leaves_bone(const BoneDistance& bone, Vec3 from, Vec3 way, double gap_mm) {
  Vec3 last = from;
  double out = 0;
  for (double t = 0; t < 120 && out <= gap_mm; t += walk_mm) {
    const Vec3 p = from + way * t;
    if (bone(p) > 0) {
      last = p;
      out = 0;
    } else {
      out += walk_mm;
    }
  }
  const double a = bone(last), b = bone(last + way * walk_mm);
  return b < 0 && b > -walk_mm * 4 ? last + way * (walk_mm * std::clamp(a / (a - b), 0.0, 1.0)) : last;
}

// The distance from that point to the end of the scan, beyond which nothing is known.
double to_scan_end_mm(const grid::Field& bone, Vec3 p) {
  const Vec3 i = bone.to_index(p);
  return std::min(i.z, bone.size[2] - 1 - i.z) * bone.spacing_mm.z;
}

// From the axis to the wall within 6 mm of that place, along rays: nearer to the truth than the distance's own raster,
// which flattens its ridge.
double to_wall_mm(const BoneDistance& bone, Vec3 at, Vec3 forwards) {
  double least = 1e9;
  for (double t = -6; t <= 6; t += 1)
    least = std::min(least, cross_section(bone, at + forwards * t, forwards).least_mm);
  return least;
}

struct Found {
  PedicleAxis axis;
  PediclePlace place;
};

void doubt(PedicleAxis& p, double share, const std::string& why) {
  p.confidence *= share;
  if (share < 0.7) p.doubt += (p.doubt.empty() ? "" : "; ") + why;
}

PedicleAxis axis_of(const BoneDistance& bone, const grid::Field& scan, const PediclePlace& place,
                    const PediclesParams& params) {
  const AxisLine line = find_axis(bone, place);
  PedicleAxis p;
  p.left = place.left;
  // The narrowest place, and the share of the directions in which a wall is met there.
  CrossSection narrowest;
  narrowest.area_mm2 = 1e9;
  for (double t = -8; t <= 8; t += 0.5) {
    const Vec3 at = line.at_mm + line.forwards * t;
    const CrossSection s = cross_section(bone, at, line.forwards);
    if (s.closed_ratio < 0.7 || s.area_mm2 >= narrowest.area_mm2) continue;
    narrowest = s;
    p.middle_mm = at;
  }
  if (narrowest.area_mm2 > 1e8) {
    p.middle_mm = line.at_mm;
    narrowest = cross_section(bone, line.at_mm, line.forwards);
  }
  p.half_width_mm = to_wall_mm(bone, line.at_mm, line.forwards);
  p.entry_mm = leaves_bone(bone, p.middle_mm, -line.forwards, 0.5);
  const Vec3 front = leaves_bone(bone, p.middle_mm, line.forwards, 4);
  p.target_mm = p.entry_mm + (front - p.entry_mm) * params.depth_ratio;

  p.confidence = 1;
  const double least = params.min_half_width_mm;
  doubt(p, mask::ramp(p.half_width_mm, 0.5 * least, least + 0.5 * least),
        fmt::format("only {:.1f} mm of bone are about its axis", p.half_width_mm));
  doubt(p, mask::ramp(narrowest.closed_ratio, 0.6, 0.95),
        fmt::format("its narrowest cross-section is closed over {:.0f} % alone", 100 * narrowest.closed_ratio));
  const double lean = lean_deg(place, line.forwards), rise = rise_deg(place, line.forwards);
  doubt(p, std::min(mask::ramp(lean, -30, -18), mask::ramp(lean, 60, 50)),
        fmt::format("it leans to the middle by {:.0f} degrees", lean));
  doubt(p, std::min(mask::ramp(rise, -30, -22), mask::ramp(rise, 30, 22)),
        fmt::format("it rises by {:.0f} degrees", rise));
  const double length = norm(front - p.entry_mm);
  doubt(p, std::min(mask::ramp(length, 15, 28), mask::ramp(length, 90, 75)),
        fmt::format("it would be {:.0f} mm long, from behind to the body's front", length));
  doubt(p, mask::ramp(place.height_mm, max_height_mm, 22),
        fmt::format("the bone beside the canal is {:.0f} mm high", place.height_mm));
  doubt(p, mask::ramp(std::min(to_scan_end_mm(scan, p.entry_mm), to_scan_end_mm(scan, p.target_mm)), 0, 3),
        "the scan ends there");
  // Bone close behind the entry: a joint, or a graft.
  double behind = 12;
  for (double t = 1; t < behind; t += walk_mm)
    if (bone(p.entry_mm - line.forwards * t) > 0.3) behind = t;
  doubt(p, mask::ramp(behind, -1, 4), fmt::format("there is other bone {:.1f} mm behind its entry", behind));
  return p;
}

Vec3 forwards(const Found& f) { return normalized(f.axis.target_mm - f.axis.entry_mm); }

// Left and right of one vertebra mirror each other, about a plane that may be turned a little, as the patient may be.
// Where one is much narrower than the other, its line runs along a wall, or it is no pedicle.
void judge_pair(Found& left, Found& right) {
  const double l = lean_deg(left.place, forwards(left)), r = lean_deg(right.place, forwards(right));
  const double converging = 0.5 * (l + r), turned = 0.5 * std::abs(l - r);
  const double rise = std::abs(rise_deg(left.place, forwards(left)) - rise_deg(right.place, forwards(right)));
  const double higher = std::abs(dot(left.axis.middle_mm - right.axis.middle_mm, left.place.up));
  const double share = std::min({mask::ramp(converging, -12, -4), mask::ramp(converging, 45, 38),
                                 mask::ramp(turned, 22, 14), mask::ramp(rise, 25, 14), mask::ramp(higher, 12, 6)});
  for (PedicleAxis* p : {&left.axis, &right.axis})
    doubt(*p, share,
          fmt::format(
              "left and right are no mirror images: they converge by {:.0f} degrees and are turned by {:.0f}, rise "
              "differently by {:.0f}, and are {:.0f} mm apart in height",
              converging, turned, rise, higher));
  PedicleAxis& narrow = left.axis.half_width_mm < right.axis.half_width_mm ? left.axis : right.axis;
  const double wide_mm = std::max(left.axis.half_width_mm, right.axis.half_width_mm);
  doubt(narrow, mask::ramp(narrow.half_width_mm / std::max(wide_mm, 1e-3), 0.35, 0.75),
        fmt::format("{:.1f} mm of bone are about its axis, about the other side's {:.1f}", narrow.half_width_mm,
                    wide_mm));
}

// Pedicles of neighbours rise alike along the canal; of fewer than two pairs nobody can say which one does not.
void judge_rises(std::vector<Found>& all) {
  if (all.size() < 4) return;
  std::vector<double> rises;
  for (const Found& f : all) rises.push_back(rise_deg(f.place, forwards(f)));
  std::vector<double> sorted = rises;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t half = sorted.size() / 2;
  const double usual = sorted.size() % 2 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
  for (std::size_t n = 0; n < all.size(); ++n)
    doubt(all[n].axis, mask::ramp(std::abs(rises[n] - usual), 20, 10),
          fmt::format("it rises by {} degrees along the canal, the others by about {}", std::lround(rises[n]),
                      std::lround(usual)));
}

// Counts the vertebrae from the lowest, and brings both sides of each together.
void pair_up(std::vector<Found>& all) {
  constexpr double same_mm = 12;
  std::sort(all.begin(), all.end(), [](const Found& a, const Found& b) { return a.place.at_mm.z < b.place.at_mm.z; });
  int vertebra = 0;
  for (std::size_t n = 0; n < all.size(); ++n) {
    Found& a = all[n];
    a.axis.vertebra = ++vertebra;
    Found* b = n + 1 < all.size() ? &all[n + 1] : nullptr;
    if (b && b->axis.left != a.axis.left && b->place.at_mm.z - a.place.at_mm.z < same_mm) {
      b->axis.vertebra = vertebra;
      judge_pair(a.axis.left ? a : *b, a.axis.left ? *b : a);
      ++n;
    } else {
      doubt(a.axis, 0.45, "the other side's was not found");
    }
  }
  std::sort(all.begin(), all.end(), [](const Found& a, const Found& b) {
    return a.axis.vertebra != b.axis.vertebra ? a.axis.vertebra < b.axis.vertebra : a.axis.left && !b.axis.left;
  });
}

/// How far levels lie from each other, by how long the way from an entry to the front of the body is: the median of the
/// sure ones of a side that follow each other; nothing where there are none.
std::optional<double> level_to_length(const std::vector<Found>& all, double depth_ratio) {
  std::vector<double> ratios;
  for (const Found& f : all)
    for (const Found& g : all) {
      const PedicleAxis &a = f.axis, &b = g.axis;
      if (b.vertebra != a.vertebra + 1 || b.left != a.left || a.confidence < sure || b.confidence < sure) continue;
      const double long_mm = 0.5 * (norm(a.target_mm - a.entry_mm) + norm(b.target_mm - b.entry_mm)) / depth_ratio;
      ratios.push_back(norm(b.middle_mm - a.middle_mm) / long_mm);
    }
  if (ratios.empty()) return {};
  return median_of(ratios);
}

}  // namespace

Outcome<std::vector<PedicleAxis>, PediclesFound> find_pedicles(const grid::Field& bone, const grid::Field& canal,
                                                               const PediclesParams& params, const Progress& progress,
                                                               bool some_given) {
  grid::place_in(canal, bone);  // the same raster
  const std::vector<PediclePlace> places = pedicle_places(bone, canal, params);
  if (!some_given) require_low_enough(places);
  progress.report(0.1);
  std::vector<Found> found;
  for (const PediclePlace& place : places)
    if (!place.cut) found.push_back({{}, place});
  if (found.empty() && some_given) return {};
  if (found.empty())
    throw refusal("pedicles", "none is seen beside the canal",
                  {std::string("lower `lower_hu` of the bone's `segment`, lower `min_height_mm`, or ") + give_them});
  const BoneDistance distance(bone, raster_about(bone, canal), progress.part(0.1, 0.5));
  parallel_for(0, std::int64_t(found.size()), 1, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t n = from; n < to; ++n) {
      Found& f = found[std::size_t(n)];
      f.axis = axis_of(distance, bone, f.place, params);
    }
  });
  pair_up(found);
  judge_rises(found);
  Warnings warnings;
  if (const auto ratio = level_to_length(found, params.depth_ratio); ratio && *ratio < least_level_ratio) {
    for (Found& f : found) doubt(f.axis, 0.45, "the levels lie too near to each other");
    warnings.push_back({"unusual_levels",
                        "the vertebrae lie {level_ratio:.2f} times as far from each other as they are long from behind "
                        "to the front, where a lumbar spine has 0.6 or so: the distance between the slices may be "
                        "wrong; compare it with the scan's protocol",
                        {{"level_ratio", *ratio}}});
  }
  std::vector<PedicleAxis> kept;
  for (const Found& f : found) kept.push_back(f.axis);
  if (const std::size_t cut = places.size() - found.size(); cut > 0)
    warnings.push_back({"pedicles_cut_off",
                        "{cut_count} at the ends of the scan are cut off and left out",
                        {{"cut_count", static_cast<std::int64_t>(cut)}}});
  const PediclesFound counts{kept.back().vertebra, static_cast<std::int64_t>(kept.size())};
  progress.report(1);
  return {std::move(kept), counts, std::move(warnings)};
}

double clearance_along(const grid::Field& bone, Vec3 entry, Vec3 target) {
  const Vec3 low{std::min(entry.x, target.x), std::min(entry.y, target.y), std::min(entry.z, target.z)};
  const Vec3 high{std::max(entry.x, target.x), std::max(entry.y, target.y), std::max(entry.z, target.z)};
  grid::Lattice l;
  l.spacing_mm = {raster_mm, raster_mm, raster_mm};
  l.origin_mm = low - Vec3{15, 15, 15};
  for (int c = 0; c < 3; ++c) l.size[std::size_t(c)] = int((high[c] - low[c] + 30) / raster_mm) + 1;
  const BoneDistance distance(bone, l);
  double least = 1e9;
  for (double share = 0.2; share <= 0.6; share += 0.02)
    least = std::min(least, distance(entry + (target - entry) * share));
  return least;
}

}  // namespace trephine::trunk
