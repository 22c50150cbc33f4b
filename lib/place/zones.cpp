// SPDX-License-Identifier: GPL-3.0-or-later
#include "place/zones.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "mask/coarse.h"
#include "mask/filters.h"
#include "mask/surface_field.h"
#include "place/brainstem.h"
#include "place/third_ventricle.h"
#include "place/zone_doubts.h"

namespace trephine::place {
namespace {

constexpr double cut_sigma_mm = 1, inside_hu = 200, margin_mm = 3;
constexpr double third_reach_mm = 6;    ///< from the template's third ventricle; a wide one reaches farther to the side
constexpr double least_third_ml = 0.1;  ///< a slit has more
constexpr double least_cavity_ml = 300;  ///< of a small newborn; a half head, which nothing closes, has 30 to 200
constexpr double base_z = 20, air_hu = -300, min_air_ml = 0.3;
constexpr double air_share = 0.25, near_air_mm = 4;
constexpr float some_air_hu = -60;
constexpr double among_cells_mm = 8, between_cells_mm = 3;
constexpr double air_walls_mm = 3, air_wall_mm = 1;  ///< between bone cells, and between them and the dura
constexpr double stem_room_mm = 12, told_beyond_ml = 3, most_beyond_ml = 20, told_aside_mm = 5;
// Of the template, mm: the sinus runs over the vault from the frontal crest to the inner occipital protuberance.
constexpr double crest_y = -75, crest_z = 45, protuberance_y = 75, protuberance_z = 20;

/// The cavity's signed distance, positive inside, on a box of it, on cells where `cell_mm` is above 0.
grid::Field cavity_mm(const mask::BitMask& cavity, const grid::Box& box, const grid::Field* skull, double cell_mm,
                      const Progress& progress) {
  mask::BitMask part = mask::crop(cavity, box);
  grid::Field edge(part.lattice());
  if (skull) {
    // Outside of bone the field of the skull is negative: the cavity is where its opposite is positive.
    constexpr float far = -1e4f;
    edge = grid::fit(*skull, part.lattice(), far);
    for (float& v : edge.voxels) v = static_cast<float>(std::clamp(-double(v), -inside_hu, inside_hu));
  } else {
    for (int k = 0; k < edge.size[2]; ++k)
      for (int j = 0; j < edge.size[1]; ++j)
        for (int i = 0; i < edge.size[0]; ++i) edge.at(i, j, k) = part.get(i, j, k) ? 1.0f : -1.0f;
  }
  if (cell_mm > 0) {
    const mask::CoarseRaster raster = mask::coarse_raster(part.lattice(), cell_mm);
    edge = mask::coarse_mean(edge, raster);
    part = mask::coarse_mask(part, raster, 0.5);
  }
  mask::place_surface(edge, part, cut_sigma_mm, inside_hu, progress);
  return mask::signed_distance_mm(edge, progress);
}

grid::Box box_around(const mask::BitMask& cavity) {
  const grid::Lattice& all = cavity.lattice();
  const double least = std::min({all.spacing_mm.x, all.spacing_mm.y, all.spacing_mm.z});
  return grid::grown(cavity.bounds(), static_cast<int>(std::ceil(margin_mm / least)), all);
}

/// How far a place of the template lies within the zone as far as the template says it, mm.
double template_mm(Vec3 t, double side_mm, const ZoneParams& params, Vec3 medulla_end) {
  switch (params.what) {
    case Zone::dura:
      return 1e3;
    case Zone::midline:
      return params.half_width_mm - side_mm;
    case Zone::sagittal_sinus: {
      const double above = t.z - (crest_z + (protuberance_z - crest_z) * (t.y - crest_y) / (protuberance_y - crest_y));
      return std::min(params.sinus_half_width_mm - side_mm, above);
    }
    case Zone::third_ventricle: {
      const double third = place_mm(Place::third, t);
      const double lateral = std::min(place_mm(Place::lateral_left, t), place_mm(Place::lateral_right, t));
      return std::min(lateral - third, third_reach_mm - third);
    }
    case Zone::brainstem:
      return -brainstem_mm(t, medulla_end);
  }
  return -1e3;
}

/// The part of the box in which the template has something of the zone, with room for distances around it.
grid::Box box_of_template(const grid::Lattice& l, const grid::Box& box, const HeadPlace& place,
                          const ZoneParams& params, Vec3 medulla_end) {
  constexpr int step = 4;
  constexpr double room_mm = 12;
  grid::Box out{box.end, box.begin};
  for (int k = box.begin[2]; k < box.end[2]; k += step)
    for (int j = box.begin[1]; j < box.end[1]; j += step)
      for (int i = box.begin[0]; i < box.end[0]; i += step) {
        const Vec3 t = place.to_template(l.to_world_mm({double(i), double(j), double(k)}));
        if (template_mm(t, std::abs(t.x) * place.scale.x, params, medulla_end) < -room_mm) continue;
        const int at[3] = {i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          out.begin[a] = std::min(out.begin[a], at[a]);
          out.end[a] = std::max(out.end[a], at[a] + 1);
        }
      }
  if (out.begin[0] >= out.end[0]) return box;  // nothing: the zone is then refused
  grid::Box roomy = grid::grown(out, step, l);
  for (std::size_t a = 0; a < 3; ++a) {
    roomy.begin[a] = std::max(roomy.begin[a], box.begin[a]);
    roomy.end[a] = std::min(roomy.end[a], box.end[a]);
  }
  return roomy;
}

HeadPlace place_of(const mask::BitMask& cavity, const ZoneShapes& shapes, bool with_ventricles,
                   const Progress& progress) {
  if (shapes.place) return shapes.place(with_ventricles, progress);
  return place_in_cavity(cavity, with_ventricles ? shapes.ventricles : nullptr, progress);
}

using Made = Outcome<grid::Field, ZoneResult>;

/// Cuts off the dura what lies beyond the template's cavity and the way of the brainstem out of it.
void keep_near_template(grid::Field& wall, const HeadPlace& place, const ZoneParams& params, Made& made) {
  if (!place.sure) return;
  std::vector<std::int64_t> cut(std::size_t(wall.size[2]));
  parallel_for(0, wall.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < wall.size[1]; ++j)
        for (int i = 0; i < wall.size[0]; ++i) {
          const Vec3 t = place.to_template(wall.to_world_mm({double(i), double(j), double(k)}));
          const double room_mm = params.max_beyond_mm - std::min(template_cavity_mm(t), brainstem_mm(t) - stem_room_mm);
          float& v = wall.at(i, j, k);
          if (v > 0 && room_mm <= 0) ++cut[std::size_t(k)];
          v = std::min(v, static_cast<float>(room_mm == 0 ? -1e-6 : room_mm));
        }
  });
  const double ml = double(std::accumulate(cut.begin(), cut.end(), std::int64_t{0})) * wall.voxel_volume_mm3() / 1000;
  made.result.beyond_ml = ml;
  if (ml > told_beyond_ml)
    made.warnings.push_back({ml > most_beyond_ml ? "dura_not_seen" : "dura_by_template",
                             "{beyond_ml:.0f} ml behind the thin bone of the skull's base were cut off, where the scan "
                             "shows no bone: the dura's border there is a template's, not the scan's",
                             {{"beyond_ml", ml}}});
}

/// Of the cells near the wall, at the skull's base: those that hold air, and those that hold some of it, darker than
/// all that the dura encloses. The nearest voxel alone misses bone cells, where air and their walls are mixed, and in
/// noise any voxel may be as dark: so 27 places about a cell are asked, over 2 mm at least and, but in thick slices,
/// over three voxels.
struct AirCells {
  mask::BitMask air, some;
};
AirCells air_at_base(const grid::Field& wall, const grid::HuVolume& volume, const HeadPlace& place) {
  const mask::HuView hu(volume);
  grid::Grid<float> mean(grid::Lattice(wall), 0.f);
  constexpr double over_mm = 2, over_voxels = 1.6;
  Vec3 third;  // of the way over which a cell is asked, in cells
  for (int a = 0; a < 3; ++a) {
    const double voxel_mm = hu.lattice().spacing_mm[a];
    const double way_mm = voxel_mm > over_mm ? over_mm : std::max(over_mm, over_voxels * voxel_mm);
    third[a] = std::max(1.0, way_mm / wall.spacing_mm[a]) / 3;
  }
  const auto air = mask::make_mask(grid::Lattice(wall), [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < wall.size[0]; ++i) {
      row[i] = 0;
      if (wall.at(i, j, k) < -near_air_mm) continue;
      const Vec3 middle{double(i), double(j), double(k)};
      if (place.to_template(wall.to_world_mm(middle)).z >= base_z) continue;
      int air = 0, looked = 0;
      double sum = 0;
      for (int n = 0; n < 27; ++n) {
        const Vec3 part{(n % 3 - 1) * third.x, (n / 3 % 3 - 1) * third.y, (n / 9 - 1) * third.z};
        const Vec3 at = hu.lattice().to_index(wall.to_world_mm(middle + part));
        const int x = int(std::lround(at.x)), y = int(std::lround(at.y)), z = int(std::lround(at.z));
        if (hu.lattice().contains(x, y, z)) ++looked, air += hu(x, y, z) < air_hu, sum += hu(x, y, z);
      }
      if (looked > 0) mean.at(i, j, k) = float(sum / looked);
      row[i] = looked > 0 && air >= air_share * looked;
    }
  });
  auto some = mask::make_mask(mean, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < mean.size[0]; ++i) row[i] = mean.at(i, j, k) < some_air_hu;
  });
  some |= air;
  return {air, some};
}

/// How far each cell lies from the air of sinuses and of bone cells at the skull's base, whose thin walls thick slices
/// lose, less those walls: no dura where it is not above 0. Empty without such air inside the wall. Air above the base
/// may be inside the dura, as after an operation.
std::vector<float> off_air_mm(const grid::Field& wall, const grid::HuVolume& volume, const HeadPlace& place, Made& made,
                              const Progress& progress) {
  if (!place.sure) return {};
  const AirCells cells = air_at_base(wall, volume, place);
  const mask::Components some = mask::components(mask::closed(cells.some, air_walls_mm, progress));
  const mask::BitMask pieces =
      mask::at_least_ml(mask::components(mask::select(some, mask::touching(some, cells.air))), min_air_ml);
  const mask::BitMask inside = mask::positive(wall, wall);
  const double ml = double(mask::both(pieces, inside).count()) * wall.voxel_volume_mm3() / 1000;
  if (ml == 0) return {};
  made.result.air_ml = ml;
  if (ml > told_beyond_ml)
    made.warnings.push_back({"air_at_base",
                             "{air_ml:.0f} ml of air at the skull's base were left out of it, as of sinuses and bone "
                             "cells whose walls the scan does not show: look there where the head may hold air inside "
                             "the skull",
                             {{"air_ml", ml}}});
  std::vector<float> off = mask::distance_mm(pieces, progress).voxels;
  // What is left between bone cells is no place of the dura's.
  mask::BitMask room = mask::make_mask(wall, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < wall.size[0]; ++i) row[i] = inside.get(i, j, k) && off[wall.index(i, j, k)] > air_wall_mm;
  });
  const mask::BitMask wide = mask::dilated(mask::eroded(room, between_cells_mm, progress), between_cells_mm, progress);
  for (int k = 0; k < wall.size[2]; ++k)
    for (int j = 0; j < wall.size[1]; ++j)
      for (int i = 0; i < wall.size[0]; ++i) {
        float& v = off[wall.index(i, j, k)];
        if (v < among_cells_mm && room.get(i, j, k) && !wide.get(i, j, k)) v = 0;
        v -= float(air_wall_mm);
      }
  return off;
}

/// Keeps what lies off the air, in one piece.
void leave_air(grid::Field& wall, const std::vector<float>& off) {
  if (off.empty()) return;
  for (std::size_t n = 0; n < wall.voxels.size(); ++n) wall.voxels[n] = std::min(wall.voxels[n], off[n]);
  const mask::BitMask whole = mask::largest(mask::components(mask::positive(wall, wall)));
  for (int k = 0; k < wall.size[2]; ++k)
    for (int j = 0; j < wall.size[1]; ++j)
      for (int i = 0; i < wall.size[0]; ++i)
        if (wall.at(i, j, k) >= 0 && !whole.get(i, j, k)) wall.at(i, j, k) = -1e-6f;
}

const char* name_of(Zone zone) {
  switch (zone) {
    case Zone::dura:
      return "dura";
    case Zone::midline:
      return "midline";
    case Zone::sagittal_sinus:
      return "sagittal sinus";
    case Zone::third_ventricle:
      return "third ventricle";
    case Zone::brainstem:
      return "brainstem";
  }
  return "";
}

/// The smallest box around what is positive, with room for the surface.
Made trimmed(const grid::Field& field, Made made, Zone zone, const grid::HuVolume* volume) {
  const char* what = name_of(zone);
  const double least_ml = zone == Zone::third_ventricle ? least_third_ml : 0;
  grid::Box box{{field.size[0], field.size[1], field.size[2]}, {0, 0, 0}};
  std::size_t count = 0;
  for (int k = 0; k < field.size[2]; ++k)
    for (int j = 0; j < field.size[1]; ++j)
      for (int i = 0; i < field.size[0]; ++i) {
        if (!(field.at(i, j, k) > 0)) continue;
        ++count;
        const int at[3] = {i, j, k};
        for (int a = 0; a < 3; ++a) {
          box.begin[a] = std::min(box.begin[a], at[a]);
          box.end[a] = std::max(box.end[a], at[a] + 1);
        }
      }
  const double ml = double(count) * field.voxel_volume_mm3() / 1000;
  if (count == 0)
    throw refusal("", std::string("nothing of the ") + what + " lies in the scan",
                  {"take the zone out of the scene's `anatomies`, or take a scan of the whole head"});
  if (ml <= least_ml)
    throw refusal("", fmt::format("no more than {:.2g} ml of the {} are seen", ml, what),
                  {"take the zone out of the scene's `anatomies`, or take a scan of thinner slices or less noise"});
  made.result.volume_ml = ml;
  made.value = grid::crop(field, grid::grown(box, 2, field));
  for (Warning& w : zone_doubts(made.value, zone, volume)) made.warnings.push_back(std::move(w));
  return made;
}

/// Half of the slab's width: at least a voxel across it, or none would hold it. Thick slices do not matter to it.
double slab_mm(const grid::Lattice& l, const ZoneParams& params) {
  std::size_t across = 0;
  for (std::size_t a = 1; a < 3; ++a)
    if (std::abs(l.direction.column[a].x) > std::abs(l.direction.column[across].x)) across = a;
  return std::max({params.half_width_mm, l.spacing_mm[int(across)], params.cell_mm});
}

void check(const mask::BitMask& cavity, const ZoneShapes& shapes, const ZoneParams& params) {
  const grid::Lattice& l = cavity.lattice();
  const double coarsest = std::max({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z, params.cell_mm});
  if (params.what == Zone::dura && params.thickness_mm > 0 && params.thickness_mm < 2 * coarsest)
    throw Error(ExitCode::usage, "", "thickness_mm",
                "is less than two voxels, which cannot hold a shell: give more, or 0 for all that the dura encloses");
  if (params.what == Zone::third_ventricle && !shapes.ventricles)
    throw Error(ExitCode::usage, "", "ventricles", "must be given: the third ventricle is a part of them");
  if (const double ml = double(cavity.count()) * l.voxel_volume_mm3() / 1000; ml < least_cavity_ml)
    throw refusal(
        "",
        fmt::format("the bone encloses {:.0f} ml, and the smallest whole cranial cavity has {:.0f} ml: "
                    "where the scan's field cuts the head, nothing closes it",
                    ml, least_cavity_ml),
        {"take a scan that shows the skull on all sides, or a recipe without a brain (configs/ct_skull.yaml)"});
}

}  // namespace

HeadPlace place_in_cavity(const mask::BitMask& cavity, const grid::Field* ventricles, const Progress& progress) {
  mask::BitMask fluid;
  if (ventricles) fluid = mask::positive(*ventricles, cavity.lattice());
  return place_head(cavity, ventricles ? &fluid : nullptr, cavity.lattice(), progress);
}

Outcome<grid::Field, ZoneResult> find_zone(const mask::BitMask& cavity, const ZoneShapes& shapes,
                                           const ZoneParams& said, const Progress& progress) {
  check(cavity, shapes, said);
  Made made;
  ZoneParams params = said;
  params.half_width_mm = slab_mm(cavity.lattice(), said);
  const grid::Box whole = box_around(cavity);
  if (params.what == Zone::dura) {
    grid::Field wall = cavity_mm(cavity, whole, shapes.skull, params.cell_mm, progress);
    std::vector<float> off_air;
    if (params.max_beyond_mm > 0) {
      const HeadPlace place = place_of(cavity, shapes, false, progress);
      keep_near_template(wall, place, params, made);
      if (shapes.volume) off_air = off_air_mm(wall, *shapes.volume, place, made, progress);
      leave_air(wall, off_air);
    }
    if (params.smooth_mm > 0) {
      mask::gaussian(wall, params.smooth_mm);
      for (float& v : wall.voxels)
        if (v == 0) v = -1e-6f;
      leave_air(wall, off_air);  // which a smoothed surface runs into again
    }
    if (params.inset_mm > 0)
      for (float& v : wall.voxels) v = v == float(params.inset_mm) ? -1e-6f : v - float(params.inset_mm);
    if (params.thickness_mm > 0)
      for (float& v : wall.voxels) v = std::min(v, static_cast<float>(params.thickness_mm) - v);
    return trimmed(wall, std::move(made), params.what, shapes.volume);
  }
  HeadPlace place = place_of(cavity, shapes, true, progress.part(0, 0.4));
  made.result.place = figures_of(place);
  made.warnings = warnings_of(place);
  if (!place.sure)
    throw refusal("", std::string("where the ") + name_of(params.what) + " lies is not sure: the template fits badly",
                  {"take the zone out of the scene, or bring it as labels by the stage `labels`"});
  // What the scan itself shows: the inner table, or of the third ventricle the ventricles' walls.
  Vec3 medulla_end = template_medulla_end;
  if (const auto end = params.what == Zone::brainstem ? find_medulla_end(cavity, place) : std::nullopt) {
    made.result.medulla_shift_mm = beside_mm(*end, place);
    medulla_end = *end;
  }
  const grid::Box box = box_of_template(cavity.lattice(), whole, place, params, medulla_end);
  grid::Field seen;
  if (params.what == Zone::third_ventricle) {
    constexpr float far = -1e3f;
    seen = mask::signed_distance_mm(grid::fit(*shapes.ventricles, grid::cropped(cavity.lattice(), box), far), progress);
    if (const double shift_mm = third_shift_mm(seen, place); shift_mm != 0) {
      place.centre_mm += place.axes.column[0] * shift_mm;
      made.result.third_shift_mm = shift_mm;
      if (std::abs(shift_mm) > told_aside_mm)
        made.warnings.push_back({"third_ventricle_aside",
                                 "the third ventricle lies {shift_mm:.0f} mm to the {side} of the midline",
                                 {{"shift_mm", std::abs(shift_mm)}, {"side", shift_mm > 0 ? "left" : "right"}}});
    }
    cut_off_lateral(seen, place, progress);
  } else {
    seen = cavity_mm(cavity, box, shapes.skull, params.what == Zone::midline ? params.cell_mm : 0,
                     progress.part(0.4, 0.8));
  }
  grid::Field zone{grid::Lattice(seen)};
  parallel_for(0, zone.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = static_cast<int>(from); k < to; ++k) {
      progress.part(0.8, 1).report(double(k) / zone.size[2]);
      for (int j = 0; j < zone.size[1]; ++j)
        for (int i = 0; i < zone.size[0]; ++i) {
          const Vec3 t = place.to_template(zone.to_world_mm({double(i), double(j), double(k)}));
          const std::size_t n = zone.index(i, j, k);
          const double in_mm = seen.voxels[n];
          double mm = std::min(template_mm(t, std::abs(t.x) * place.scale.x, params, medulla_end), in_mm);
          if (params.what == Zone::sagittal_sinus) mm = std::min(mm, params.sinus_depth_mm - in_mm);
          // No voxel is 0, and the field is the same far away: it holds a surface and nothing else.
          zone.voxels[n] = static_cast<float>(std::clamp(mm == 0 ? -1e-6 : mm, -10.0, 10.0));
        }
    }
  });
  return trimmed(zone, std::move(made), params.what, shapes.volume);
}

}  // namespace trephine::place
