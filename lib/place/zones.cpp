// SPDX-License-Identifier: GPL-3.0-or-later
#include "place/zones.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/refusal.h"
#include "mask/filters.h"
#include "mask/surface_field.h"
#include "place/place_head.h"

namespace trephine {
namespace {

using namespace segmentation;

constexpr double cut_sigma_mm = 1, inside_hu = 200, margin_mm = 3;
constexpr double third_reach_mm = 6;  ///< from the template's third ventricle; a wide one reaches farther to the side
// Of the template, mm: the sinus runs over the vault from the frontal crest to the inner occipital protuberance.
constexpr double crest_y = -75, crest_z = 45, protuberance_y = 75, protuberance_z = 20;

/// The cavity's signed distance, positive inside, on a box around it.
Field cavity_mm(const BitMask& cavity, const Field* skull, const Progress& progress) {
  const Lattice& all = cavity.lattice();
  const double least = std::min({all.spacing_mm.x, all.spacing_mm.y, all.spacing_mm.z});
  const Box box = grown(cavity.bounds(), static_cast<int>(std::ceil(margin_mm / least)), all);
  const BitMask part = crop(cavity, box);
  const Lattice& l = part.lattice();
  Field edge(l);
  if (skull) {
    // Outside of bone the field of the skull is negative: the cavity is where its opposite is positive.
    constexpr float far = -1e4f;
    edge = fit(*skull, l, far);
    for (float& v : edge.voxels) v = static_cast<float>(std::clamp(-double(v), -inside_hu, inside_hu));
  } else {
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) edge.at(i, j, k) = part.get(i, j, k) ? 1.0f : -1.0f;
  }
  place_surface(edge, part, cut_sigma_mm, inside_hu, progress);
  return signed_distance_mm(edge, progress);
}

double stem_mm(Vec3 p) {
  // As the synthetic head's, which follows an atlas: midbrain and pons, then the medulla down to the foramen magnum.
  const auto capsule = [&](Vec3 a, Vec3 b, double r, double s) {
    const Vec3 ab = b - a;
    const double t = std::clamp(dot(p - a, ab) / dot(ab, ab), 0.0, 1.0);
    return norm(p - (a + ab * t)) - (r + t * (s - r));
  };
  return std::min(capsule({0, 6, 30}, {0, 16, 4}, 11.5, 12), capsule({0, 16, 4}, {0, 27, -26}, 9, 6));
}

double sinus_mm(Vec3 t, double side_mm, double wall_mm, const ZoneParams& params) {
  const double above = t.z - (crest_z + (protuberance_z - crest_z) * (t.y - crest_y) / (protuberance_y - crest_y));
  return std::min({params.sinus_half_width_mm - side_mm, params.sinus_depth_mm - wall_mm, wall_mm, above});
}

/// The smallest box around what is positive, with room for the surface.
Field trimmed(const Field& field, Report& report, const char* what) {
  Box box{{field.size[0], field.size[1], field.size[2]}, {0, 0, 0}};
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
  if (count == 0)
    throw refusal("", std::string("nothing of the ") + what + " lies in the scan",
                  {"take the zone out of the scene's `anatomies`, or take a scan of the whole head"});
  report.add("volume_ml", double(count) * field.voxel_volume_mm3() / 1000);
  return crop(field, grown(box, 2, field));
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

void check(const Lattice& l, const ZoneShapes& shapes, const ZoneParams& params) {
  const double coarsest = std::max({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z});
  if (params.what == Zone::dura && params.thickness_mm > 0 && params.thickness_mm < 2 * coarsest)
    throw Error(ExitCode::usage, "", "thickness_mm",
                "is less than two voxels, which cannot hold a shell: give more, or 0 for all that the dura encloses");
  if (params.what == Zone::midline && params.half_width_mm < coarsest)
    throw Error(ExitCode::usage, "", "half_width_mm", "is less than a voxel, which cannot hold a slab: give more");
  if (params.what == Zone::third_ventricle && !shapes.ventricles)
    throw Error(ExitCode::usage, "", "ventricles", "must be given: the third ventricle is a part of them");
}

}  // namespace

Field find_zone(const BitMask& cavity, const ZoneShapes& shapes, const ZoneParams& params, Report& report,
                const Progress& progress) {
  check(cavity.lattice(), shapes, params);
  Field wall = cavity_mm(cavity, shapes.skull, progress.part(0, 0.4));
  const Lattice lattice = wall;
  if (params.what == Zone::dura) {
    if (params.thickness_mm > 0)
      for (float& v : wall.voxels) v = std::min(v, static_cast<float>(params.thickness_mm) - v);
    return trimmed(wall, report, name_of(params.what));
  }
  BitMask fluid;
  if (shapes.ventricles) fluid = positive(*shapes.ventricles, cavity.lattice());
  const HeadPlace place =
      place_head(cavity, shapes.ventricles ? &fluid : nullptr, cavity.lattice(), progress.part(0.4, 0.8));
  report_place(place, report);
  if (!place.sure)
    throw refusal("", std::string("where the ") + name_of(params.what) + " lies is not sure: the template fits badly",
                  {"take the zone out of the scene, or bring it as labels by the stage `labels`"});
  Field ventricles;
  if (params.what == Zone::third_ventricle) {
    constexpr float far = -1e3f;
    ventricles = fit(signed_distance_mm(*shapes.ventricles, progress), lattice, far);
  }
  Field zone(lattice);
  parallel_for(0, zone.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = static_cast<int>(from); k < to; ++k) {
      progress.part(0.8, 1).report(double(k) / zone.size[2]);
      for (int j = 0; j < zone.size[1]; ++j)
        for (int i = 0; i < zone.size[0]; ++i) {
          const Vec3 t = place.to_template(zone.to_world_mm({double(i), double(j), double(k)}));
          const std::size_t n = zone.index(i, j, k);
          const double side_mm = std::abs(t.x) * place.scale.x, in_mm = wall.voxels[n];
          double mm = -1e3;
          switch (params.what) {
            case Zone::dura:
              break;
            case Zone::midline:
              mm = std::min(params.half_width_mm - side_mm, in_mm);
              break;
            case Zone::sagittal_sinus:
              mm = sinus_mm(t, side_mm, in_mm, params);
              break;
            case Zone::third_ventricle: {
              const double third = place_mm(Place::third, t);
              const double lateral = std::min(place_mm(Place::lateral_left, t), place_mm(Place::lateral_right, t));
              mm = std::min({double(ventricles.voxels[n]), lateral - third, third_reach_mm - third});
              break;
            }
            case Zone::brainstem:
              mm = std::min({-stem_mm(t), in_mm, 1e3});
              break;
          }
          // No voxel is 0, and the field is the same far away: it holds a surface and nothing else.
          zone.voxels[n] = static_cast<float>(std::clamp(mm == 0 ? -1e-6 : mm, -10.0, 10.0));
        }
    }
  });
  return trimmed(zone, report, name_of(params.what));
}

}  // namespace trephine
