// SPDX-License-Identifier: GPL-3.0-or-later
#include "itk/registration.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>

#include "base/error.h"
#include "base/parallel.h"
#include "base/rank.h"
#include "grid/resample.h"
#include "itk/itk_child.h"
#include "itk/registration_message.h"

namespace trephine::itk {
namespace {

constexpr double smallest_extent_mm = 32;
constexpr std::array<double, 2> coarse_mm{8, 4};

struct Window {
  double low = 0, high = 1;
};

grid::Grid<float> floats_of(const grid::HuVolume& volume, const std::string& which) {
  return std::visit(
      [&](const auto& grid) {
        grid::Grid<float> out(static_cast<const grid::Lattice&>(grid));
        for (std::size_t i = 0; i < grid.voxels.size(); ++i) {
          out.voxels[i] = static_cast<float>(grid.voxels[i]);
          if (!std::isfinite(out.voxels[i]))
            throw Error(ExitCode::bad_input, "", which, "holds a voxel that is not finite");
        }
        return out;
      },
      volume);
}

// The values between which the middle 99 % of the voxels lie. Which voxels: every 7th, so that it is quick.
Window middle_values(const grid::Grid<float>& grid) {
  std::vector<float> some;
  for (std::size_t i = 0; i < grid.voxels.size(); i += 7) some.push_back(grid.voxels[i]);
  const auto at = [&](double share) {
    return double(value_at_rank(some, std::size_t(share * double(some.size() - 1))));
  };
  const double low = at(0.005);
  return {low, at(0.995)};
}

void clamp_to(grid::Grid<float>& grid, const Window& window, const std::string& which) {
  if (!(window.high > window.low))
    throw Error(ExitCode::bad_input, "", which, "has one value only: nothing to register");
  const auto low = static_cast<float>(window.low), scale = static_cast<float>(1 / (window.high - window.low));
  for (float& v : grid.voxels) v = std::clamp((v - low) * scale, 0.0f, 1.0f);
}

void check_extent(const grid::Lattice& lattice, const std::string& which) {
  for (int a = 0; a < 3; ++a)
    if (lattice.size[a] * lattice.spacing_mm[a] < smallest_extent_mm)
      throw Error(ExitCode::bad_input, "", which,
                  fmt::format("is smaller than {} mm along an axis", smallest_extent_mm));
}

grid::Grid<float> at_spacing(const grid::Grid<float>& grid, double mm) {
  return std::get<grid::Grid<float>>(grid::resample(grid::HuVolume(grid), {{mm, mm, mm}}).value);
}

// 8 mm, 4 mm and the finest; each made of the one before it, from fine to coarse.
std::array<grid::Grid<float>, registration_levels> pyramid(grid::Grid<float> grid, double finest_mm,
                                                           const Progress& progress) {
  std::array<grid::Grid<float>, registration_levels> levels;
  levels[2] = at_spacing(grid, finest_mm);
  grid = {};
  for (int l = 1; l >= 0; --l) {
    const auto at = static_cast<std::size_t>(l);
    levels[at] = at_spacing(levels[at + 1], coarse_mm[at]);
    progress.check();
  }
  return levels;
}

grid::Grid<float> looked_at(const grid::Lattice& coarse, const grid::Field* within) {
  grid::Grid<float> look(coarse, 1.0f);
  if (!within) return look;
  for (int k = 0; k < coarse.size[2]; ++k)
    for (int j = 0; j < coarse.size[1]; ++j)
      for (int i = 0; i < coarse.size[0]; ++i) {
        const Vec3 v = within->to_index(coarse.to_world_mm({double(i), double(j), double(k)}));
        const int a = static_cast<int>(std::lround(v.x)), b = static_cast<int>(std::lround(v.y)),
                  c = static_cast<int>(std::lround(v.z));
        look.at(i, j, k) = within->contains(a, b, c) && within->at(a, b, c) > 0 ? 1.0f : 0.0f;
      }
  return look;
}

std::string doubts_of(const RegistrationFound& f, const RegistrationParams& p, double longest_side_mm) {
  constexpr double fine_mm = 2;
  const double largest_inverse_mm = p.largest_inverse_mm * std::max(1.0, longest_side_mm / fine_mm);
  std::string doubts;
  const auto add = [&](bool bad, const std::string& text) {
    if (bad) doubts += (doubts.empty() ? "" : "; ") + text;
  };
  add(!(f.information > 0), "the scans share no information");
  add(!(f.spread_mm <= p.largest_spread_mm),
      fmt::format("other starts end up to {:.2f} mm away, at most {} (largest_spread_mm)", f.spread_mm,
                  p.largest_spread_mm));
  add(!(f.inverse_mm <= largest_inverse_mm),
      fmt::format("the other direction differs by {:.2f} mm, at most {:.4g} (largest_inverse_mm)", f.inverse_mm,
                  largest_inverse_mm));
  add(!(f.overlap_ratio >= p.least_overlap_ratio),
      fmt::format("{:.2f} of the head lies in both scans, at least {} (least_overlap_ratio)", f.overlap_ratio,
                  p.least_overlap_ratio));
  add(!(f.margin_ratio >= p.least_margin_ratio),
      fmt::format(
          "the information is only {:.2f} of itself above that of places 20 mm off, at least {} (least_margin_ratio)",
          f.margin_ratio, p.least_margin_ratio));
  add(p.kind == RegistrationKind::rigid && !(f.scale_ratio <= p.largest_scale_ratio),
      fmt::format(
          "an affine registration would stretch by {:.3f}, at most {} (largest_scale_ratio): another patient, or "
          "voxels of another size than the file says",
          f.scale_ratio, p.largest_scale_ratio));
  return doubts;
}

// Two scans of one head give figures well within the limits, which are wide for scans that are worse than ours.
bool is_unusual(const RegistrationFound& f, const RegistrationParams& p) {
  constexpr double usual_ratio = 0.3;  // of the limit of the stretch: 1.2 %; phantoms of one head give 0.7 % at most
  return p.kind == RegistrationKind::rigid && f.scale_ratio > usual_ratio * p.largest_scale_ratio;
}

RegistrationFigures figures_of_map(const LinearMap& map) {
  RegistrationFigures figures;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) figures.transform.push_back(map.matrix.column[k][i]);
    figures.transform.push_back(map.offset_mm[i]);
  }
  figures.turn_deg = angle_deg(map);
  return figures;
}

}  // namespace

Registration register_scans(const grid::HuVolume& fixed, const grid::HuVolume& moving, const grid::Field* within,
                            const std::optional<LinearMap>& initial, const RegistrationParams& params,
                            const Progress& progress) {
  if (!(params.lower_hu < params.upper_hu)) throw Error(ExitCode::usage, "", "lower_hu", "is not below upper_hu");
  check_extent(grid::lattice_of(fixed), "volume");
  check_extent(grid::lattice_of(moving), "moving");
  const Window hu{params.lower_hu, params.upper_hu};
  const auto levels_of = [&](const grid::HuVolume& volume, bool is_hu, const char* which, const Progress& part) {
    grid::Grid<float> grid = floats_of(volume, which);
    clamp_to(grid, is_hu ? hu : middle_values(grid), which);
    return pyramid(std::move(grid), params.finest_mm, part);
  };
  const auto still = levels_of(fixed, true, "volume", progress.part(0, 0.1));
  const auto mobile = levels_of(moving, params.moving == MovingValues::hu, "moving", progress.part(0.1, 0.2));

  RegistrationTask task;
  task.affine = params.kind == RegistrationKind::affine;
  task.has_initial = initial.has_value();
  if (initial) task.initial = *initial;
  task.bins = params.bins_count;
  task.samples = params.samples_count;
  MessageWriter request = itk_child::request();
  request.value(task);
  std::uint64_t bytes = 0;
  for (int l = 0; l < registration_levels; ++l)
    for (const auto* levels : {&still, &mobile}) {
      const grid::Grid<float>& grid = (*levels)[static_cast<std::size_t>(l)];
      itk_child::put(request, grid);
      bytes += grid.voxels.size() * sizeof(float);
    }
  itk_child::put(request, looked_at(still[0], within));

  ChildLimits limits;
  // The libraries' address space and the stacks of threads, both scans twice, histograms and samples of eight searches.
  limits.memory_bytes = (std::uint64_t{6} << 30) + 4 * bytes;
  limits.cpu_s = 1800;
  limits.wall_s = 3600;
  const ChildResult result = itk_child::run(register_worker_name, request, limits, progress.part(0.2, 1));
  MessageReader in(register_worker_name, result.bytes());
  const auto found = in.value<RegistrationFound>();
  double longest_side_mm = params.finest_mm;
  for (const grid::HuVolume* volume : {&fixed, &moving})
    for (int a = 0; a < 3; ++a) longest_side_mm = std::max(longest_side_mm, grid::lattice_of(*volume).spacing_mm[a]);
  Registration r{found.map, doubts_of(found, params, longest_side_mm), figures_of_map(found.map), {}};
  r.figures.information_nats = found.information;
  r.figures.spread_mm = found.spread_mm;
  r.figures.inverse_mm = found.inverse_mm;
  r.figures.overlap_ratio = found.overlap_ratio;
  r.figures.margin_ratio = found.margin_ratio;
  r.figures.scale_ratio = found.scale_ratio;
  r.figures.another_patient = r.doubts.empty() && is_unusual(found, params);
  if (*r.figures.another_patient)
    r.warnings.push_back({"another_patient",
                          "an affine registration would stretch by {scale_ratio:.3f}, which is within the limit of "
                          "{limit_ratio} and more than two scans of one head usually give: look at the picture of "
                          "`register` whether this is the same patient",
                          {{"scale_ratio", found.scale_ratio}, {"limit_ratio", params.largest_scale_ratio}}});
  return r;
}

Registration given_registration(const grid::HuVolume& fixed, const grid::HuVolume& moving, const LinearMap& map,
                                const RegistrationParams& params) {
  constexpr float body_hu = -300;
  constexpr double stretch = 1e-4;
  for (int a = 0; a < 3 && params.kind == RegistrationKind::rigid; ++a)
    for (int b = 0; b <= a; ++b)
      if (!(std::abs(dot(map.matrix.column[a], map.matrix.column[b]) - (a == b)) <= stretch))
        throw Error(ExitCode::bad_input, params.given, "transform",
                    "stretches or shears, which two scans of one patient do not");
  if (params.kind == RegistrationKind::rigid && !(determinant(map.matrix) > 0))
    throw Error(ExitCode::bad_input, params.given, "transform", "mirrors: left would be right");
  const grid::Lattice& at = grid::lattice_of(moving);
  std::int64_t body = 0, both = 0;
  std::visit(
      [&](const auto& grid) {
        const int step = 2;
        for (int k = 0; k < grid.size[2]; ++k)
          for (int j = 0; j < grid.size[1]; j += step)
            for (int i = 0; i < grid.size[0]; i += step) {
              if (!(grid.at(i, j, k) > body_hu)) continue;
              const Vec3 p = at.to_index(map(grid.to_world_mm({double(i), double(j), double(k)})));
              bool inside = true;
              for (int a = 0; a < 3; ++a) inside = inside && p[a] >= -0.5 && p[a] <= at.size[a] - 0.5;
              ++body;
              both += inside;
            }
      },
      fixed);
  RegistrationFound found;
  found.map = map;
  found.overlap_ratio = body > 0 ? double(both) / double(body) : 0;
  Registration r{map, "", figures_of_map(map), {}};
  if (!(found.overlap_ratio >= params.least_overlap_ratio))
    r.doubts = fmt::format("{:.2f} of the CT's body lies in the second scan, at least {} (least_overlap_ratio)",
                           found.overlap_ratio, params.least_overlap_ratio);
  r.figures.overlap_ratio = found.overlap_ratio;
  return r;
}

grid::HuVolume resample_onto(const grid::HuVolume& moving, const grid::Lattice& fixed, const LinearMap& map,
                             float outside, const Progress& progress) {
  return std::visit(
      [&](const auto& grid) -> grid::HuVolume {
        using T = typename std::decay_t<decltype(grid)>::Sample;
        grid::Grid<T> out(fixed);
        const auto index_of = [&](double i, double j, double k) {
          return grid.to_index(map(fixed.to_world_mm({i, j, k})));
        };
        parallel_for(0, fixed.size[2], 1, [&](std::int64_t from, std::int64_t to) {
          for (int k = static_cast<int>(from); k < to; ++k) {
            progress.check();
            for (int j = 0; j < fixed.size[1]; ++j) {
              const Vec3 first = index_of(0, j, k), step = index_of(1, j, k) - first;
              for (int i = 0; i < fixed.size[0]; ++i) {
                const Vec3 at = first + step * i;
                double value = outside;
                bool reached = true;
                int low[3], high[3];
                double t[3];
                for (int a = 0; a < 3; ++a) {
                  reached = reached && at[a] >= -0.5 && at[a] <= grid.size[a] - 0.5;
                  const double v = std::clamp(at[a], 0.0, grid.size[a] - 1.0);
                  low[a] = static_cast<int>(v);
                  high[a] = std::min(low[a] + 1, grid.size[a] - 1);
                  t[a] = v - low[a];
                }
                if (reached) {
                  const auto line = [&](int y, int z) {
                    return grid.at(low[0], y, z) * (1 - t[0]) + grid.at(high[0], y, z) * t[0];
                  };
                  const auto face = [&](int z) { return line(low[1], z) * (1 - t[1]) + line(high[1], z) * t[1]; };
                  value = face(low[2]) * (1 - t[2]) + face(high[2]) * t[2];
                }
                if constexpr (std::is_integral_v<T>)
                  out.at(i, j, k) = static_cast<T>(std::lround(std::clamp(value, -32768.0, 32767.0)));
                else
                  out.at(i, j, k) = static_cast<T>(value);
              }
            }
          }
        });
        return out;
      },
      moving);
}

}  // namespace trephine::itk
