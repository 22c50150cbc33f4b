// SPDX-License-Identifier: GPL-3.0-or-later
#include "look/body_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "base/error.h"
#include "base/rank.h"
#include "base/refusal.h"
#include "look/orientation.h"
#include "mask/coarse.h"
#include "mask/hu_view.h"
#include "place/cranium.h"
#include "trunk/canal_parts.h"

namespace trephine::look {
namespace {

constexpr double cell_mm = 3;
constexpr double bone_hu = 226, air_hu = -300, tissue_low_hu = -150, tissue_high_hu = 150;

// A cranial cavity. Given heads have 1,250 to 1,540 ml with up to 2 % of air, and a wall of 97 to 100 %.
constexpr double head_low_ml = 900, head_high_ml = 2000, head_air_ratio = 0.05, head_walled_ratio = 0.9;
constexpr double cavity_ml = 300, cavity_air_ratio = 0.25, cavity_walled_ratio = 0.7;  ///< as small, open or cut
constexpr double wall_mm = 6;

// Lungs: the given chest has 50 %, an empty skull too, but no tissue about it. What stages refuse later is a quarter.
// A skull full of gas has both, and walls as those of other heads; of what the given chest encloses 86 % are walled.
constexpr double lung_ratio = 0.35, lung_ml = 150, lung_tissue_ml = 2000, lung_walled_ratio = 0.93;

// A spine alone: its canal, which holds tissue, and hardly any bone away from it.
constexpr double spine_mm = 80, spine_low_hu = -100, spine_high_hu = 250, spine_bone_ratio = 0.9;

// How far below a cranial cavity a scan must go to show a whole vertebra with pedicles (the atlas has none, the axis
// ends some 45 mm down), or a clavicle.
constexpr double vertebra_mm = 45, clavicle_mm = 50;

double ml(const mask::BitMask& m) { return double(m.count()) * m.lattice().voxel_volume_mm3() / 1000; }

mask::BitMask between(const mask::HuView& hu, double low, double high) {
  mask::BitMask m = mask::above(hu, low);
  return m.remove(mask::above(hu, high));
}

// How far the lattice reaches below the mask, along the patient's length.
double below_mm(const mask::BitMask& m) {
  const grid::Lattice& l = m.lattice();
  const int axis = place::vertical_axis(l);
  const grid::Box box = m.bounds();
  const bool up = l.direction.column[std::size_t(axis)].z > 0;
  const int cells = up ? box.begin[std::size_t(axis)] : l.size[std::size_t(axis)] - box.end[std::size_t(axis)];
  return cells * l.spacing_mm[axis] * std::abs(l.direction.column[std::size_t(axis)].z);
}

// The share of the mask's surface, within the lattice, that has bone within wall_mm.
double walled_ratio(const mask::BitMask& space, const mask::BitMask& bone, const Progress& progress) {
  const mask::BitMask wall = mask::dilated(bone, wall_mm, progress);
  const mask::BitMask rim = mask::without(mask::dilated_6(space), space);
  return double(mask::both(rim, wall).count()) / double(std::max<std::size_t>(1, rim.count()));
}

// Air whose neighbours are air: no cell that a surface crosses.
double inner_air_ml(const mask::BitMask& air) {
  mask::BitMask other = air;
  other.invert();
  return ml(mask::without(air, mask::dilated_6(other)));
}

void look_for_canal(const mask::BitMask& bone, const mask::HuView& hu, BodyPartSeen& seen, const Progress& progress) {
  constexpr double about_mm = 60;
  seen.canal_mm = seen.canal_hu = seen.bone_about_canal_ratio = 0;
  const grid::Lattice& l = bone.lattice();
  if (std::abs(l.direction.column[2].z) < 0.7) return;
  const trunk::CanalCourse course = trunk::canal_course(bone, {}, progress);
  if (course.points.empty()) return;
  seen.canal_mm = double(course.points.size()) * l.spacing_mm.z;
  std::vector<float> content;
  std::size_t all = 0, about = 0;
  for (int k = 0; k < l.size[2]; ++k) {
    const int s = k - course.first_slice;
    const bool within = s >= 0 && s < int(course.points.size());
    const trunk::CanalPoint p = course.points[std::size_t(std::clamp(s, 0, int(course.points.size()) - 1))];
    if (within) content.push_back(hu(int(std::lround(p.i)), int(std::lround(p.j)), k));
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (bone.get(i, j, k)) {
          ++all;
          about += std::hypot((i - p.i) * l.spacing_mm.x, (j - p.j) * l.spacing_mm.y) < about_mm;
        }
  }
  seen.canal_hu = median_of(content);
  seen.bone_about_canal_ratio = double(about) / double(std::max<std::size_t>(1, all));
}

}  // namespace

BodyPartSeen body_part_of(const grid::HuVolume& volume, const Progress& progress) {
  const mask::HuView hu(volume);
  const mask::CoarseRaster raster = mask::coarse_raster(hu.lattice(), cell_mm);
  mask::BitMask all(hu.lattice());
  all.invert();
  const grid::Grid<float> means = mask::coarse_mean(hu, all, raster, -1000);
  const mask::HuView cells(means);
  const mask::BitMask bone = mask::coarse_mask(mask::above(hu, bone_hu), raster, 0.4);
  BodyPartSeen seen;
  seen.tissue_ml = ml(between(cells, tissue_low_hu, tissue_high_hu));
  if (!bone.any()) {
    seen.canal_mm = seen.canal_hu = seen.bone_about_canal_ratio = 0;
    return seen;
  }
  progress.report(0.4);
  try {
    const mask::BitMask space = place::cranial_cavity(bone, progress).value;
    seen.enclosed_ml = ml(space);
    mask::BitMask air = space;
    air.remove(mask::above(cells, air_hu));
    seen.enclosed_air_ratio = double(air.count()) / double(std::max<std::size_t>(1, space.count()));
    seen.enclosed_inner_air_ml = inner_air_ml(air);
    seen.walled_ratio = walled_ratio(space, bone, progress);
    seen.below_mm = below_mm(space);
    if (seen.enclosed_ml > head_low_ml && seen.enclosed_ml < head_high_ml && seen.enclosed_air_ratio < head_air_ratio &&
        seen.walled_ratio > head_walled_ratio)
      seen.head = head_signs(bone, mask::BitMask(bone.lattice()), progress).found;
  } catch (const Error& e) {
    if (e.code() != ExitCode::quality) throw;
  }
  progress.report(0.7);
  if (!seen.head) look_for_canal(bone, cells, seen, progress);
  progress.report(1);
  return seen;
}

namespace {

/// The scan surely shows another part of the body, and what is done about it.
struct OtherPart {
  std::string what;
  Message remedy;
};

const Message or_all_the_same = "; or where it is a head all the same, " + Setting{"refuse", "false"} +
                                " makes it, and the verdict calls it doubtful";

std::optional<OtherPart> other_than_head(const BodyPartSeen& seen) {
  if (seen.head) return {};
  if (seen.enclosed_air_ratio > lung_ratio && seen.enclosed_inner_air_ml > lung_ml && seen.tissue_ml > lung_tissue_ml &&
      seen.walled_ratio < lung_walled_ratio)
    return OtherPart{fmt::format("lungs are seen, and no head: {:.0f} % of the {:.0f} ml that bone encloses are air, "
                                 "of a head at most {:.0f} %",
                                 100 * seen.enclosed_air_ratio, seen.enclosed_ml, 100 * lung_ratio),
                     "take a series of a head; of this one configs/ct_chest.yaml makes a chest, "
                     "configs/ct_chest_bone.yaml skin and bone alone" +
                         or_all_the_same};
  const double canal_mm = *seen.canal_mm, canal_hu = *seen.canal_hu, bone_ratio = *seen.bone_about_canal_ratio;
  if (seen.enclosed_ml == 0 && canal_mm > spine_mm && canal_hu > spine_low_hu && canal_hu < spine_high_hu &&
      bone_ratio > spine_bone_ratio)
    return OtherPart{fmt::format("a spine is seen, and no head: bone encloses no cranial cavity, but a canal {:.0f} mm "
                                 "long, and {:.0f} % of all bone lie about it, of a head less than {:.0f} %",
                                 canal_mm, 100 * bone_ratio, 100 * spine_bone_ratio),
                     "take a series of a head; of this one configs/ct_spine_bone.yaml makes a spine" + or_all_the_same};
  return {};
}

// What is not in the scan no parameter makes: the one remedy is the recipe of a head.
std::optional<OtherPart> other_than_trunk(const BodyPartSeen& seen, bool spine) {
  const double least_mm = spine ? vertebra_mm : clavicle_mm;
  if (!seen.head || seen.below_mm >= least_mm) return {};
  return OtherPart{fmt::format("a head is seen (a cranial cavity of {:.0f} ml), and the scan ends {:.0f} mm below it: "
                               "{} at least {:.0f} mm below",
                               seen.enclosed_ml, seen.below_mm,
                               spine ? "a vertebra with pedicles ends" : "a chest begins", least_mm),
                   fmt::format("take a series of a {}; of this one configs/ct_head.yaml makes a head",
                               spine ? "spine" : "chest with its shoulders")};
}

}  // namespace

bool may_be_head(const BodyPartSeen& seen) {
  return seen.head || (seen.enclosed_ml > cavity_ml && seen.enclosed_air_ratio < cavity_air_ratio &&
                       seen.walled_ratio > cavity_walled_ratio);
}

Outcome<std::monostate, BodyPartResult> judge_body_part(const grid::HuVolume& volume, const BodyPartParams& params,
                                                        const Progress& progress) {
  mask::check_finite(volume);
  Outcome<std::monostate, BodyPartResult> out;
  out.result.seen = body_part_of(volume, progress);
  if (params.expected == BodyPart::head) out.result.is_expected = IsExpected::yes;
  std::optional<OtherPart> other;
  if (params.expected == BodyPart::head) other = other_than_head(out.result.seen);
  if (params.expected == BodyPart::spine || params.expected == BodyPart::chest)
    other = other_than_trunk(out.result.seen, params.expected == BodyPart::spine);
  if (other && params.refuse) throw refusal("expected", other->what, {other->remedy});
  if (other) {
    out.warnings.push_back({"other_part", "{why}", {{"why", other->what}}});
  } else if (params.expected == BodyPart::head && !may_be_head(out.result.seen)) {
    out.warnings.push_back({"no_cranial_cavity",
                            "no cranial cavity with a brain in it is seen, so nothing says that a head was scanned: "
                            "bone is made of it, whichever it is; look at the overlays",
                            {}});
  }
  if (!out.warnings.empty()) out.result.is_expected = IsExpected::unknown;
  return out;
}

}  // namespace trephine::look
