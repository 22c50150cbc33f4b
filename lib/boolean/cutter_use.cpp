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

Warnings warnings_of(const Cutter& cutter, const Warnings& of_one) {
  Warnings all;
  for (Warning w : of_one) {
    w.form.insert(0, "{cutter}: ");
    w.values.emplace_back("cutter", cutter.name);
    all.push_back(std::move(w));
  }
  return all;
}

std::optional<Warning> thin_cutter(const Cutter& c, Vec3 spacing_mm) {
  double least_mm = 0;
  switch (c.kind) {
    case Cutter::Kind::mesh:
      return {};
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
  if (!(least_mm < voxel_mm)) return {};
  return Warning{
      "thin_cutter",
      "{cutter}: its radius, {radius_mm} mm, is less than a voxel, {voxel_mm} mm: the voxels cannot hold it, "
      "more may be removed",
      {{"cutter", c.name.empty() ? "cutter" : c.name},
       {"radius_mm", to_text(ParameterValue(least_mm))},
       {"voxel_mm", to_text(ParameterValue(voxel_mm))}}};
}

}  // namespace trephine::boolean
