// SPDX-License-Identifier: GPL-3.0-or-later
#include "place/third_ventricle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "mask/filters.h"

namespace trephine::place {
namespace {

constexpr double third_wide_mm = 9;  ///< fluid that goes on beyond this from the midline is a lateral ventricle's,
constexpr double third_near_mm = 3;  ///< and so is what does not come as near to it as this
constexpr double third_cut_mm = 1;   ///< its border to them is smoothed by this
constexpr double most_shift_mm = 12, shift_step_mm = 0.5, clearly_more = 2, least_share = 1.0 / 3;
constexpr double most_lateral = 0.25;

/// How much of the template's third ventricle is fluid when the template is moved to the left by so much, of 1.
class Overlap {
 public:
  Overlap(const grid::Field& fluid_mm, const HeadPlace& place) : fluid_mm_(fluid_mm), place_(place) {
    // The template's third ventricle lies within these bounds, and is sampled every millimetre.
    for (double x = -8; x <= 8; ++x)
      for (double y = -40; y <= 40; ++y)
        for (double z = 0; z <= 70; ++z)
          if (place_mm(Place::third, {x, y, z}) < 0) third_.push_back({x, y, z});
  }
  /// `lateral` counts alone what lies in the lateral ventricles of the template where it is.
  double at(double shift_mm, bool lateral = false) const {
    std::size_t wet = 0;
    for (Vec3 t : third_) {
      t.x += shift_mm / place_.scale.x;
      if (lateral && std::min(place_mm(Place::lateral_left, t), place_mm(Place::lateral_right, t)) > 0) continue;
      const Vec3 i = fluid_mm_.to_index(place_.to_lps(t));
      const int x = int(std::lround(i.x)), y = int(std::lround(i.y)), z = int(std::lround(i.z));
      wet += fluid_mm_.contains(x, y, z) && fluid_mm_.at(x, y, z) > 0;
    }
    return double(wet) / double(std::max<std::size_t>(1, third_.size()));
  }

 private:
  const grid::Field& fluid_mm_;
  const HeadPlace& place_;
  std::vector<Vec3> third_;
};

}  // namespace

double third_shift_mm(const grid::Field& fluid_mm, const HeadPlace& place) {
  const Overlap overlap(fluid_mm, place);
  const double here = overlap.at(0);
  double most = here, shift_mm = 0;
  for (double mm = shift_step_mm; mm <= most_shift_mm; mm += shift_step_mm)  // of equals, the nearest
    for (const double to : {mm, -mm})
      if (const double share = overlap.at(to); share > most) most = share, shift_mm = to;
  if (most < clearly_more * here || most < least_share) return 0;
  // Fluid at both sides is that of wide lateral ventricles, and so is what lies where they lie.
  if (most < clearly_more * overlap.at(-shift_mm) || overlap.at(shift_mm, true) > most_lateral * most) return 0;
  return shift_mm;
}

void cut_off_lateral(grid::Field& fluid_mm, const HeadPlace& place, const Progress& progress) {
  const Vec3 sideways = normalized(place.axes.column[0]);
  const double step_mm = 0.5 * std::min({fluid_mm.spacing_mm.x, fluid_mm.spacing_mm.y, fluid_mm.spacing_mm.z});
  const auto side_mm = [&](Vec3 p) { return std::abs(place.to_template(p).x) * place.scale.x; };
  const auto is_fluid = [&](Vec3 p) {
    const Vec3 at = fluid_mm.to_index(p);
    const int i = int(std::lround(at.x)), j = int(std::lround(at.y)), k = int(std::lround(at.z));
    return fluid_mm.contains(i, j, k) && fluid_mm.at(i, j, k) > 0;
  };
  grid::Field narrow(grid::Lattice(fluid_mm), 1.0f);
  parallel_for(0, narrow.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < narrow.size[1]; ++j)
        for (int i = 0; i < narrow.size[0]; ++i) {
          if (!(fluid_mm.at(i, j, k) > 0)) continue;
          const Vec3 p = narrow.to_world_mm({double(i), double(j), double(k)});
          double least_mm = third_wide_mm, most_mm = 0;
          for (const double way : {step_mm, -step_mm})
            for (Vec3 q = p; is_fluid(q) && most_mm <= third_wide_mm; q = q + sideways * way) {
              least_mm = std::min(least_mm, side_mm(q));
              most_mm = std::max(most_mm, side_mm(q));
            }
          if (most_mm > third_wide_mm || least_mm > third_near_mm) narrow.at(i, j, k) = -1;
        }
  });
  mask::gaussian(narrow, third_cut_mm);
  for (std::size_t n = 0; n < narrow.voxels.size(); ++n)
    fluid_mm.voxels[n] = std::min(fluid_mm.voxels[n], static_cast<float>(2 * third_cut_mm) * narrow.voxels[n]);
}

}  // namespace trephine::place
