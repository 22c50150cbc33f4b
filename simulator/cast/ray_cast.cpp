// SPDX-License-Identifier: GPL-3.0-or-later
#include "cast/ray_cast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "scene/picture.h"

namespace trephine::cast {
namespace {

constexpr double nowhere = std::numeric_limits<double>::infinity();

// The eight voxels about a place, and where between them it lies.
struct Cell {
  std::array<std::size_t, 8> voxel;
  std::array<double, 3> fraction;

  Cell(const grid::Lattice& l, Vec3 at) {
    int begin[3], step[3];
    for (int a = 0; a < 3; ++a) {
      const int size = l.size[std::size_t(a)];
      const double x = std::clamp(at[a], 0.0, double(size - 1));
      begin[a] = std::min(int(x), std::max(0, size - 2));
      step[a] = size > 1 ? 1 : 0;
      fraction[std::size_t(a)] = x - begin[a];
    }
    for (int c = 0; c < 8; ++c)
      voxel[std::size_t(c)] =
          l.index(begin[0] + (c & 1) * step[0], begin[1] + (c >> 1 & 1) * step[1], begin[2] + (c >> 2) * step[2]);
  }
  // Of eight equal values exactly that value.
  template <class Value>
  double between(const Value& value) const {
    std::array<double, 8> v;
    for (std::size_t c = 0; c < 8; ++c) v[c] = value(voxel[c]);
    for (std::size_t a = 0, n = 4; a < 3; ++a, n /= 2)
      for (std::size_t c = 0; c < n; ++c) v[c] = v[2 * c] + fraction[a] * (v[2 * c + 1] - v[2 * c]);
    return v[0];
  }
  double weight(std::size_t corner) const {
    double w = 1;
    for (std::size_t a = 0; a < 3; ++a) w *= (corner >> a & 1) ? fraction[a] : 1 - fraction[a];
    return w;
  }
};

template <class Value>
Vec3 gradient_of(const grid::Lattice& l, Vec3 at, const Value& value) {
  Vec3 gradient;  // along the lattice's axes, a mm
  for (int a = 0; a < 3; ++a) {
    Vec3 one;
    one[a] = 1;
    gradient[a] = (value(at + one) - value(at - one)) / (2 * l.spacing_mm[a]);
  }
  return gradient;
}

// What is seen of HU at a place, in voxels, and how they rise there.
struct HuField {
  const grid::Grid<std::int16_t>& voxels;
  const CastTable& table;

  double hu(Vec3 at) const {
    return Cell(voxels, at).between([&](std::size_t n) { return double(voxels.voxels[n]); });
  }
  CastTable::Entry entry(Vec3 at) const { return table.at(hu(at)); }
  Vec3 gradient(Vec3 at) const {
    return gradient_of(voxels, at, [&](Vec3 p) { return hu(p); });
  }
};

// The same of shapes.
struct ShapeField {
  const CastShapes& shapes;
  const grid::Grid<CastShapes::Voxel>& voxels;

  double share(int number, const Cell& cell) const {
    return cell.between([&](std::size_t n) {
      const CastShapes::Voxel& v = voxels.voxels[n];
      return double(v.number == number ? v.share : v.rest == number ? voxel::haptic_full - v.share : 0);
    });
  }
  // Of all that meets in the cell, only what wins a vote can have half of it; 0 where that has less, or is empty.
  int number(Vec3 at) const {
    const Cell cell(voxels, at);
    int leads = 0;
    double by = 0;
    const auto vote = [&](int n, double weight) {
      by += n == leads ? weight : -weight;
      if (by >= 0) return;
      leads = n;
      by = -by;
    };
    for (std::size_t c = 0; c < 8; ++c) {
      const CastShapes::Voxel& v = voxels.voxels[cell.voxel[c]];
      vote(v.number, cell.weight(c) * v.share);
      vote(v.rest, cell.weight(c) * (voxel::haptic_full - v.share));
    }
    return leads != 0 && share(leads, cell) >= 0.5 * voxel::haptic_full ? leads : 0;
  }
  CastTable::Entry entry(Vec3 at) const { return shapes.entries()[std::size_t(number(at))]; }
  Vec3 gradient(Vec3 at) const {
    const int n = number(at);
    return gradient_of(voxels, at, [&](Vec3 p) { return share(n, Cell(voxels, p)) * (shape_hu / voxel::haptic_full); });
  }
};

// Leaves of a ray's part from `begin` to `end` what lies between two planes: low <= from + along * t <= high.
void between(double from, double along, double low, double high, double& begin, double& end) {
  if (std::abs(along) < 1e-12) {
    if (from < low || from > high) end = -nowhere;
    return;
  }
  const double a = (low - from) / along, b = (high - from) / along;
  begin = std::max(begin, std::min(a, b));
  end = std::min(end, std::max(a, b));
}

template <class Field>
class Caster {
 public:
  Caster(const Field& field, const CastBricks& bricks, const scene::EyeView& eye, const CastParams& params)
      : field_(field),
        voxels_(field.voxels),
        bricks_(bricks),
        eye_(eye),
        params_(params),
        step_mm_(step_of(params, voxels_)),
        from_(voxels_.to_index(eye.eye_mm)) {}

  struct Seen {
    std::array<float, 4> rgba{0, 0, 0, 0};
    double begins_mm = nowhere, hides_mm = nowhere;
  };

  Seen ray(Vec3 direction, double surface_mm) const {
    const Vec3 along = voxels_.to_index(eye_.eye_mm + direction) - from_;
    double begin = 0, end = surface_mm / std::max(1e-9, -dot(direction, eye_.toward));
    for (int a = 0; a < 3; ++a) between(from_[a], along[a], -0.5, voxels_.size[std::size_t(a)] - 0.5, begin, end);
    if (params_.cut) {
      const Vec3 n = normalized(params_.cut->normal);
      between(dot(n, eye_.eye_mm - params_.cut->point_mm), dot(n, direction), -nowhere, 0, begin, end);
    }
    if (params_.box)
      for (int a = 0; a < 3; ++a)
        between(eye_.eye_mm[a], direction[a], params_.box->min_mm[a], params_.box->max_mm[a], begin, end);
    Seen seen;
    if (!(begin < end)) return seen;
    double light = 1;
    bool clear = true;  // the sample before this one
    bool cut = false;   // the ray began within what is seen
    for (auto n = std::int64_t(begin / step_mm_); double(n) * step_mm_ < end; ++n) {
      double low = std::max(begin, double(n) * step_mm_);
      const double high = std::min(end, double(n + 1) * step_mm_);
      double at = (low + high) / 2;
      if (params_.leave_out_empty) {
        const double leaves = leaves_empty(along, at);
        if (leaves > at) {
          n = std::max(n, std::int64_t(leaves / step_mm_ - 0.5) - 1);
          clear = true;
          continue;
        }
      }
      CastTable::Entry e = entry(along, at);
      if (!(e[3] > 0)) {
        clear = true;
        continue;
      }
      if (clear) {
        low = first(along, std::max(begin, at - step_mm_), at);
        at = (low + high) / 2;
        e = entry(along, at);
        cut = cut || low == begin;
        if (seen.begins_mm == nowhere) seen.begins_mm = low;
      }
      clear = false;
      const double alpha = 1 - std::pow(std::max(1e-6, 1.0 - double(e[3])), high - low);
      const std::array<double, 3> lit =
          lit_colour(e, along, at, direction, cut ? std::min(1.0, (at - begin) / (cut_steps * step_mm_)) : 1);
      for (std::size_t c = 0; c < 3; ++c) seen.rgba[c] += float(light * alpha * lit[c]);
      light *= 1 - alpha;
      if (light <= 0.5 && seen.hides_mm == nowhere) seen.hides_mm = low;
      if (light < least_light) break;
    }
    seen.rgba[3] = float(1 - light);
    return seen;
  }

 private:
  CastTable::Entry entry(Vec3 along, double t) const { return field_.entry(from_ + along * t); }

  // Where opacity begins between a place that is clear, or the ray's begin, and one that is not.
  double first(Vec3 along, double low, double high) const {
    if (entry(along, low)[3] > 0) return low;
    for (int n = 0; n < halvings; ++n) {
      const double middle = (low + high) / 2;
      (entry(along, middle)[3] > 0 ? high : low) = middle;
    }
    return high;
  }

  // Where the ray leaves the bricks about that place that show nothing; 0 where its own shows something.
  double leaves_empty(Vec3 along, double t) const {
    const Vec3 at = from_ + along * t;
    int b[3];
    for (int a = 0; a < 3; ++a)
      b[a] = std::clamp(int(std::floor(at[a] / CastBricks::side)), 0, bricks_.size[std::size_t(a)] - 1);
    const int away = bricks_.clear[bricks_.index(b[0], b[1], b[2])];
    if (away == 0) return 0;
    double leaves = nowhere;
    for (int a = 0; a < 3; ++a)
      if (std::abs(along[a]) > 1e-9)
        leaves = std::min(leaves, ((b[a] + (along[a] > 0 ? away : 1 - away)) * CastBricks::side - from_[a]) / along[a]);
    return leaves;
  }

  std::array<double, 3> lit_colour(const CastTable::Entry& e, Vec3 along, double t, Vec3 direction,
                                   double lit_share) const {
    const Vec3 gradient = field_.gradient(from_ + along * t);
    const double steep = norm(gradient);
    const double share = lit_share * std::min(1.0, steep / unlit_hu_per_mm);
    const Vec3 world = voxels_.direction * gradient, to_eye = seen_by_eye(-direction);
    Vec3 n = seen_by_eye(world) * (-1 / std::max(1e-6, steep));
    if (dot(n, to_eye) < 0) n = -n;
    const Vec3 key = normalized(Vec3{scene::key_light[0], scene::key_light[1], scene::key_light[2]}),
               fill = normalized(Vec3{0.80, 0.05, 0.45}), rim = normalized(Vec3{0.25, 0.55, -0.80});
    const double light = 0.70 * std::max(0.0, dot(n, key)) + 0.30 * std::max(0.0, dot(n, fill)) +
                         0.12 * std::max(0.0, dot(n, rim)) + 0.26 + 0.08 * n.y;
    const double shine = 0.10 * share * std::pow(std::max(0.0, dot(n, normalized(key + to_eye))), 32);
    std::array<double, 3> lit;
    for (std::size_t c = 0; c < 3; ++c) lit[c] = e[c] * (0.7 + share * (light - 0.7)) + shine;
    return lit;
  }

  Vec3 seen_by_eye(Vec3 v) const { return {dot(v, eye_.right), dot(v, eye_.up), dot(v, eye_.toward)}; }

  const Field& field_;
  const grid::Lattice& voxels_;
  const CastBricks& bricks_;
  const scene::EyeView& eye_;
  const CastParams& params_;
  const double step_mm_;
  const Vec3 from_;
};

template <class Field>
CastPicture cast_of(const Field& field, const CastBricks& bricks, const scene::EyeView& eye, int width, int height,
                    const CastParams& params) {
  CastPicture picture{width, height, {}, {}, {}};
  const std::size_t pixels = std::size_t(width) * std::size_t(height);
  picture.rgba.resize(pixels);
  picture.begins_mm.resize(pixels);
  picture.hides_mm.resize(pixels);
  const Caster<Field> caster(field, bricks, eye, params);
  parallel_for(0, height, 1, [&](std::int64_t y, std::int64_t) {
    for (int x = 0; x < width; ++x) {
      const std::size_t n = std::size_t(y) * std::size_t(width) + std::size_t(x);
      const double surface = params.surface_mm.empty() ? nowhere : double(params.surface_mm[n]);
      const typename Caster<Field>::Seen seen = caster.ray(eye.ray(x + 0.5, double(y) + 0.5, width, height), surface);
      picture.rgba[n] = seen.rgba;
      picture.begins_mm[n] = float(seen.begins_mm);
      picture.hides_mm[n] = float(seen.hides_mm);
    }
  });
  return picture;
}

}  // namespace

double step_of(const CastParams& params, const grid::Lattice& l) {
  return params.step_mm > 0 ? params.step_mm : 0.5 * std::min({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z});
}

CastPicture cast_rays(const grid::Grid<std::int16_t>& voxels, const CastTable& table, const CastBricks& bricks,
                      const scene::EyeView& eye, int width, int height, const CastParams& params) {
  return cast_of(HuField{voxels, table}, bricks, eye, width, height, params);
}

CastPicture cast_rays(const CastShapes& shapes, const CastBricks& bricks, const scene::EyeView& eye, int width,
                      int height, const CastParams& params) {
  return cast_of(ShapeField{shapes, shapes.voxels()}, bricks, eye, width, height, params);
}

}  // namespace trephine::cast
