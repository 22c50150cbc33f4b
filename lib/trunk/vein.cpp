// SPDX-License-Identifier: GPL-3.0-or-later
#include "trunk/vein.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/refusal.h"
#include "mask/filters.h"
#include "trunk/vein_parts.h"

namespace trephine::trunk {
namespace {

constexpr double film_mm = 0.5;  ///< an estimated vein keeps this from bone and lung

/// A tube of that radius, positive inside, in mm, that leaves bone and lung alone.
grid::Field tube(const VeinCourse& course, const mask::HuView& hu, const grid::Field& bone, const grid::Box& box,
                 double radius_mm, const Progress& progress) {
  grid::Field field = distance_to(course, grid::cropped(hu.lattice(), box), radius_mm + 3);
  const grid::Lattice& l = field;
  const grid::Grid<float> room = room_around(hu, bone, box, progress);
  for (std::size_t v = 0; v < field.count(); ++v) {
    float& f = field.voxels[v];
    f = std::min(float(radius_mm) - f, room.voxels[v] - float(film_mm));
    if (std::abs(f) < 1e-3f) f = f > 0 ? 1e-3f : -1e-3f;
  }
  const mask::BitMask whole = mask::positive(field, field), kept = mask::largest(mask::components(whole));
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (whole.get(i, j, k) && !kept.get(i, j, k)) field.at(i, j, k) = -1e-3f;
  return field;
}

struct Vein {
  grid::Field field;
  grid::Box box;  ///< in the volume's indices
};

Vein vein_of(const ClavicleCourse& clavicle, const mask::HuView& hu, const grid::Field& all_bone, const VeinParams& p,
             Outcome<grid::Field, VeinResult>& made, const Progress& progress) {
  const std::string name = clavicle.side == BodySide::right ? "right" : "left";
  const grid::Field bone =
      p.source == VeinSource::automatic ? without_dense_vein(all_bone, clavicle, p, progress) : all_bone;
  const VeinCourse course = estimated_course(clavicle, hu, bone, p, progress);
  Vein vein;
  EnhancedVein enhanced;
  if (p.source == VeinSource::automatic) enhanced = enhanced_vein(hu, mask::positive(bone, bone), course, p, progress);
  if (enhanced.found) {
    vein.field = std::move(enhanced.field);
  } else {
    enhanced.length_mm = course.length_mm();
    enhanced.radius_mm = p.radius_mm;
    const grid::Box box = box_around(course, hu.lattice(), p.radius_mm + 3);
    if (box.empty())
      throw refusal("vein", "its course lies outside the volume: 0 voxels",
                    {"choose the other `side`, or take the vein out of the scene (configs/ct_chest_bone.yaml shows "
                     "`segment` of bone alone)"});
    vein.field = tube(course, hu, bone, box, p.radius_mm, progress);
  }
  vein.box = grid::place_in(vein.field, hu.lattice());
  const double ml = double(mask::positive(vein.field, vein.field).count()) * hu.lattice().voxel_volume_mm3() / 1000;
  made.result.sides.emplace_back(name, VeinFigures{enhanced.found ? "contrast" : "estimated", enhanced.contrast_hu,
                                                   enhanced.length_mm, enhanced.radius_mm, ml, course.clearance_mm});
  if (!enhanced.found) {
    const char* why = p.source == VeinSource::estimated ? "as asked" : "nothing along it is enhanced like a vessel";
    made.warnings.push_back({"vein_estimated",
                             "the {side} vein is estimated, not found: {reason}; a tube of {radius_mm} mm radius where "
                             "a vein usually runs below the clavicle",
                             {{"side", name}, {"reason", why}, {"radius_mm", p.radius_mm}}});
    if (course.clearance_mm < p.radius_mm)
      made.warnings.push_back(
          {"vein_in_bone_or_lung",
           "bone or lung leave {clearance_mm:.1f} mm around the {side} vein's middle, less than its radius",
           {{"clearance_mm", course.clearance_mm}, {"side", name}}});
  }
  return vein;
}

constexpr double min_lung_ml = 20;
constexpr double half_sternum_mm = 20;  ///< from a clavicle's sternal end to the body's middle
constexpr double sure_lung_mm2 = 1000, gap_ratio = 0.15, min_gap_mm = 5;
constexpr double max_lower_end_mm = 60;  ///< the liver raises a lung's base by a third of this

double middle_x_mm(const std::vector<ClavicleCourse>& clavicles) {
  double sum = 0;
  for (const ClavicleCourse& c : clavicles)
    sum += c.points_mm.front().x + (c.side == BodySide::right ? half_sternum_mm : -half_sternum_mm);
  return sum / double(clavicles.size());
}

/// The area of the lung on one side, slice by slice.
std::vector<double> lung_areas_mm2(const grid::Field& lung, bool right, double middle_x) {
  std::vector<double> area(std::size_t(lung.size[2]));
  for (int k = 0; k < lung.size[2]; ++k)
    for (int j = 0; j < lung.size[1]; ++j)
      for (int i = 0; i < lung.size[0]; ++i)
        if (lung.at(i, j, k) > 0 && right == (lung.to_world_mm({double(i), double(j), double(k)}).x < middle_x))
          area[std::size_t(k)] += lung.spacing_mm.x * lung.spacing_mm.y;
  return area;
}

/// The longest run of slices with next to no lung between slices with much of it, in indices; empty: {0, 0}.
std::pair<int, int> gap_of(const std::vector<double>& area) {
  const int n = int(area.size());
  std::vector<double> below(area), above(area);
  for (int k = 1; k < n; ++k) below[k] = std::max(below[k], below[k - 1]);
  for (int k = n - 2; k >= 0; --k) above[k] = std::max(above[k], above[k + 1]);
  std::pair<int, int> longest{0, 0};
  for (int k = 0, from = 0; k <= n; ++k) {
    const double least = k < n ? std::min(below[k], above[k]) : 0;
    if (k < n && least >= sure_lung_mm2 && area[k] < gap_ratio * least) continue;
    if (k - from > longest.second - longest.first) longest = {from, k};
    from = k + 1;
  }
  return longest;
}

// How much lung lies on each clavicle's side, and whether a part of a lung is missing.
void look_at_lung(const std::vector<ClavicleCourse>& clavicles, const grid::Field& lung,
                  Outcome<grid::Field, VeinResult>& made) {
  const double middle_x = middle_x_mm(clavicles), step_mm = lung.spacing_mm.z;
  const auto z_mm = [&](int k) { return lung.to_world_mm({0, 0, double(k)}).z; };
  double lowest_mm[2] = {1e9, 1e9};
  for (const bool right : {true, false}) {
    const std::vector<double> area = lung_areas_mm2(lung, right, middle_x);
    const std::string name = right ? "right" : "left";
    const double ml = std::accumulate(area.begin(), area.end(), 0.0) * step_mm / 1000;
    made.result.lung_ml.emplace_back(name, ml);
    for (int k = 0; k < lung.size[2]; ++k)
      if (area[std::size_t(k)] >= sure_lung_mm2) lowest_mm[right] = std::min(lowest_mm[right], z_mm(k));
    const bool has_clavicle = std::any_of(clavicles.begin(), clavicles.end(), [&](const ClavicleCourse& c) {
      return right == (c.side == BodySide::right);
    });
    if (has_clavicle && ml < min_lung_ml)
      made.warnings.push_back({"little_lung",
                               "the scan shows {lung_ml:.0f} ml of the {side} lung, less than {least_ml:.0f}: a needle "
                               "to the {side} vein is not judged for lung and pleura",
                               {{"lung_ml", ml}, {"side", name}, {"least_ml", min_lung_ml}}});
    const auto [from, to] = gap_of(area);
    if ((to - from) * step_mm >= min_gap_mm)
      made.warnings.push_back({"lung_interrupted",
                               "the {side} lung is missing from z {from_mm:.0f} to {to_mm:.0f} mm, with lung below and "
                               "above: look at the slices there, and paint what is missing",
                               {{"side", name}, {"from_mm", z_mm(from)}, {"to_mm", z_mm(to - 1)}}});
  }
  for (const bool right : {true, false})
    if (lowest_mm[right] < 1e9 && lowest_mm[right] - lowest_mm[!right] > max_lower_end_mm)
      made.warnings.push_back({"lung_ends_early",
                               "the {side} lung ends at z {side_mm:.0f} mm, {longer_mm:.0f} mm above the other one: "
                               "look at the slices below "
                               "it, and paint what is missing",
                               {{"side", right ? "right" : "left"},
                                {"side_mm", lowest_mm[right]},
                                {"longer_mm", lowest_mm[right] - lowest_mm[!right]}}});
}

}  // namespace

Outcome<grid::Field, VeinResult> find_vein(const grid::HuVolume& volume, const grid::Field& bone,
                                           const VeinParams& params, const Progress& progress,
                                           const grid::Field* lung) {
  const mask::HuView hu(volume);
  const grid::Box place = grid::place_in(bone, hu.lattice());
  for (int a = 0; a < 3; ++a)
    if (place.begin[a] < 0 || place.end[a] > hu.lattice().size[a])
      throw Error(ExitCode::bad_input, "", "bone", "the field reaches beyond the volume");
  ClavicleParams which;
  which.side = params.side;
  const auto clavicles = clavicle_courses(bone, which, progress);
  if (clavicles.empty())
    throw refusal("vein", "no clavicle of that side is found that tells where it runs",
                  {"choose the other `side`, or take a series that holds the shoulders"});
  Outcome<grid::Field, VeinResult> made;
  if (lung) {
    grid::place_in(*lung, hu.lattice());
    look_at_lung(clavicles, *lung, made);
  }
  progress.report(0.3);
  std::vector<Vein> veins;
  for (const ClavicleCourse& c : clavicles) {
    veins.push_back(vein_of(c, hu, bone, params, made, progress));
    progress.report(0.3 + 0.6 * double(veins.size()) / double(clavicles.size()));
  }
  grid::Box all = veins[0].box;
  for (const Vein& v : veins)
    for (int a = 0; a < 3; ++a) {
      all.begin[a] = std::min(all.begin[a], v.box.begin[a]);
      all.end[a] = std::max(all.end[a], v.box.end[a]);
    }
  const grid::Lattice lattice = grid::cropped(hu.lattice(), all);
  grid::Field field(lattice, -3.f);
  for (const Vein& v : veins) {
    const grid::Field placed = grid::fit(v.field, lattice, -3.f);
    for (std::size_t n = 0; n < field.count(); ++n) field.voxels[n] = std::max(field.voxels[n], placed.voxels[n]);
  }
  const mask::BitMask mask = mask::positive(field, field);
  made.result.size = mask::check_mask(mask, hu.lattice().count());
  progress.report(1);
  made.value = grid::crop(field, grid::grown(mask.bounds(), 2, field));
  return made;
}

}  // namespace trephine::trunk
