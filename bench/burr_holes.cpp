// SPDX-License-Identifier: GPL-3.0-or-later
// Burr holes at random places of a skull: bench_burr_holes SKULL.vtp [holes [diameter_mm [first]]]. Each is cut out of
// the whole surface, where a ray from outside towards the middle first meets it, square to the surface there, until it
// is through the bone. Prints how many came out valid or were refused (80), and how long a cut takes (wall clock, so
// run it on an idle machine).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "base/child.h"
#include "base/error.h"
#include "boolean/cut_surface.h"
#include "meshing/validity.h"
#include "meshio/vtp.h"

using namespace trephine;

namespace {

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// In [0, 1): SplitMix64 of the number.
double random_of(std::uint64_t n) {
  std::uint64_t z = n * 0x9e3779b97f4a7c15ull + 0x1234567;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return double((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

/// Where the ray first meets the surface beyond `after`; Moeller and Trumbore.
double first_hit(const TriMesh& m, Vec3 from, Vec3 along, double after) {
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
Vec3 mean_normal(const TriMesh& m, Vec3 at, Vec3 outwards, double radius) {
  Vec3 sum;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    const auto& v = m.triangles[t];
    const Vec3 n = triangle_normal(m, t);
    if (dot(n, outwards) > 0 && norm((m.world_mm(v[0]) + m.world_mm(v[1]) + m.world_mm(v[2])) / 3 - at) < radius)
      sum += n;
  }
  return sum == Vec3{} ? outwards : normalized(sum);
}

Cutter hole_at(const TriMesh& m, std::uint64_t number, double radius) {
  const Bounds b = bounds_of(m);
  const Vec3 middle = (b.min_mm + b.max_mm) / 2;
  for (std::uint64_t k = 0;; ++k) {
    const double z = 2 * random_of(number * 1000 + 2 * k) - 1,
                 a = 6.283185307179586 * random_of(number * 1000 + 2 * k + 1);
    const Vec3 out{std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z};
    const Vec3 start = middle + out * 500;
    const double d = first_hit(m, start, -out, 0);
    if (!(d < 450)) continue;
    Cutter c;
    c.position_mm = start - out * d;
    c.direction = -mean_normal(m, c.position_mm, out, radius);
    c.radius_mm = radius;
    const double through = first_hit(m, c.position_mm, c.direction, 0.01);
    c.depth_mm = std::min(30.0, (std::isfinite(through) ? through : 10.0) + 3);
    return c;
  }
}

}  // namespace

int main(int argc, char** argv) try {
  run_child_if_asked(argc, argv);
  if (argc < 2) return std::fprintf(stderr, "bench_burr_holes SKULL.vtp [holes [diameter_mm [first]]]\n"), 64;
  const TriMesh skull = read_vtp(argv[1]);
  const int holes = argc > 2 ? std::atoi(argv[2]) : 100, first = argc > 4 ? std::atoi(argv[4]) : 0;
  const double radius = (argc > 3 ? std::atof(argv[3]) : 14) / 2;
  int valid = 0, invalid = 0, refused = 0, again = 0, narrow = 0;
  double moved = 0, worst = 0, least_free = 1e9;
  std::vector<double> times;
  for (int i = first; i < first + holes; ++i) {
    const Cutter c = hole_at(skull, std::uint64_t(i), radius);
    const double start = seconds();
    try {
      Report r;
      const TriMesh out = cut_surface(skull, {c}, {}, r);
      times.push_back(seconds() - start);
      const Validity v = check_validity(out);
      (v.valid() && v.float32 ? valid : invalid)++;
      if (!v.valid()) std::printf("hole %d: INVALID: %s\n", i, v.text().c_str());
      const double removed = std::get<double>(*r.find("cutter_1.removed_mm3"));
      const double expected = std::get<double>(*r.find("cutter_1.removed_expected_mm3"));
      worst = std::max(worst, std::abs(removed - expected) / std::max(expected, 50.0));
      again += std::get<std::int64_t>(*r.find("tries_count")) > 1;
      moved = std::max(moved, std::get<double>(*r.find("moved_mm")));
      const double free = free_radius_mm(out, c);
      least_free = std::min(least_free, free);
      if (free < radius - 0.5) {
        ++narrow;
        std::printf("hole %d: a probe of %.3f mm passes\n", i, free);
      }
    } catch (const Error& e) {
      ++refused;
      times.push_back(seconds() - start);
      std::printf("hole %d: refused (%d): %s\n", i, int(e.code()), e.line("").c_str());
    }
    std::fflush(stdout);
  }
  std::sort(times.begin(), times.end());
  std::printf(
      "%d holes in %zu triangles: %d valid, %d invalid, %d refused; %d needed another try, moved at most %.4f mm; "
      "volume "
      "off by %.4f %% at most; least free radius %.3f mm, %d too narrow; %.2f s a cut (median), %.2f s at most\n",
      holes, skull.triangles.size(), valid, invalid, refused, again, moved, 100 * worst, least_free, narrow,
      times[times.size() / 2], times.back());
  return invalid == 0 ? 0 : 1;
} catch (const Error& e) {
  std::fprintf(stderr, "%s\n", e.line("bench_burr_holes").c_str());
  return static_cast<int>(e.code());
}
