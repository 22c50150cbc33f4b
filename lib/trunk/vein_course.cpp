// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/refusal.h"
#include "mask/filters.h"
#include "surface/bounds.h"
#include "trunk/vein_parts.h"

namespace trephine::trunk {
namespace {

constexpr double step_mm = 2;
constexpr double bridge_mm = 1;  ///< width of the bridges between a dense vein and bone that are cut
constexpr double dense_least_mm3 = 300, dense_follow = 0.6;
constexpr double film_mm = 1;  ///< of soft tissue between vein and bone or lung
constexpr float air_below_hu = -300;
constexpr double room_mm = 15;       ///< how far the course may leave the first guess
constexpr double move_mm = 2.5;      ///< the step in which a point of the course is moved
constexpr double stray_cost = 0.03;  ///< a mm^2 off the first guess against a mm^2 of missing room
constexpr double bend_cost = 0.4;    ///< the same, between neighbours

const Vec3 back{0, 1, 0}, down{0, 0, -1};

/// The points again, step_mm apart.
std::vector<Vec3> resampled(const std::vector<Vec3>& line) {
  std::vector<Vec3> out{line.front()};
  double left = step_mm;
  for (std::size_t n = 1; n < line.size(); ++n) {
    const Vec3 way = line[n] - line[n - 1];
    const double length = norm(way);
    double at = left;
    for (; at <= length; at += step_mm) out.push_back(line[n - 1] + way * (at / length));
    left = at - length;
  }
  return out;
}

std::vector<Vec3> smoothed(const std::vector<Vec3>& line, int reach) {
  std::vector<Vec3> out = line;
  const int n = int(line.size());
  for (int p = 0; p < n; ++p) {
    const int around = std::min({reach, p, n - 1 - p});
    Vec3 sum;
    for (int q = p - around; q <= p + around; ++q) sum += line[q];
    out[p] = sum / (2 * around + 1);
  }
  return out;
}

/// Behind the sternal end, turning below the shaft outwards; from the sternal end on downwards to the middle.
std::vector<Vec3> first_guess(const ClavicleCourse& c, const VeinParams& p) {
  const std::vector<Vec3> middle = smoothed(c.points_mm, 8);
  const int n = std::max(2, int(std::lround(p.lateral_ratio * double(middle.size()))));
  std::vector<Vec3> line;
  for (int q = 0; q < std::min(n, int(middle.size())); ++q) {
    const double t = double(q) / std::max<std::size_t>(1, middle.size() - 1);
    const int before = std::max(0, q - 5), after = std::min(int(middle.size()) - 1, q + 5);
    const Vec3 along = normalized(middle[after] - middle[before]);
    const double turn = std::min(1.0, 2 * t);
    Vec3 away = back * (1 - 0.5 * turn) + down * (0.3 + 0.6 * turn);
    away = normalized(away - along * dot(away, along));
    line.push_back(middle[q] + away * (c.radius_mm[q] + p.gap_mm + p.radius_mm));
  }
  const double inwards = c.points_mm.back().x > c.points_mm.front().x ? -1 : 1;
  const Vec3 on = normalized(Vec3{inwards * (c.side == BodySide::left ? 0.9 : 0.5), 0.1, -0.7});
  std::vector<Vec3> all;
  for (double s = p.medial_mm; s >= step_mm; s -= step_mm) all.push_back(line.front() + on * s);
  all.insert(all.end(), line.begin(), line.end());
  return smoothed(resampled(all), 4);
}

float sample(const grid::Grid<float>& g, Vec3 index) {
  int low[3];
  double part[3];
  for (int a = 0; a < 3; ++a) {
    const double x = std::clamp(index[a], 0.0, g.size[a] - 1.0);
    low[a] = std::min(int(x), std::max(0, g.size[a] - 2));
    part[a] = x - low[a];
  }
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double w = 1;
    int at[3];
    for (int a = 0; a < 3; ++a) {
      const int high = corner >> a & 1;
      at[a] = std::min(low[a] + high, g.size[a] - 1);
      w *= high ? part[a] : 1 - part[a];
    }
    sum += w * g.at(at[0], at[1], at[2]);
  }
  return float(sum);
}

}  // namespace

double VeinCourse::length_mm() const {
  double sum = 0;
  for (std::size_t n = 1; n < points_mm.size(); ++n) sum += norm(points_mm[n] - points_mm[n - 1]);
  return sum;
}

grid::Box box_around(const VeinCourse& course, const grid::Lattice& l, double margin_mm) {
  surface::Bounds indices;
  for (const Vec3& p : course.points_mm) surface::include(indices, l.to_index(p));
  const auto [least, most] = indices;
  grid::Box box;
  for (int a = 0; a < 3; ++a) {
    const double margin = margin_mm / l.spacing_mm[a];
    box.begin[a] = int(std::clamp(std::floor(least[a] - margin), 0.0, double(l.size[a])));
    box.end[a] = int(std::clamp(std::ceil(most[a] + margin) + 1, 0.0, double(l.size[a])));
  }
  return box;
}

grid::Grid<float> distance_to(const VeinCourse& course, const grid::Lattice& l, double reach_mm) {
  grid::Grid<float> out(l, float(reach_mm));
  for (std::size_t n = 0; n < course.points_mm.size(); ++n) {
    const Vec3 a = course.points_mm[n], b = course.points_mm[std::min(n + 1, course.points_mm.size() - 1)];
    VeinCourse piece;
    piece.points_mm = {a, b};
    const grid::Box box = box_around(piece, l, reach_mm);
    const Vec3 way = b - a;
    const double length2 = std::max(dot(way, way), 1e-12);
    for (int k = box.begin[2]; k < box.end[2]; ++k)
      for (int j = box.begin[1]; j < box.end[1]; ++j)
        for (int i = box.begin[0]; i < box.end[0]; ++i) {
          const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
          const Vec3 nearest = a + way * std::clamp(dot(p - a, way) / length2, 0.0, 1.0);
          float& d = out.at(i, j, k);
          d = std::min(d, float(norm(p - nearest)));
        }
  }
  return out;
}

grid::Grid<float> room_around(const mask::HuView& hu, const grid::Field& bone, const grid::Box& box,
                              const Progress& progress) {
  grid::Grid<float> here = mask::crop(hu, box);
  mask::gaussian(here, 1, progress);
  mask::BitMask obstacles = mask::make_mask(here, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < here.size[0]; ++i) row[i] = here.at(i, j, k) < air_below_hu;
  });
  obstacles |= mask::positive(bone, here);
  grid::Grid<float> room = mask::distance_mm(obstacles, progress);
  const grid::Grid<float> depth = mask::distance_mm(obstacles.invert(), progress);
  for (std::size_t v = 0; v < room.count(); ++v) room.voxels[v] -= depth.voxels[v];
  return room;
}

namespace {

/// The line near `first` with the most room: every point may move across it, by about as much as its neighbours.
std::vector<Vec3> with_room(const std::vector<Vec3>& first, const grid::Grid<float>& room, double wanted_mm) {
  struct Move {
    double a, b;
  };
  std::vector<Move> moves;
  const int reach = int(room_mm / move_mm);
  for (int a = -reach; a <= reach; ++a)
    for (int b = -reach; b <= reach; ++b)
      if (a * a + b * b <= reach * reach) moves.push_back({a * move_mm, b * move_mm});
  const std::size_t m = moves.size(), n = first.size();
  std::vector<std::vector<int>> before(n, std::vector<int>(m, 0));
  std::vector<double> sum(m, 0), last;
  const auto moved = [&](std::size_t p, const Move& move) {
    const Vec3 along = normalized(first[std::min(p + 3, n - 1)] - first[p >= 3 ? p - 3 : 0]);
    const Vec3 u = normalized(back - along * dot(back, along)), v = cross(along, u);
    return first[p] + u * move.a + v * move.b;
  };
  for (std::size_t p = 0; p < n; ++p) {
    std::swap(sum, last);
    sum.assign(m, 1e300);
    for (std::size_t to = 0; to < m; ++to) {
      const double lack = std::max(0.0, wanted_mm - double(sample(room, room.to_index(moved(p, moves[to])))));
      const double here = lack * lack + stray_cost * (moves[to].a * moves[to].a + moves[to].b * moves[to].b);
      if (p == 0) {
        sum[to] = here;
        continue;
      }
      for (std::size_t from = 0; from < m; ++from) {
        const double da = moves[to].a - moves[from].a, db = moves[to].b - moves[from].b;
        const double cost = last[from] + here + bend_cost * (da * da + db * db);
        if (cost < sum[to]) sum[to] = cost, before[p][to] = int(from);
      }
    }
  }
  std::vector<Vec3> line(n);
  std::size_t at = std::size_t(std::min_element(sum.begin(), sum.end()) - sum.begin());
  for (std::size_t p = n; p-- > 0; at = std::size_t(before[p][at])) line[p] = moved(p, moves[at]);
  return line;
}

}  // namespace

grid::Field without_dense_vein(const grid::Field& bone, const ClavicleCourse& clavicle, const VeinParams& p,
                               const Progress& progress) {
  VeinCourse course;
  course.points_mm = first_guess(clavicle, p);
  const grid::Box box = box_around(course, bone, p.search_mm + 5);
  if (box.empty()) return bone;
  const mask::BitMask here = mask::crop(mask::positive(bone, bone), box);
  const mask::Components pieces = mask::components(mask::eroded(here, bridge_mm, progress));
  std::vector<char> is_vein(pieces.list.size());
  for (std::size_t c = 0; c < is_vein.size(); ++c) {
    if (double(pieces.list[c].voxels) * bone.voxel_volume_mm3() < dense_least_mm3) continue;
    std::vector<char> one(is_vein.size());
    one[c] = 1;
    const mask::BitMask piece = mask::select(pieces, one);
    is_vein[c] = followed(piece, course, 0.75 * p.search_mm) >= dense_follow;
    for (const Vec3& q : clavicle.points_mm) {
      const Vec3 at = piece.lattice().to_index(q);
      if (piece.at(int(std::lround(at.x)), int(std::lround(at.y)), int(std::lround(at.z)))) is_vein[c] = 0;
    }
  }
  const mask::BitMask core = mask::select(pieces, is_vein);
  if (!core.any()) return bone;
  const mask::BitMask vein = mask::grown_within(core, here, 2 * bridge_mm, progress);
  grid::Field out = bone;
  for (int k = 0; k < vein.lattice().size[2]; ++k)
    for (int j = 0; j < vein.lattice().size[1]; ++j)
      for (int i = 0; i < vein.lattice().size[0]; ++i)
        if (vein.get(i, j, k)) {
          float& f = out.at(i + box.begin[0], j + box.begin[1], k + box.begin[2]);
          f = -std::abs(f);
        }
  return out;
}

VeinCourse estimated_course(const ClavicleCourse& clavicle, const mask::HuView& hu, const grid::Field& bone,
                            const VeinParams& p, const Progress& progress) {
  VeinCourse course;
  const std::vector<Vec3> first = first_guess(clavicle, p);
  course.points_mm = first;
  const grid::Box box = box_around(course, hu.lattice(), room_mm + 2 * p.radius_mm);
  if (box.empty())
    throw refusal("vein", "its course lies outside the volume: 0 voxels",
                  {"choose the other `side`, or take the vein out of the scene (configs/ct_chest_bone.yaml shows "
                   "`segment` of bone alone)"});
  const grid::Grid<float> room = room_around(hu, bone, box, progress);
  progress.check();
  course.points_mm = resampled(smoothed(with_room(first, room, p.radius_mm + film_mm), 4));
  course.clearance_mm = 1e9;
  for (const Vec3& q : course.points_mm)
    course.clearance_mm = std::min(course.clearance_mm, double(sample(room, room.to_index(q))));
  return course;
}

}  // namespace trephine::trunk
