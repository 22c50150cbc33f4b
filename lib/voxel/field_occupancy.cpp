// SPDX-License-Identifier: GPL-3.0-or-later
// The occupancy of a field's solid, without a surface of triangles in between.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "voxel/shape_occupancy.h"

namespace trephine::voxel::detail {
namespace {

constexpr int slices_of_places = 16, most_parts = 16;

// The field at any continuous index: trilinear, and outside of it beyond half a voxel, as its contour is capped.
class FieldSampler {
 public:
  FieldSampler(const grid::Field& field, const std::vector<bool>& turned)
      : f_(field), turned_(turned), dy_(std::size_t(field.size[0])), dz_(dy_ * field.size[1]) {}

  double operator()(const Vec3& p) const {
    const int i = int(std::floor(p.x)), j = int(std::floor(p.y)), k = int(std::floor(p.z));
    const double x = p.x - i, y = p.y - j, z = p.z - k;
    double c[8];
    if (i >= 0 && j >= 0 && k >= 0 && i + 1 < f_.size[0] && j + 1 < f_.size[1] && k + 1 < f_.size[2]) {
      const std::size_t first = f_.index(i, j, k);
      for (std::size_t n = 0; n < 8; ++n) c[n] = value(first + (n & 1) + (n >> 1 & 1) * dy_ + (n >> 2) * dz_);
    } else {
      for (int n = 0; n < 8; ++n) c[n] = at(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2));
    }
    for (std::size_t n = 0; n < 4; ++n) c[n] = c[2 * n] + x * (c[2 * n + 1] - c[2 * n]);
    for (std::size_t n = 0; n < 2; ++n) c[n] = c[2 * n] + y * (c[2 * n + 1] - c[2 * n]);
    return c[0] + z * (c[1] - c[0]);
  }
  double at(int i, int j, int k) const {
    if (f_.contains(i, j, k)) return value(f_.index(i, j, k));
    return -std::abs(value(f_.index(std::clamp(i, 0, f_.size[0] - 1), std::clamp(j, 0, f_.size[1] - 1),
                                    std::clamp(k, 0, f_.size[2] - 1))));
  }
  float value(std::size_t at) const {
    const float v = f_.voxels[at];
    if (turned_.empty() || !turned_[at]) return v;
    return v > 0 ? -v : std::max(-v, 1e-3f);
  }

 private:
  const grid::Field& f_;
  const std::vector<bool>& turned_;
  std::size_t dy_, dz_;
};

// A point of the surface, in the haptic lattice's indices times its spacing, and the surface's direction there.
struct Place {
  std::array<float, 3> at, normal;
};

// Of the field, seen from the haptic lattice.
struct FieldOnLattice {
  const grid::Field& field;
  const grid::Lattice& lattice;
  FieldSampler sampler;
  Vec3 first, step[3];       // of the lattice's voxels, in the field's indices
  std::array<int, 3> parts;  // the field's steps are cut into so many, so that none is longer than a voxel
  double apart_mm;           // no point of a plane is farther than this from the nearest place on it

  FieldOnLattice(const grid::Field& f, const std::vector<bool>& turned, const grid::Lattice& l)
      : field(f), lattice(l), sampler(f, turned) {
    first = f.to_index(l.to_world_mm({0, 0, 0}));
    for (int a = 0; a < 3; ++a) {
      Vec3 next;
      next[a] = 1;
      step[a] = f.to_index(l.to_world_mm(next)) - first;
    }
    const double longest = std::max({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z});
    Vec3 cell;
    for (int a = 0; a < 3; ++a) {
      parts[std::size_t(a)] = std::clamp(int(std::ceil(f.spacing_mm[a] / longest - 1e-6)), 1, most_parts);
      cell[a] = f.spacing_mm[a] / parts[std::size_t(a)];
    }
    apart_mm = norm(cell) / 2;
  }
  double reach_mm() const { return std::hypot(largest_ramp_mm(lattice), apart_mm) + 1e-3; }

  // The field's voxels about which these slices of the lattice lie.
  grid::Box box(int k_begin, int k_end) const {
    Vec3 low{1e300, 1e300, 1e300}, high = -low;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p = first + step[0] * (corner & 1 ? lattice.size[0] - 1 : 0) +
                     step[1] * (corner & 2 ? lattice.size[1] - 1 : 0) + step[2] * (corner & 4 ? k_end - 1 : k_begin);
      for (int a = 0; a < 3; ++a) low[a] = std::min(low[a], p[a]), high[a] = std::max(high[a], p[a]);
    }
    grid::Box b;
    for (int a = 0; a < 3; ++a) {
      const double rim = reach_mm() / field.spacing_mm[a] + 1, size = field.size[std::size_t(a)];
      b.begin[std::size_t(a)] = int(std::clamp(std::floor(low[a] - rim), -1.0, size));
      b.end[std::size_t(a)] = int(std::clamp(std::ceil(high[a] + rim), -1.0, size));
    }
    return b;
  }

  Place place(const Vec3& index) const {
    // By central differences over the parts: across a plate that is thinner than these it leans, and no more than that.
    Vec3 g;
    for (int a = 0; a < 3; ++a) {
      Vec3 half;
      half[a] = 1.0 / parts[std::size_t(a)];
      g[a] = (sampler(index - half) - sampler(index + half)) * parts[std::size_t(a)] / field.spacing_mm[a];
    }
    const Vec3 along = transpose_times(lattice.direction, field.direction * g);
    const Vec3 at = lattice.to_index(field.to_world_mm(index)), n = along / std::max(norm(along), 1e-30);
    Place p;
    for (int a = 0; a < 3; ++a) {
      p.at[std::size_t(a)] = float(at[a] * lattice.spacing_mm[a]);
      p.normal[std::size_t(a)] = float(n[a]);
    }
    return p;
  }

  // The places between slice k and the next, on the edges of the parts.
  void add_places(int k, const grid::Box& box, std::vector<Place>& out) const {
    // How many of a column's two voxels are inside; a cell has both signs where its four have neither none nor all.
    const int width = box.end[0] - box.begin[0] + 1;
    std::vector<std::uint8_t> inside(std::size_t(width), 0), next(inside);
    for (int j = box.begin[1]; j <= box.end[1]; ++j) {
      std::fill(next.begin(), next.end(), std::uint8_t{0});
      for (const int z : {k, k + 1}) {
        if (j < 0 || z < 0 || j >= field.size[1] || z >= field.size[2]) continue;
        const int first = std::max(0, box.begin[0]), last = std::min(field.size[0], box.end[0] + 1);
        const std::size_t row = field.index(0, j, z);
        for (int i = first; i < last; ++i)
          next[std::size_t(i - box.begin[0])] += std::uint8_t(sampler.value(row + std::size_t(i)) > 0);
      }
      for (std::size_t i = 0; j > box.begin[1] && i + 1 < inside.size(); ++i)
        if (const int all = inside[i] + inside[i + 1] + next[i] + next[i + 1]; all > 0 && all < 8)
          add_cell(box.begin[0] + int(i), j - 1, k, out);
      inside.swap(next);
    }
  }

 private:
  // Each cell has the edges that go out from its parts' corners, but for those of its far faces, which are others'.
  void add_cell(int i, int j, int k, std::vector<Place>& out) const {
    const Vec3 from{double(i), double(j), double(k)};
    for (int c = 0; c < parts[2]; ++c)
      for (int b = 0; b < parts[1]; ++b)
        for (int a = 0; a < parts[0]; ++a) {
          const Vec3 p = from + Vec3{double(a) / parts[0], double(b) / parts[1], double(c) / parts[2]};
          const double here = sampler(p);
          for (int axis = 0; axis < 3; ++axis) {
            const double way = 1.0 / parts[std::size_t(axis)];
            Vec3 q = p;
            q[axis] += way;
            const double there = sampler(q);
            if ((here > 0) == (there > 0)) continue;
            q[axis] = p[axis] + way * here / (here - there);
            out.push_back(place(q));
          }
        }
  }
};

// The nearest place of each voxel of a few slices.
class PlacesSlab {
 public:
  PlacesSlab(const FieldOnLattice& on, int k_begin, int k_end)
      : on_(on), l_(on.lattice), k_begin_(k_begin), k_end_(k_end), reach_(float(on.reach_mm())) {
    const std::size_t count = std::size_t(k_end - k_begin) * std::size_t(l_.size[1]) * std::size_t(l_.size[0]);
    squared_.assign(count, reach_ * reach_);
    nearest_.assign(count, none);
    const grid::Box box = on.box(k_begin, k_end);
    for (int k = box.begin[2]; k < box.end[2]; ++k) on.add_places(k, box, places_);
    for (std::uint32_t p = 0; p < places_.size(); ++p) visit(p);
  }

  void write(grid::Grid<std::uint8_t>& occupancy) const {
    for (int k = k_begin_; k < k_end_; ++k)
      for (int j = 0; j < l_.size[1]; ++j) {
        const Vec3 row = on_.first + on_.step[1] * j + on_.step[2] * k;
        std::uint32_t before = none;
        for (int i = 0; i < l_.size[0]; before = nearest_[index(i++, j, k)]) {
          const std::uint32_t number = nearest_[index(i, j, k)];
          const Vec3 at = row + on_.step[0] * i;
          std::uint8_t& o = occupancy.at(i, j, k);
          if (number == none) {  // so its side is that of all voxels about it
            if (i > 0 && before == none)
              o = occupancy.at(i - 1, j, k);
            else
              o = on_.sampler.at(int(std::lround(at.x)), int(std::lround(at.y)), int(std::lround(at.z))) > 0 ? 255 : 0;
            continue;
          }
          const Place& near = places_[number];
          const bool inside = on_.sampler(at) > 0;
          // The surface is a plane about its place, and ends half way to the places beside it.
          Vec3 off{i * l_.spacing_mm.x, j * l_.spacing_mm.y, k * l_.spacing_mm.z}, n;
          for (int a = 0; a < 3; ++a) off[a] -= near.at[std::size_t(a)], n[a] = near.normal[std::size_t(a)];
          const double height = dot(off, n);
          const Vec3 beside = off - n * height;
          const double aside = norm(beside), over = std::max(0.0, aside - on_.apart_mm);
          const Vec3 way = n * height + beside * (over / std::max(aside, 1e-30));
          const double d = norm(way);
          const Vec3 u = l_.direction * (d > 1e-9 ? way / d : n);
          o = std::uint8_t(share_at(inside ? -d : d, ramp_mm(l_, u)));
        }
      }
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;

  void visit(std::uint32_t number) {
    const Place& p = places_[number];
    int begin[3], end[3];
    for (std::size_t a = 0; a < 3; ++a) {
      const double s = l_.spacing_mm[int(a)];
      begin[a] = int(std::clamp(std::ceil((p.at[a] - reach_) / s), 0.0, double(l_.size[a])));
      end[a] = int(std::clamp(std::floor((p.at[a] + reach_) / s) + 1, 0.0, double(l_.size[a])));
    }
    const float sx = float(l_.spacing_mm.x), sy = float(l_.spacing_mm.y), sz = float(l_.spacing_mm.z);
    for (int k = std::max(begin[2], k_begin_); k < std::min(end[2], k_end_); ++k)
      for (int j = begin[1]; j < end[1]; ++j) {
        const float y = float(j) * sy - p.at[1], z = float(k) * sz - p.at[2], yz = y * y + z * z;
        const std::size_t row = index(0, j, k);
        for (int i = begin[0]; i < end[0]; ++i) {
          const float x = float(i) * sx - p.at[0], d = x * x + yz;
          if (d < squared_[row + std::size_t(i)]) {
            squared_[row + std::size_t(i)] = d;
            nearest_[row + std::size_t(i)] = number;
          }
        }
      }
  }

  std::size_t index(int i, int j, int k) const {
    return (std::size_t(k - k_begin_) * std::size_t(l_.size[1]) + std::size_t(j)) * std::size_t(l_.size[0]) +
           std::size_t(i);
  }
  const FieldOnLattice& on_;
  const grid::Lattice& l_;
  int k_begin_, k_end_;
  float reach_;
  std::vector<float> squared_;
  std::vector<std::uint32_t> nearest_;
  std::vector<Place> places_;
};

}  // namespace

grid::Grid<std::uint8_t> solid_occupancy(const grid::Field& field, const std::vector<bool>& turned,
                                         const grid::Lattice& lattice, const Progress& progress) {
  if (field.voxels.empty()) throw Error(ExitCode::bad_input, "", "field", "has no voxels");
  if (!turned.empty() && turned.size() != field.voxels.size())
    throw Error(ExitCode::internal, "", "turned", "is of another field");
  grid::Grid<std::uint8_t> occupancy(lattice, 0);
  const FieldOnLattice on(field, turned, lattice);
  parallel_for(0, (lattice.size[2] + slices_of_places - 1) / slices_of_places, 1, [&](std::int64_t s, std::int64_t) {
    progress.check();
    const int begin = int(s) * slices_of_places;
    PlacesSlab(on, begin, std::min(begin + slices_of_places, lattice.size[2])).write(occupancy);
  });
  progress.report(1);
  return occupancy;
}

}  // namespace trephine::voxel::detail
