// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/compare_graphics.h"

#ifdef TREPHINE_WITH_DISPLAY

#include <cmath>
#include <memory>

#include "base/cpu_time.h"
#include "base/error.h"
#include "render/renderer.h"
#include "surface/vertex_normals.h"

namespace trephine::commands {
namespace {

constexpr int width = 1280, height = 720, pictures = 3;

scene::SceneData scene_with(const surface::TriMesh& mesh) {
  scene::SceneData scene;
  scene.bounds = surface::bounds_of(mesh);
  scene.centre_mm = (scene.bounds.min_mm + scene.bounds.max_mm) * 0.5;
  scene::SceneSurface s;
  s.name = "mesh";
  const std::vector<Vec3> normals = surface::vertex_normals(mesh);
  s.vertices.resize(mesh.points_mm.size());
  for (std::size_t n = 0; n < s.vertices.size(); ++n) {
    const Vec3 p = mesh.world_mm(n) - scene.centre_mm, normal = normalized(normals[n]);
    for (int a = 0; a < 3; ++a) {
      s.vertices[n].position_mm[a] = float(p[a]);
      s.vertices[n].normal[a] = std::int8_t(std::lround(127 * normal[a]));
    }
    s.vertices[n].normal[3] = 0;
  }
  for (const auto& t : mesh.triangles) s.indices.insert(s.indices.end(), t.begin(), t.end());
  scene.surfaces.push_back(std::move(s));
  return scene;
}

double draw_ms(const surface::TriMesh& mesh) {
  const scene::SceneData scene = scene_with(mesh);
  render::RenderQuality plain;
  plain.samples = 1;
  plain.occlusion = plain.grain = false;
  plain.shadow_taps = 0;
  render::Renderer renderer(scene, plain);
  scene::OrbitCamera camera;
  camera.look(scene::ViewPreset::oblique, scene.bounds, {}, {});
  scene::SceneState state;
  state.opacity = {1};
  render::OffscreenPicture target(width, height);
  double begin = 0;
  for (int n = 0; n <= pictures; ++n) {
    if (n == 1) begin = process_cpu_ms();  // the first picture sets up what the others use
    renderer.draw(camera.eye(width, height, scene.bounds), state, width, height);
    target.bind();
    renderer.present(0, 0, width, height);
    render::wait_for_driver();
  }
  return (process_cpu_ms() - begin) / pictures;
}

}  // namespace

peers::DrawMesh mesh_drawer(std::string& renderer, std::string& fault) {
  try {
    const auto context = std::make_shared<render::OffscreenContext>();
    renderer = render::driver_facts().renderer;
    return [context](const surface::TriMesh& mesh) { return draw_ms(mesh); };
  } catch (const Error& e) {
    fault = e.what();
    return {};
  }
}

}  // namespace trephine::commands
#else
namespace trephine::commands {

peers::DrawMesh mesh_drawer(std::string&, std::string& fault) {
  fault = "this build has no OpenGL (TREPHINE_HEADLESS)";
  return {};
}

}  // namespace trephine::commands
#endif
