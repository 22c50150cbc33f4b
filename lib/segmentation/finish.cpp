// SPDX-License-Identifier: GPL-3.0-or-later
#include "segmentation/finish.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/refusal.h"
#include "mask/filters.h"
#include "mask/surface_field.h"
#include "segmentation/scan_edge.h"

namespace trephine::segmentation {
namespace {

/// A fault of the shape that names no parameter is attributed to the thresholds.
template <class F>
auto of_thresholds(F&& f) {
  try {
    return f();
  } catch (Error& e) {
    if (e.field().empty()) e.in_field("lower_hu, upper_hu");
    throw;
  }
}

/// The field's surface moved by grow_mm, on a lattice with room for it.
grid::Field moved(const grid::Field& field, const grid::Lattice& volume, double grow_mm, const Progress& progress) {
  grid::Box box = grid::place_in(field, volume);
  for (int axis = 0; axis < 3; ++axis) {
    const int margin = int(std::ceil(std::max(0.0, grow_mm) / volume.spacing_mm[axis])) + 1;
    box.begin[axis] = std::max(0, box.begin[axis] - margin);
    box.end[axis] = std::min(volume.size[axis], box.end[axis] + margin);
  }
  float lowest = -1;
  for (float f : field.voxels) lowest = std::min(lowest, f);
  grid::Field out = mask::signed_distance_mm(grid::fit(field, grid::cropped(volume, box), lowest), progress);
  for (float& d : out.voxels) {
    d += float(grow_mm);
    if (std::abs(d) < 1e-4f) d = d > 0 ? 1e-4f : -1e-4f;
  }
  return out;
}

using Finished = Outcome<grid::Field, FinishResult>;

/// Checks whether the surface is that of a body. Where that is not asked for, a shape that mostly is not is told of.
void check_scan_edge(const mask::HuView& hu, const FinishParams& params, Finished& made) {
  constexpr double told = 0.1, told_unasked = 0.5;
  const bool asked = params.max_scan_edge_ratio < 1;
  const double ratio = scan_edge_ratio(hu, made.value);
  if (asked || ratio > told_unasked) made.result.scan_edge_ratio = ratio;
  if (ratio > params.max_scan_edge_ratio)
    throw refusal(
        "max_scan_edge_ratio",
        fmt::format("{:.0f} % of its rim are the edge of the scanned field, at most {:.0f} %", 100 * ratio,
                    100 * params.max_scan_edge_ratio),
        {Message("leave it out of the scene, take a scan with a wider field of view, or, where a surface that "
                 "ends at the field will do, raise `max_scan_edge_ratio`: ") +
         Setting{"max_scan_edge_ratio", fmt::format("{:.2f}", std::min(1.0, std::ceil(100 * ratio + 1) / 100))}});
  if (ratio > (asked ? told : told_unasked))
    made.warnings.push_back(
        {"rim_is_scan_edge",
         "{rim_percent:.0f} % of its rim in the slices are the edge of the scanned field, and no surface of a body",
         {{"rim_percent", 100 * ratio}}});
}

/// The field cropped to its positive part and two voxels more.
grid::Field trimmed(grid::Field field) {
  const grid::Box box = grid::grown(mask::positive(field, field).bounds(), 2, field);
  const grid::Lattice target = grid::cropped(field, box);
  if (target == field) return field;
  return grid::crop(field, box);
}

}  // namespace

void check_thresholds(double lower_hu, double upper_hu) {
  if (lower_hu > upper_hu)
    throw Error(ExitCode::usage, "", "lower_hu", fmt::format("{} is above upper_hu, {}", lower_hu, upper_hu));
}

Outcome<grid::Field, FinishResult> found_and_finished(const grid::HuVolume& volume, const FinishParams& params,
                                                      const std::function<grid::Field(const mask::HuView&)>& find,
                                                      const Progress& progress) {
  const grid::Lattice& lattice = grid::lattice_of(volume);
  const mask::HuView hu(volume);
  mask::check_finite(volume);
  Finished made;
  grid::Field& field = made.value = of_thresholds([&] { return find(hu); });
  if (params.grow_mm != 0) {
    field = moved(field, lattice, params.grow_mm, progress);
    made.result.grown_mm = params.grow_mm;
  }
  made.result.size = of_thresholds([&] { return mask::check_mask(mask::positive(field, field), lattice.count()); });
  field = trimmed(std::move(field));
  check_scan_edge(hu, params, made);
  progress.report(1);
  return made;
}

}  // namespace trephine::segmentation
