// SPDX-License-Identifier: GPL-3.0-or-later
#include "place/place_head.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/pi.h"
#include "mask/filters.h"

namespace trephine::place {
namespace {

constexpr Vec3 middle{0, 2, 45};  ///< of the template's cavity
constexpr double cell_mm = 3;     ///< of the raster on which the cavity's distances are taken
constexpr int pad_cells = 8;
constexpr double point_mm = 11;  ///< about the distance between the template's surface points
constexpr double canal_mm = 20;  ///< this near to the foramen magnum no surface is expected
constexpr std::array<double, 3> start_pitch_deg{-30, -10, 12};
constexpr int rounds = 40, widening = 12;  ///< rounds, and those in which outliers still count
constexpr double settled = 0.02;           ///< of the cost
constexpr double first_outlier_mm = 30, last_outlier_mm = 12;
constexpr double error_mm = 3;                                 ///< by which the template misses a head, and
constexpr double independent = 100;                            ///< so many points of its surface do so independently
constexpr double scale_spread = 0.05;                          ///< of the logarithm of adults' sizes
constexpr double roll_deg = 15, yaw_deg = 20, pitch_deg = 40;  ///< how heads lie
constexpr double fluid_raster_mm = 4;                          ///< one sample of the fluid in a cube of this
constexpr double fluid_error_mm = 4, fluid_independent = 60, fluid_outlier_mm = 16;
constexpr double fits_mm = 6, min_scanned = 0.5, min_matched = 0.6;

struct Sample {
  Vec3 at;
  double weight;  ///< mm^2 of surface
};

/// Points of the template's cavity, about evenly spread, relative to `middle`.
std::vector<Sample> surface_points() {
  std::vector<Sample> points;
  const int rings = 22;
  for (int ring = 0; ring < rings; ++ring) {
    const double polar = pi * (ring + 0.5) / rings;
    const int around = std::max(4, int(std::lround(2 * rings * std::sin(polar))));
    for (int n = 0; n < around; ++n) {
      const double turn = 2 * pi * (n + 0.5 * (ring % 2)) / around;
      const Vec3 way{std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)};
      double from = 0, to = 150;
      for (int halving = 0; halving < 40; ++halving)
        (template_cavity_mm(middle + 0.5 * (from + to) * way) < 0 ? from : to) = 0.5 * (from + to);
      const Vec3 at = from * way;
      if (norm(middle + at - template_foramen_mm) < canal_mm) continue;
      points.push_back({at, from * from});
    }
  }
  return points;
}

/// Signed distance to the cavity in mm, negative inside, as a function of the place.
class Distance {
 public:
  Distance(const mask::BitMask& cavity, const grid::Lattice& scan, const Progress& progress) {
    const grid::Lattice& from = cavity.lattice();
    grid::Lattice l = from;
    std::array<double, 3> step;
    Vec3 first;
    for (int a = 0; a < 3; ++a) {
      step[a] = std::max(1.0, std::round(cell_mm / from.spacing_mm[a]));
      l.spacing_mm[a] = from.spacing_mm[a] * step[a];
      l.size[a] = int(std::ceil(from.size[a] / step[a])) + 2 * pad_cells;
      first[a] = 0.5 * (step[a] - 1) - pad_cells * step[a];
    }
    l.origin_mm = from.to_world_mm(first);
    mask::BitMask in(l), out(l);
    for (int k = 0; k < l.size[2]; ++k)
      for (int j = 0; j < l.size[1]; ++j)
        for (int i = 0; i < l.size[0]; ++i) {
          const Vec3 at = l.to_world_mm({double(i), double(j), double(k)}), f = from.to_index(at),
                     s = scan.to_index(at);
          const bool set = cavity.at(int(std::lround(f.x)), int(std::lround(f.y)), int(std::lround(f.z)));
          bool scanned = true;
          for (int a = 0; a < 3; ++a) scanned = scanned && s[a] > -0.5 && s[a] < scan.size[a] - 0.5;
          if (set)
            in.set(i, j, k);
          else if (scanned)
            out.set(i, j, k);
        }
    values_ = mask::distance_mm(in, progress);
    const grid::Grid<float> inside = mask::distance_mm(out, progress);
    for (std::size_t v = 0; v < values_.voxels.size(); ++v)
      values_.voxels[v] = std::clamp(values_.voxels[v] - inside.voxels[v], -80.f, 80.f);
    scan_ = scan;
  }

  bool scanned(Vec3 at) const {
    const Vec3 s = scan_.to_index(at);
    for (int a = 0; a < 3; ++a)
      if (s[a] < 0 || s[a] > scan_.size[a] - 1) return false;
    return true;
  }

  /// Linear between the cells; beyond the raster the value at its end.
  double at(Vec3 lps, Vec3* slope = nullptr) const {
    const Vec3 x = values_.to_index(lps);
    int low[3];
    double t[3];
    for (int a = 0; a < 3; ++a) {
      const double c = std::clamp(x[a], 0.0, double(values_.size[a] - 1));
      low[a] = std::min(int(c), std::max(0, values_.size[a] - 2));
      t[a] = c - low[a];
    }
    double sum = 0;
    Vec3 g;
    for (int n = 0; n < 8; ++n) {
      const int d[3] = {n & 1, n >> 1 & 1, n >> 2};
      double w[3];
      for (int a = 0; a < 3; ++a) w[a] = d[a] ? t[a] : 1 - t[a];
      const auto inside = [&](int a) { return std::min(low[a] + d[a], values_.size[a] - 1); };
      const double v = values_.at(inside(0), inside(1), inside(2));
      sum += w[0] * w[1] * w[2] * v;
      g.x += (d[0] ? 1 : -1) * w[1] * w[2] * v;
      g.y += (d[1] ? 1 : -1) * w[0] * w[2] * v;
      g.z += (d[2] ? 1 : -1) * w[0] * w[1] * v;
    }
    if (slope) {
      for (int a = 0; a < 3; ++a) g[a] /= values_.spacing_mm[a];
      *slope = values_.direction * g;
    }
    return sum;
  }

 private:
  grid::Grid<float> values_;
  grid::Lattice scan_;
};

/// Centres of the fluid, one in each cube of fluid_raster_mm.
std::vector<Vec3> fluid_points(const mask::BitMask* fluid) {
  std::vector<Vec3> points;
  if (!fluid) return points;
  const grid::Lattice& l = fluid->lattice();
  int step[3];
  for (int a = 0; a < 3; ++a) step[a] = std::max(1, int(std::lround(fluid_raster_mm / l.spacing_mm[a])));
  for (int k = step[2] / 2; k < l.size[2]; k += step[2])
    for (int j = step[1] / 2; j < l.size[1]; j += step[1])
      for (int i = step[0] / 2; i < l.size[0]; i += step[0])
        if (fluid->get(i, j, k)) points.push_back(l.to_world_mm({double(i), double(j), double(k)}));
  return points;
}

/// How far a place in the template is from any wide space of fluid; 0 within.
double off_fluid_mm(Vec3 p) {
  double d = 1e9;
  for (const Place place :
       {Place::lateral_left, Place::lateral_right, Place::third, Place::fourth, Place::quadrigeminal, Place::basal})
    d = std::min(d, place_mm(place, p));
  return std::max(0.0, d);
}

constexpr int unknowns = 9;
using Vector = std::array<double, unknowns>;

/// Rotations about the axes: pitch about x, roll about y, yaw about z.
struct Pose {
  Vec3 centre, turn, log_scale;
  Mat3 axes() const {
    const auto about = [](int axis, double angle, Vec3 v) {
      const int b = (axis + 1) % 3, c = (axis + 2) % 3;
      const double x = v[b], y = v[c];
      v[b] = std::cos(angle) * x - std::sin(angle) * y;
      v[c] = std::sin(angle) * x + std::cos(angle) * y;
      return v;
    };
    Mat3 m;
    for (Vec3& c : m.column) c = about(2, turn.z, about(1, turn.y, about(0, turn.x, c)));
    return m;
  }
  Vec3 scale() const { return {std::exp(log_scale.x), std::exp(log_scale.y), std::exp(log_scale.z)}; }
  Vec3 to_template(Vec3 lps_mm) const {
    const Vec3 v = transpose_times(axes(), lps_mm - centre), s = scale();
    return middle + Vec3{v.x / s.x, v.y / s.y, v.z / s.z};
  }
  Pose moved(const Vector& by, double share) const {
    Pose p = *this;
    for (int a = 0; a < 3; ++a) {
      p.centre[a] += share * by[a];
      p.turn[a] += share * by[3 + a];
      p.log_scale[a] += share * by[6 + a];
    }
    return p;
  }
};

/// For derivatives by differences: of mm, of radians and logarithms.
double step_of(int unknown) { return unknown < 3 ? 0.1 : 1e-3; }

/// Solves the symmetric system by elimination; the priors keep it positive definite.
Vector solved(std::array<Vector, unknowns> a, Vector b) {
  for (int i = 0; i < unknowns; ++i)
    for (int r = i + 1; r < unknowns; ++r) {
      const double f = a[r][i] / a[i][i];
      for (int c = i; c < unknowns; ++c) a[r][c] -= f * a[i][c];
      b[r] -= f * b[i];
    }
  for (int i = unknowns - 1; i >= 0; --i) {
    for (int c = i + 1; c < unknowns; ++c) b[i] -= a[i][c] * b[c];
    b[i] /= a[i][i];
  }
  return b;
}

/// How precisely each unknown is known beforehand (0: not at all).
Vector priors() {
  const auto of = [](double spread) { return 1 / (spread * spread); };
  const double pitch = of(pitch_deg * pi / 180), roll = of(roll_deg * pi / 180), yaw = of(yaw_deg * pi / 180);
  const double scale = of(scale_spread);
  return {0, 0, 0, pitch, roll, yaw, scale, scale, scale};
}

Vector state_of(const Pose& p) {
  return {0, 0, 0, p.turn.x, p.turn.y, p.turn.z, p.log_scale.x, p.log_scale.y, p.log_scale.z};
}

/// The cost of a pose: how badly the points fit (outliers count as the outlier's distance) and how unusual it is.
double cost_of(const Pose& pose, const std::vector<Sample>& points, const std::vector<Vec3>& fluid, const Distance& to,
               double outlier_mm) {
  const Mat3 m = pose.axes();
  const Vec3 s = pose.scale();
  double sum = 0, weights = 0, all = 0;
  for (const Sample& p : points) {
    all += p.weight;
    const Vec3 at = pose.centre + m * Vec3{s.x * p.at.x, s.y * p.at.y, s.z * p.at.z};
    if (!to.scanned(at)) continue;
    const double e = std::min(1.0, std::abs(to.at(at)) / outlier_mm), q = 1 - e * e;
    sum += p.weight * (1 - q * q * q) / 3;
    weights += p.weight;
  }
  // What is not scanned must not be a way out: it counts as badly as what fits a little.
  const double missing = 0.1 * (all - weights);
  double cost = independent * outlier_mm * outlier_mm / (error_mm * error_mm) * (sum + missing) / all;
  double off = 0;
  for (const Vec3 at : fluid) {
    const double e = std::min(1.0, off_fluid_mm(pose.to_template(at)) / fluid_outlier_mm), q = 1 - e * e;
    off += (1 - q * q * q) / 3;
  }
  if (!fluid.empty())
    cost += fluid_independent * fluid_outlier_mm * fluid_outlier_mm / (fluid_error_mm * fluid_error_mm) * off /
            double(fluid.size());
  const Vector prior = priors(), x = state_of(pose);
  for (int n = 0; n < unknowns; ++n) cost += prior[n] * x[n] * x[n];
  return cost;
}

Pose fitted(Pose pose, const std::vector<Sample>& points, const std::vector<Vec3>& fluid, const Distance& to,
            const Progress& progress) {
  const Vector prior = priors();
  for (int round = 0; round < rounds; ++round) {
    progress.check();
    const double outlier = std::max(
        last_outlier_mm, first_outlier_mm * std::pow(last_outlier_mm / first_outlier_mm, round / double(widening)));
    const Mat3 m = pose.axes();
    const Vec3 s = pose.scale();
    std::array<Vector, unknowns> a{};
    Vector b{};
    double weights = 0;
    for (const Sample& p : points) weights += p.weight;
    const double unit = independent / (error_mm * error_mm * weights);
    // Turning by a little more, by differences.
    std::array<Mat3, 3> turned;
    constexpr double little = 1e-4;
    for (int n = 0; n < 3; ++n) {
      Pose q = pose;
      q.turn[n] += little;
      turned[n] = q.axes();
    }
    for (const Sample& p : points) {
      const Vec3 local{s.x * p.at.x, s.y * p.at.y, s.z * p.at.z}, at = pose.centre + m * local;
      if (!to.scanned(at)) continue;
      Vec3 g;
      const double d = to.at(at, &g), e = d / outlier;
      if (std::abs(e) >= 1) continue;
      const double w = p.weight * unit * (1 - e * e) * (1 - e * e);
      Vector j{g.x, g.y, g.z};
      for (int n = 0; n < 3; ++n) {
        j[3 + n] = dot(g, (turned[n] * local - m * local) / little);
        j[6 + n] = dot(g, m.column[n]) * local[n];
      }
      for (int r = 0; r < unknowns; ++r) {
        b[r] -= w * j[r] * d;
        for (int c = 0; c < unknowns; ++c) a[r][c] += w * j[r] * j[c];
      }
    }
    // The fluid, by differences.
    std::array<Pose, unknowns> beside;
    for (int n = 0; n < unknowns; ++n) {
      Vector by{};
      by[n] = step_of(n);
      beside[n] = pose.moved(by, 1);
    }
    const double fluid_unit = fluid_independent / (fluid_error_mm * fluid_error_mm * double(fluid.size()));
    for (const Vec3 at : fluid) {
      const double d = off_fluid_mm(pose.to_template(at)), e = d / fluid_outlier_mm;
      if (e >= 1 || !(d > 0)) continue;
      const double w = fluid_unit * (1 - e * e) * (1 - e * e);
      Vector j;
      for (int n = 0; n < unknowns; ++n) j[n] = (off_fluid_mm(beside[n].to_template(at)) - d) / step_of(n);
      for (int r = 0; r < unknowns; ++r) {
        b[r] -= w * j[r] * d;
        for (int c = 0; c < unknowns; ++c) a[r][c] += w * j[r] * j[c];
      }
    }
    const Vector x = state_of(pose);
    for (int n = 0; n < unknowns; ++n) {
      a[n][n] += prior[n] + 1e-3;
      b[n] -= prior[n] * x[n];
    }
    const Vector step = solved(a, b);
    const double before = cost_of(pose, points, fluid, to, outlier);
    double share = 1;
    Pose next = pose.moved(step, share);
    while (share > 0.05 && cost_of(next, points, fluid, to, outlier) > before) next = pose.moved(step, share /= 2);
    if (!(share > 0.05)) {
      if (outlier <= last_outlier_mm) break;
      continue;
    }
    pose = next;
    if (outlier <= last_outlier_mm && before - cost_of(pose, points, fluid, to, outlier) < settled) break;
  }
  return pose;
}

}  // namespace

Vec3 HeadPlace::to_template(Vec3 lps_mm) const {
  const Vec3 v = transpose_times(axes, lps_mm - centre_mm);
  return middle + Vec3{v.x / scale.x, v.y / scale.y, v.z / scale.z};
}

Vec3 HeadPlace::to_lps(Vec3 t) const {
  const Vec3 v = t - middle;
  return centre_mm + axes * Vec3{v.x * scale.x, v.y * scale.y, v.z * scale.z};
}

HeadPlace place_head(const mask::BitMask& cavity, const mask::BitMask* fluid, const grid::Lattice& scan,
                     const Progress& progress) {
  HeadPlace found;
  if (!cavity.any()) return found;
  const std::vector<Sample> points = surface_points();
  const std::vector<Vec3> dark = fluid_points(fluid);
  const Distance to(cavity, scan, progress);
  const Vec3 centre = cavity.centre_mm();
  Pose best;
  double least = 1e300;
  for (const double degrees : start_pitch_deg) {
    Pose start;
    start.centre = centre;
    start.turn.x = degrees * pi / 180;
    const Pose pose = fitted(start, points, dark, to, progress);
    const double cost = cost_of(pose, points, dark, to, last_outlier_mm);
    if (cost < least) {
      least = cost;
      best = pose;
    }
  }
  found.centre_mm = best.centre;
  found.axes = best.axes();
  found.scale = best.scale();
  std::vector<float> off;
  double all = 0, scanned = 0, matched = 0;
  for (const Sample& p : points) {
    all += p.weight;
    const Vec3 at = found.to_lps(middle + p.at);
    if (!to.scanned(at)) continue;
    const double d = std::abs(to.at(at));
    scanned += p.weight;
    if (d <= fits_mm) matched += p.weight;
    off.push_back(float(d));
  }
  found.residual_mm = mask::median(off, 1e3f);
  found.scanned = scanned / all;
  found.matched = scanned > 0 ? matched / scanned : 0;
  found.sure = found.scanned >= min_scanned && found.matched >= min_matched;
  return found;
}

PlaceFigures figures_of(const HeadPlace& place) {
  return {place.residual_mm, place.matched, place.scanned,
          std::atan2(place.axes.column[1].z, place.axes.column[1].y) * 180 / pi};
}

Warnings warnings_of(const HeadPlace& place) {
  if (place.sure) return {};
  return {{"unsure_place",
           "the cranial cavity found is not of a head's shape, or less than half of it was scanned: ventricles and "
           "cisterns are distinguished by their place in the scan alone, which holds for straight heads",
           {}}};
}

}  // namespace trephine::place
