// SPDX-License-Identifier: GPL-3.0-or-later
#include "print/print_head.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/refusal.h"
#include "meshing/validity.h"
#include "print/head_parts.h"
#include "print/measure_parts.h"
#include "surface/bounds.h"

namespace trephine::print {
namespace {

constexpr double plate_gap_mm = 10;
constexpr double least_gap_ratio = 0.5;  ///< of the gap that was asked for; nearer parts would not come apart
constexpr double touch_voxels = 0.3;     ///< what sticks out of a part by less is its roughness
constexpr int most_tries = 3;
constexpr double again_mm = 0.1;                     ///< of a ball's radius, above half of the least wall
constexpr double sealed_mm = 3, least_gel_ml = 100;  ///< of gel: narrower openings than twice this hold it
constexpr double notable_ml = 0.5;

/// A part's surface, and its smallest wall.
struct Surface {
  surface::TriMesh mesh;
  double wall_mm = 0;
};
// Where a wall is thinner than it may be, which the raster does to few places, the solid is opened again.
Surface surface_with_walls(PartSolid part, const PrintParams& params, double from_z_mm, const Progress& progress) {
  return with_field(part.name, [&] {
    Surface made;
    double crumbs_ml = 0;
    for (int tries = 0;; ++tries) {
      made.mesh = surface_of(part.solid, progress);
      meshing::require_valid(made.mesh);
      made.wall_mm =
          smallest_wall_mm(made.mesh, {4 * params.wall_mm, touch_voxels * params.voxel_mm, from_z_mm}, progress);
      if (made.wall_mm >= params.wall_mm && crumbs_ml <= most_crumbs_ml) return made;
      if (tries == most_tries || crumbs_ml > most_crumbs_ml)
        throw refusal("", fmt::format("its smallest wall is {:.2f} mm, below {:.2f} mm", made.wall_mm, params.wall_mm),
                      {"set a finer raster (`voxel_mm`) or another least wall (`wall_mm`)"});
      part.solid = with_walls(part.solid, params.wall_mm / 2 + again_mm, params.wall_mm);
      crumbs_ml += keep_largest(part.solid);
    }
  });
}

PrintPart described(const PrintedPart& part, double wall_mm) {
  PrintPart of;
  of.name = part.name;
  of.colour_rgb = part.colour_rgb;
  of.triangles_count = std::int64_t(part.mesh.triangles.size());
  of.volume_ml = surface::volume_mm3(part.mesh) / 1000;
  of.smallest_wall_mm = wall_mm;
  const surface::Bounds box = surface::bounds_of(part.mesh);
  for (int a = 0; a < 3; ++a) of.size_mm[std::size_t(a)] = box.max_mm[a] - box.min_mm[a];
  return of;
}

void measure_gaps(Printed& made, const PrintParams& params, const Progress& progress) {
  PrintRecord& record = made.record;
  const double far = 4 * params.gap_mm;
  record.smallest_gap_mm = far;
  for (std::size_t a = 0; a < made.parts.size(); ++a)
    for (std::size_t b = a + 1; b < made.parts.size(); ++b) {
      const double gap = smallest_gap_mm(made.parts[a].mesh, made.parts[b].mesh, far, progress);
      if (gap >= far) continue;
      record.gaps.push_back({made.parts[a].name, made.parts[b].name, gap});
      record.smallest_gap_mm = std::min(record.smallest_gap_mm, gap);
      if (gap < least_gap_ratio * params.gap_mm)
        throw refusal(made.parts[a].name,
                      fmt::format("between it and {} the smallest gap is {:.2f} mm, and {:.2f} mm were asked for",
                                  made.parts[b].name, gap, params.gap_mm),
                      {"set a finer raster (`voxel_mm`) or a wider gap (`gap_mm`)"});
    }
}

// What fills the skull above the base, beside the ventricles: what no way leads to from outside through openings of up
// to the width that the inserts leave.
double gel_ml(const HeadPlan& plan, const VentriclesPart* ventricles) {
  const Solid& bone = plan.bone;
  mask::BitMask walls = mask::make_mask(bone, [&](int j, int k, std::uint8_t* row) {
    const bool below = bone.to_world_mm({0, 0, double(k)}).z < 0;
    for (int i = 0; i < bone.size[0]; ++i) row[i] = below || bone.at(i, j, k) > 0;
  });
  const mask::BitMask closed = mask::closed(walls, sealed_mm);
  mask::BitMask open = closed;
  const mask::Components spaces = mask::components(open.invert());
  std::vector<char> inner(spaces.list.size(), 0);
  for (std::size_t c = 0; c < inner.size(); ++c) inner[c] = spaces.list[c].faces == 0;
  mask::BitMask space = mask::largest(mask::components(mask::select(spaces, inner)));
  double ml = double(space.count()) * bone.voxel_volume_mm3() / 1000;
  if (ventricles) ml -= volume_ml(ventricles->part.solid);
  return std::max(0.0, ml);
}

}  // namespace

Printed print_head(const cases::LoadedCase& loaded, const PrintParams& params, const Progress& progress) {
  if (params.voxel_mm > params.wall_mm / 3 + 1e-9)
    throw Error(ExitCode::usage, "", "voxel_mm", "must be at most a third of wall_mm");
  const HeadPlan plan = plan_head(loaded, params, progress.part(0, 0.25));
  const std::vector<InsertPlan> inserts = plan_inserts(plan);
  Printed made;
  PrintRecord& record = made.record;
  record.case_token = loaded.manifest.case_token;
  record.case_to_print = rows_of(plan.frame.to_print);
  record.wall_mm = params.wall_mm;
  record.gap_mm = params.gap_mm;
  record.marks = plan_marks(plan, inserts);
  for (const cases::CaseTarget& t : loaded.manifest.targets) record.targets.push_back({t.name, t.position_mm});
  if (plan.dropped_ml > notable_ml)
    made.warnings.push_back({"bone_left_out",
                             "{left_out_ml:.1f} ml of bone above the cut hang on nothing and are not printed",
                             {{"left_out_ml", plan.dropped_ml}}});

  record.smallest_wall_mm = 1e4;
  const auto add = [&](const PartSolid& part, const Progress& some, double from_z_mm = nowhere_mm) {
    Surface surface = surface_with_walls(part, params, from_z_mm, some);
    made.parts.push_back({part.name, part.colour_rgb, std::move(surface.mesh)});
    record.parts.push_back(described(made.parts.back(), surface.wall_mm));
    record.smallest_wall_mm = std::min(record.smallest_wall_mm, surface.wall_mm);
  };
  add(skull_part(plan, inserts, record.marks, progress.part(0.25, 0.4)), progress.part(0.4, 0.5));
  for (const InsertPlan& insert : inserts) add(insert_part(plan, insert), progress.part(0.5, 0.55));
  std::optional<VentriclesPart> ventricles;
  if (params.ventricles != Ventricles::none) {
    ventricles = ventricles_part(plan, progress.part(0.55, 0.7));
    add(ventricles->part, progress.part(0.7, 0.75));
    if (ventricles->bridges > 0)
      made.warnings.push_back({"ventricles_bridged",
                               "{bridges_count:.0f} rods join pieces of the ventricles that do not hang together",
                               {{"bridges_count", double(ventricles->bridges)}}});
  }
  const VentriclesPart* stem = ventricles ? &*ventricles : nullptr;
  const BaseParts base = base_parts(plan, stem, loaded.manifest.case_token, progress.part(0.75, 0.85));
  add(base.base, progress.part(0.85, 0.9), base.letters_to_mm + 0.1);  // letters are no walls
  add(base.lid, progress.part(0.9, 0.92));
  record.gel_ml = gel_ml(plan, stem);
  if (record.gel_ml < least_gel_ml)
    made.warnings.push_back({"leaks",
                             "the printed skull has openings wider than {opening_mm:.0f} mm, through which gel would "
                             "run out: how much it holds is not known, and they must be closed from outside",
                             {{"opening_mm", 2 * sealed_mm}}});
  measure_gaps(made, params, progress);
  progress.report(1);
  return made;
}

std::vector<PrintedPart> on_a_plate(std::vector<PrintedPart> parts) {
  double x = 0;
  for (PrintedPart& part : parts) {
    const surface::Bounds box = surface::bounds_of(part.mesh);
    const auto whole = [](double v) { return std::ceil(v); };  // mm, so that the points keep their raster
    part.mesh.origin_mm += Vec3{whole(x - box.min_mm.x), whole(-box.min_mm.y), -box.min_mm.z};
    x += whole(box.max_mm.x - box.min_mm.x) + plate_gap_mm;
  }
  return parts;
}

}  // namespace trephine::print
