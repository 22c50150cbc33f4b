// SPDX-License-Identifier: GPL-3.0-or-later
// The face region's axes, and the gate on shapes whose distances are known.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/pi.h"
#include "face/deface_distance.h"
#include "face/face_gate.h"

namespace trephine {
namespace {

constexpr double degree = pi / 180;

head::HeadLandmarks upright() {
  head::HeadLandmarks l;
  l.landmarks = {{"nasion", {0, -90, 32}, 1, "given"},
                 {"tragus_left", {75, 0, 0}, 1, "given"},
                 {"tragus_right", {-75, 0, 0}, 1, "given"}};
  return l;
}

head::HeadLandmarks turned(const Mat3& m) {
  head::HeadLandmarks l = upright();
  for (cases::CaseLandmark& p : l.landmarks) p.position_mm = m * p.position_mm + Vec3{10, 20, -30};
  return l;
}

std::string refusal(const head::HeadLandmarks& landmarks) {
  try {
    face::face_region(landmarks);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::privacy);
    return e.line("");
  }
  return "";
}

TEST(FaceRegion, AxesAreTheHeadsOwn) {
  const face::FaceRegion r = face::face_region(upright());
  EXPECT_NEAR(norm(cross(r.front, r.up) - -r.left), 0, 1e-12) << "orthonormal";
  // The nasion's own ascent is 19.6 degrees here, so the axes are the patient's to 0.4 degrees.
  EXPECT_GT(dot(r.front, {0, -1, 0}), std::cos(0.5 * degree));
  EXPECT_GT(dot(r.up, {0, 0, 1}), std::cos(0.5 * degree));
  EXPECT_NEAR(r.in_front_mm({75, 0, 0}), 0, 1e-9);
  EXPECT_NEAR(r.in_front_mm({-75, 0, 0}), 0, 1e-9);
  EXPECT_NEAR(r.below_mm({0, -90, 32}), 0, 1e-9);
  EXPECT_TRUE(r.contains({0, -100, 0}));
  EXPECT_FALSE(r.contains({0, -100, 40})) << "forehead";
  EXPECT_FALSE(r.contains({0, 5, 0})) << "behind the tragi";
  // However the head lies.
  const double a = 25 * degree;
  const Mat3 nods{{Vec3{1, 0, 0}, Vec3{0, std::cos(a), std::sin(a)}, Vec3{0, -std::sin(a), std::cos(a)}}};
  const face::FaceRegion n = face::face_region(turned(nods));
  for (const Vec3 p : {Vec3{0, -100, 0}, Vec3{30, -20, 22}, Vec3{0, -100, 40}, Vec3{50, -3, -40}}) {
    const Vec3 q = nods * p + Vec3{10, 20, -30};
    EXPECT_NEAR(n.in_front_mm(q), r.in_front_mm(p), 1e-9);
    EXPECT_NEAR(n.below_mm(q), r.below_mm(p), 1e-9);
  }
}

TEST(FaceRegion, LandmarksThatSayNothingAreRefused) {
  head::HeadLandmarks l = upright();
  l.landmarks.erase(l.landmarks.begin());
  EXPECT_NE(refusal(l).find("landmarks.nasion: is missing"), std::string::npos) << refusal(l);
  l = upright();
  l.landmarks[2].confidence = 0.3;
  EXPECT_NE(refusal(l).find("landmarks.tragus_right: found with a confidence of 0.3"), std::string::npos) << refusal(l);
  l = upright();
  std::swap(l.landmarks[1].position_mm, l.landmarks[2].position_mm);
  EXPECT_NE(refusal(l).find("landmarks.tragus_left: does not lie to the left"), std::string::npos) << refusal(l);
  l = upright();
  l.landmarks[0].position_mm = {0, -20, 0};
  EXPECT_NE(refusal(l).find("landmarks.nasion: lies before the tragi by 20 mm"), std::string::npos) << refusal(l);
  l = upright();
  l.landmarks[0].position_mm.x = std::nan("");
  EXPECT_NE(refusal(l).find("not finite"), std::string::npos) << refusal(l);
}

/// A ball of 80 mm about the middle between the tragi, in mm or clipped as HU are.
constexpr double ball_mm = 80;
grid::Field ball(Vec3 spacing, double reach_mm) {
  grid::Lattice l;
  l.spacing_mm = spacing;
  for (int a = 0; a < 3; ++a) l.size[a] = int(200 / spacing[a]) + 1;
  l.origin_mm = {-100, -100, -100};
  grid::Field f(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const double d = ball_mm - norm(l.to_world_mm({double(i), double(j), double(k)}));
        f.at(i, j, k) = float(std::clamp(d, -reach_mm, reach_mm)) + 1e-4f;
      }
  return f;
}

const grid::Field& ball_of_1_mm() {
  static const grid::Field f = ball({1, 1, 1}, 3);
  return f;
}

TEST(SkinDistance, OfABall) {
  for (const Vec3 spacing : {Vec3{1, 1, 1}, Vec3{0.8, 0.8, 2.5}}) {
    const grid::Field f = ball(spacing, 2 * spacing.z);
    grid::Box box = grid::whole_box(f);
    box.begin[0] -= 10;  // beyond the field
    const face::SkinDistance skin(f, box, 2);
    double worst_above = 0, worst_below = 0;
    for (int n = 0; n < 2000; ++n) {
      const double z = -0.95 + 1.9 * ((n * 0.618034) - std::floor(n * 0.618034)), phi = n * 2.399963;
      const Vec3 u{std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z};
      for (double d : {-5.0, 5.0}) {
        const double error = skin.distance_mm(u * (ball_mm + d)) - 5;
        worst_above = std::max(worst_above, error);
        worst_below = std::max(worst_below, -error);
      }
    }
    EXPECT_LT(worst_above, skin.error_mm()) << spacing.z;
    EXPECT_LT(worst_below, 0.02) << spacing.z;
    EXPECT_LT(skin.error_mm(), 0.3);
  }
}

/// A latitude-longitude ball.
surface::TriMesh ball_mesh(double radius_mm, int rings) {
  surface::TriMesh m;
  for (int r = 0; r <= rings; ++r)
    for (int s = 0; s < 2 * rings; ++s) {
      const double a = 180 * degree * r / rings, b = 180 * degree * s / rings;
      m.points_mm.push_back(Vec3{std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)} * radius_mm);
    }
  const auto at = [&](int r, int s) { return std::uint32_t(r * 2 * rings + s % (2 * rings)); };
  for (int r = 0; r < rings; ++r)
    for (int s = 0; s < 2 * rings; ++s) {
      m.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      m.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
  return m;
}

bool refused(const grid::Field& skin, const face::FaceRegion& region, const std::vector<face::FaceSurface>& surfaces,
             const std::vector<face::FaceVolume>& volumes, std::string* line = nullptr) {
  try {
    face::check_face_removed(skin, {region}, surfaces, volumes);
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ExitCode::privacy);
    if (line) *line = e.line("");
    return true;
  }
  return false;
}

// By points placed by looking, on two real heads: the slits of closed eyes lie 2 to 12 mm under the nasion's level. A
// region that begins 10 mm under it lets them be published.
TEST(FaceRegion, HoldsTheEyes) {
  const face::FaceRegion r = face::face_region(upright());
  for (const double side : {-1.0, 1.0})
    for (const double under_mm : {2.0, 6.0, 12.0}) EXPECT_TRUE(r.contains({32 * side, -78, 32 - under_mm})) << under_mm;
  EXPECT_FALSE(r.contains({0, -88, 42})) << "a brow";
  // And what is removed of them does not hang on a parameter.
  const grid::Field& skin = ball_of_1_mm();
  surface::TriMesh eye = ball_mesh(ball_mm + 0.5, 60);
  std::vector<std::array<std::uint32_t, 3>> kept;
  for (const auto& t : eye.triangles) {
    const double below = r.below_mm(eye.world_mm(t[0]));
    if (below > 4 && below < 9) kept.push_back(t);
  }
  eye.triangles = kept;
  EXPECT_TRUE(refused(skin, r, {{"skin", &eye}}, {}));
}

TEST(FaceGate, SurfacesToATenthOfAMillimetre) {
  const grid::Field& skin = ball_of_1_mm();
  const face::FaceRegion region = face::face_region(upright());
  const surface::TriMesh near = ball_mesh(ball_mm - 4.8, 60), clear = ball_mesh(ball_mm - 5.5, 60),
                         outside = ball_mesh(ball_mm + 4.8, 60);
  std::string line;
  EXPECT_TRUE(refused(skin, region, {{"brain", &clear}, {"skin", &near}}, {}, &line));
  EXPECT_NE(line.find("skin: shows the patient's face: 4."), std::string::npos) << line;
  EXPECT_TRUE(refused(skin, region, {{"mask", &outside}}, {}));
  EXPECT_FALSE(refused(skin, region, {{"skin", &clear}}, {}));
  const double found = face::face_distances(skin, region, {{"skin", &clear}}, {})[0].distance_mm;
  EXPECT_NEAR(found, 5.5, 0.35);
  // A few large triangles: what counts is all of a triangle, not its corners.
  surface::TriMesh one;
  one.points_mm = {{-60, -84, -90}, {60, -84, -90}, {0, -84, 90}};
  one.triangles = {{0, 1, 2}};
  EXPECT_TRUE(refused(skin, region, {{"sheet", &one}}, {}));
  // The same behind the tragi, and above the level, shows no face.
  for (Vec3& p : one.points_mm) p.y = -p.y;
  EXPECT_FALSE(refused(skin, region, {{"sheet", &one}}, {}));
  surface::TriMesh above = near;
  std::vector<std::array<std::uint32_t, 3>> kept;
  for (const auto& t : above.triangles) {
    bool outside_region = true;
    for (const auto p : t) outside_region = outside_region && region.below_mm(above.world_mm(p)) < 0;
    if (outside_region) kept.push_back(t);
  }
  above.triangles = kept;
  EXPECT_FALSE(refused(skin, region, {{"forehead", &above}}, {}));
}

/// Air but for a step of `step_hu` at that depth under the ball's surface.
template <class T>
grid::Grid<T> step_volume(double depth_mm, T low, T step) {
  const grid::Field f = ball({1, 1, 1}, 1000);
  grid::Grid<T> g(f, low);
  for (std::size_t v = 0; v < g.voxels.size(); ++v)
    if (f.voxels[v] > depth_mm) g.voxels[v] = T(low + step);
  return g;
}

TEST(FaceGate, VolumesShowTheFaceAtAnyValue) {
  const grid::Field& skin = ball_of_1_mm();
  const face::FaceRegion region = face::face_region(upright());
  for (const int step : {1, 1000}) {
    const grid::HuVolume near = step_volume<std::int16_t>(5, -1000, std::int16_t(step)),
                         clear = step_volume<std::int16_t>(7, -1000, std::int16_t(step));
    EXPECT_TRUE(refused(skin, region, {}, {face::face_volume("ct", near)})) << step;
    EXPECT_FALSE(refused(skin, region, {}, {face::face_volume("ct", clear)})) << step;
    const grid::HuVolume real = step_volume<float>(3, -1000.f, float(step));
    EXPECT_TRUE(refused(skin, region, {}, {face::face_volume("ct", real)})) << step;
  }
  voxel::HapticVolume felt;
  felt.shapes = {voxel::occupancy_shape("skin", 1)};
  felt.voxels = step_volume<std::int16_t>(0, 0, 1255);
  std::string line;
  EXPECT_TRUE(refused(skin, region, {}, {face::face_volume("haptic", felt)}, &line));
  EXPECT_NE(line.find("haptic: shows the patient's face: 0 mm"), std::string::npos) << line;
  felt.voxels = step_volume<std::int16_t>(7, 0, 1255);
  EXPECT_FALSE(refused(skin, region, {}, {face::face_volume("haptic", felt)}));
  // Cropped within the skin: what ends at the border has a surface there.
  const grid::HuVolume body =
      grid::crop(step_volume<std::int16_t>(-30, -1000, 1040), grid::Box{{60, 22, 40}, {140, 100, 100}});
  EXPECT_TRUE(refused(skin, region, {}, {face::face_volume("ct", body)}));
  const grid::HuVolume air =
      grid::crop(step_volume<std::int16_t>(7, -1000, 1040), grid::Box{{60, 22, 40}, {140, 26, 100}});
  EXPECT_FALSE(refused(skin, region, {}, {face::face_volume("ct", air)}));
  grid::Mask hardness(body.index() == 0 ? std::get<0>(body) : grid::Grid<std::int16_t>(), 0);
  EXPECT_FALSE(refused(skin, region, {}, {face::face_volume("hardness", hardness)}));
  hardness.at(40, 2, 30) = 1;
  EXPECT_TRUE(refused(skin, region, {}, {face::face_volume("hardness", hardness)}));
}

}  // namespace
}  // namespace trephine
