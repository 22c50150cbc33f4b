// SPDX-License-Identifier: GPL-3.0-or-later
// The proof that a mesh is valid: who gives it, what it goes with, and every change that ends it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "base/error.h"
#include "meshing/decimate.h"
#include "meshing/normals.h"
#include "meshing/remesh.h"
#include "meshing/repair.h"
#include "meshing/smooth.h"
#include "meshing/validity.h"
#include "meshing_box.h"
#include "meshing_shapes.h"
#include "report_of.h"

namespace trephine {
namespace {

using shapes::box;
using Triangle = std::array<std::uint32_t, 3>;

TEST(Proof, IsGivenByTheCheckAloneAndOnlyToWhatIsValid) {
  surface::TriMesh m = box({}, {2, 2, 2});
  EXPECT_FALSE(m.proven_valid());
  EXPECT_FALSE(surface::TriMesh().proven_valid());
  ASSERT_TRUE(meshing::check_validity(m).valid());
  EXPECT_TRUE(m.proven_valid());
  std::swap(m.triangles[3][0], m.triangles[3][1]);
  ASSERT_FALSE(meshing::check_validity(m).valid());
  EXPECT_FALSE(m.proven_valid());
  EXPECT_THROW(meshing::require_valid(m), Error);
  EXPECT_FALSE(m.proven_valid());
}

TEST(Proof, DoesNotCoverAChangeThroughAnOlderReference) {
  surface::TriMesh m = box({}, {2, 2, 2});
  Vec3& point = m.points_mm[5];
  std::uint32_t& corner = m.triangles[3][0];
  meshing::require_valid(m);
  const auto code = [&] {
    try {
      meshing::require_valid(m);
    } catch (const Error& e) {
      return e.code();
    }
    return ExitCode::ok;
  };
  EXPECT_EQ(code(), ExitCode::ok);
  const double x = point.x;
  point.x = std::nextafter(x, 3);
  EXPECT_TRUE(m.proven_valid()) << "the array cannot know of it";
  EXPECT_EQ(code(), ExitCode::internal);
  point.x = x;
  EXPECT_EQ(code(), ExitCode::ok);
  corner = (corner + 1) % 8;
  EXPECT_EQ(code(), ExitCode::internal);
  const surface::TriMesh copy = m;
  EXPECT_THROW(meshing::require_valid(copy), Error) << "a copy has the same proof";
}

TEST(Proof, GoesWithCopiesAndMovesOfBothArrays) {
  surface::TriMesh m = box({}, {2, 2, 2});
  meshing::require_valid(m);
  surface::TriMesh copy = m;
  EXPECT_TRUE(copy.proven_valid());
  const auto shared = std::make_shared<const surface::TriMesh>(std::move(copy));
  EXPECT_TRUE(shared->proven_valid());
  EXPECT_FALSE(copy.proven_valid());  // NOLINT(bugprone-use-after-move): it holds nothing now
  copy = *shared;
  EXPECT_TRUE(copy.proven_valid());
  copy.origin_mm = {1, 2, 3};
  copy.normals.assign(copy.points_mm.size(), Vec3{0, 0, 1});
  EXPECT_TRUE(copy.proven_valid());
  // The points of one proof and the triangles of another prove nothing.
  surface::TriMesh other = box({}, {3, 3, 3});
  meshing::require_valid(other);
  copy.points_mm = other.points_mm;
  EXPECT_FALSE(copy.proven_valid());
  copy.triangles = other.triangles;
  EXPECT_TRUE(copy.proven_valid());
}

TEST(Proof, EndsWithEveryWayToChangeTheMesh) {
  surface::TriMesh valid = box({}, {2, 2, 2});
  meshing::require_valid(valid);
  const std::vector<std::function<void(surface::TriMesh&)>> changes = {
      [](surface::TriMesh& m) { m.points_mm[5].x += 1e-3; },
      [](surface::TriMesh& m) { m.points_mm.at(5).x += 1e-3; },
      [](surface::TriMesh& m) { m.points_mm.front().x += 1e-3; },
      [](surface::TriMesh& m) { m.points_mm.back().x += 1e-3; },
      [](surface::TriMesh& m) { m.points_mm.data()[1].x += 1e-3; },
      [](surface::TriMesh& m) { m.points_mm.begin()->x += 1e-3; },
      [](surface::TriMesh& m) {
        for (Vec3& p : m.points_mm) p = p * 2;
      },
      [](surface::TriMesh& m) { (m.points_mm.end() - 1)->x += 1e-3; },
      [](surface::TriMesh& m) { m.points_mm.push_back({}); },
      [](surface::TriMesh& m) { m.points_mm.resize(3); },
      [](surface::TriMesh& m) { m.points_mm.clear(); },
      [](surface::TriMesh& m) {
        m.points_mm = {{0, 0, 0}};
      },
      [](surface::TriMesh& m) { m.points_mm = std::vector<Vec3>(8); },
      [](surface::TriMesh& m) { m.triangles.pop_back(); },
      [](surface::TriMesh& m) { m.triangles.erase(m.triangles.begin()); },
      [](surface::TriMesh& m) {
        m.triangles.assign(2, Triangle{0, 1, 2});
      },
      [](surface::TriMesh& m) {
        m.triangles.insert(m.triangles.end(), Triangle{0, 1, 2});
      },
      [](surface::TriMesh& m) { std::swap(m.triangles[0], m.triangles[1]); },
      [](surface::TriMesh& m) { const surface::TriMesh taken = std::move(m); }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    surface::TriMesh m = valid;
    changes[i](m);
    EXPECT_FALSE(m.proven_valid()) << i;
  }
  EXPECT_TRUE(valid.proven_valid());
}

TEST(Proof, StaysWhereThereIsNothingToDo) {
  surface::TriMesh m = shapes::contoured(shapes::sphere(14, 5));
  EXPECT_TRUE(m.proven_valid()) << "contour checks what it makes";
  meshing::snap_to_float32(m);
  meshing::centre_origin(m);
  surface::drop_unused_points(m);
  Report report;
  meshing::compute_normals(m, {});
  EXPECT_TRUE(m.proven_valid());
  EXPECT_TRUE(value_of(report, meshing::smooth(m, {})).proven_valid());
  EXPECT_TRUE(value_of(report, meshing::decimate(m, {})).proven_valid());
  EXPECT_TRUE(value_of(report, meshing::remesh(m, {})).proven_valid());
  EXPECT_TRUE(value_of(report, meshing::repair(m, {})).proven_valid());
}

}  // namespace
}  // namespace trephine
