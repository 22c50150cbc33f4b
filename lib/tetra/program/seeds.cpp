// SPDX-License-Identifier: GPL-3.0-or-later
#include "tetra/program/seeds.h"

#include <cmath>
#include <map>

#include "surface/vertex_normals.h"
#include "tetra/program/regions.h"

namespace trephine::tetra {
namespace {

constexpr double beside_mm = 0.01;  // where the regions beside a corner are asked for
constexpr std::size_t enough = 4;   // of one piece

// Points no two of which are nearer than a distance that is given with each question.
class Spread {
 public:
  explicit Spread(double cell_mm) : cell_mm_(cell_mm) {}
  bool has_room(Vec3 p, double mm) const {
    const std::array<long, 3> c = cell(p);
    const long reach = long(std::ceil(mm / cell_mm_));
    for (long i = c[0] - reach; i <= c[0] + reach; ++i)
      for (long j = c[1] - reach; j <= c[1] + reach; ++j)
        for (long k = c[2] - reach; k <= c[2] + reach; ++k)
          if (const auto found = cells_.find({i, j, k}); found != cells_.end())
            for (const Vec3 q : found->second)
              if (norm(q - p) < mm) return false;
    return true;
  }
  void add(Vec3 p) { cells_[cell(p)].push_back(p); }

 private:
  std::array<long, 3> cell(Vec3 p) const {
    return {std::lround(p.x / cell_mm_), std::lround(p.y / cell_mm_), std::lround(p.z / cell_mm_)};
  }
  double cell_mm_;
  std::map<std::array<long, 3>, std::vector<Vec3>> cells_;
};

}  // namespace

std::vector<Seed> seeds_of(const std::vector<surface::TriMesh>& surfaces, const Regions& regions, double size_mm) {
  std::vector<Seed> seeds;
  Spread spread(size_mm);
  for (const surface::TriMesh& s : surfaces) {
    std::vector<int> piece_of_triangle;
    const int pieces = surface::label_components(s, piece_of_triangle);
    std::vector<int> piece_of(s.points_mm.size(), -1);
    for (std::size_t t = 0; t < s.triangles.size(); ++t)
      for (const std::uint32_t c : s.triangles[t]) piece_of[c] = piece_of_triangle[t];
    const std::vector<Vec3> normals = surface::vertex_normals(s);
    std::vector<std::size_t> found(std::size_t(pieces), 0);
    for (double mm = 2 * size_mm; mm > 0.2 * size_mm; mm /= 2)
      for (std::size_t n = 0; n < piece_of.size(); ++n) {
        if (piece_of[n] < 0) continue;
        std::size_t& count = found[std::size_t(piece_of[n])];
        if ((mm < 2 * size_mm && count >= enough) || !spread.has_room(s.world_mm(n), mm)) continue;
        if (!(norm(normals[n]) > 0)) continue;
        const Vec3 p = s.world_mm(n), out = normalized(normals[n]) * beside_mm;
        const std::array<int, 2> between{regions.at(p - out), regions.at(p + out)};
        if (between[0] == between[1]) continue;
        seeds.push_back({p, between});
        spread.add(p);
        ++count;
      }
  }
  return seeds;
}

}  // namespace trephine::tetra
