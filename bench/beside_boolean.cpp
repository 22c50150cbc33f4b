// SPDX-License-Identifier: GPL-3.0-or-later
#include "beside_boolean.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>

#include "../tests/report_of.h"
#include "cases/load_case.h"
#include "contact/contact.h"
#include "meshing/contour.h"
#include "surface/bounds.h"
#include "voxel/cut.h"
#include "voxel/shape_field.h"

namespace trephine {
namespace {

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

// About an axis through `middle`, which points out of the head; heights of the tip along it.
struct Hole {
  Vec3 middle, axis, u, v;
  double radius_mm = 0, lowest_mm = 1e9;
  double across(Vec3 p) const {
    const Vec3 d = p - middle;
    return norm(d - axis * dot(d, axis));
  }
};

Hole hole_of(const haptics::Recording& r, double ball_radius_mm) {
  Hole h;
  double low[2] = {1e9, 1e9}, high[2] = {-1e9, -1e9};
  for (const haptics::ServoFrame& f : r.frames) {
    if (!(f.buttons & haptics::Drilling::pedal) || f.faults != 0) continue;
    if (h.axis == Vec3{}) {
      h.axis = normalized(vec(f.axis));
      const Mat3 frame = haptics::frame_along(h.axis);
      h.u = frame.column[0];
      h.v = frame.column[1];
      h.middle = vec(f.tip_mm);
    }
    const Vec3 d = vec(f.tip_mm) - h.middle;
    const double at[2] = {dot(d, h.u), dot(d, h.v)};
    for (int a = 0; a < 2; ++a) {
      low[a] = std::min(low[a], at[a]);
      high[a] = std::max(high[a], at[a]);
    }
    h.lowest_mm = std::min(h.lowest_mm, dot(d, h.axis));
  }
  h.middle += h.u * (0.5 * (low[0] + high[0])) + h.v * (0.5 * (low[1] + high[1]));
  h.radius_mm = 0.25 * (high[0] - low[0] + high[1] - low[1]) + ball_radius_mm;
  return h;
}

// A voxel's part of the bone, with the ramp taken as shape_volume_mm3 does.
double bone_in(const voxel::HapticDecoder& d, const voxel::HapticVolume& v, std::uint64_t bits, int i, int j, int k) {
  double o = 0;
  for (const voxel::HapticShape& s : v.shapes)
    if (bits >> s.number & 1) o += d.occupancy(s.number, i, j, k);
  return std::clamp(0.5 + 2 * (o - 0.5), 0.0, 1.0);
}

// mm3 that only the first, only the second and both have taken from `before`, within `reach` of the axis.
void compare(const char* what, const voxel::HapticVolume& before, const voxel::HapticVolume& one,
             const voxel::HapticVolume& other, std::uint64_t bits, const Hole& hole, double reach_mm) {
  const voxel::HapticDecoder was(before), a(one), b(other);
  const grid::Lattice& l = before.voxels;
  double only_one = 0, only_other = 0, both = 0;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        if (before.voxels.at(i, j, k) == one.voxels.at(i, j, k) &&
            before.voxels.at(i, j, k) == other.voxels.at(i, j, k))
          continue;
        if (hole.across(l.to_world_mm({double(i), double(j), double(k)})) > reach_mm) continue;
        const double whole = bone_in(was, before, bits, i, j, k);
        const double by_one = whole - bone_in(a, one, bits, i, j, k),
                     by_other = whole - bone_in(b, other, bits, i, j, k);
        only_one += std::max(0.0, by_one - by_other);
        only_other += std::max(0.0, by_other - by_one);
        both += std::min(by_one, by_other);
      }
  const double mm3 = l.voxel_volume_mm3();
  std::printf("  %s: both take %.0f mm3, the hand alone %.1f, the boolean alone %.1f\n", what, both * mm3,
              only_one * mm3, only_other * mm3);
}

}  // namespace

std::uint64_t bits_of(const drill::DrillShapes& shapes) {
  std::uint64_t bits = 0;
  for (std::size_t n = 1; n < shapes.size(); ++n)
    if (shapes[n].cuttable && shapes[n].energy_j_per_mm3 > 0) bits |= std::uint64_t{1} << n;
  return bits;
}

void beside_boolean(const voxel::HapticVolume& before, const voxel::HapticVolume& after,
                    const drill::DrillShapes& shapes, const haptics::Recording& recording, double ball_radius_mm,
                    const std::string& drilled_case) {
  const std::uint64_t bits = bits_of(shapes);
  const Hole h = hole_of(recording, ball_radius_mm);
  voxel::HapticVolume cut = voxel::copy_without_hardness(before), was = voxel::copy_without_hardness(before),
                      is = voxel::copy_without_hardness(after);
  // The cylinder from the lowest place of the tip outwards.
  constexpr double out_mm = 30;
  const auto solid = [&](Vec3 p) {
    const double along = dot(p - h.middle, h.axis);
    return std::max({h.across(p) - h.radius_mm, h.lowest_mm - along, along - h.lowest_mm - out_mm});
  };
  surface::Bounds bounds;
  for (const double along : {h.lowest_mm, h.lowest_mm + out_mm}) {
    const Vec3 r{h.radius_mm, h.radius_mm, h.radius_mm}, p = h.middle + h.axis * along;
    surface::include(bounds, surface::Bounds{p - r, p + r});
  }
  std::vector<int> numbers;
  for (const voxel::HapticShape& s : before.shapes)
    if (bits >> s.number & 1) numbers.push_back(s.number);
  Report report;
  value_of(report, voxel::cut_volume(cut, solid, bounds, numbers));
  std::printf("  hole of %.2f mm; walls beside the cylinder's, where the burr is at its widest:\n", 2 * h.radius_mm);
  // Along rays from the axis: where the wall of bone is.
  contact::ContactVolume felt(is), uncut(was);
  const contact::TouchableFaces faces{bits, 0};
  std::vector<double> off;
  int standing = 0;
  const double side = felt.smallest_side_mm();
  for (double along = h.lowest_mm + ball_radius_mm; along < h.lowest_mm + out_mm; along += 0.5 * side)
    for (int n = 0; n < 144; ++n) {
      const double a = 2 * M_PI * n / 144;
      const Vec3 way = h.u * std::cos(a) + h.v * std::sin(a), p = h.middle + h.axis * along;
      const auto bone = [&](double r) { return (bits >> uncut.shape_at(p + way * r) & 1) != 0; };
      if (!bone(h.radius_mm) || !bone(h.radius_mm - side) || !bone(h.radius_mm + side)) continue;
      if (bits >> felt.shape_at(p) & 1) {
        ++standing;
        continue;
      }
      const contact::Contact c = felt.intersect(p, p + way * (h.radius_mm + 3), faces);
      off.push_back(c.hit ? norm(c.point_mm - p) - h.radius_mm : 3);
    }
  if (!off.empty()) {
    std::sort(off.begin(), off.end());
    double mean = 0, squares = 0;
    for (const double d : off) {
      mean += d / double(off.size());
      squares += d * d / double(off.size());
    }
    const auto at = [&](double share) { return off[std::size_t(share * double(off.size() - 1))]; };
    std::printf(
        "    %zu places: mean %+.3f mm, RMS %.3f, p1 %+.3f, p99 %+.3f, from %+.3f to %+.3f; %d where bone stands\n",
        off.size(), mean, std::sqrt(squares), at(0.01), at(0.99), off.front(), off.back(), standing);
  }
  compare("beside a cylinder of that width, to the tip's depth", was, is, cut, bits, h, h.radius_mm + 3);
  if (drilled_case.empty()) return;
  const cases::LoadedCase other = cases::load_case(drilled_case);
  if (other.manifest.burr_holes.empty()) throw std::runtime_error(drilled_case + " has no burr hole");
  const cases::CaseBurrHole& b = other.manifest.burr_holes.front();
  const double angle = std::acos(std::clamp(-dot(b.direction, h.axis), -1.0, 1.0)) * 180 / M_PI;
  // Both axes where they meet the outer table.
  const auto table = [&](Vec3 p, Vec3 out) { return uncut.intersect(p + out * 30, p - out * 30, faces).point_mm; };
  std::printf("  the case's hole: axis turned by %.1f degrees, %.1f mm away on the outer table\n", angle,
              norm(table(h.middle, h.axis) - table(b.position_mm, -b.direction)));
  if (!(other.haptic.voxels.size == before.voxels.size && other.haptic.voxels.origin_mm == before.voxels.origin_mm)) {
    std::printf("    its volume has another lattice\n");
    return;
  }
  compare("beside the case's own hole", was, is, other.haptic, bits, h, 40);
}

void beside_contour(const voxel::HapticVolume& after, int number, const drill::LiveSurface& followed) {
  const drill::LiveSurface fresh(after, number);
  std::size_t differ = 0;
  for (std::size_t n = 0; n < fresh.layout().count(); ++n) {
    const drill::BrickMesh &a = fresh.brick(n), &b = followed.brick(n);
    differ += a.indices != b.indices || a.vertices.size() != b.vertices.size() ||
              (!a.vertices.empty() &&
               std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(drill::LiveVertex)) != 0);
  }
  // Vertices of both lie on edges between voxel centres: by the edge.
  const grid::Lattice& l = after.voxels;
  std::map<std::array<int, 4>, Vec3> of_edge;
  const auto edge_of = [&](Vec3 world) {
    const Vec3 i = l.to_index(world);
    int axis = 0;
    double most = -1;
    for (int a = 0; a < 3; ++a)
      if (const double d = std::abs(i[a] - std::round(i[a])); d > most) most = d, axis = a;
    std::array<int, 4> e{int(std::lround(i.x)), int(std::lround(i.y)), int(std::lround(i.z)), axis};
    e[std::size_t(axis)] = int(std::floor(i[axis]));
    return e;
  };
  meshing::ContourParams params;
  params.min_component_mm3 = 0;
  params.keep_cavities = true;
  Report report;
  const surface::TriMesh contoured = value_of(report, meshing::contour(voxel::shape_field(after, number), params));
  for (std::size_t n = 0; n < contoured.points_mm.size(); ++n) {
    const Vec3 i = l.to_index(contoured.world_mm(n));
    int between = 0;  // an ambiguous cell's own points lie on no edge
    for (int a = 0; a < 3; ++a) between += std::abs(i[a] - std::round(i[a])) > 1e-4;
    if (between < 2) of_edge[edge_of(contoured.world_mm(n))] = contoured.world_mm(n);
  }
  std::size_t vertices = 0, alone = 0;
  std::vector<double> off;
  for (std::size_t n = 0; n < followed.layout().count(); ++n)
    for (const drill::LiveVertex& p : followed.brick(n).vertices) {
      const Vec3 at{p.position_mm[0], p.position_mm[1], p.position_mm[2]};
      const Vec3 world = l.origin_mm + l.direction * at;
      const Vec3 index = l.to_index(world);
      bool border = false;  // which a contour caps half a voxel outside
      for (int a = 0; a < 3; ++a) border = border || index[a] < 0 || index[a] > l.size[std::size_t(a)] - 1;
      if (border) continue;
      ++vertices;
      const auto found = of_edge.find(edge_of(world));
      if (found == of_edge.end())
        ++alone;
      else
        off.push_back(norm(found->second - world));
    }
  std::sort(off.begin(), off.end());
  std::printf(
      "  shape %d: %zu bricks differ from a surface made anew; %zu vertices, %.2f %% on an edge that a contour does "
      "not "
      "cross, the others off by p99 %.5f, at most %.5f mm\n",
      number, differ, vertices, 100.0 * double(alone) / double(std::max<std::size_t>(1, vertices)),
      off.empty() ? 0 : off[off.size() * 99 / 100], off.empty() ? 0 : off.back());
}

}  // namespace trephine
