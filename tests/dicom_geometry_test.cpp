// SPDX-License-Identifier: GPL-3.0-or-later
// Where things end up in space, against blobs whose centroids are known: D15 to D19.
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

#include "base/error.h"
#include "dicom/import.h"
#include "dicom/resample.h"
#include "dicom_synthetic.h"

namespace trephine {
namespace {

using synthetic::Scan;

double figure(const Report& r, const std::string& name) {
  const ParameterValue* v = r.find(name);
  if (!v) throw std::runtime_error("no figure " + name);
  if (const auto* i = std::get_if<std::int64_t>(v)) return static_cast<double>(*i);
  if (const auto* b = std::get_if<bool>(v)) return *b;
  return std::get<double>(*v);
}

dicom::ImportResult import(const Scan& scan, const dicom::ImportParams& params = {}) {
  const ScratchFolder folder;
  scan.write(folder);
  return dicom::import_series(folder.path(), params);
}

/// Every blob within 0.1 mm of the truth and of its height: a mirrored or swapped axis would put another one there.
void expect_blobs(const grid::HuVolume& volume, const Scan& scan, double height_tolerance = 0.1) {
  const grid::Lattice& l = grid::lattice_of(volume);
  EXPECT_NEAR(determinant(l.direction), 1, 1e-9);
  for (const auto& blob : scan.blobs) {
    const auto found = synthetic::find_blob(volume, blob, scan.background_hu);
    EXPECT_LT(norm(found.centroid_mm - blob.centre_mm), 0.1)
        << "blob of " << blob.amplitude_hu << ": off by " << found.centroid_mm.x - blob.centre_mm.x << " "
        << found.centroid_mm.y - blob.centre_mm.y << " " << found.centroid_mm.z - blob.centre_mm.z;
    EXPECT_NEAR(found.peak_hu / blob.amplitude_hu, 1, height_tolerance);
  }
}

std::string error_of(const Scan& scan, const dicom::ImportParams& params = {}) {
  try {
    import(scan, params);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::bad_input);
    return e.line("import");
  }
  return "no error";
}

Vec3 rotated(Vec3 v, Vec3 axis, double degrees) {
  const double a = degrees * M_PI / 180;
  axis = normalized(axis);
  return v * std::cos(a) + cross(axis, v) * std::sin(a) + axis * (dot(axis, v) * (1 - std::cos(a)));
}

Scan head() {
  Scan s;
  s.columns = 64;
  s.rows = 60;
  s.slices = 32;
  s.blobs = synthetic::four_blobs(13, 4);
  return s;
}

struct Pose {
  const char* name;
  Vec3 u, v;
};
void PrintTo(const Pose& v, std::ostream* out) { *out << v.name; }

class Orientations : public testing::TestWithParam<Pose> {};

TEST_P(Orientations, BlobsWhereTheyAre) {
  Scan s = head();
  s.u = GetParam().u;
  s.v = GetParam().v;
  s.columns = s.rows = 64;
  const dicom::ImportResult r = import(s);
  EXPECT_EQ(figure(r.report(), "resampled"), 0);
  expect_blobs(r.volume, s);
  const grid::Lattice& l = grid::lattice_of(r.volume);
  EXPECT_LT(norm(l.direction.column[0] - s.u) + norm(l.direction.column[1] - s.v), 1e-9);
}

const Vec3 oblique_u = rotated({1, 0, 0}, {0.3, -0.5, 0.8}, 27), oblique_v = rotated({0, 1, 0}, {0.3, -0.5, 0.8}, 27);

INSTANTIATE_TEST_SUITE_P(D19, Orientations,
                         testing::Values(Pose{"axial_supine", {1, 0, 0}, {0, 1, 0}},
                                         Pose{"axial_prone", {-1, 0, 0}, {0, -1, 0}},
                                         Pose{"feet_first_supine", {-1, 0, 0}, {0, 1, 0}},
                                         Pose{"feet_first_prone", {1, 0, 0}, {0, -1, 0}},
                                         Pose{"sagittal", {0, 1, 0}, {0, 0, -1}},
                                         Pose{"coronal", {1, 0, 0}, {0, 0, -1}}, Pose{"oblique", oblique_u, oblique_v}),
                         [](const auto& i) { return i.param.name; });

TEST(DicomGeometry, ThinPixelsThickSlices) {
  Scan s;
  s.columns = s.rows = 240;
  s.dx_mm = s.dy_mm = 0.3;
  s.step_mm = 5;
  s.slices = 15;
  s.blobs = synthetic::four_blobs(15, 5);
  expect_blobs(import(s).volume, s);
}

TEST(DicomGeometry, FieldsOfView) {
  for (const double field : {50.0, 1000.0}) {
    Scan s;
    s.columns = s.rows = 64;
    s.dx_mm = s.dy_mm = field / 64;
    s.step_mm = field / 64;
    s.slices = 48;
    s.blobs = synthetic::four_blobs(field / 6, field / 24);
    dicom::ImportParams p;
    p.max_gap_mm = 20;
    expect_blobs(import(s, p).volume, s);
  }
}

class Tilts : public testing::TestWithParam<double> {};

TEST_P(Tilts, AreRectified) {
  Scan s = head();
  s.background_hu = 20;
  s.drift_per_mm = s.v * std::tan(GetParam() * M_PI / 180);
  const dicom::ImportResult r = import(s);
  EXPECT_NEAR(figure(r.report(), "tilt_deg"), GetParam(), 0.01);
  EXPECT_EQ(figure(r.report(), "resampled"), 1);
  expect_blobs(r.volume, s);
  // Nothing of any slice is lost: the grid covers all of them.
  const grid::Lattice& l = grid::lattice_of(r.volume);
  EXPECT_EQ(l.size[0], s.columns);
  EXPECT_GE((l.size[1] - 1) * l.spacing_mm.y + 1e-6,
            (s.rows - 1) * s.dy_mm + std::abs(s.drift_per_mm.y) * 31 * s.step_mm);
  // What no slice covers is air; no overshoot of the interpolation goes beyond the true range.
  EXPECT_EQ(figure(r.report(), "hu_min"), 20);
  std::visit([&](const auto& g) { EXPECT_EQ(*std::min_element(g.voxels.begin(), g.voxels.end()), -1000); }, r.volume);
}

INSTANTIATE_TEST_SUITE_P(D17, Tilts, testing::Values(13.5, -13.5, 25.0, -25.0, 0.5));

TEST(DicomGeometry, TiltOfAnObliqueStackInBothDirections) {
  Scan s = head();
  s.u = oblique_u;
  s.v = oblique_v;
  s.background_hu = 20;
  s.drift_per_mm = s.v * 0.2 + s.u * -0.1;
  const dicom::ImportResult r = import(s);
  EXPECT_NEAR(figure(r.report(), "tilt_deg"), std::atan(std::hypot(0.2, 0.1)) * 180 / M_PI, 0.01);
  expect_blobs(r.volume, s);
}

TEST(DicomGeometry, UprightUniformStackIsNotTouched) {
  Scan s = head();
  s.centre_mm = {-3.3, 120.7, -1234.56};
  for (auto& b : s.blobs) b.centre_mm += s.centre_mm;
  const dicom::ImportResult r = import(s);
  EXPECT_EQ(figure(r.report(), "resampled"), 0);
  const auto& g = std::get<grid::Grid<std::int16_t>>(r.volume);
  for (int k = 0; k < s.slices; ++k)
    for (int j = 0; j < s.rows; ++j)
      for (int i = 0; i < s.columns; ++i)
        ASSERT_EQ(g.at(i, j, k), std::llround(s.hu(s.position(k) + s.u * (i * s.dx_mm) + s.v * (j * s.dy_mm))));
  EXPECT_LT(norm(g.origin_mm - s.position(0)), 1e-9);
  EXPECT_NEAR(g.spacing_mm.z, 2, 1e-9);
}

std::vector<double> positions(std::initializer_list<std::pair<int, double>> runs) {
  std::vector<double> z{0};
  for (const auto& [count, step] : runs)
    for (int i = 0; i < count; ++i) z.push_back(z.back() + step);
  const double middle = z.back() / 2;
  for (double& v : z) v -= middle;
  return z;
}

TEST(DicomGeometry, JitteredPositions) {
  for (const double jitter : {0.002, 0.3}) {
    Scan s = head();
    s.step_mm = 1.5;
    unsigned seed = 12345;
    for (int k = 0; k < 44; ++k) {
      seed = seed * 1664525u + 1013904223u;
      s.along_mm.push_back((k - 21.5) * 1.5 + jitter * (2.0 * (seed >> 8) / 16777216.0 - 1));
    }
    const dicom::ImportResult r = import(s);
    EXPECT_EQ(figure(r.report(), "resampled"), 1) << jitter;
    double largest = 0;
    for (std::size_t k = 1; k < s.along_mm.size(); ++k) largest = std::max(largest, s.along_mm[k] - s.along_mm[k - 1]);
    EXPECT_NEAR(figure(r.report(), "largest_gap_mm"), largest, 1e-6);
    expect_blobs(r.volume, s);
  }
}

TEST(DicomGeometry, SpacingThatChanges) {
  Scan s = head();
  s.along_mm = positions({{30, 1.0}, {10, 5.0}});
  s.blobs = synthetic::four_blobs(15, 5);
  const dicom::ImportResult r = import(s);
  EXPECT_NEAR(grid::lattice_of(r.volume).spacing_mm.z, 1, 1e-6);
  EXPECT_EQ(grid::lattice_of(r.volume).size[2], 81);
  EXPECT_NEAR(figure(r.report(), "largest_gap_mm"), 5, 1e-6);
  expect_blobs(r.volume, s, 0.15);                         // slices 5 mm apart miss the tops
  s.along_mm = positions({{2, 1.0}, {9, 5.0}, {2, 1.0}});  // two equal new steps are a change, not a missing slice
  EXPECT_NO_THROW(import(s));
}

TEST(DicomGeometry, OneSmallerStep) {
  Scan s = head();
  s.along_mm = positions({{20, 1.5}, {1, 1.0}, {19, 1.5}});
  const dicom::ImportResult r = import(s);
  EXPECT_NEAR(grid::lattice_of(r.volume).spacing_mm.z, 1.5, 1e-6);
  EXPECT_EQ(figure(r.report(), "missing_slices_interpolated_count"), 0);
  expect_blobs(r.volume, s);
}

TEST(DicomGeometry, StepAboveTheLargestAllowed) {
  Scan s = head();
  s.along_mm = positions({{8, 4.0}, {6, 9.0}});
  EXPECT_NE(
      error_of(s).find("9.000 mm between slices, max_gap_mm is 8; take another series, or --max-gap-mm 9 reads it"),
      std::string::npos)
      << error_of(s);
  dicom::ImportParams p;
  p.max_gap_mm = 10;
  EXPECT_NO_THROW(import(s, p));
  p.max_gap_mm = 8;
  p.gaps = dicom::GapPolicy::interpolate;
  EXPECT_NE(error_of(s, p).find("--max-gap-mm 9 reads it"), std::string::npos) << error_of(s, p);
  s.along_mm = positions({{10, 2.0}, {1, 29.5}, {10, 2.0}});
  const std::string filled = "or --max-gap-mm 30 with --gaps interpolate fills it";
  EXPECT_NE(error_of(s).find(filled), std::string::npos) << error_of(s);
  p.max_gap_mm = 30;
  EXPECT_NO_THROW(import(s, p));
  s.along_mm = positions({{10, 2.0}, {1, 60.0}, {10, 2.0}});
  EXPECT_EQ(error_of(s).find("--max-gap-mm"), std::string::npos) << "no setting allows as much: " << error_of(s);
}

TEST(DicomGeometry, MissingSlice) {
  // In the middle, two at once, next to either end, beside jitter.
  std::vector<std::vector<double>> cases = {positions({{15, 2.0}, {1, 4.0}, {15, 2.0}}),
                                            positions({{15, 2.0}, {1, 6.0}, {15, 2.0}}),
                                            positions({{1, 4.0}, {30, 2.0}}), positions({{30, 2.0}, {1, 4.0}})};
  cases.push_back(cases[0]);
  for (std::size_t k = 0; k < cases.back().size(); ++k) cases.back()[k] += k % 3 == 0 ? 0.01 : -0.005;
  for (const auto& along : cases) {
    Scan s = head();
    s.along_mm = along;
    double gap = 0;
    for (std::size_t k = 1; k < along.size(); ++k) gap = std::max(gap, along[k] - along[k - 1]);
    const std::string error = error_of(s);
    char text[20];
    std::snprintf(text, sizeof text, "%.3f mm", gap);
    EXPECT_NE(error.find(text), std::string::npos) << error;
    dicom::ImportParams p;
    p.gaps = dicom::GapPolicy::interpolate;
    const dicom::ImportResult r = import(s, p);
    EXPECT_EQ(figure(r.report(), "missing_slices_interpolated_count"), 1);
    EXPECT_EQ(figure(r.report(), "resampled"), 1);
    expect_blobs(r.volume, s, 0.15);
  }
}

TEST(DicomGeometry, TiltAndChangingSpacingAtOnce) {
  Scan s = head();
  s.background_hu = 20;
  s.blobs = synthetic::four_blobs(15, 5);
  s.along_mm = positions({{9, 4.0}, {7, 6.0}});
  s.drift_per_mm = s.v * std::tan(-18.5 * M_PI / 180);
  const dicom::ImportResult r = import(s);
  EXPECT_NEAR(figure(r.report(), "tilt_deg"), -18.5, 0.01);
  EXPECT_NEAR(grid::lattice_of(r.volume).spacing_mm.z, 4, 1e-6);
  expect_blobs(r.volume, s, 0.15);
}

TEST(DicomGeometry, NotOneVolume) {
  Scan s = head();
  s.slices = 2;
  EXPECT_NE(error_of(s).find("2 slice positions"), std::string::npos);
  s.slices = 1;
  EXPECT_NE(error_of(s).find("1 slice position"), std::string::npos);
  s = head();
  s.drift_per_mm = s.v * 1.2;
  EXPECT_NE(error_of(s).find("degrees"), std::string::npos);
  s = head();
  s.edit = [&](int k, synthetic::DataSet& d) {
    const Vec3 p = s.position(k == 7 ? 6 : k) + s.u * (k == 7 ? 40.0 : 0);
    d.text(synthetic::tag(0x20, 0x32), "DS", synthetic::decimals({p.x, p.y, p.z}));
  };
  EXPECT_NE(error_of(s).find("side by side"), std::string::npos);
}

TEST(DicomResample, CubicWeightsAreExactForParabolas) {
  for (const std::array<double, 4> x :
       {std::array<double, 4>{-1, 0, 1, 2}, std::array<double, 4>{-1, 0, 5, 10}, std::array<double, 4>{2, 3.5, 4, 4.2}})
    for (const double t : {0.0, 0.25, 0.6, 1.0}) {
      const double at = x[1] + t * (x[2] - x[1]);
      const dicom::Weights w = dicom::cubic_weights(x, at);
      const auto parabola = [](double v) { return 3 - 2 * v + 0.7 * v * v; };
      double sum = 0;
      for (std::size_t i = 0; i < 4; ++i) sum += w[i] * parabola(x[i]);
      EXPECT_NEAR(sum, parabola(at), 1e-12);
    }
}

TEST(DicomResample, NoOvershootAtAnEdge) {
  dicom::Taps taps;
  taps.level = {0, 1, 2, 3};
  std::vector<float> air{-1000, -1000, -1000}, metal{15000, 15000, 15000};
  for (double t = 0.05; t < 1; t += 0.05) {
    taps.weight = dicom::cubic_weights(t);
    std::vector<std::int16_t> out(3);
    dicom::blend(taps, {air.data(), air.data(), metal.data(), metal.data()}, 3, out.data());
    EXPECT_GE(out[0], -1000);
    EXPECT_LE(out[0], 15000);
  }
}

}  // namespace
}  // namespace trephine
