// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/parallel.h"
#include "base/pi.h"
#include "phantom/chest.h"
#include "phantom/phantom.h"
#include "phantom/random.h"

using namespace trephine;
using namespace trephine::phantom;

namespace {

/// A coarse scan that still sees the whole head.
phantom::ScanParams coarse() {
  phantom::ScanParams p;
  p.columns_count = p.rows_count = 96;
  p.field_of_view_mm = 240;
  p.slices_count = 12;
  p.slice_step_mm = 16;
  p.slice_thickness_mm = 2;
  return p;
}

phantom::ScanParams marks_alone() {
  phantom::ScanParams p;
  p.contents = phantom::Contents::fiducials;
  p.columns_count = p.rows_count = 200;
  p.field_of_view_mm = 200;
  p.slices_count = 100;
  p.slice_step_mm = p.slice_thickness_mm = 2;
  p.noise_hu = 0;
  return p;
}

/// Where the marks lie in the images, from the pixels and the slices' planes alone; the same order as `marks`.
std::vector<Vec3> measured_centroids(const phantom::Scan& s, const std::vector<phantom::Fiducial>& marks,
                                     double reach_mm) {
  std::vector<Vec3> sum(marks.size());
  std::vector<double> weight(marks.size(), 0.0);
  for (int k = 0; k < static_cast<int>(s.slices.size()); ++k)
    for (int j = 0; j < s.rows; ++j)
      for (int i = 0; i < s.columns; ++i) {
        const double w = s.hu[(static_cast<std::size_t>(k) * s.rows + j) * s.columns + i] + 1000.0;
        if (w == 0) continue;
        const Vec3 p = s.position_mm(i, j, k);
        for (std::size_t m = 0; m < marks.size(); ++m)
          if (norm(p - marks[m].centre_mm) < reach_mm) sum[m] += p * w, weight[m] += w;
      }
  for (std::size_t m = 0; m < marks.size(); ++m) sum[m] = sum[m] / weight[m];
  return sum;
}

void expect_marks_in_place(const phantom::ScanParams& p, double tolerance_mm) {
  const std::vector<phantom::Fiducial> marks = phantom::fiducials_of(p);
  const phantom::Scan s = phantom::scan(phantom::Head(phantom::HeadParams{}), p);
  const std::vector<Vec3> found = measured_centroids(s, marks, 4.5 * p.fiducial_sigma_mm);
  for (std::size_t m = 0; m < marks.size(); ++m)
    EXPECT_LT(norm(found[m] - marks[m].centre_mm), tolerance_mm) << "mark " << m;
}

// Where clavicles and spinous processes lie shows on the skin, without steps.
TEST(PhantomBodies, BonesArePalpatedThroughTheSkin) {
  for (const int seed : {0, 3}) {
    phantom::ChestParams params;
    params.chest_seed = seed;
    params.shoulders_raised_deg = seed;
    const phantom::Chest chest(params);
    const auto skin_y = [&](double x, double z) {
      double y = -120;
      while (!(chest.skin({x, y, z}) > 0)) y += 0.02;
      return y;
    };
    for (const bool left : {false, true})
      for (const Vec3& c : chest.clavicle_line(left)) {
        const double cover_mm = c.y - params.clavicle_half_width_mm - skin_y(c.x, c.z);
        EXPECT_GT(cover_mm, 3) << c.x;
        EXPECT_LT(cover_mm, 18) << c.x;
        if (std::abs(c.x) < 110) EXPECT_LT(skin_y(c.x, c.z), skin_y(c.x, c.z + 20) - 2) << "a hollow above it";
      }
    const Vec3 notch = chest.notch_mm();
    for (double x = -120; x < 120; x += 0.25)
      EXPECT_LT(std::abs(skin_y(x, notch.z) - skin_y(x + 0.25, notch.z)), 0.5) << x;
  }
}

}  // namespace

TEST(PhantomScan, MarksAreWhereTheTruthSaysHoweverThePatientIsScanned) {
  const phantom::ScanParams plain = marks_alone();
  expect_marks_in_place(plain, 0.05);
  for (const double tilt : {13.5, -13.5, 25.0, -25.0}) {
    phantom::ScanParams p = plain;
    p.tilt_deg = tilt;
    expect_marks_in_place(p, 0.05);
  }
  for (const phantom::Position position : {phantom::Position::head_first_prone, phantom::Position::feet_first_supine,
                                           phantom::Position::feet_first_prone}) {
    phantom::ScanParams p = plain;
    p.position = position;
    expect_marks_in_place(p, 0.05);
  }
  for (const phantom::Plane plane : {phantom::Plane::sagittal, phantom::Plane::coronal}) {
    phantom::ScanParams p = plain;
    p.plane = plane;
    expect_marks_in_place(p, 0.05);
  }
  phantom::ScanParams oblique = plain;
  oblique.rotation_deg = {20, -15, 10};
  expect_marks_in_place(oblique, 0.05);
  phantom::ScanParams thick = plain;
  thick.slices_count = 40;
  thick.slice_step_mm = thick.slice_thickness_mm = 5;
  expect_marks_in_place(thick, 0.05);
}

TEST(PhantomScan, LeftMarkIsHighestAndHasNoTwinOnTheRight) {
  const std::vector<phantom::Fiducial> marks = phantom::fiducials_of(marks_alone());
  ASSERT_EQ(marks.size(), 12u);
  for (std::size_t i = 1; i < marks.size(); ++i) {
    EXPECT_GT(marks[0].height_hu, marks[i].height_hu);
    EXPECT_GT(marks[0].centre_mm.x, marks[i].centre_mm.x);
    Vec3 mirrored = marks[0].centre_mm;
    mirrored.x = -mirrored.x;
    EXPECT_GT(norm(mirrored - marks[i].centre_mm), 20);
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GT(norm(marks[i].centre_mm - marks[j].centre_mm), 9 * marks[i].sigma_mm) << i << " " << j;
  }
}

TEST(PhantomScan, AxesOfEachPosition) {
  phantom::ScanParams p;
  const auto pose = [&](phantom::Position position) {
    p.position = position;
    return phantom::slice_poses(p);
  };
  auto s = pose(phantom::Position::head_first_supine);
  EXPECT_EQ(s[0].row, (Vec3{1, 0, 0}));
  EXPECT_EQ(s[0].column, (Vec3{0, 1, 0}));
  EXPECT_GT(s[1].origin_mm.z, s[0].origin_mm.z);
  s = pose(phantom::Position::feet_first_supine);  // the image's right is the patient's right, slices go to the feet
  EXPECT_EQ(s[0].row, (Vec3{-1, 0, 0}));
  EXPECT_EQ(s[0].column, (Vec3{0, 1, 0}));
  EXPECT_LT(s[1].origin_mm.z, s[0].origin_mm.z);
  s = pose(phantom::Position::head_first_prone);
  EXPECT_EQ(s[0].row, (Vec3{-1, 0, 0}));
  EXPECT_EQ(s[0].column, (Vec3{0, -1, 0}));
  s = pose(phantom::Position::feet_first_prone);
  EXPECT_EQ(s[0].row, (Vec3{1, 0, 0}));
  EXPECT_EQ(s[0].column, (Vec3{0, -1, 0}));
}

TEST(PhantomScan, TiltShearsAndUnevenStepsShow) {
  phantom::ScanParams p;
  p.tilt_deg = 13.5;
  auto s = phantom::slice_poses(p);
  const Vec3 normal = cross(s[0].row, s[0].column), step = s[1].origin_mm - s[0].origin_mm;
  EXPECT_NEAR(norm(step), 1.0, 1e-12);
  EXPECT_NEAR(dot(step, normal), std::cos(13.5 * pi / 180), 1e-12);
  EXPECT_FALSE(phantom::has_lattice(p));
  p.tilt_deg = 0;
  p.upper_step_mm = 5;
  s = phantom::slice_poses(p);
  EXPECT_NEAR(norm(s[96].origin_mm - s[95].origin_mm), 5, 1e-12);
  EXPECT_NEAR(norm(s[95].origin_mm - s[94].origin_mm), 1, 1e-12);
  phantom::Scan uneven;
  uneven.columns = uneven.rows = 8;
  uneven.slices = s;
  EXPECT_THROW(phantom::lattice_of(uneven), Error);
}

// A voxel holds the average of the tissue in it: against dense point sampling, where edges are.
TEST(PhantomScan, PartialVolumeIsTheAverageOverTheVoxel) {
  const phantom::Head head{phantom::HeadParams{}};
  phantom::ScanParams p = coarse();
  p.noise_hu = p.kernel_mm = 0;
  p.table = false;
  const phantom::Scan s = phantom::scan(head, p);
  double sum = 0, square = 0;
  int count = 0;
  for (int n = 0; n < 60000 && count < 1500; ++n) {
    const auto pick = [&](int stream, int size) {
      return static_cast<int>(0.5 * (1 + phantom::uniform(4, stream, n)) * size);
    };
    const int i = pick(0, s.columns), j = pick(1, s.rows), k = pick(2, p.slices_count);
    constexpr int m = 8;
    double mean = 0, low = 1e9, high = -1e9;
    for (int c = 0; c < m; ++c)
      for (int b = 0; b < m; ++b)
        for (int a = 0; a < m; ++a) {
          const Vec3 at = s.position_mm(i + (a + 0.5) / m - 0.5, j + (b + 0.5) / m - 0.5, k) +
                          Vec3{0, 0, ((c + 0.5) / m - 0.5) * p.slice_thickness_mm};
          const double hu = head.hu(at);
          mean += hu / (m * m * m);
          low = std::min(low, hu);
          high = std::max(high, hu);
        }
    if (high == low && n % 10 != 0) continue;
    const double difference = s.hu[(static_cast<std::size_t>(k) * s.rows + j) * s.columns + i] - mean;
    if (high == low) {
      EXPECT_NEAR(difference, 0, 5) << "within one tissue, if near its edge";
      continue;
    }
    sum += difference;
    square += difference * difference;
    ++count;
  }
  ASSERT_GT(count, 1000);
  std::printf("partial volume: bias %.2f HU, RMS %.2f HU of %d voxels with edges\n", sum / count,
              std::sqrt(square / count), count);
  EXPECT_LT(std::fabs(sum / count), 2);
  EXPECT_LT(std::sqrt(square / count), 15);
}

TEST(PhantomScan, NoiseHasItsSizeAndIsCorrelatedByTheKernel) {
  phantom::ScanParams p = coarse();
  p.slices_count = 1;
  p.centre_mm = {0, 0, 300};  // air
  p.columns_count = p.rows_count = 256;
  p.table = false;
  p.noise_hu = 8;
  p.kernel_mm = 1.6;
  const phantom::Scan s = phantom::scan(phantom::Head(phantom::HeadParams{}), p);
  double sum = 0, square = 0, neighbour = 0;
  const int n = static_cast<int>(s.hu.size());
  for (int i = 0; i < n; ++i) sum += s.hu[i];
  for (int i = 0; i + 1 < n; ++i) {
    const double a = s.hu[i] - sum / n, b = s.hu[i + 1] - sum / n;
    square += a * a;
    neighbour += a * b;
  }
  EXPECT_NEAR(sum / n, -1000, 0.5);
  EXPECT_NEAR(std::sqrt(square / n), 8, 0.4);
  // Gaussian noise through a Gaussian of sigma s pixels: exp(-1 / (4 s^2)).
  const double sigma = 1.6 / 2.3548 / (240.0 / 256);
  EXPECT_NEAR(neighbour / square, std::exp(-1 / (4 * sigma * sigma)), 0.03);
}

TEST(PhantomScan, SameBytesWhateverTheThreads) {
  phantom::HeadParams h;
  h.level = phantom::Level::clinical;
  phantom::ScanParams p = coarse();
  p.contents = phantom::Contents::head_with_fiducials;
  p.slices_count = 6;
  p.slice_step_mm = 32;
  set_thread_count(1);
  const phantom::Scan one = phantom::scan(phantom::Head(h), p);
  set_thread_count(2);
  const phantom::Scan two = phantom::scan(phantom::Head(h), p);
  set_thread_count(0);
  EXPECT_EQ(one.hu, two.hu);
  h.seed = 2;
  EXPECT_NE(phantom::scan(phantom::Head(h), p).hu, one.hu);
}

TEST(PhantomScan, HeadHolderLiesBelowTheHeadAndApartFromIt) {
  phantom::ScanParams p = coarse();
  p.noise_hu = 0;
  p.centre_mm = {0, -10, 60};
  p.slices_count = 1;
  const phantom::Scan with = phantom::scan(phantom::Head(phantom::HeadParams{}), p);
  p.table = false;
  const phantom::Scan without = phantom::scan(phantom::Head(phantom::HeadParams{}), p);
  int holder = 0;
  for (std::size_t i = 0; i < with.hu.size(); ++i) {
    if (with.hu[i] == without.hu[i]) continue;
    holder += with.hu[i] > -700;
    EXPECT_LT(with.hu[i], 0);
    EXPECT_GT(with.position_mm(0, static_cast<int>(i / with.columns), 0).y, 20);
  }
  EXPECT_GT(holder, 20);
}

TEST(PhantomScan, RoundFieldIsPadded) {
  phantom::ScanParams p = coarse();
  p.round_field = true;
  p.slices_count = 1;
  const phantom::Scan s = phantom::scan(phantom::Head(phantom::HeadParams{}), p);
  EXPECT_EQ(s.hu[0], phantom::padding_hu);
  EXPECT_NE(s.hu[s.hu.size() / 2 + s.columns / 2], phantom::padding_hu);
}
