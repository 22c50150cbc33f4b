// SPDX-License-Identifier: GPL-3.0-or-later
// Burr holes at random places of a skull: bench_burr_holes SKULL.vtp [holes [diameter_mm [first [FIELD.nrrd]]]]. Each
// is cut out of the whole surface, where a ray from outside towards the middle first meets it, square to the surface
// there, until it is through the bone. Prints how many came out valid or were refused (80), and how long a cut takes
// (wall clock, so run it on an idle machine).
//
// With the skull's field the holes are cut out of patches: the field around the hole, contoured. They are 0.3 to 1.4
// times as wide as diameter_mm, tilted by up to 30 degrees; of a hundred 15 are ellipsoids, and 15 are two overlapping
// cylinders and an ellipsoid at once. Every tenth is also cut out of the patch's field before contouring, and the two
// results are compared.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "../tests/report_of.h"
#include "base/child.h"
#include "base/error.h"
#include "base/pi.h"
#include "base/splitmix64.h"
#include "boolean/cut_surface.h"
#include "grid/nrrd.h"
#include "meshing/contour.h"
#include "meshing/validity.h"
#include "meshio/vtp.h"
#include "metrics/deviation.h"
#include "voxel/cut.h"

using namespace trephine;

namespace {

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// In [0, 1): of the number.
double random_of(std::uint64_t n) { return unit_of_bits(splitmix64_mixed(n * splitmix64_step + 0x1234567)); }

/// Where the ray first meets the surface beyond `after`; Moeller and Trumbore.
double first_hit(const surface::TriMesh& m, Vec3 from, Vec3 along, double after) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& t : m.triangles) {
    const Vec3 a = m.world_mm(t[0]), u = m.world_mm(t[1]) - a, v = m.world_mm(t[2]) - a;
    const Vec3 p = cross(along, v);
    const double det = dot(u, p);
    if (det == 0) continue;
    const Vec3 s = from - a, q = cross(s, u);
    const double x = dot(s, p) / det, y = dot(along, q) / det, d = dot(v, q) / det;
    if (x >= 0 && y >= 0 && x + y <= 1 && d > after) nearest = std::min(nearest, d);
  }
  return nearest;
}

/// Of what looks outwards within the radius.
Vec3 mean_normal(const surface::TriMesh& m, Vec3 at, Vec3 outwards, double radius) {
  Vec3 sum;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const auto& v = m.triangles[t];
    const Vec3 n = surface::triangle_normal(m, t);
    if (dot(n, outwards) > 0 && norm((m.world_mm(v[0]) + m.world_mm(v[1]) + m.world_mm(v[2])) / 3 - at) < radius)
      sum += n;
  }
  return sum == Vec3{} ? outwards : normalized(sum);
}

boolean::Cutter hole_at(const surface::TriMesh& m, std::uint64_t number, double radius) {
  const surface::Bounds b = surface::bounds_of(m);
  const Vec3 middle = (b.min_mm + b.max_mm) / 2;
  for (std::uint64_t k = 0;; ++k) {
    const double z = 2 * random_of(number * 1000 + 2 * k) - 1, a = 2 * pi * random_of(number * 1000 + 2 * k + 1);
    const Vec3 out{std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z};
    const Vec3 start = middle + out * 500;
    const double d = first_hit(m, start, -out, 0);
    if (!(d < 450)) continue;
    boolean::Cutter c;
    c.position_mm = start - out * d;
    c.direction = -mean_normal(m, c.position_mm, out, radius);
    c.radius_mm = radius;
    const double through = first_hit(m, c.position_mm, c.direction, 0.01);
    c.depth_mm = std::min(30.0, (std::isfinite(through) ? through : 10.0) + 3);
    return c;
  }
}

/// The hole of that number in many shapes: see above.
std::vector<boolean::Cutter> many(boolean::Cutter c, std::uint64_t number) {
  const auto u = [&](int n) { return random_of(number * 977 + 31 * n + 500000000); };
  c.radius_mm *= 0.3 + 1.1 * u(0);
  const double z = 2 * u(1) - 1, a = 2 * pi * u(2), s = std::sqrt(1 - z * z);
  const Vec3 aside = Vec3{s * std::cos(a), s * std::sin(a), z};
  c.direction = normalized(c.direction + aside * (0.55 * u(3)));
  boolean::Cutter e;
  e.kind = boolean::Cutter::Kind::ellipsoid;
  e.position_mm = c.position_mm;
  e.direction = c.direction;
  e.across = normalized(cross(c.direction, std::abs(c.direction.x) < 0.7 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  e.radii_mm = {c.radius_mm * (0.8 + u(4)), c.radius_mm, c.radius_mm * (0.6 + u(5))};
  if (u(6) < 0.15) return {e};
  if (u(6) > 0.3) return {c};
  boolean::Cutter d = c;
  d.position_mm += e.across * (c.radius_mm * (0.3 + 1.4 * u(7)));
  e.position_mm -= e.across * (c.radius_mm * 1.2 * u(8));
  return {c, d, e};
}

/// The field around the cutters.
grid::Field patch_around(const grid::Field& field, const std::vector<boolean::Cutter>& cutters) {
  grid::Box box{field.size, {0, 0, 0}};
  for (const boolean::Cutter& c : cutters) {
    const surface::Bounds b = boolean::bounds_of(c);
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 p = field.to_index({corner & 1 ? b.max_mm.x : b.min_mm.x, corner & 2 ? b.max_mm.y : b.min_mm.y,
                                     corner & 4 ? b.max_mm.z : b.min_mm.z});
      for (int a = 0; a < 3; ++a) {
        const int margin = int(std::ceil(4 / field.spacing_mm[a]));
        box.begin[a] = std::max(0, std::min(box.begin[a], int(std::floor(p[a])) - margin));
        box.end[a] = std::min(field.size[a], std::max(box.end[a], int(std::ceil(p[a])) + 1 + margin));
      }
    }
  }
  return grid::crop(field, box);
}

/// Cut in the field, then contoured, against what was cut out of the mesh.
struct Comparison {
  int holes = 0;
  double worst_volume = 0, volume = 0, worst_max = 0, max = 0, rms = 0, more_triangles = 0, field_s = 0, mesh_s = 0;

  void add(grid::Field patch, const surface::TriMesh& whole, const surface::TriMesh& cut,
           const std::vector<boolean::Cutter>& cutters, double cut_s) {
    const double start = seconds();
    for (const boolean::Cutter& c : cutters)
      voxel::cut_field(patch, boolean::distance_to(c), boolean::bounds_of(c)).value;
    surface::TriMesh other;
    try {
      other = meshing::contour(patch, {}).value;
    } catch (const Error&) {
      return;  // nothing is left
    }
    field_s += seconds() - start;
    mesh_s += cut_s;
    const double removed = surface::volume_mm3(whole) - surface::volume_mm3(cut),
                 of_field = surface::volume_mm3(whole) - surface::volume_mm3(other);
    metrics::DeviationParams samples;
    samples.sample_count = 20000;
    const metrics::Deviation d = metrics::measure_deviation(other, cut, samples);
    ++holes;
    const double off = std::abs(of_field - removed) / std::max(removed, 50.0);
    worst_volume = std::max(worst_volume, off);
    volume += off;
    worst_max = std::max(worst_max, d.both.max_mm);
    max += d.both.max_mm;
    rms += d.both.rms_mm;
    more_triangles += double(other.triangles.size()) / double(cut.triangles.size());
  }
  void print() const {
    if (holes == 0) return;
    std::printf(
        "%d holes cut in the field before contouring, against the mesh: removed volume off by %.2f %% (mean; %.2f %% "
        "at "
        "most), deviation max %.3f mm (mean; %.3f at most), RMS %.4f mm (mean), %.2f times the triangles, %.3f s "
        "(mesh %.3f s, without its contour)\n",
        holes, 100 * volume / holes, 100 * worst_volume, max / holes, worst_max, rms / holes, more_triangles / holes,
        field_s / holes, mesh_s / holes);
  }
};

}  // namespace

int main(int argc, char** argv) try {
  run_child_if_asked(argc, argv);
  if (argc < 2)
    return std::fprintf(stderr, "bench_burr_holes SKULL.vtp [holes [diameter_mm [first [FIELD.nrrd]]]]\n"), 64;
  const surface::TriMesh skull = meshio::read_vtp(argv[1]);
  const bool patches = argc > 5;
  grid::Field field;
  if (patches) field = grid::read_field_nrrd(argv[5]);
  Comparison comparison;
  const int holes = argc > 2 ? std::atoi(argv[2]) : 100, first = argc > 4 ? std::atoi(argv[4]) : 0;
  const double radius = (argc > 3 ? std::atof(argv[3]) : 14) / 2;
  int valid = 0, invalid = 0, refused = 0, over_limit = 0, empty = 0, again = 0, narrow = 0;
  double triangles = 0, moved = 0, worst = 0, min_free = 1e9;
  std::vector<double> times;
  for (int i = first; i < first + holes; ++i) {
    boolean::Cutter c = hole_at(skull, std::uint64_t(i), radius);
    std::vector<boolean::Cutter> cutters{c};
    surface::TriMesh around;
    grid::Field patch;
    if (patches) {
      cutters = many(c, std::uint64_t(i));
      c = cutters.front();
      patch = patch_around(field, cutters);
      try {
        around = meshing::contour(patch, {}).value;
      } catch (const Error& e) {
        std::printf("hole %d: no patch: %s\n", i, e.line("").c_str());
        ++empty;
        continue;
      }
    }
    const surface::TriMesh& whole = patches ? around : skull;
    triangles += double(whole.triangles.size());
    const double start = seconds();
    try {
      Report r;
      const surface::TriMesh out = value_of(r, boolean::cut_surface(whole, cutters, {}));
      times.push_back(seconds() - start);
      const meshing::Validity v = meshing::check_validity(out);
      (v.valid() && v.float32 ? valid : invalid)++;
      if (!v.valid()) std::printf("hole %d: INVALID: %s\n", i, v.text().c_str());
      for (std::size_t n = 0; n < cutters.size(); ++n) {
        const std::string name = "cutter_" + std::to_string(n + 1);
        const double removed = std::get<double>(*r.find(name + ".removed_mm3"));
        const double expected = std::get<double>(*r.find(name + ".removed_expected_mm3"));
        worst = std::max(worst, std::abs(removed - expected) / std::max(expected, 50.0));
      }
      again += std::get<std::int64_t>(*r.find("tries_count")) > std::int64_t(cutters.size());
      moved = std::max(moved, std::get<double>(*r.find("moved_mm")));
      const double free = boolean::free_radius_mm(out, c);
      if (c.kind == boolean::Cutter::Kind::cylinder) {
        min_free = std::min(min_free, free - c.radius_mm);
        if (free < c.radius_mm - 0.5) {
          ++narrow;
          std::printf("hole %d: a probe of %.3f mm passes, not %.3f\n", i, free, c.radius_mm);
        }
      }
      if (patches && i % 10 == 0) comparison.add(patch, whole, out, cutters, times.back());
    } catch (const Error& e) {
      ++refused;
      over_limit += e.code() == ExitCode::internal;
      times.push_back(seconds() - start);
      std::printf("hole %d: refused (%d): %s\n", i, int(e.code()), e.line("").c_str());
    }
    std::fflush(stdout);
    if ((i + 1 - first) % 100 == 0) std::printf("%d done, %d valid, %d refused\n", i + 1 - first, valid, refused);
  }
  std::sort(times.begin(), times.end());
  if (times.empty()) return 1;
  std::printf(
      "%d holes in %.0f triangles each (mean): %d valid, %d invalid, %d refused (%d of them over the time limit), %d "
      "without bone; %d needed another try, moved at most %.4f mm; volume off by %.4f %% at most; least free radius "
      "%.3f mm below the cutter's, %d too narrow; %.2f s a cut (median), %.2f s at most\n",
      holes, triangles / double(times.size()), valid, invalid, refused, over_limit, empty, again, moved, 100 * worst,
      -min_free, narrow, times[times.size() / 2], times.back());
  comparison.print();
  return invalid == 0 ? 0 : 1;
} catch (const Error& e) {
  std::fprintf(stderr, "%s\n", e.line("bench_burr_holes").c_str());
  return static_cast<int>(e.code());
}
