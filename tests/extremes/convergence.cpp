// SPDX-License-Identifier: GPL-3.0-or-later
// Results near an extreme converge to those away from it: series of one parameter, of which every step is held against
// the truth or against the result far from the extreme.
#include <algorithm>
#include <cmath>

#include "../report_of.h"
#include "boolean/cut_surface.h"
#include "boolean/cutter_use.h"
#include "meshing/contour.h"
#include "meshing/decimate.h"
#include "meshing/smooth.h"
#include "outcome.h"
#include "scenes.h"
#include "voxel/cut.h"
#include "voxel/voxelize.h"

namespace trephine::extremes {
namespace {

double ball_mm3(double r) { return 4 * M_PI / 3 * r * r * r; }

surface::TriMesh contoured(const grid::Field& field) {
  Report r;
  meshing::ContourParams p;
  p.min_component_mm3 = 0;
  return value_of(r, meshing::contour(field, p));
}

surface::TriMesh ball(const grid::Lattice& l, double radius_mm, Vec3 centre = {}) {
  return contoured(sampled(l, balls(radius_mm, centre).outer_mm));
}

struct Series {
  std::vector<double> at, values;
  std::string text() const {
    std::string all;
    for (std::size_t n = 0; n < at.size(); ++n)
      all += (n ? ", " : "") + rounded(at[n]) + ": " + rounded(std::round(values[n] * 1e3) / 1e3);
    return all;
  }
};

// Largest minus least.
double range_of(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end()) - *std::min_element(values.begin(), values.end());
}

std::string over_spacing() {
  Series s;
  for (const double mm : {0.05, 0.1, 0.5, 2.0, 10.0}) {
    s.at.push_back(mm);
    s.values.push_back(
        100 * (surface::volume_mm3(ball(cube({32, 32, 32}, {mm, mm, mm}), 12.3 * mm)) / ball_mm3(12.3 * mm) - 1));
  }
  if (range_of(s.values) > 0.01) return "FAULT: the voxel's size alone changes the shape: " + s.text();
  return "volume % off the truth at mm: " + s.text();
}

std::string over_anisotropy() {
  Series s;
  for (const double ratio : {1.0, 2.0, 5.0, 10.0, 20.0}) {
    s.at.push_back(ratio);
    const double z = 0.5 * ratio;
    const grid::Lattice l = cube({88, 88, int(44 / z) + 3}, {0.5, 0.5, z}, {0, 0, z / 3});
    s.values.push_back(100 * (surface::volume_mm3(ball(l, 20)) / ball_mm3(20) - 1));
  }
  for (std::size_t n = 1; n < s.values.size(); ++n)
    if (std::fabs(s.values[n]) < std::fabs(s.values[n - 1]) - 0.05) return "FAULT: does not converge: " + s.text();
  if (std::fabs(s.values.front()) > 0.5 || std::fabs(s.values.back()) > 10) return "FAULT: too far off: " + s.text();
  return "volume % off the truth at 1 : n: " + s.text();
}

Series beside(const grid::Field& field, double truth_mm3) {
  Series s;
  for (const double off : {-0.1, -0.01, -0.001, 0.0, 0.001, 0.01, 0.1}) {
    grid::Field f = field;
    for (float& v : f.voxels) v -= float(off);
    s.at.push_back(off);
    s.values.push_back(100 * (surface::volume_mm3(contoured(f)) / truth_mm3 - 1));
  }
  return s;
}

// Some voxels are exactly 0: nothing jumps.
std::string over_isovalue() {
  const Series s = beside(sampled(cube({33, 33, 33}, {1, 1, 1}), balls(13, {}).outer_mm), ball_mm3(13));
  for (std::size_t n = 1; n < s.values.size(); ++n)
    if (s.values[n] > s.values[n - 1]) return "FAULT: a higher isovalue gives a larger volume: " + s.text();
  if (std::fabs(s.values[2] - s.values[4]) > 0.1) return "FAULT: jumps: " + s.text();
  return "volume % off the truth's at isovalue: " + s.text();
}

// A shell of a voxel is 0 as a whole: it is outside, as it is at every isovalue above.
std::string over_whole_isovalue() {
  const grid::Field whole = sampled(cube({32, 32, 32}, {1, 1, 1}), [](Vec3 p) { return std::round(12.3 - norm(p)); });
  const Series s = beside(whole, ball_mm3(12.3));
  for (std::size_t n = 1; n < s.values.size(); ++n)
    if (s.values[n] > s.values[n - 1] + 1e-3) return "FAULT: a higher isovalue gives a larger volume: " + s.text();
  if (std::fabs(s.values[4] - s.values[3]) > 0.1) return "FAULT: a plateau is not outside: " + s.text();
  return "volume % off a ball's at isovalue: " + s.text();
}

std::string over_deviation() {
  Series s;
  const surface::TriMesh in = ball(cube({32, 32, 32}, {1, 1, 1}), 12.3);
  for (const double mm : {10.0, 1.0, 0.1, 0.01, 0.001}) {
    meshing::DecimateParams p;
    p.max_deviation_mm = mm;
    Report r;
    const surface::TriMesh out = value_of(r, meshing::decimate(in, p));
    if (std::get<double>(*r.find("deviation_max_mm")) > mm)
      return "FAULT: the bound of " + rounded(mm) + " mm is passed";
    s.at.push_back(mm);
    s.values.push_back(100 * (surface::volume_mm3(out) / surface::volume_mm3(in) - 1));
  }
  for (std::size_t n = 1; n < s.values.size(); ++n)
    if (std::fabs(s.values[n]) > std::fabs(s.values[n - 1]) + 0.05) return "FAULT: does not converge: " + s.text();
  if (std::fabs(s.values.back()) > 0.05) return "FAULT: not the input at 0.001 mm: " + s.text();
  return "volume % off the input at mm: " + s.text();
}

// RMS distance of the vertices from the sphere of that radius.
double off_sphere_mm(const surface::TriMesh& m, double radius_mm) {
  double sum = 0;
  for (const Vec3& p : m.points_mm) sum += (norm(p) - radius_mm) * (norm(p) - radius_mm);
  return std::sqrt(sum / double(m.points_mm.size()));
}

// A mask's staircase: smoothing takes it away, and then goes no further however long it goes on.
std::string over_iterations() {
  Series s;
  const auto steps = [](Vec3 p) { return norm(p) < 12.3 ? 0.5 : -0.5; };
  const surface::TriMesh in = contoured(sampled(cube({32, 32, 32}, {1, 1, 1}), steps));
  const double radius_mm = std::cbrt(surface::volume_mm3(in) / (4 * M_PI / 3));
  for (const int n : {0, 1, 10, 100, 1000, 10000}) {
    meshing::SmoothParams p;
    p.iterations_count = n;
    p.pass_band_ratio = 0.1;
    p.max_displacement_mm = 1;
    Report r;
    const surface::TriMesh out = value_of(r, meshing::smooth(in, p));
    s.at.push_back(n);
    s.values.push_back(off_sphere_mm(out, radius_mm));
    if (n > 0 && !(std::get<double>(*r.find("displacement_max_mm")) <= p.max_displacement_mm + 1e-9))
      return "FAULT: the bound is passed at " + rounded(n) + " iterations";
    if (std::fabs(surface::volume_mm3(out) / surface::volume_mm3(in) - 1) > 0.005)
      return "FAULT: the volume changes at " + rounded(n) + " iterations";
  }
  if (s.values.back() > 0.5 * s.values.front()) return "FAULT: the staircase stays: " + s.text();
  if (std::fabs(s.values[5] - s.values[4]) > 0.1 * s.values[4]) return "FAULT: does not converge: " + s.text();
  return "RMS mm off the sphere at iterations: " + s.text();
}

std::string over_distance() {
  Series s;
  for (const double m : {0.0, 1.0, 10.0, 100.0, 1000.0}) {
    const Vec3 at = Vec3{0.6, -0.64, 0.48} * (1000 * m);
    const surface::TriMesh surface = ball(cube({32, 32, 32}, {0.5, 0.5, 0.5}, at), 6, at);
    s.at.push_back(m);
    s.values.push_back(100 * (surface::volume_mm3(surface) / ball_mm3(6) - 1));
  }
  if (range_of(s.values) > 0.02) return "FAULT: depends on where it is: " + s.text();
  return "volume % off the truth at m: " + s.text();
}

std::string over_radius() {
  Series s;
  constexpr double R = 30;
  const surface::TriMesh in = ball(cube({64, 64, 64}, {1, 1, 1}), R);
  for (const double r : {0.05, 0.3, 1.0, 5.0, 20.0, 29.0}) {
    const boolean::Cutter c = drill({0, 0, 0}, r, 100);
    Report report;
    const double removed =
        surface::volume_mm3(in) - surface::volume_mm3(value_of(report, boolean::cut_surface(in, {c}, {})));
    s.at.push_back(r);
    s.values.push_back(100 * (removed / (ball_mm3(R) - ball_mm3(std::sqrt(R * R - r * r))) - 1));
  }
  for (const double off : s.values)
    if (std::fabs(off) > 3) return "FAULT: not the truth: " + s.text();
  return "removed % off the truth at mm: " + s.text();
}

std::string wider_than_the_body() {
  Report report;
  const surface::TriMesh left =
      value_of(report, boolean::cut_surface(ball(cube({64, 64, 64}, {1, 1, 1}), 30), {drill({0, 0, 0}, 40, 100)}, {}));
  return "FAULT: " + std::to_string(left.triangles.size()) + " triangles are left of nothing";
}

voxel::HapticVolume felt(const surface::TriMesh& in, double mm) {
  voxel::VoxelizeParams p;
  p.spacing_mm = {mm, mm, mm};
  surface::Bounds b = surface::bounds_of(in);
  for (int a = 0; a < 3; ++a) b.min_mm[a] -= 3 * mm, b.max_mm[a] += 3 * mm;
  Report r;
  return value_of(r, voxel::voxelize(voxel::haptic_lattice(b, grid::Lattice().direction, b.min_mm, p),
                                     {{"ball", &in, nullptr, 0}}));
}

std::string over_haptic_radius() {
  Series s;
  constexpr double R = 12.3;
  const voxel::HapticVolume whole = felt(ball(cube({32, 32, 32}, {1, 1, 1}), R), 0.5);
  const int number = whole.find_shape("ball")->number;
  for (const double r : {0.05, 0.25, 0.5, 1.0, 5.0, 12.0, 40.0}) {
    voxel::HapticVolume volume = whole;
    const boolean::Cutter c = drill({0, 0, 0}, r, 100);
    Report report;
    value_of(report, voxel::cut_volume(volume, boolean::distance_to(c), boolean::bounds_of(c), {number}));
    const double removed = voxel::shape_volume_mm3(whole, number) - voxel::shape_volume_mm3(volume, number);
    const double left_mm3 = r < R ? ball_mm3(std::sqrt(R * R - r * r)) : 0;
    s.at.push_back(r);
    s.values.push_back(100 * (removed / (ball_mm3(R) - left_mm3) - 1));
    // Less than a voxel's radius: not held, and said.
    if (boolean::thin_cutter(c, volume.voxels.spacing_mm).has_value() != (r < 0.5))
      return "FAULT: warns at the wrong radius, " + rounded(r) + " mm";
    if (r >= 0.5 && std::fabs(s.values.back()) > 3) return "FAULT: not the truth: " + s.text();
    if (removed < 0) return "FAULT: grows: " + s.text();
  }
  return "removed % off the truth at mm: " + s.text() + "; warns below the size of a voxel";
}

std::string over_haptic_spacing() {
  Series s;
  const surface::TriMesh in = ball(cube({32, 32, 32}, {1, 1, 1}), 12.3);
  for (const double mm : {10.0, 5.0, 2.0, 1.0, 0.5, 0.25}) {
    const voxel::HapticVolume v = felt(in, mm);
    s.at.push_back(mm);
    s.values.push_back(100 * (voxel::shape_volume_mm3(v, v.find_shape("ball")->number) / surface::volume_mm3(in) - 1));
  }
  if (std::fabs(s.values.back()) > 0.2 || std::fabs(s.values[3]) > 1) return "FAULT: does not converge: " + s.text();
  return "volume % off the surface's at mm: " + s.text();
}

}  // namespace

std::vector<Section> convergence_sections() {
  return {{"convergence", "Convergence", "Spheres whose truth is known, along one parameter towards its end.", [] {
             return std::vector<Case>{
                 {"contour: voxels of 0.05 to 10 mm, a sphere of 12.3 voxels' radius", over_spacing},
                 {"contour: voxels of 1 : 1 to 1 : 20, a sphere of 20 mm, 0.5 mm in the slice", over_anisotropy},
                 {"contour: isovalues beside and on the values of some voxels", over_isovalue},
                 {"contour: the same of whole numbers, where a shell of a voxel is 0", over_whole_isovalue},
                 {"contour: 0 to 1 km from the frame's origin", over_distance},
                 {"decimate: max_deviation_mm from 10 to 0.001", over_deviation},
                 {"smooth: 0 to 10,000 iterations, pass band 0.1, 1 mm at most, a mask's staircase", over_iterations},
                 {"boolean: drills of 0.05 to 29 mm radius through a sphere of 30 mm", over_radius},
                 {"boolean: a drill of 40 mm radius, wider than the sphere", wider_than_the_body},
                 {"haptic volume, voxels of 0.5 mm: drills of 0.05 to 40 mm radius through a sphere of 12.3 mm",
                  over_haptic_radius},
                 {"voxelize: voxels of 10 to 0.25 mm, a sphere of 12.3 mm", over_haptic_spacing},
             };
           }}};
}

}  // namespace trephine::extremes
