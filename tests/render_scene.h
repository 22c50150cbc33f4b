// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A context and scenes to draw.
#include <gtest/gtest.h>

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>

#include "base/error.h"
#include "case_samples.h"
#include "picture/camera.h"
#include "render/renderer.h"
#include "render/stage.h"

namespace trephine::drawing {

/// A test of pictures has a context, or is skipped where the machine has none (in ./check it fails then).
class Picture : public ::testing::Test {
 protected:
  void SetUp() override {
    ::setenv("LP_NUM_THREADS", "1", 1);
    try {
      context_ = std::make_unique<render::OffscreenContext>();
    } catch (const Error& e) {
      const char* check = std::getenv("TREPHINE_CHECK");
      if (check && std::string(check) == "1") FAIL() << e.what();
      GTEST_SKIP() << e.what();
    }
  }
  std::unique_ptr<render::OffscreenContext> context_;
};

constexpr int width = 320, height = 240;

inline scene::SceneSurface surface_of(const surface::TriMesh& mesh, const std::string& name,
                                      std::array<double, 3> colour) {
  scene::SceneSurface s;
  s.name = name;
  s.colour_rgb = colour;
  const std::vector<Vec3> normals = mesh.normals;
  for (std::size_t n = 0; n < mesh.points_mm.size(); ++n) {
    const Vec3 p = mesh.world_mm(n), normal = normals.empty() ? normalized(mesh.points_mm[n]) : normals[n];
    scene::SceneVertex v{{float(p.x), float(p.y), float(p.z)}, {0, 0, 0, 0}};
    for (int a = 0; a < 3; ++a) v.normal[a] = std::int8_t(127 * normal[a]);
    s.vertices.push_back(v);
  }
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n)
    for (const std::uint32_t corner : mesh.triangles[n]) s.indices.push_back(corner);
  return s;
}

/// The eye of the toolchain's pictures.
inline scene::EyeView eye_of(const picture::detail::Camera& c) {
  scene::EyeView e;
  e.eye_mm = c.target_mm + c.toward * c.distance_mm;
  e.right = c.right;
  e.up = c.up;
  e.toward = c.toward;
  const double k = 1 / (c.px_per_mm * c.distance_mm);
  e.left = -c.center_x * k;
  e.right_edge = (width - c.center_x) * k;
  e.top = c.center_y * k;
  e.bottom = (c.center_y - height) * k;
  e.near_mm = c.distance_mm * 0.2;
  e.far_mm = c.distance_mm * 3;
  return e;
}

inline trephine::scene::Picture drawn(render::Renderer& renderer, const scene::EyeView& eye,
                                      const scene::SceneState& state) {
  renderer.draw(eye, state, width, height);
  render::OffscreenPicture out(width, height);
  out.bind();
  renderer.present(0, 0, width, height);
  return out.read();
}

/// Makes coarser triangles beside a surface's own, all at once; false where they are not worth it.
inline bool make_coarse(render::Renderer& renderer, int surface, double within_mm) {
  std::optional<render::CoarseParts> made =
      render::coarse_parts(*renderer.parts(surface), within_mm, std::numeric_limits<std::size_t>::max());
  const bool any = made.has_value();
  renderer.set_coarse(surface, std::move(made));
  while (renderer.upload_coarse(1000)) {
  }
  return any;
}

/// With the case that a window's tests play: a scalp that an incision cuts, a live skull, a brain.
class PlayCase : public Picture {
 protected:
  void SetUp() override {
    Picture::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    folder_ = std::filesystem::temp_directory_path() / ("trephine-stage-" + std::to_string(::getpid()));
    case_samples::play_case().write(folder_ / "case");
    loaded_ = cases::load_case(folder_ / "case");
    view_.samples = 1;
    view_.places = false;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
  cases::LoadedCase loaded_;
  scene::ViewParams view_;
};

inline trephine::scene::Picture shot(render::Stage& stage, const scene::OrbitCamera& camera, int w = width,
                                     int h = height) {
  render::OffscreenPicture out(w, h);
  stage.draw(camera, w, h, [&](render::Eye) { out.bind(); });
  return out.read();
}

}  // namespace trephine::drawing
