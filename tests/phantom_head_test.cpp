// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "base/error.h"
#include "phantom/head.h"
#include "phantom/measure_truth.h"
#include "phantom/random.h"
#include "phantom/truth.h"

using namespace trephine;
using namespace trephine::phantom;

namespace {

phantom::HeadParams head_params(phantom::Variant variant, phantom::Level level = phantom::Level::simple,
                                std::int64_t seed = 1) {
  phantom::HeadParams p;
  p.variant = variant;
  p.level = level;
  p.seed = seed;
  return p;
}

double segment_distance(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 d = b - a;
  const double t = std::clamp(dot(p - a, d) / std::max(1e-30, dot(d, d)), 0.0, 1.0);
  return norm(p - a - d * t);
}

/// By the triangle's plane where the foot lies within, else by its edges.
double triangle_distance(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 n = cross(b - a, c - a);
  const double nn = dot(n, n);
  if (nn > 1e-30) {
    const Vec3 q = p - n * (dot(p - a, n) / nn);
    if (dot(cross(b - a, q - a), n) >= 0 && dot(cross(c - b, q - b), n) >= 0 && dot(cross(a - c, q - c), n) >= 0)
      return norm(p - q);
  }
  return std::min({segment_distance(p, a, b), segment_distance(p, b, c), segment_distance(p, c, a)});
}

double brute_force_distance(const surface::TriMesh& mesh, Vec3 p) {
  double best = 1e300;
  for (const auto& t : mesh.triangles)
    best = std::min(best, triangle_distance(p, mesh.points_mm[t[0]], mesh.points_mm[t[1]], mesh.points_mm[t[2]]));
  return best;
}

/// Points on the surface, spread over it: where rays from `from` in random directions cross it last within 150 mm.
std::vector<Vec3> surface_points(const phantom::Head& head, phantom::Anatomy anatomy, Vec3 from, int count) {
  std::vector<Vec3> out;
  for (int i = 0; static_cast<int>(out.size()) < count && i < 50 * count; ++i) {
    const Vec3 u{phantom::uniform(5, 1, 3 * i), phantom::uniform(5, 1, 3 * i + 1), phantom::uniform(5, 1, 3 * i + 2)};
    if (norm(u) > 1 || norm(u) < 0.1) continue;
    const Vec3 d = normalized(u);
    for (double t = 150; t > 1; t -= 0.5) {
      if (!(head.implicit_mm(anatomy, from + d * t) < 0)) continue;
      double in = t, outside = t + 0.5;
      for (int b = 0; b < 50; ++b)
        (head.implicit_mm(anatomy, from + d * (0.5 * (in + outside))) < 0 ? in : outside) = 0.5 * (in + outside);
      out.push_back(from + d * in);
      break;
    }
  }
  return out;
}

Vec3 middle_of(const phantom::Head& head, phantom::Anatomy anatomy) {
  return anatomy == phantom::Anatomy::ventricles
             ? (head.landmark("monro_left") + head.landmark("monro_right")) * 0.5 + Vec3{0, 4, -4}
             : Vec3{0, 0, 40};
}

}  // namespace

// Distances agree with brute force over a fine local mesh of the zero set.
TEST(PhantomHead, SignedDistanceAgreesWithBruteForce) {
  const phantom::Head head(head_params(phantom::Variant::normal));
  for (const phantom::Anatomy anatomy : phantom::all_anatomies) {
    std::vector<double> errors;
    for (const Vec3& s : surface_points(head, anatomy, middle_of(head, anatomy), 8)) {
      surface::Bounds box;
      for (int a = 0; a < 3; ++a) box.min_mm[a] = s[a] - 12, box.max_mm[a] = s[a] + 12;
      const surface::TriMesh mesh = phantom::truth_mesh(head, anatomy, box, 0.5);
      for (int i = 0; i < 25; ++i) {
        const Vec3 p = s + Vec3{phantom::uniform(6, 2, 3 * i), phantom::uniform(6, 2, 3 * i + 1),
                                phantom::uniform(6, 2, 3 * i + 2)} *
                               4.0;
        const double brute = brute_force_distance(mesh, p), found = head.signed_distance_mm(anatomy, p);
        if (brute > 6) continue;
        EXPECT_EQ(found < 0, head.implicit_mm(anatomy, p) < 0);
        errors.push_back(std::fabs(std::fabs(found) - brute));
      }
    }
    std::sort(errors.begin(), errors.end());
    ASSERT_GT(errors.size(), 100u);
    std::printf("%s: median %.4f p95 %.4f p99 %.4f max %.4f mm of %zu\n", phantom::name_of(anatomy),
                errors[errors.size() / 2], errors[errors.size() * 95 / 100], errors[errors.size() * 99 / 100],
                errors.back(), errors.size());
    EXPECT_LT(errors[errors.size() / 2], 0.005) << phantom::name_of(anatomy);
    EXPECT_LT(errors[errors.size() * 95 / 100], 0.02) << phantom::name_of(anatomy);
    EXPECT_LT(errors[errors.size() * 99 / 100], 0.1) << phantom::name_of(anatomy);
  }
}

// The implicit function is a distance to first order at its zero set, and its gradient is its own.
TEST(PhantomHead, GradientIsNearOneAndRight) {
  const phantom::Head head(head_params(phantom::Variant::normal));
  for (const phantom::Anatomy anatomy : phantom::all_anatomies) {
    int far_from_one = 0, count = 0;
    for (const Vec3& s : surface_points(head, anatomy, middle_of(head, anatomy), 200)) {
      Vec3 g;
      head.implicit_mm(anatomy, s, g);
      far_from_one += std::fabs(norm(g) - 1) > 0.25;
      EXPECT_GT(norm(g), 0.3);
      EXPECT_LT(norm(g), 1.5);
      ++count;
      const Vec3 n = normalized(g);
      const double h = 1e-4;
      const double slope = (head.implicit_mm(anatomy, s + n * h) - head.implicit_mm(anatomy, s - n * h)) / (2 * h);
      EXPECT_NEAR(slope, norm(g), 1e-3);
    }
    ASSERT_GE(count, 150);
    EXPECT_LE(far_from_one, count / 10) << phantom::name_of(anatomy);
  }
}

// Each shape lies within the next one, with room between them, in every variant.
TEST(PhantomHead, ShapesAreNested) {
  for (const phantom::Variant v :
       {phantom::Variant::normal, phantom::Variant::hydrocephalic, phantom::Variant::shifted, phantom::Variant::small})
    for (const phantom::Level level : {phantom::Level::simple, phantom::Level::clinical}) {
      const phantom::Head head(head_params(v, level, 3));
      for (const Vec3& p : surface_points(head, phantom::Anatomy::skull, {0, 0, 40}, 150))
        EXPECT_LT(head.signed_distance_mm(phantom::Anatomy::skin, p), -2.0);
      for (const Vec3& p : surface_points(head, phantom::Anatomy::brain, {0, 0, 50}, 150)) {
        if (p.z < -15) continue;  // the cord leaves through the foramen magnum
        EXPECT_GT(head.implicit_mm(phantom::Anatomy::skull, p), 0.7);
        EXPECT_LT(head.implicit_mm(phantom::Anatomy::skin, p), -8);
      }
      for (const Vec3& p :
           surface_points(head, phantom::Anatomy::ventricles, middle_of(head, phantom::Anatomy::ventricles), 150))
        EXPECT_LT(head.implicit_mm(phantom::Anatomy::brain, p), -1.0) << p.x << " " << p.y << " " << p.z;
    }
}

TEST(PhantomHead, VolumesArePlausible) {
  surface::Bounds box;
  box.min_mm = {-110, -130, -60};
  box.max_mm = {110, 110, 140};
  const auto ml = [&](const phantom::Head& head, phantom::Anatomy a, double step) {
    return surface::volume_mm3(phantom::truth_mesh(head, a, box, step)) / 1000;
  };
  for (const std::int64_t seed : {1, 2, 3}) {
    const phantom::Head head(head_params(phantom::Variant::normal, phantom::Level::simple, seed));
    const double skin = ml(head, phantom::Anatomy::skin, 4), skull = ml(head, phantom::Anatomy::skull, 2),
                 brain = ml(head, phantom::Anatomy::brain, 4), ventricles = ml(head, phantom::Anatomy::ventricles, 1.5);
    std::printf("seed %d: skin %.0f skull %.0f brain %.0f ventricles %.1f ml\n", static_cast<int>(seed), skin, skull,
                brain, ventricles);
    EXPECT_GT(skin, 2900);
    EXPECT_LT(skin, 4300);
    EXPECT_GT(skull, 450);
    EXPECT_LT(skull, 900);
    EXPECT_GT(brain, 1100);
    EXPECT_LT(brain, 1550);
    EXPECT_GT(ventricles, 14);
    EXPECT_LT(ventricles, 28);
  }
  EXPECT_GT(ml(phantom::Head(head_params(phantom::Variant::hydrocephalic)), phantom::Anatomy::ventricles, 1.5), 75);
  const double small = ml(phantom::Head(head_params(phantom::Variant::small)), phantom::Anatomy::ventricles, 1.0);
  EXPECT_GT(small, 5);
  EXPECT_LT(small, 11);
}

// Closed, manifold, one piece; the ventricles are joined by the foramina of Monro (the genus counts the loop: both
// foramina lead from one lateral ventricle to the other only through the third, so there is none).
TEST(PhantomHead, TruthMeshesAreValid) {
  surface::Bounds box;
  box.min_mm = {-110, -130, -50};
  box.max_mm = {110, 110, 140};
  for (const phantom::Variant v : {phantom::Variant::normal, phantom::Variant::hydrocephalic, phantom::Variant::shifted,
                                   phantom::Variant::small}) {
    const phantom::Head head(head_params(v));
    for (const phantom::Anatomy a : phantom::all_anatomies) {
      if (v != phantom::Variant::normal && a != phantom::Anatomy::ventricles) continue;
      const surface::TriMesh mesh = phantom::truth_mesh(head, a, box, a == phantom::Anatomy::ventricles ? 0.8 : 2.0);
      const surface::Topology t = surface::topology_of(mesh);
      EXPECT_TRUE(t.closed() && t.manifold()) << phantom::name_of(a);
      EXPECT_GT(surface::volume_mm3(mesh), 0) << phantom::name_of(a);
      if (a != phantom::Anatomy::skull) {
        EXPECT_EQ(t.components, 1) << phantom::name_of(a);
      }
      if (a == phantom::Anatomy::ventricles) {
        EXPECT_EQ(t.genus, 0);
      }
      int off = 0, points = 0;
      for (std::size_t i = 0; i < mesh.points_mm.size(); i += 7) {
        const Vec3 p = mesh.world_mm(i);
        const double wall = std::min({p.z - box.min_mm.z, box.max_mm.z - p.z});
        if (wall < 3) continue;  // caps
        ++points;
        off += std::fabs(head.implicit_mm(a, p)) > 1e-5;
      }
      EXPECT_LT(off, 1 + points / 500) << phantom::name_of(a);
    }
  }
}

TEST(PhantomHead, TissuesHaveTheirHu) {
  const phantom::Head head(head_params(phantom::Variant::normal));
  EXPECT_DOUBLE_EQ(head.hu({0, -200, 0}), -1000);
  EXPECT_DOUBLE_EQ(head.hu({0, 20, 100}), 29);                // white matter
  EXPECT_DOUBLE_EQ(head.hu(head.landmark("monro_left")), 8);  // ventricle
  // Through the vault, from outside: skin, fat, galea, outer table, diploe, inner table, CSF, grey, white.
  const Vec3 d = normalized(Vec3{0.5, 0.25, 0.6});
  std::vector<double> seen;
  for (double t = 140; t > 0; t -= 0.1) {
    const double hu = head.hu(Vec3{0, 0, 50} + d * t);
    if (seen.empty() || seen.back() != hu) seen.push_back(hu);
  }
  const std::vector<double> layers{-1000, 40, -90, 55, 1400, 550, 1400, 8, 37, 29};
  ASSERT_GE(seen.size(), layers.size());
  for (std::size_t i = 0; i < layers.size(); ++i) EXPECT_DOUBLE_EQ(seen[i], layers[i]) << i;
}

// CSF leads from the third ventricle through aqueduct, fourth ventricle and Magendie's foramen to the cisterna magna: a
// flood of voxels of pure CSF from the middle of a foramen of Monro gets there, in a box too small for another way.
TEST(PhantomHead, VentriclesAreOpenToTheCisterns) {
  for (const phantom::Variant v : {phantom::Variant::normal, phantom::Variant::hydrocephalic, phantom::Variant::shifted,
                                   phantom::Variant::small}) {
    const phantom::Head head(head_params(v));
    const Vec3 low{-14, -25, -20};
    const int nx = 41, ny = 125, nz = 120;  // 0.67 mm
    const auto at = [&](int i, int j, int k) { return low + Vec3{1.0 * i, 1.0 * j, 1.0 * k} * 0.67; };
    std::vector<char> open(static_cast<std::size_t>(nx) * ny * nz);
    const auto index = [&](int i, int j, int k) { return (static_cast<std::size_t>(k) * ny + j) * nx + i; };
    for (int k = 0; k < nz; ++k)
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) open[index(i, j, k)] = head.hu(at(i, j, k)) == 8;
    const Vec3 seed = (head.landmark("monro_left") - low) / 0.67;
    std::vector<std::array<int, 3>> front{
        {int(std::lround(seed.x)), int(std::lround(seed.y)), int(std::lround(seed.z))}};
    bool arrived = false;
    while (!front.empty()) {
      const auto [i, j, k] = front.back();
      front.pop_back();
      if (i < 0 || j < 0 || k < 0 || i >= nx || j >= ny || k >= nz || !open[index(i, j, k)]) continue;
      open[index(i, j, k)] = 0;
      const Vec3 p = at(i, j, k);
      arrived = arrived || (p.y > 46 && p.z < -8);
      for (int n = 0; n < 27; ++n) front.push_back({i + n % 3 - 1, j + n / 3 % 3 - 1, k + n / 9 - 1});
    }
    EXPECT_TRUE(arrived) << static_cast<int>(v);
  }
}

// What the scanner relies on to skip blocks: nothing changes within the clearance.
TEST(PhantomHead, ClearanceIsALowerBound) {
  for (const phantom::Level level : {phantom::Level::simple, phantom::Level::clinical}) {
    const phantom::Head head(head_params(phantom::Variant::normal, level));
    int tried = 0;
    for (int i = 0; i < 60000; ++i) {
      const Vec3 p{110 * phantom::uniform(9, 1, 3 * i), -10 + 115 * phantom::uniform(9, 1, 3 * i + 1),
                   40 + 100 * phantom::uniform(9, 1, 3 * i + 2)};
      const phantom::Head::Sample s = head.sample(p, 0.5);
      if (s.clearance_mm < 0.3 || s.hu == -1000) continue;
      ++tried;
      for (int n = 0; n < 3; ++n) {
        const Vec3 u{phantom::uniform(9, 2, 9 * i + 3 * n), phantom::uniform(9, 2, 9 * i + 3 * n + 1),
                     phantom::uniform(9, 2, 9 * i + 3 * n + 2)};
        const Vec3 q = p + normalized(u) * (0.999 * s.clearance_mm);
        EXPECT_EQ(head.sample(q, 0.5).hu, s.hu) << p.x << " " << p.y << " " << p.z << " clearance " << s.clearance_mm
                                                << (level == phantom::Level::simple ? " simple" : " clinical");
      }
    }
    EXPECT_GT(tried, 5000);
  }
}

TEST(PhantomHead, LandmarksLieOnTheSkinWhereTheyShould) {
  for (const std::int64_t seed : {1, 5, 9}) {
    const phantom::Head head(head_params(phantom::Variant::normal, phantom::Level::simple, seed));
    for (const char* name : {"nasion", "inion", "tragus_left", "tragus_right", "kocher_left", "kocher_right"})
      EXPECT_NEAR(head.signed_distance_mm(phantom::Anatomy::skin, head.landmark(name)), 0, 1e-3) << name;
    EXPECT_GT(head.landmark("tragus_left").x, 60);
    EXPECT_LT(head.landmark("tragus_right").x, -60);
    EXPECT_GT(head.landmark("kocher_left").x, 20);
    EXPECT_LT(head.landmark("kocher_right").x, -20);
    EXPECT_LT(head.landmark("nasion").y, -80);
    EXPECT_GT(head.landmark("inion").y, 75);
    // Straight lines are a little shorter than the way along the skin.
    const Vec3 n = head.landmark("nasion"), k = head.landmark("kocher_left");
    EXPECT_LT(norm(n - k), std::hypot(110, 27.5));
    EXPECT_GT(norm(n - k), 85);
    for (const char* name : {"monro_left", "monro_right"})
      EXPECT_LT(head.signed_distance_mm(phantom::Anatomy::ventricles, head.landmark(name)), -0.8) << name;
  }
  const phantom::Head normal(head_params(phantom::Variant::normal)), moved(head_params(phantom::Variant::shifted));
  EXPECT_NEAR(moved.landmark("monro_left").x - normal.landmark("monro_left").x, -8, 0.6);
  EXPECT_THROW(normal.landmark("bregma"), Error);
}

TEST(PhantomHead, SeedsDiffer) {
  const phantom::Head a(head_params(phantom::Variant::normal, phantom::Level::simple, 1)),
      b(head_params(phantom::Variant::normal, phantom::Level::simple, 2));
  EXPECT_GT(norm(a.landmark("inion") - b.landmark("inion")), 0.1);
}

// A field that is the truth as far as a tilted scan of half a head reaches: what the box around the scan holds beyond
// it is not missing.
TEST(PhantomHead, TruthEndsWhereATiltedScanDoes) {
  phantom::ScanParams scan;
  scan.columns_count = scan.rows_count = 128;
  scan.pixel_mm = 1.9;
  scan.slices_count = 30;
  scan.slice_step_mm = 3;
  EXPECT_TRUE(phantom::scanned_region(scan).faces.empty());
  scan.tilt_deg = 20;
  phantom::Truth truth{phantom::Head(head_params(phantom::Variant::normal)), {}, phantom::scanned_region(scan)};
  const phantom::ScannedRegion& region = truth.scanned;
  ASSERT_FALSE(region.faces.empty());
  const std::vector<phantom::SlicePose> slices = phantom::slice_poses(scan);
  const auto pixel = [&](const phantom::SlicePose& s, double i, double j) {
    return s.origin_mm + s.row * (i * scan.pixel_mm) + s.column * (j * scan.pixel_mm);
  };
  EXPECT_NEAR(region.beyond_mm(pixel(slices[0], 60, 60)), 0, 1e-9);
  EXPECT_NEAR(region.beyond_mm(pixel(slices[29], 3, 127)), 0, 1e-9);
  EXPECT_NEAR(region.beyond_mm(pixel(slices[15], 0, 70)), 0, 1e-9);
  EXPECT_LT(region.beyond_mm(pixel(slices[15], 64, 64)), -30);
  const Vec3 low = region.box_mm.min_mm, high = region.box_mm.max_mm;
  EXPECT_GT(std::max(region.beyond_mm(high), region.beyond_mm({high.x, low.y, high.z})), 20);

  grid::Lattice lattice;
  lattice.spacing_mm = {1.5, 1.5, 1.5};
  lattice.origin_mm = region.box_mm.min_mm;
  for (int a = 0; a < 3; ++a)
    lattice.size[a] = int((region.box_mm.max_mm[a] - region.box_mm.min_mm[a]) / lattice.spacing_mm[a]) + 1;
  grid::Field field(lattice);
  for (int k = 0; k < lattice.size[2]; ++k)
    for (int j = 0; j < lattice.size[1]; ++j)
      for (int i = 0; i < lattice.size[0]; ++i) {
        const Vec3 p = lattice.to_world_mm({double(i), double(j), double(k)});
        field.at(i, j, k) = float(std::min(-truth.head.implicit_mm(phantom::Anatomy::brain, p), -region.beyond_mm(p)));
      }
  const phantom::TruthSurface known = phantom::truth_surface(truth, phantom::Anatomy::brain);
  const Report report = printed(figures_of(phantom::measure_against_truth(field, known, 2000)), {});
  const auto number = [&](const char* name) { return std::get<double>(*report.find(name)); };
  EXPECT_GT(number("dice_ratio"), 0.999);
  EXPECT_NEAR(number("volume_difference_ratio"), 0, 0.002);
  EXPECT_LT(number("deviation_max_mm"), 1.5);
  EXPECT_NEAR(surface::volume_mm3(known.mesh) / 1000, number("reference_volume_ml"),
              0.005 * number("reference_volume_ml"));
}
