// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/drilled_hole.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace trephine::lessons {
namespace {

constexpr std::size_t min_voxels = 4;  // of a hole: fewer are a scratch
constexpr double beside_mm = 2;        // of the axis: where the tables are looked for

using Voxel = std::array<int, 3>;

// A box of flags.
struct Flags {
  explicit Flags(const grid::Box& b) : box(b) {
    std::size_t n = 1;
    for (std::size_t a = 0; a < 3; ++a) n *= std::size_t(std::max(0, b.end[a] - b.begin[a]));
    on.assign(n, 0);
  }
  bool holds(const Voxel& v) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (v[a] < box.begin[a] || v[a] >= box.end[a]) return false;
    return true;
  }
  std::uint8_t& at(const Voxel& v) {
    const std::size_t nx = std::size_t(box.end[0] - box.begin[0]), ny = std::size_t(box.end[1] - box.begin[1]);
    return on[(std::size_t(v[2] - box.begin[2]) * ny + std::size_t(v[1] - box.begin[1])) * nx +
              std::size_t(v[0] - box.begin[0])];
  }
  grid::Box box;
  std::vector<std::uint8_t> on;
};

template <class F>
void for_each(const grid::Box& box, F f) {
  for (int k = box.begin[2]; k < box.end[2]; ++k)
    for (int j = box.begin[1]; j < box.end[1]; ++j)
      for (int i = box.begin[0]; i < box.end[0]; ++i) f(Voxel{i, j, k});
}

Vec3 centre_of(const grid::Lattice& l, const Voxel& v) {
  return l.to_world_mm({double(v[0]), double(v[1]), double(v[2])});
}

// Groups of removed voxels that touch.
std::vector<std::vector<Voxel>> groups_of(Flags& removed) {
  std::vector<std::vector<Voxel>> all;
  for_each(removed.box, [&](const Voxel& seed) {
    if (removed.at(seed) != 1) return;
    std::vector<Voxel> group{seed};
    removed.at(seed) = 2;
    for (std::size_t n = 0; n < group.size(); ++n)
      for (int d = 0; d < 27; ++d) {
        const Voxel v{group[n][0] + d % 3 - 1, group[n][1] + d / 3 % 3 - 1, group[n][2] + d / 9 - 1};
        if (!removed.holds(v) || removed.at(v) != 1) continue;
        removed.at(v) = 2;
        group.push_back(v);
      }
    if (group.size() >= min_voxels) all.push_back(std::move(group));
  });
  return all;
}

// Whether the ball's middle gets from above `top` to below `bottom` along the hole's axis.
bool passes(const voxel::HapticVolume& now, const voxel::HapticDecoder& decoder, const std::vector<Voxel>& hole,
            const BoneHole& found, const HoleSearch& search) {
  const grid::Lattice& l = now.voxels;
  const double radius = 0.5 * search.ball_mm;
  const double side = std::min({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z});
  const int margin = int(std::ceil(2 * radius / side)) + 2;
  double wide = 0;
  grid::Box box;
  box.begin = box.end = hole[0];
  for (const Voxel& v : hole) {
    const Vec3 d = centre_of(l, v) - found.outer_mm;
    wide = std::max(wide, norm(d - found.out * dot(d, found.out)));
    for (std::size_t a = 0; a < 3; ++a) {
      box.begin[a] = std::min(box.begin[a], v[a]);
      box.end[a] = std::max(box.end[a], v[a] + 1);
    }
  }
  box = grid::grown(box, margin, l);
  const double top = 0.5 * side, bottom = dot(found.inner_mm - found.outer_mm, found.out) - 0.5 * side;
  Flags shut(box);
  std::vector<Voxel> near;
  const int reach = int(std::ceil(radius / side));
  for (int d = 0; d < (2 * reach + 1) * (2 * reach + 1) * (2 * reach + 1); ++d) {
    const int n = 2 * reach + 1;
    const Voxel v{d % n - reach, d / n % n - reach, d / (n * n) - reach};
    const Vec3 mm{v[0] * l.spacing_mm.x, v[1] * l.spacing_mm.y, v[2] * l.spacing_mm.z};
    if (norm(mm) < radius) near.push_back(v);
  }
  for_each(grid::grown(box, reach, l), [&](const Voxel& v) {
    if (decoder.occupancy(search.bone, v[0], v[1], v[2]) < 0.5) return;
    for (const Voxel& d : near)
      if (const Voxel to{v[0] + d[0], v[1] + d[1], v[2] + d[2]}; shut.holds(to)) shut.at(to) = 1;
  });
  std::vector<Voxel> open;
  for_each(box, [&](const Voxel& v) {
    const Vec3 d = centre_of(l, v) - found.outer_mm;
    const double height = dot(d, found.out);
    if (norm(d - found.out * height) > wide + side) shut.at(v) = 1;
    if (shut.at(v) == 0 && height > top) {
      shut.at(v) = 2;
      open.push_back(v);
    }
  });
  constexpr int ways[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (std::size_t n = 0; n < open.size(); ++n) {
    if (dot(centre_of(l, open[n]) - found.outer_mm, found.out) < bottom) return true;
    for (const auto& way : ways) {
      const Voxel v{open[n][0] + way[0], open[n][1] + way[1], open[n][2] + way[2]};
      if (!shut.holds(v) || shut.at(v) != 0) continue;
      shut.at(v) = 2;
      open.push_back(v);
    }
  }
  return false;
}

// The groups of voxels that were bone and are no more.
std::vector<std::vector<Voxel>> removed_groups(const voxel::HapticVolume& before, const voxel::HapticVolume& now,
                                               const HoleSearch& search) {
  const grid::Lattice& l = before.voxels;
  const voxel::HapticDecoder was(before), is(now);
  Flags removed(search.box.empty() ? grid::whole_box(l) : grid::grown(search.box, 0, l));
  for_each(removed.box, [&](const Voxel& v) {
    const std::size_t at = l.index(v[0], v[1], v[2]);
    if (before.voxels.voxels[at] == __atomic_load_n(&now.voxels.voxels[at], __ATOMIC_RELAXED)) return;
    if (was.occupancy(search.bone, v[0], v[1], v[2]) >= 0.5 && is.occupancy(search.bone, v[0], v[1], v[2]) < 0.5)
      removed.at(v) = 1;
  });
  return groups_of(removed);
}

BoneHole measured(const std::vector<Voxel>& group, const voxel::HapticVolume& now, const HoleSearch& search) {
  const grid::Lattice& l = now.voxels;
  BoneHole hole;
  hole.drilled = true;
  hole.removed_mm3 = double(group.size()) * l.voxel_volume_mm3();
  Vec3 middle;
  for (const Voxel& v : group) middle += centre_of(l, v) / double(group.size());
  hole.out = normalized(search.out);
  double nearest = 1e300;
  for (const HoleSite& site : search.sites)
    if (const double far = norm(site.at_mm - middle); far < nearest) {
      nearest = far;
      hole.out = normalized(site.out);
      hole.begin_s = site.begin_s;
    }
  double top = -1e300, bottom = 1e300;
  for (const Voxel& v : group) {
    const Vec3 d = centre_of(l, v) - middle;
    const double height = dot(d, hole.out), across = norm(d - hole.out * height);
    hole.radius_mm = std::max(hole.radius_mm, across);
    if (across > beside_mm) continue;
    top = std::max(top, height);
    bottom = std::min(bottom, height);
  }
  if (top < bottom) top = bottom = 0;
  // Voxel centres lie half a voxel inside the tables.
  const double half = 0.5 * std::cbrt(l.voxel_volume_mm3());
  hole.outer_mm = middle + hole.out * (top + half);
  hole.inner_mm = middle + hole.out * (bottom - half);
  hole.through = passes(now, voxel::HapticDecoder(now), group, hole, search);
  return hole;
}

}  // namespace

std::optional<BoneHole> find_drilled_hole(const voxel::HapticVolume& before, const voxel::HapticVolume& now,
                                          const HoleSearch& search) {
  const auto groups = removed_groups(before, now, search);
  const std::vector<Voxel>* chosen = nullptr;
  double best = 0;
  for (const auto& group : groups) {
    double worth = double(group.size());
    if (search.near_mm) {
      double nearest = 1e300;
      for (const Voxel& v : group) nearest = std::min(nearest, norm(centre_of(before.voxels, v) - *search.near_mm));
      worth = 1 / (1 + nearest);
    }
    if (worth > best) {
      best = worth;
      chosen = &group;
    }
  }
  if (!chosen) return {};
  return measured(*chosen, now, search);
}

std::vector<BoneHole> find_drilled_holes(const voxel::HapticVolume& before, const voxel::HapticVolume& now,
                                         const HoleSearch& search) {
  std::vector<BoneHole> all;
  for (const auto& group : removed_groups(before, now, search)) all.push_back(measured(group, now, search));
  std::stable_sort(all.begin(), all.end(),
                   [](const BoneHole& a, const BoneHole& b) { return a.removed_mm3 > b.removed_mm3; });
  return all;
}

std::optional<BoneHole> find_case_hole(const cases::CaseManifest& manifest, const std::optional<Vec3>& near_mm) {
  const cases::CaseBurrHole* best = nullptr;
  for (const cases::CaseBurrHole& b : manifest.burr_holes)
    if (!best || (near_mm && norm(b.position_mm - *near_mm) < norm(best->position_mm - *near_mm))) best = &b;
  if (!best) return {};
  BoneHole hole;
  hole.out = -best->direction;
  hole.outer_mm = best->position_mm;
  double thick = 0;
  for (const auto& [name, value] : best->figures)
    if (const double* mm = std::get_if<double>(&value); mm && name == "bone_thickness_mm") thick = *mm;
  hole.inner_mm = hole.outer_mm - hole.out * thick;
  hole.through = true;
  return hole;
}

}  // namespace trephine::lessons
