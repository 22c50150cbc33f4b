// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/cutter_use.h"

#include <algorithm>
#include <set>

#include "base/error.h"

namespace trephine::boolean {

std::vector<Cutter> with_unique_names(std::vector<Cutter> all) {
  std::set<std::string> known;
  for (Cutter& c : all) {
    const std::string name = c.name.empty() ? "cutter" : c.name;
    c.name = name;
    for (int n = 2; !known.insert(c.name).second; ++n) c.name = name + "_" + std::to_string(n);
  }
  return all;
}

Cutter widened(Cutter cutter, double by_mm) {
  if (by_mm == 0) return cutter;
  if (cutter.kind == Cutter::Kind::mesh)
    throw Error(ExitCode::bad_config, "", "widen_mm", "a cutter that is a mesh cannot be made wider");
  cutter.radius_mm += by_mm;
  cutter.end_radius_mm += by_mm;
  for (double& r : cutter.radii_mm) r += by_mm;
  return cutter;
}

void add_of_cutter(Report& report, const Cutter& cutter, const Report& one) {
  for (const auto& [name, value] : one.figures) report.figures.emplace_back(cutter.name + "." + name, value);
  for (const std::string& w : one.warnings) report.warn(cutter.name + ": " + w);
}

void warn_of_thin(Report& report, const Cutter& c, Vec3 spacing_mm) {
  double least_mm = 0;
  switch (c.kind) {
    case Cutter::Kind::mesh:
      return;
    case Cutter::Kind::ellipsoid:
      least_mm = *std::min_element(c.radii_mm.begin(), c.radii_mm.end());
      break;
    case Cutter::Kind::cone:
      least_mm = std::max(c.radius_mm, c.end_radius_mm);
      break;
    case Cutter::Kind::cylinder:
    case Cutter::Kind::sphere:
      least_mm = c.radius_mm;
      break;
  }
  const double voxel_mm = std::max({spacing_mm.x, spacing_mm.y, spacing_mm.z});
  if (least_mm < voxel_mm)
    report.warn((c.name.empty() ? "cutter" : c.name) + ": its radius, " + to_text(ParameterValue(least_mm)) +
                " mm, is less than a voxel, " + to_text(ParameterValue(voxel_mm)) +
                " mm: the voxels cannot hold it, more may be removed");
}

}  // namespace trephine::boolean
