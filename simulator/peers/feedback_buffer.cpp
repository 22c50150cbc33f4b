// SPDX-License-Identifier: GPL-3.0-or-later
#include "peers/feedback_buffer.h"

#include <algorithm>
#include <cmath>

namespace trephine::peers {
namespace {

// Above the captured facets, against the rounding of their corners.
constexpr double least_lift_mm = 1e-4;

// A place as a window's coordinates hold it, from 0 to 1 over the box, and back.
Vec3 as_captured(Vec3 p, Vec3 low, double side_mm) {
  Vec3 out;
  for (int a = 0; a < 3; ++a) out[a] = low[a] + double(float((p[a] - low[a]) / side_mm)) * side_mm;
  return out;
}

}  // namespace

std::vector<Vec3> clipped_to_cube(const std::array<Vec3, 3>& triangle, Vec3 middle, double half) {
  std::vector<Vec3> polygon(triangle.begin(), triangle.end()), cut;
  for (int a = 0; a < 3; ++a)
    for (const double sign : {-1.0, 1.0}) {
      const auto inside = [&](Vec3 p) { return half - sign * (p[a] - middle[a]); };
      cut.clear();
      for (std::size_t n = 0; n < polygon.size(); ++n) {
        const Vec3 from = polygon[n], to = polygon[(n + 1) % polygon.size()];
        const double here = inside(from), there = inside(to);
        if (here >= 0) cut.push_back(from);
        if ((here >= 0) != (there >= 0)) cut.push_back(from + (to - from) * (here / (here - there)));
      }
      polygon.swap(cut);
      if (polygon.size() < 3) return {};
    }
  return polygon;
}

FeedbackBuffer::FeedbackBuffer(const PeerScene& scene, const PeerParams& params)
    : scene_(scene), params_(params), god_(scene, [&] {
        PeerParams own = params;
        own.god_object_lift_mm = std::max(least_lift_mm, params.god_object_lift_mm);
        return own;
      }()) {
  god_.feel(nullptr);
}

void FeedbackBuffer::reset() {
  god_.feel(nullptr);
  god_.reset();
  mesh_.reset();
}

void FeedbackBuffer::client(Vec3 device_mm) {
  const FeltMesh& all = *scene_.mesh;
  const double half = 0.5 * params_.feedback_side_mm;
  const Vec3 origin = all.mesh().origin_mm, middle = god_.place_mm().value_or(device_mm - origin),
             low = middle - Vec3{half, half, half};
  surface::TriMesh captured;
  captured.origin_mm = origin;
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::size_t corners = 0;
  lost_ = 0;
  for (std::uint32_t t = 0; t < all.mesh().triangles.size(); ++t) {
    const std::array<Vec3, 3> triangle{all.corner(t, 0), all.corner(t, 1), all.corner(t, 2)};
    bool beyond = false;
    for (int a = 0; a < 3; ++a) {
      const auto [least, most] = std::minmax({triangle[0][a], triangle[1][a], triangle[2][a]});
      beyond = beyond || least > middle[a] + half || most < middle[a] - half;
    }
    if (beyond) continue;
    const std::vector<Vec3> polygon = clipped_to_cube(triangle, middle, half);
    if (polygon.empty()) continue;
    if (corners + polygon.size() > std::size_t(params_.feedback_vertices)) {
      lost_ += polygon.size();
      continue;
    }
    corners += polygon.size();
    const auto first = std::uint32_t(points.size());
    for (const Vec3 p : polygon) points.push_back(as_captured(p, low, params_.feedback_side_mm));
    for (std::uint32_t n = 2; n < polygon.size(); ++n) {
      const std::array<Vec3, 3> piece{points[first], points[first + n - 1], points[first + n]};
      if (norm(cross(piece[1] - piece[0], piece[2] - piece[0])) > 0)
        triangles.push_back({first, first + n - 1, first + n});
    }
  }
  god_.feel(nullptr);
  mesh_.reset();
  if (triangles.empty()) return;
  captured.points_mm = std::move(points);
  captured.triangles = std::move(triangles);
  mesh_ = std::make_unique<FeltMesh>(std::move(captured));
  god_.feel(mesh_.get());
}

const haptics::HapticState& FeedbackBuffer::update(const haptics::HapticInput& given) {
  if (mesh_) return god_.update(given);
  god_.move_to(given.tip_mm - scene_.mesh->mesh().origin_mm);
  answer(state_, given, given.tip_mm, false, {}, scene_.shape, params_.spring_n_per_mm);
  return state_;
}

}  // namespace trephine::peers
