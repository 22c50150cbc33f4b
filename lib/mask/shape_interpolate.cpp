// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/shape_interpolate.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mask/filters.h"

namespace trephine::mask {
namespace {

constexpr double between_slices_mm = 1e4;  // farther than anything within a slice, so that slices do not see each other

/// The field with `axis` as its last axis, cropped to the shape and `margin` voxels around it.
grid::Field with_last_axis(const grid::Field& field, int axis, int margin) {
  const std::array<int, 3> from{(axis + 1) % 3, (axis + 2) % 3, axis};
  grid::Lattice l = field;
  const double spacing[3] = {field.spacing_mm.x, field.spacing_mm.y, field.spacing_mm.z};
  for (int c = 0; c < 3; ++c) {
    l.size[c] = field.size[from[c]];
    l.direction.column[c] = field.direction.column[from[c]];
  }
  l.spacing_mm = {spacing[from[0]], spacing[from[1]], spacing[from[2]]};
  grid::Field turned(l);
  grid::Box shape{l.size, {0, 0, 0}};
  for (int k = 0; k < field.size[2]; ++k)
    for (int j = 0; j < field.size[1]; ++j)
      for (int i = 0; i < field.size[0]; ++i) {
        const float f = field.at(i, j, k);
        const int at[3] = {i, j, k};
        const int to[3] = {at[from[0]], at[from[1]], at[from[2]]};
        turned.at(to[0], to[1], to[2]) = f;
        if (!(f > 0)) continue;
        for (int c = 0; c < 3; ++c) {
          shape.begin[c] = std::min(shape.begin[c], to[c]);
          shape.end[c] = std::max(shape.end[c], to[c] + 1);
        }
      }
  return shape.empty() ? turned : grid::crop(turned, grid::grown(shape, margin, l));
}

/// Where an outline crosses the edges of one slice's pixels, and for each pixel the distance to the nearest of these
/// points, by vector sweeps [Danielsson1980].
class OutlineDistance {
 public:
  OutlineDistance(const grid::Field& field, int k) : f_(field), k_(k), nx_(field.size[0]), ny_(field.size[1]) {
    closest_.assign(std::size_t(nx_) * ny_, -1);
    distance_mm_.assign(closest_.size(), 1e6f);
    for (int j = 0; j + 1 < ny_; ++j)
      for (int i = 0; i + 1 < nx_; ++i) add_cell(i, j);
    for (int round = 0; round < 2; ++round)
      for (int way : {1, -1}) sweep(way);
  }
  float at(int i, int j) const { return distance_mm_[std::size_t(j) * nx_ + i]; }

 private:
  struct Point {
    double x, y;
  };

  void add_cell(int i, int j) {
    const float corner[4] = {f_.at(i, j, k_), f_.at(i + 1, j, k_), f_.at(i + 1, j + 1, k_), f_.at(i, j + 1, k_)};
    static constexpr int x[5] = {0, 1, 1, 0, 0}, y[5] = {0, 0, 1, 1, 0};
    Point crossing[4], middle{0, 0};
    int n = 0;
    for (int e = 0; e < 4; ++e) {
      const double a = corner[e], b = corner[(e + 1) % 4];
      if ((a > 0) == (b > 0)) continue;
      const double t = a / (a - b);
      crossing[n] = {i + x[e] + t * (x[e + 1] - x[e]), j + y[e] + t * (y[e + 1] - y[e])};
      middle.x += crossing[n].x;
      middle.y += crossing[n].y;
      ++n;
    }
    if (!n) return;
    middle = {middle.x / n, middle.y / n};
    add(i, j, middle);
    for (int c = 0; c < n; ++c) {
      add(i, j, crossing[c]);
      add(i, j, {(crossing[c].x + middle.x) / 2, (crossing[c].y + middle.y) / 2});
    }
  }
  void add(int i, int j, Point p) {
    points_.push_back({p.x * f_.spacing_mm.x, p.y * f_.spacing_mm.y});
    for (int dj : {0, 1})
      for (int di : {0, 1}) offer(i + di, j + dj, int(points_.size()) - 1);
  }
  void offer(int i, int j, int point) {
    if (point < 0) return;
    const Point& p = points_[std::size_t(point)];
    const float d = float(std::hypot(p.x - i * f_.spacing_mm.x, p.y - j * f_.spacing_mm.y));
    const std::size_t v = std::size_t(j) * nx_ + i;
    if (d >= distance_mm_[v]) return;
    distance_mm_[v] = d;
    closest_[v] = point;
  }
  void from(int i, int j, int di, int dj) {
    if (i + di < 0 || i + di >= nx_ || j + dj < 0 || j + dj >= ny_) return;
    offer(i, j, closest_[std::size_t(j + dj) * nx_ + (i + di)]);
  }
  void sweep(int way) {
    for (int row = 0; row < ny_; ++row) {
      const int j = way > 0 ? row : ny_ - 1 - row;
      for (int i = 0; i < nx_; ++i) {
        for (int di : {-1, 0, 1}) from(i, j, di, -way);
        from(i, j, -1, 0);
      }
      for (int i = nx_ - 1; i >= 0; --i) from(i, j, 1, 0);
    }
  }

  const grid::Field& f_;
  int k_, nx_, ny_;
  std::vector<Point> points_;
  std::vector<int> closest_;
  std::vector<float> distance_mm_;
};

/// Signed distance to the outline within the slice, mm, positive inside, at most reach_mm.
grid::Field outline_distance_mm(const grid::Field& field, double reach_mm, const Progress& progress) {
  grid::Field out(field);
  parallel_for(0, field.size[2], 1, [&](std::int64_t from, std::int64_t end) {
    progress.check();
    for (int k = int(from); k < end; ++k) {
      const OutlineDistance distance(field, k);
      for (int j = 0; j < field.size[1]; ++j)
        for (int i = 0; i < field.size[0]; ++i) {
          const float d = std::min(distance.at(i, j), float(reach_mm));
          out.at(i, j, k) = field.at(i, j, k) > 0 ? d : -d;
        }
    }
  });
  return out;
}

/// 1 where a disc of radius_mm that holds the voxel fits into the shape's slice, or for a voxel outside into the space
/// around it; 0 in thin parts and gaps, with a seam of two voxels. What the lattice's border cuts may be of any width.
grid::Field thickness_weight(const grid::Field& signed_mm, double radius_mm, const Progress& progress) {
  grid::Field weight(signed_mm, 1.f);
  if (radius_mm <= 0) return weight;
  grid::Lattice flat = signed_mm;
  flat.spacing_mm.z = between_slices_mm;
  const double seam_mm = 2 * std::max(flat.spacing_mm.x, flat.spacing_mm.y);
  for (const float side : {1.f, -1.f}) {
    const int nx = flat.size[0], ny = flat.size[1];
    const BitMask core = make_mask(flat, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < nx; ++i) {
        const float d = side * signed_mm.at(i, j, k);
        const bool border = i == 0 || j == 0 || i == nx - 1 || j == ny - 1;
        row[i] = d >= radius_mm || (border && d > 0);
      }
    });
    const grid::Grid<float> to_core = distance_mm(core, progress);
    for (std::size_t v = 0; v < weight.voxels.size(); ++v)
      if (side * signed_mm.voxels[v] > 0)
        weight.voxels[v] = float(ramp(to_core.voxels[v], radius_mm + seam_mm, radius_mm));
  }
  return weight;
}

/// How many mm within the slice one unit of the field is at the outlines, in the mean.
double mm_per_unit(const grid::Field& field) {
  double steps_mm = 0, rise = 0;
  for (int k = 0; k < field.size[2]; ++k)
    for (int j = 0; j < field.size[1]; ++j)
      for (int i = 0; i + 1 < field.size[0]; ++i) {
        const double a = field.at(i, j, k), b = field.at(i + 1, j, k);
        if ((a > 0) == (b > 0)) continue;
        steps_mm += field.spacing_mm.x;
        rise += std::abs(a - b);
      }
  return rise > 0 ? steps_mm / rise : 1;
}

/// The slope at the middle of three samples one step apart, such that a cubic through them never overshoots
/// [Fritsch1984]: 0 at a maximum or minimum, else the harmonic mean of the two steps.
double slope_at(double before, double at, double after) {
  const double a = at - before, b = after - at;
  return a * b > 0 ? 2 * a * b / (a + b) : 0;
}

/// What lies between the voxels `below` and `above` of neighbouring slices.
class Slices {
 public:
  Slices(const grid::Field& grey, const grid::Field& shape_mm, const grid::Field& thickness, double reach_mm)
      : grey_(grey), shape_mm_(shape_mm), thickness_(thickness), reach_mm_(reach_mm), grey_mm_(mm_per_unit(grey)) {}

  float given(std::size_t v) const {
    const double w = thickness_.voxels[v];
    return float(w * shape_mm_.voxels[v] + (1 - w) * linear(v));
  }
  float between(std::size_t below, std::size_t above, double t) const {
    const double w = std::min(thickness_.voxels[below], thickness_.voxels[above]);
    const double grey_way = (1 - t) * linear(below) + t * linear(above);
    return float(w > 0 ? w * shape_way(below, above, t) + (1 - w) * grey_way : grey_way);
  }

 private:
  double linear(std::size_t v) const { return std::clamp(grey_mm_ * grey_.voxels[v], -reach_mm_, reach_mm_); }

  double shape_way(std::size_t below, std::size_t above, double t) const {
    double a = shape_mm_.voxels[below], b = shape_mm_.voxels[above];
    if ((a > 0) != (b > 0)) {
      // On a ledge that no outline crosses, both distances are at the reach and say nothing: the grey values do.
      const double f = std::abs(grey_.voxels[below]), g = std::abs(grey_.voxels[above]);
      const double at = f + g > 0 ? std::clamp(f / (f + g), 0.1, 0.9) : 0.5;
      const double ledge = ramp(std::min(std::abs(a), std::abs(b)), 0.5 * reach_mm_, reach_mm_) * (2 * at - 1);
      a *= 1 + ledge;
      b *= 1 - ledge;
    }
    const std::size_t slice = above - below;
    const double before = below >= slice ? shape_mm_.voxels[below - slice] : 2 * a - b;
    const double after = above + slice < grey_.voxels.size() ? shape_mm_.voxels[above + slice] : 2 * b - a;
    const double rise_a = slope_at(before, a, b), rise_b = slope_at(a, b, after), u = 1 - t;
    return u * u * (1 + 2 * t) * a + t * t * (3 - 2 * t) * b + t * u * (u * rise_a - t * rise_b);
  }

  const grid::Field &grey_, &shape_mm_, &thickness_;
  double reach_mm_, grey_mm_;
};

}  // namespace

int thick_axis(const grid::Lattice& lattice, const ShapeInterpolateParams& params) {
  const double s[3] = {lattice.spacing_mm.x, lattice.spacing_mm.y, lattice.spacing_mm.z};
  const int axis = int(std::max_element(s, s + 3) - s);
  const double within = std::max(s[(axis + 1) % 3], s[(axis + 2) % 3]);
  return s[axis] > params.thicker_than_mm && s[axis] >= 1.5 * within && lattice.size[axis] > 1 ? axis : -1;
}

int interpolated_steps(const grid::Lattice& lattice, const ShapeInterpolateParams& params) {
  if (thick_axis(lattice, params) < 0) return 1;
  const double thick_mm = std::max({lattice.spacing_mm.x, lattice.spacing_mm.y, lattice.spacing_mm.z});
  const int n = std::max(3, int(std::ceil(thick_mm / params.step_mm - 1e-9)));
  return n + (n % 2 == 0);  // odd, so that half a given step is a whole number of new ones and half of one
}

Outcome<std::shared_ptr<const grid::Field>, ShapeInterpolateResult> shape_interpolate(
    const std::shared_ptr<const grid::Field>& whole, const ShapeInterpolateParams& params, const Progress& progress) {
  const grid::Field& given = *whole;
  check_finite(given);
  Warnings warnings;
  if (std::none_of(given.voxels.begin(), given.voxels.end(), [](float f) { return f > 0; }))
    warnings.push_back({"nothing_inside", "nothing is inside: there is nothing to interpolate", {}});
  const int axis = thick_axis(given, params);
  const double s[3] = {given.spacing_mm.x, given.spacing_mm.y, given.spacing_mm.z};
  const double step_before_mm = axis < 0 ? *std::max_element(s, s + 3) : s[axis];
  if (axis < 0) return {whole, {step_before_mm, step_before_mm}, std::move(warnings)};
  const grid::Field field = with_last_axis(given, axis, 2);
  const double step_mm = field.spacing_mm.z, reach_mm = params.reach_steps * step_mm;
  const int n = interpolated_steps(given, params);
  const grid::Field shape_mm = outline_distance_mm(field, reach_mm, progress);
  const grid::Field thickness =
      thickness_weight(shape_mm, std::min(params.thin_steps * step_mm, 0.99 * reach_mm), progress);
  const Slices slices(field, shape_mm, thickness, reach_mm);

  const int nz = field.size[2], more = n / 2;
  grid::Lattice l = field;
  l.size[2] = (nz - 1) * n + 1 + 2 * more;
  l.spacing_mm.z = step_mm / n;
  l.origin_mm = field.to_world_mm({0, 0, -double(more) / n});
  grid::Field out(l);
  const std::size_t slice = std::size_t(l.size[0]) * l.size[1];
  parallel_for(0, l.size[2], 1, [&](std::int64_t from, std::int64_t end) {
    progress.check();
    for (int z = int(from); z < end; ++z) {
      const int at = std::clamp(z - more, 0, (nz - 1) * n), k = at / n, m = at % n;
      for (std::size_t p = 0; p < slice; ++p) {
        const std::size_t below = std::size_t(k) * slice + p;
        out.voxels[std::size_t(z) * slice + p] =
            m ? slices.between(below, below + slice, double(m) / n) : slices.given(below);
      }
    }
  });
  return {std::make_shared<const grid::Field>(std::move(out)), {step_before_mm, l.spacing_mm.z}, std::move(warnings)};
}

}  // namespace trephine::mask
