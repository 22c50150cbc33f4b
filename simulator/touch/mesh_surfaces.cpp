// SPDX-License-Identifier: GPL-3.0-or-later
#include "touch/mesh_surfaces.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace trephine::touch {
namespace {

constexpr double alike_mm = 1e-6;  // of two facets that are as near, one is looked at
constexpr int measured = 6;        // what a facet counts whose distance was measured
constexpr double beside_mm = 1.5;  // of the tool, beside the part of it that is near, for which facets are gathered
constexpr double slack_mm = 0.2;   // how far a line moves until its facets are gathered again

// All parts in one mesh, about the first one's origin.
surface::TriMesh together(const std::vector<MeshSurfaces::Part>& parts) {
  surface::TriMesh all;
  if (parts.empty() || parts.size() > std::size_t(max_meshes))
    throw Error(ExitCode::internal, "", "meshes", "must be 1 to " + std::to_string(max_meshes));
  all.origin_mm = parts.front().mesh.origin_mm;
  for (const MeshSurfaces::Part& part : parts) {
    const auto first = std::uint32_t(all.points_mm.size());
    for (std::size_t n = 0; n < part.mesh.points_mm.size(); ++n)
      all.points_mm.push_back(part.mesh.points_mm[n] + (part.mesh.origin_mm - all.origin_mm));
    for (std::size_t n = 0; n < part.mesh.triangles.size(); ++n) {
      const auto& t = part.mesh.triangles[n];
      all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  }
  return all;
}

// A lower bound of the squared distance between a line and a box.
double squared_from_box(const surface::FloatBox& box, Vec3 from, Vec3 to, double share) {
  double apart = 0, half = 0;
  double middle[3];
  for (int a = 0; a < 3; ++a) {
    const double d =
        std::max({double(box.min[a]) - std::max(from[a], to[a]), std::min(from[a], to[a]) - box.max[a], 0.0});
    apart += d * d;
    const double side = 0.5 * (double(box.max[a]) - box.min[a]);
    half += side * side;
    middle[a] = 0.5 * (double(box.max[a]) + box.min[a]);
  }
  if (!(share > 0)) return apart;
  const Vec3 way = to - from, off = Vec3{middle[0], middle[1], middle[2]} - from;
  const Vec3 aside = off - way * std::clamp(dot(off, way) * share, 0.0, 1.0);
  const double beyond = std::sqrt(dot(aside, aside)) - std::sqrt(half);
  return beyond > 0 ? std::max(apart, beyond * beyond * (1 - 1e-12)) : apart;
}

}  // namespace

NearFacets::NearFacets() : facet(most), least_mm(most), certain_mm(most), unsorted(most), unsorted_mm(most) {}

void NearFacets::sort() {
  std::array<int, steps + 1> at{};
  const float scale = float(steps / (reach_mm + slack_mm));
  const auto step_of = [&](int n) { return std::min(steps - 1, int(unsorted_mm[std::size_t(n)] * scale)); };
  for (int n = 0; n < count; ++n) ++at[std::size_t(step_of(n)) + 1];
  for (std::size_t s = 1; s < at.size(); ++s) at[s] += at[s - 1];
  for (int n = 0; n < count; ++n) {
    const auto to = std::size_t(at[std::size_t(step_of(n))]++);
    facet[to] = unsorted[std::size_t(n)];
    least_mm[to] = certain_mm[to] = unsorted_mm[std::size_t(n)];
  }
}

MeshSurfaces::Line::Line(Vec3 begin, Vec3 end) : from(begin), way(end - begin) {
  if (const double squared = dot(way, way); squared > 0) share = 1 / squared;
}

double MeshSurfaces::Line::from_it(Vec3 place) const {
  const Vec3 off = place - from;
  return norm(off - way * std::clamp(dot(off, way) * share, 0.0, 1.0));
}

MeshSurfaces::MeshSurfaces(const std::vector<Part>& parts, double skin_mm)
    : mesh_(together(parts)),
      far_(mesh_.mesh(), mesh_.tree()),
      cells_(mesh_.tree(), skin_mm),
      origin_mm_(mesh_.mesh().origin_mm),
      skin_mm_(skin_mm) {
  sides_.reserve(triangles());
  shape_.reserve(triangles());
  for (const Part& part : parts) {
    shapes_ |= std::uint64_t{1} << part.shape;
    for (std::size_t n = 0; n < part.mesh.triangles.size(); ++n) {
      const auto t = std::uint32_t(shape_.size());
      shape_.push_back(std::uint8_t(part.shape));
      Sides& sides = sides_.emplace_back();
      for (int side = 0; side < 3; ++side)
        sides[std::size_t(side)] =
            normalized(cross(mesh_.normal(t), mesh_.corner(t, (side + 1) % 3) - mesh_.corner(t, side)));
    }
    if (const surface::Topology topology = surface::topology_of(part.mesh); topology.closed() && topology.manifold())
      solids_.push_back({part.shape, std::make_unique<surface::InsideQuery>(part.mesh)});
  }
  facets_.reserve(triangles());
  for (const std::uint32_t t : mesh_.tree().order()) {
    Facet& f = facets_.emplace_back();
    f.normal = mesh_.normal(t);
    f.level = dot(f.normal, mesh_.corner(t, 0));
    f.middle = (mesh_.corner(t, 0) + mesh_.corner(t, 1) + mesh_.corner(t, 2)) / 3;
    for (int n = 0; n < 3; ++n) f.radius = std::max(f.radius, norm(mesh_.corner(t, n) - f.middle));
    f.shape = shape_[t];
  }
}

// Clips the way to the skin: what lies over the facet, a skin wider on each side, and nearer to its plane than the skin
// on the side where the way begins.
void MeshSurfaces::enter(std::uint32_t t, Vec3 from, Vec3 way, Meeting& first) const {
  const double begins = mesh_.above(t, from), side = begins < 0 ? -1 : 1;
  const double high = side * begins, sinks = -side * dot(mesh_.normal(t), way);
  if (!(sinks > 0) || !(high - sinks < std::min(high, skin_mm_))) return;
  double in = high > skin_mm_ ? (high - skin_mm_) / sinks : 0, out = std::min(1.0, high / sinks);
  for (int n = 0; n < 3; ++n) {
    const Vec3 inward = sides_[t][std::size_t(n)];
    const double within = dot(inward, from - mesh_.corner(t, n)) + skin_mm_, change = dot(inward, way);
    if (change > 0)
      in = std::max(in, -within / change);
    else if (change < 0)
      out = std::min(out, -within / change);
    else if (within < 0)
      return;
    if (!(in < first.along && in <= out)) return;
  }
  const Vec3 at = from + way * in;
  first.shape = shape_[t];
  first.along = in;
  first.normal = mesh_.normal(t) * side;
  first.front = side > 0;
  first.distance_mm = std::max(0.0, side * mesh_.above(t, at));
  first.point_mm = at - first.normal * first.distance_mm;
}

MeshSurfaces::Meeting MeshSurfaces::first_met(Vec3 from_mm, Vec3 to_mm, std::uint64_t shapes) const {
  Meeting first;
  const Vec3 from = from_mm - origin_mm_, way = to_mm - from_mm;
  if ((shapes & shapes_) == 0 || !may_meet(from_mm, to_mm)) return first;
  double until = 2;
  const auto look = [&](std::uint32_t t) {
    if (!(shapes >> shape_[t] & 1)) return;
    enter(t, from, way, first);
    if (first.shape != 0) until = first.along;
  };
  if (!cells_.known()) {
    mesh_.look_along(from, from + way, skin_mm_, until, look);
  } else {  // by pieces, of which each ends within reach of the cell where it begins
    const int pieces = std::max(1, int(std::ceil(norm(way) / cells_.reach_mm())));
    for (int piece = 0; piece < pieces && until > double(piece) / pieces; ++piece) {
      const Vec3 begin = from + way * (double(piece) / pieces), end = from + way * (double(piece + 1) / pieces);
      if (!may_meet(begin + origin_mm_, end + origin_mm_)) continue;
      const surface::FloatBox box = FeltMesh::box_around(begin, end, skin_mm_);
      cells_.for_each(begin, [&](std::uint32_t n) {
        if (mesh_.tree().box(n).meets(box)) look(mesh_.tree().order()[n]);
      });
    }
  }
  if (first.shape != 0) first.point_mm += origin_mm_;
  return first;
}

// A lower bound of a facet's distance: by the ball around it and, where the line is on one side of it, by its plane.
double MeshSurfaces::least_mm(const Facet& f, const Line& line) const {
  const double least = std::max(0.0, line.from_it(f.middle) - f.radius);
  const double begins = dot(f.normal, line.from) - f.level, ends = begins + dot(f.normal, line.way);
  return begins * ends > 0 ? std::max(least, std::min(std::abs(begins), std::abs(ends))) : least;
}

// Returns the distance where it was measured, else 0.
double MeshSurfaces::take(std::size_t facet, const Line& line, std::uint64_t shapes, Place& best) const {
  const Facet& f = facets_[facet];
  if (!(shapes >> f.shape & 1) || least_mm(f, line) >= best.mm - alike_mm) return 0;
  const std::uint32_t t = mesh_.tree().order()[facet];
  const LineToTriangle at =
      nearest_to_line(line.from, line.end(), mesh_.corner(t, 0), mesh_.corner(t, 1), mesh_.corner(t, 2));
  const double mm = std::sqrt(at.squared_mm2);
  if (at.squared_mm2 < best.at.squared_mm2) best = {at, mm, t, true};
  return mm;
}

MeshSurfaces::Place MeshSurfaces::search(const Line& line, double reach_mm, std::uint64_t shapes) const {
  Place best;
  best.mm = reach_mm;
  best.at.squared_mm2 = reach_mm * reach_mm;
  const Vec3 end = line.end();
  mesh_.tree().visit_nearest(
      best.at.squared_mm2,
      [&](const surface::FloatBox& box) { return squared_from_box(box, line.from, end, line.share); },
      [&](std::size_t leaf) {
        const std::size_t last = std::min(surface::TriangleTree::width * (leaf + 1), facets_.size());
        for (std::size_t n = surface::TriangleTree::width * leaf; n < last; ++n) take(n, line, shapes, best);
      });
  return best;
}

// All facets that the line may come within `reach_mm` of, until it has moved by the slack.
void MeshSurfaces::gather(const Line& line, double reach_mm, NearFacets& near) const {
  near.known = true;
  near.from_mm = line.from;
  near.to_mm = line.end();
  near.reach_mm = reach_mm;
  near.count = near.last = 0;
  const double reach = reach_mm + slack_mm, limit = reach * reach;
  mesh_.tree().visit_nearest(
      limit, [&](const surface::FloatBox& box) { return squared_from_box(box, line.from, near.to_mm, line.share); },
      [&](std::size_t leaf) {
        const std::size_t last = std::min(surface::TriangleTree::width * (leaf + 1), facets_.size());
        for (std::size_t n = surface::TriangleTree::width * leaf; n < last; ++n) {
          ++near.looked_at;
          const double least = least_mm(facets_[n], line);
          if (!(least < reach)) continue;
          if (near.count < NearFacets::most) {
            near.unsorted[std::size_t(near.count)] = std::uint32_t(n);
            near.unsorted_mm[std::size_t(near.count)] = float(least);
          }
          ++near.count;
        }
      });
  if (near.count <= NearFacets::most) near.sort();
}

// The part of the line outside of which it is known to be farther from everything than that; none where all of it is.
std::optional<MeshSurfaces::Line> MeshSurfaces::near_part(Vec3 from_mm, Vec3 to_mm, double reach_mm) const {
  Line line(from_mm - origin_mm_, to_mm - origin_mm_);
  const double length = norm(line.way);
  const int places = 1 + int(length);
  const double between = 0.5 * length / places;
  int first = places, last = -1;
  for (int n = 0; n < places; ++n) {
    if (far_.least_mm(line.from + line.way * ((n + 0.5) / places)) > reach_mm + between) continue;
    first = std::min(first, n);
    last = n;
  }
  if (last < 0) return {};
  if (first == 0 && last == places - 1) return line;
  const double begin = double(first) / places, end = double(last + 1) / places;
  Line part(line.from + line.way * begin, line.from + line.way * end);
  part.begin = begin;
  part.part = end - begin;
  return part;
}

MeshSurfaces::Meeting MeshSurfaces::meeting(const Line& line, const Place& place) const {
  Meeting near;
  if (!place.found) return near;
  const Vec3 middle = line.from + line.way * place.at.along, normal = mesh_.normal(place.triangle);
  near.shape = shape_[place.triangle];
  near.along = line.begin + line.part * place.at.along;
  near.distance_mm = place.mm;
  near.point_mm = place.at.point_mm + origin_mm_;
  near.front = mesh_.above(place.triangle, middle) >= 0;
  near.normal = place.mm > 1e-9 ? (middle - place.at.point_mm) / place.mm : near.front ? normal : -normal;
  return near;
}

MeshSurfaces::Meeting MeshSurfaces::nearest(Vec3 from_mm, Vec3 to_mm, double reach_mm, std::uint64_t shapes) const {
  if ((shapes & shapes_) == 0) return {};
  const std::optional<Line> line = near_part(from_mm, to_mm, reach_mm);
  return line ? meeting(*line, search(*line, reach_mm, shapes)) : Meeting{};
}

MeshSurfaces::Meeting MeshSurfaces::nearest(Vec3 from_mm, Vec3 to_mm, double reach_mm, double most_mm,
                                            std::uint64_t shapes, NearFacets& near) const {
  if ((shapes & shapes_) == 0) return {};
  const std::optional<Line> part = near_part(from_mm, to_mm, reach_mm);
  if (!part) return {};
  const Line& line = *part;
  const auto moved_of = [&] {  // how far the line lies from the one that was gathered for
    const Line then(near.from_mm, near.to_mm);
    return std::max(then.from_it(line.from), then.from_it(line.end()));
  };
  double moved = moved_of();
  if (!near.known || most_mm > near.reach_mm || moved > slack_mm) {
    // A little more of the tool than this part, which may slide along itself.
    const Vec3 way = normalized(to_mm - from_mm);
    const double before = std::min(beside_mm, norm(line.from + origin_mm_ - from_mm));
    const double after = std::min(beside_mm, norm(line.end() + origin_mm_ - to_mm));
    gather(Line(line.from - way * before, line.end() + way * after), most_mm, near);
    moved = moved_of();
  }
  if (near.count > NearFacets::most) return meeting(line, search(line, reach_mm, shapes));
  Place best;
  best.mm = reach_mm;
  best.at.squared_mm2 = reach_mm * reach_mm;
  const double rounding = 1e-5 + moved;
  const auto look_at = [&](int n) {
    const double before = best.mm;
    const double mm = take(near.facet[std::size_t(n)], line, shapes, best);
    near.looked_at += mm > 0 ? measured : 1;
    near.certain_mm[std::size_t(n)] = std::max(near.certain_mm[std::size_t(n)], float(mm - rounding));
    if (best.mm < before) near.last = n;
  };
  // The one that was nearest first: most of the others are then too far without being measured.
  const int first = near.last;
  if (near.count > 0) look_at(first);
  const double step = (near.reach_mm + slack_mm) / NearFacets::steps;
  for (int n = 0; n < near.count; ++n) {
    const double within = best.mm + rounding;
    if (!(double(near.least_mm[std::size_t(n)]) < within + step)) break;  // so are all that follow
    if (n != first && double(near.certain_mm[std::size_t(n)]) < within) look_at(n);
  }
  return meeting(line, best);
}

bool MeshSurfaces::inside(Vec3 place_mm, std::uint64_t shapes) const {
  for (const Solid& s : solids_)
    if ((shapes >> s.shape & 1) && s.query->inside(place_mm)) return true;
  return false;
}

}  // namespace trephine::touch
