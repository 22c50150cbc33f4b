// SPDX-License-Identifier: GPL-3.0-or-later
#include "trunk/canal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "mask/filters.h"
#include "mask/hu_view.h"
#include "trunk/canal_parts.h"

namespace trephine::trunk {
namespace {

/// The box around the canal's slices, in the bone's indices: one slice more at ends that lie inside.
grid::Box box_of(const CanalCourse& course, const CanalWall& wall, const grid::Lattice& l) {
  grid::Box box;
  box.begin = {l.size[0], l.size[1], course.first_slice};
  box.end = {0, 0, course.first_slice + int(course.points.size())};
  for (std::size_t s = 0; s < course.points.size(); ++s) {
    const float* r = &wall.radius_mm[s * CanalWall::directions];
    const double most = *std::max_element(r, r + CanalWall::directions);
    const double centre[2] = {course.points[s].i, course.points[s].j};
    for (int a = 0; a < 2; ++a) {
      box.begin[a] = std::min(box.begin[a], int(centre[a] - most / l.spacing_mm[a]));
      box.end[a] = std::max(box.end[a], int(centre[a] + most / l.spacing_mm[a]) + 2);
    }
  }
  return grid::grown(box, 2, l);
}

/// The wall's distance minus the point's, in its slice; beyond the ends negative, so that it is closed half a slice on.
grid::Field inside_wall(const CanalCourse& course, const CanalWall& wall, const grid::Lattice& l,
                        const grid::Box& box) {
  grid::Field field(grid::cropped(l, box));
  const int slices = int(course.points.size());
  parallel_for(0, field.size[2], 2, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k) {
      const int s = k + box.begin[2] - course.first_slice, near = std::clamp(s, 0, slices - 1);
      const double beyond_mm = (std::abs(s - near) - 0.5) * l.spacing_mm.z;
      const CanalPoint centre = course.points[near];
      for (int j = 0; j < field.size[1]; ++j)
        for (int i = 0; i < field.size[0]; ++i) {
          const double x = (i + box.begin[0] - centre.i) * l.spacing_mm.x,
                       y = (j + box.begin[1] - centre.j) * l.spacing_mm.y;
          double f = wall.at(near, std::atan2(y, x)) - std::hypot(x, y);
          if (s != near) f = std::min(f, -beyond_mm);
          field.at(i, j, k) = float(f);
        }
    }
  });
  return field;
}

void measure(const mask::HuView& hu, const grid::Box& place, const CanalCourse& course, const CanalWall& wall,
             Outcome<grid::Field, CanalResult>& made) {
  const grid::Field& field = made.value;
  const std::size_t slices = course.points.size();
  std::vector<float> areas, content;
  double least = 0, min_z = 0, walled = 0;
  for (std::size_t s = 0; s < slices; ++s) {
    const double area = wall.area_mm2(s);
    areas.push_back(float(area));
    walled += wall.walled_ratio(s) / double(slices);
    if (wall.walled_ratio(s) < 0.5 || (least > 0 && area >= least)) continue;
    least = area;
    const double k = double(s) + course.first_slice + place.begin[2];
    min_z = hu.lattice().to_world_mm({course.points[s].i + place.begin[0], course.points[s].j + place.begin[1], k}).z;
  }
  const grid::Box at = grid::place_in(field, hu.lattice());
  for (int k = 0; k < field.size[2]; ++k)
    for (int j = 0; j < field.size[1]; ++j)
      for (int i = 0; i < field.size[0]; ++i)
        if (field.at(i, j, k) > 2) content.push_back(hu(i + at.begin[0], j + at.begin[1], k + at.begin[2]));
  const double middle = mask::median(areas, 0), tissue = mask::median(content, 0);
  made.result.area_median_mm2 = middle;
  made.result.area_least_mm2 = least;
  made.result.area_least_z_mm = min_z;
  made.result.walled_ratio = walled;
  made.result.tissue_hu = tissue;
  if (middle < 80 || middle > 700)
    made.warnings.push_back({"unusual_canal",
                             "its cross-section, {area_mm2:.0f} mm^2, is not of the size of an adult's spinal canal",
                             {{"area_mm2", middle}}});
  if (tissue < -500)
    throw refusal(
        "canal",
        fmt::format("it holds {:.0f} HU, which is air: what bone encloses there is an airway or a sinus, of a "
                    "spinal canal the content is above -500 HU",
                    tissue),
        {"take a series of a spine, or one that shows more of it (`import --list` shows all), or bring the canal as "
         "labels by the stage `labels`"});
  if (tissue < -60 || tissue > 100)
    made.warnings.push_back({"unusual_content",
                             "it holds {content_hu:.0f} HU, which is no cord, root or liquor without contrast",
                             {{"content_hu", tissue}}});
}

}  // namespace

Outcome<grid::Field, CanalResult> find_canal(const grid::HuVolume& volume, const grid::Field& bone,
                                             const CanalParams& params, const Progress& progress) {
  const mask::HuView hu(volume);
  const grid::Lattice& l = bone;
  if (std::abs(l.direction.column[2].z) < 0.7)
    throw refusal("canal", "the volume's slices are not axial", {"take the axial series (`import --list` shows all)"});
  const grid::Box place = grid::place_in(bone, hu.lattice());
  for (int a = 0; a < 3; ++a)
    if (place.begin[a] < 0 || place.end[a] > hu.lattice().size[a])
      throw Error(ExitCode::bad_input, "", "bone", "the field reaches beyond the volume");
  const mask::BitMask mask = mask::positive(bone, bone);
  if (!mask.any())
    throw refusal("bone", fmt::format("the mask is empty: 0 of {} voxels", l.count()),
                  {"lower `lower_hu` of its `segment`"});

  CanalCourse course = canal_course(mask, params, progress.part(0, 0.5));
  const double length_mm = double(course.points.size()) * l.spacing_mm.z;
  if (length_mm < params.min_length_mm)
    throw refusal("min_length_mm",
                  fmt::format("the longest space that bone encloses slice by slice is {:.0f} mm long, at least {:.0f} "
                              "mm make a canal: is this a spine, and its bone complete?",
                              length_mm, params.min_length_mm),
                  {"lower `lower_hu` of the bone's `segment`, lower `min_length_mm`, or take the canal out of the "
                   "scene (configs/ct_spine_bone.yaml)"});
  progress.report(0.5);
  const CanalWall wall = canal_wall(bone, course, params, progress);
  double walled = 0;
  for (std::size_t s = 0; s < course.points.size(); ++s) walled += wall.walled_ratio(s) / double(course.points.size());
  if (walled < params.min_walled_ratio)
    throw refusal(
        "min_walled_ratio",
        fmt::format("{:.0f} % of its wall are bone, at least {:.0f} %", 100 * walled, 100 * params.min_walled_ratio),
        {"lower `lower_hu` of the bone's `segment`, or lower `min_walled_ratio`"});
  progress.report(0.7);

  const grid::Box box = box_of(course, wall, l);
  Outcome<grid::Field, CanalResult> made;
  grid::Field& field = made.value = inside_wall(course, wall, l, box);
  const grid::Field inside_bone = mask::signed_distance_mm(grid::crop(bone, box), progress);
  for (std::size_t v = 0; v < field.count(); ++v) {
    float& f = field.voxels[v];
    f = std::min(f, -inside_bone.voxels[v] - float(params.gap_mm));
    if (std::abs(f) < 1e-3f) f = f > 0 ? 1e-3f : -1e-3f;
  }
  const mask::BitMask whole = mask::positive(field, field), kept = mask::largest(mask::components(whole));
  for (int k = 0; k < field.size[2]; ++k)
    for (int j = 0; j < field.size[1]; ++j)
      for (int i = 0; i < field.size[0]; ++i)
        if (whole.get(i, j, k) && !kept.get(i, j, k)) field.at(i, j, k) = -1e-3f;
  made.result.length_mm = length_mm;
  made.result.size = mask::check_mask(kept, hu.lattice().count());
  measure(hu, place, course, wall, made);
  progress.report(1);
  field = grid::crop(field, grid::grown(kept.bounds(), 2, field));
  return made;
}

}  // namespace trephine::trunk
