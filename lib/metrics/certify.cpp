// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/certify.h"

#include <array>
#include <atomic>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "surface/bvh.h"

namespace trephine::metrics {
namespace {

constexpr std::int64_t grain = 256;
constexpr std::size_t max_pieces = 200000;
constexpr double rounding = 1e-9;

struct Corner {
  Vec3 at;  ///< about the target's origin
  std::uint32_t nearest = 0;
  double distance = 0;
};

class OneWay {
 public:
  OneWay(const surface::TriMesh& from, const surface::TriMesh& to, const CertifyParams& params,
         const Progress& progress)
      : from_(from),
        to_(to),
        tolerance_(params.certify_tolerance_mm),
        max_pieces_(params.certify_max_pieces_count),
        bvh_(to, progress),
        shift_(from.origin_mm - to.origin_mm) {}

  CertifiedDistance run(const Progress& progress) {
    find_corners(progress.part(0, 0.4));
    for (const Corner& c : corners_) floor_ = std::max(floor_, c.distance);
    const auto count = static_cast<std::int64_t>(from_.triangles.size());
    std::vector<CertifiedDistance> of_piece(std::size_t((count + grain - 1) / grain));
    parallel_for(0, count, grain, [&](std::int64_t begin, std::int64_t end) {
      progress.check();
      CertifiedDistance& best = of_piece[std::size_t(begin / grain)];
      for (std::int64_t t = begin; t < end; ++t) {
        const auto& v = from_.triangles[t];
        pieces_ += std::int64_t(examine(corners_[v[0]], corners_[v[1]], corners_[v[2]], best));
        if (pieces_ > max_pieces_)  // what all triangles need does not depend on the threads
          throw Error(ExitCode::internal, "", "certify",
                      "the surface would be cut into more than " + grouped_text(max_pieces_) + " pieces; set " +
                          Setting{"certify_tolerance_mm", to_text(std::min(10.0, 10 * tolerance_))} + " or " +
                          Setting{"certify_max_pieces_count",
                                  std::to_string(std::min<std::int64_t>(1000000000000, 10 * max_pieces_))});
      }
    });
    CertifiedDistance all;
    for (const CertifiedDistance& d : of_piece) {
      if (d.lower_mm > all.lower_mm) {
        all.lower_mm = d.lower_mm;
        all.at_mm = d.at_mm;
      }
      all.upper_mm = std::max(all.upper_mm, d.upper_mm);
    }
    const surface::Bounds a = surface::bounds_of(from_), b = surface::bounds_of(to_);
    all.upper_mm += rounding * std::max(norm(a.max_mm - a.min_mm), norm(b.max_mm - b.min_mm));
    all.at_mm = all.at_mm + to_.origin_mm;
    progress.report(1);
    return all;
  }

 private:
  Corner corner(Vec3 at, std::uint32_t seed) const {
    Corner c;
    c.at = at;
    c.distance = std::sqrt(bvh_.nearest(at, seed, 0, c.nearest).squared_mm2);
    return c;
  }

  void find_corners(const Progress& progress) {
    corners_.resize(from_.points_mm.size());
    parallel_for(0, static_cast<std::int64_t>(corners_.size()), 2048, [&](std::int64_t begin, std::int64_t end) {
      progress.check();
      std::uint32_t seed = 0;
      for (std::int64_t p = begin; p < end; ++p) {
        corners_[p] = corner(from_.points_mm[p] + shift_, seed);
        seed = corners_[p].nearest;
      }
    });
    // Points that no triangle uses do not count.
    std::vector<char> used(corners_.size(), 0);
    for (const auto& t : from_.triangles)
      for (const std::uint32_t v : t) used[v] = 1;
    for (std::size_t p = 0; p < used.size(); ++p)
      if (!used[p]) corners_[p].distance = 0;
  }

  double to_triangle(Vec3 p, std::uint32_t t) const {
    const auto& v = to_.triangles[t];
    return std::sqrt(
        surface::nearest_on_triangle(p, to_.points_mm[v[0]], to_.points_mm[v[1]], to_.points_mm[v[2]]).squared_mm2);
  }

  /// Of the triangles that are nearest to one of the corners, takes the one whose largest distance to a corner is
  /// least, and returns that distance.
  double bound(const std::array<Corner, 3>& c) const {
    double best = 1e300;
    for (int i = 0; i < 3; ++i) {
      if (i > 0 && (c[i].nearest == c[0].nearest || (i == 2 && c[2].nearest == c[1].nearest))) continue;
      double most = 0;
      for (int k = 0; k < 3; ++k) most = std::max(most, k == i ? c[k].distance : to_triangle(c[k].at, c[i].nearest));
      best = std::min(best, most);
    }
    return best;
  }

  /// Returns how many pieces it took.
  std::size_t examine(const Corner& a, const Corner& b, const Corner& c, CertifiedDistance& best) const {
    std::vector<std::array<Corner, 3>> stack{{a, b, c}};
    for (const Corner& k : stack[0]) take(k, best);
    std::size_t pieces = 1;
    for (; !stack.empty(); ++pieces) {
      const std::array<Corner, 3> t = stack.back();
      stack.pop_back();
      const double upper = bound(t);
      // Uses only what this run of triangles found, so that the result does not depend on the number of threads.
      if (upper <= std::max(floor_, best.lower_mm) + tolerance_ || pieces > max_pieces) {
        best.upper_mm = std::max(best.upper_mm, upper);
        continue;
      }
      std::array<Corner, 3> middle;
      for (int k = 0; k < 3; ++k) {
        middle[k] = corner((t[k].at + t[(k + 1) % 3].at) / 2, t[k].nearest);
        take(middle[k], best);
      }
      stack.push_back({t[0], middle[0], middle[2]});
      stack.push_back({middle[0], t[1], middle[1]});
      stack.push_back({middle[2], middle[1], t[2]});
      stack.push_back({middle[0], middle[1], middle[2]});
    }
    return pieces - 1;
  }

  static void take(const Corner& c, CertifiedDistance& best) {
    if (c.distance <= best.lower_mm) return;
    best.lower_mm = c.distance;
    best.at_mm = c.at;
  }

  const surface::TriMesh &from_, &to_;
  double tolerance_, floor_ = 0;
  std::int64_t max_pieces_;
  surface::Bvh bvh_;
  Vec3 shift_;
  std::vector<Corner> corners_;
  std::atomic<std::int64_t> pieces_{0};
};

}  // namespace

CertifiedDeviation certify_deviation(const surface::TriMesh& mesh, const surface::TriMesh& reference,
                                     const CertifyParams& params, const Progress& progress) {
  const auto check = [](const char* which, const surface::TriMesh& m) {
    with_field(which, [&] {
      surface::check_mesh(m);
      if (m.triangles.empty()) throw Error(ExitCode::bad_input, "", "", "has no triangles");
    });
  };
  check("surface", mesh);
  check("reference", reference);
  CertifiedDeviation d;
  d.mesh_to_reference = OneWay(mesh, reference, params, progress).run(progress.part(0, 0.5));
  d.reference_to_mesh = OneWay(reference, mesh, params, progress).run(progress.part(0.5, 1));
  return d;
}

CertifiedFigures::CertifiedFigures(const CertifiedDeviation& d)
    : max_mm(d.upper_mm()),
      lower_mm(d.lower_mm()),
      to_reference_mm(d.mesh_to_reference.upper_mm),
      from_reference_mm(d.reference_to_mesh.upper_mm) {
  const bool first = d.mesh_to_reference.lower_mm >= d.reference_to_mesh.lower_mm;
  const Vec3 at = first ? d.mesh_to_reference.at_mm : d.reference_to_mesh.at_mm;
  at_x_mm = at.x, at_y_mm = at.y, at_z_mm = at.z;
}

}  // namespace trephine::metrics
