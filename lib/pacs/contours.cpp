// SPDX-License-Identifier: GPL-3.0-or-later
#include "pacs/contours.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

namespace trephine::pacs {
namespace {

// A point of a contour is where the plane crosses an edge: edges are known by their two corners, the lower one first.
using Edge = std::uint64_t;
Edge edge_of(std::uint32_t a, std::uint32_t b) { return a < b ? Edge{a} << 32 | b : Edge{b} << 32 | a; }

struct Nearest {
  double squared = 1e300;
  std::size_t at = 0, of = 0;  ///< points of the outer and of the inner line
};

Nearest nearest_points(const PlaneLine& outer, const PlaneLine& inner) {
  Nearest best;
  for (std::size_t i = 0; i < outer.size(); ++i)
    for (std::size_t j = 0; j < inner.size(); ++j) {
      const double x = outer[i].x - inner[j].x, y = outer[i].y - inner[j].y;
      if (x * x + y * y < best.squared) best = {x * x + y * y, i, j};
    }
  return best;
}

void cut_out(PlaneLine& outer, const PlaneLine& inner) {
  const Nearest n = nearest_points(outer, inner);
  PlaneLine walk;
  for (std::size_t j = 0; j <= inner.size(); ++j) walk.push_back(inner[(n.of + j) % inner.size()]);
  walk.push_back(outer[n.at]);
  outer.insert(outer.begin() + std::ptrdiff_t(n.at) + 1, walk.begin(), walk.end());
}

}  // namespace

std::vector<PlaneLine> contours_on(const surface::TriMesh& mesh, const SliceSet& slices, std::size_t slice) {
  const Vec3 origin = slices.origins_mm[slice] - mesh.origin_mm, n = slices.normal();
  std::vector<double> height(mesh.points_mm.size());
  for (std::size_t i = 0; i < height.size(); ++i) height[i] = dot(mesh.points_mm[i] - origin, n);
  std::unordered_map<Edge, Edge> next;
  std::vector<Edge> starts;
  for (const auto& t : mesh.triangles) {
    const bool up[3] = {height[t[0]] >= 0, height[t[1]] >= 0, height[t[2]] >= 0};
    if (up[0] == up[1] && up[1] == up[2]) continue;
    // The line enters by the edge that falls and leaves by the one that rises: so it has the inside on its right.
    Edge rises = 0, falls = 0;
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      if (!up[k] && up[l]) rises = edge_of(t[k], t[l]);
      if (up[k] && !up[l]) falls = edge_of(t[k], t[l]);
    }
    next.emplace(falls, rises);
    starts.push_back(falls);
  }
  const auto point_of = [&](Edge e) {
    const auto a = std::uint32_t(e >> 32), b = std::uint32_t(e & 0xffffffffu);
    const double part = height[a] / (height[a] - height[b]);
    const Vec3 p = mesh.points_mm[a] + (mesh.points_mm[b] - mesh.points_mm[a]) * part - origin;
    return PlanePoint{dot(p, slices.u), dot(p, slices.v)};
  };
  std::sort(starts.begin(), starts.end());
  std::vector<PlaneLine> lines;
  for (const Edge start : starts) {
    PlaneLine line;
    for (auto at = next.find(start); at != next.end();) {
      line.push_back(point_of(at->first));
      const Edge to = at->second;
      next.erase(at);
      at = next.find(to);
    }
    if (line.size() >= 3) lines.push_back(std::move(line));
  }
  return lines;
}

double signed_area_mm2(const PlaneLine& line) {
  double twice = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const PlanePoint &a = line[i], &b = line[(i + 1) % line.size()];
    twice += a.x * b.y - b.x * a.y;
  }
  return twice / 2;
}

bool is_within(const PlaneLine& line, PlanePoint p) {
  bool odd = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const PlanePoint &a = line[i], &b = line[(i + 1) % line.size()];
    if ((a.y > p.y) == (b.y > p.y)) continue;
    odd ^= p.x < a.x + (p.y - a.y) * (b.x - a.x) / (b.y - a.y);
  }
  return odd;
}

std::vector<PlaneLine> with_keyholes(std::vector<PlaneLine> lines) {
  // From the largest to the smallest, so that what holds a line comes before it.
  std::vector<double> area(lines.size());
  std::vector<std::size_t> order(lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    area[i] = std::abs(signed_area_mm2(lines[i]));
    order[i] = i;
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return area[a] > area[b]; });
  struct Outer {
    std::size_t line;
    PlaneLine cut;
  };
  std::vector<Outer> outers;
  std::vector<std::size_t> depth(lines.size(), 0);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const PlaneLine& line = lines[order[i]];
    std::size_t holder = order.size();
    for (std::size_t k = 0; k < i; ++k)
      if (is_within(lines[order[k]], line.front())) {
        ++depth[order[i]];
        holder = order[k];
      }
    if (depth[order[i]] % 2 == 0) {
      outers.push_back({order[i], line});
      continue;
    }
    for (Outer& o : outers)
      if (o.line == holder) cut_out(o.cut, line);
  }
  std::vector<PlaneLine> out;
  for (Outer& o : outers) out.push_back(std::move(o.cut));
  return out;
}

std::vector<std::uint8_t> filled(const std::vector<PlaneLine>& lines, int columns, int rows, double dx_mm,
                                 double dy_mm) {
  std::vector<std::uint8_t> out(std::size_t(columns) * std::size_t(rows), 0);
  for (const PlaneLine& line : lines)
    for (std::size_t n = 0; n < line.size(); ++n) {
      PlanePoint a = line[n], b = line[(n + 1) % line.size()];
      // An edge and the same one walked back are one, so that both turn the same pixels.
      if (a.y > b.y || (a.y == b.y && a.x > b.x)) std::swap(a, b);
      const int from = int(std::clamp(std::ceil(a.y / dy_mm), 0.0, double(rows))),
                to = int(std::clamp(std::ceil(b.y / dy_mm), 0.0, double(rows)));
      for (int j = from; j < to; ++j) {
        const double x = a.x + (j * dy_mm - a.y) * (b.x - a.x) / (b.y - a.y);
        const int i = int(std::clamp(std::ceil(x / dx_mm), 0.0, double(columns)));
        if (i < columns) out[std::size_t(j) * std::size_t(columns) + std::size_t(i)] ^= 1;
      }
    }
  for (int j = 0; j < rows; ++j) {
    std::uint8_t* row = out.data() + std::size_t(j) * std::size_t(columns);
    for (int i = 1; i < columns; ++i) row[i] ^= row[i - 1];
  }
  return out;
}

}  // namespace trephine::pacs
