// SPDX-License-Identifier: GPL-3.0-or-later
// bench_frame_vtk CASE [FRAMES]: a picture of the simulator's renderer beside one of VTK's: the same surfaces, camera
// and size (1280 x 720), both drawn by the same driver, in CPU ms of the process (llvmpipe's threads included). VTK
// needs a display: xvfb-run -a build/release/bin/bench_frame_vtk library/sample. The rounds of both alternate, for the
// processor's speed changes.
#include <fmt/format.h>
#include <sys/resource.h>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>

#include "cases/load_case.h"
#include "haptics/tool.h"
#include "render/renderer.h"
#include "scene/tool_solid.h"

using namespace trephine;

namespace {

constexpr int width = 1280, height = 720;

double cpu_ms() {
  rusage u{};
  ::getrusage(RUSAGE_SELF, &u);
  const auto ms = [](const timeval& t) { return 1e3 * double(t.tv_sec) + 1e-3 * double(t.tv_usec); };
  return ms(u.ru_utime) + ms(u.ru_stime);
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v.empty() ? 0 : v[v.size() / 2];
}

scene::OrbitCamera camera_at(const scene::SceneData& scene, int frame) {
  scene::OrbitCamera camera;
  camera.look(scene::ViewPreset::front, scene.bounds, {}, {});
  camera.orbit(0.02 * frame, 0);
  return camera;
}

// CPU ms of each picture, after three that are not counted.
template <class Draw>
double measured(int frames, const Draw& draw) {
  std::vector<double> ms;
  for (int n = 0; n < frames + 3; ++n) {
    const double begin = cpu_ms();
    draw(n);
    if (n >= 3) ms.push_back(cpu_ms() - begin);
  }
  return median(ms);
}

// Share of the picture that is not background.
double covered(const std::uint8_t* rgb, std::size_t pixels, const std::uint8_t* background) {
  std::size_t n = 0;
  for (std::size_t p = 0; p < pixels; ++p)
    n += std::abs(rgb[3 * p] - background[0]) + std::abs(rgb[3 * p + 1] - background[1]) +
             std::abs(rgb[3 * p + 2] - background[2]) >
         12;
  return double(n) / double(pixels);
}

struct Result {
  double ms = 0, covered = 0;
};

Result by_vtk(const scene::SceneData& scene, int frames) {
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(0, 0, 0);
  for (const scene::SceneSurface& s : scene.surfaces) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToFloat();
    vtkNew<vtkFloatArray> normals;
    normals->SetNumberOfComponents(3);
    for (const scene::SceneVertex& v : s.vertices) {
      points->InsertNextPoint(v.position_mm);
      const float n[3] = {v.normal[0] / 127.f, v.normal[1] / 127.f, v.normal[2] / 127.f};
      normals->InsertNextTuple(n);
    }
    vtkNew<vtkCellArray> triangles;
    for (std::size_t t = 0; t + 2 < s.indices.size(); t += 3) {
      const vtkIdType corners[3] = {s.indices[t], s.indices[t + 1], s.indices[t + 2]};
      triangles->InsertNextCell(3, corners);
    }
    vtkNew<vtkPolyData> mesh;
    mesh->SetPoints(points);
    mesh->SetPolys(triangles);
    mesh->GetPointData()->SetNormals(normals);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(mesh);
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetColor(s.colour_rgb[0], s.colour_rgb[1], s.colour_rgb[2]);
    actor->GetProperty()->BackfaceCullingOn();
    renderer->AddActor(actor);
  }
  vtkNew<vtkRenderWindow> window;
  window->SetOffScreenRendering(1);
  window->SetMultiSamples(0);
  window->SetSize(width, height);
  window->AddRenderer(renderer);
  Result r;
  r.ms = measured(frames, [&](int n) {
    const scene::OrbitCamera c = camera_at(scene, n);
    const scene::EyeView eye = c.eye(width, height, scene.bounds);
    const Vec3 at = c.target_mm - scene.centre_mm, from = c.eye_mm() - scene.centre_mm;
    vtkCamera* camera = renderer->GetActiveCamera();
    camera->SetFocalPoint(at.x, at.y, at.z);
    camera->SetPosition(from.x, from.y, from.z);
    camera->SetViewUp(c.up.x, c.up.y, c.up.z);
    camera->SetViewAngle(2 * std::atan(eye.top) * 180 / M_PI);
    camera->SetClippingRange(eye.near_mm, eye.far_mm);
    window->Render();
    window->WaitForCompletion();
  });
  vtkNew<vtkUnsignedCharArray> pixels;
  window->GetPixelData(0, 0, width - 1, height - 1, 0, pixels);
  const std::uint8_t black[3] = {0, 0, 0};
  r.covered = covered(pixels->GetPointer(0), std::size_t(width) * height, black);
  return r;
}

Result by_us(const scene::SceneData& scene, int frames, const render::RenderQuality& quality, bool tool = false) {
  const render::OffscreenContext context;
  render::Renderer renderer(scene, quality);
  haptics::ToolParams burr;
  burr.tool = "burr";
  renderer.set_tool(scene::solid_of(haptics::own_tool(burr)));
  renderer.set_background({0, 0, 0});
  render::OffscreenPicture target(width, height);
  scene::SceneState state;
  state.opacity.assign(scene.surfaces.size(), 1);
  state.tool_shown = tool;
  state.tip_mm = {scene.centre_mm.x, scene.bounds.min_mm.y - 5, scene.centre_mm.z};
  state.axis = normalized(Vec3{0.3, -1, 0.4});
  Result r;
  r.ms = measured(frames, [&](int n) {
    renderer.draw(camera_at(scene, n).eye(width, height, scene.bounds), state, width, height);
    target.bind();
    renderer.present(0, 0, width, height);
    render::wait_for_driver();
  });
  const std::uint8_t black[3] = {0, 0, 0};
  r.covered = covered(target.read().rgb.data(), std::size_t(width) * height, black);
  return r;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 64;
  ::setenv("LP_NUM_THREADS", "1", 0);
  const int frames = argc > 2 ? std::atoi(argv[2]) : 15;
  cases::LoadedCase loaded = cases::load_case(argv[1]);
  for (cases::CaseShape& shape : loaded.manifest.haptic.shapes)
    shape.displayed = "surface";  // VTK cannot follow a drill
  scene::SceneData scene = scene::scene_of(loaded);
  std::size_t triangles = 0;
  for (const scene::SceneSurface& s : scene.surfaces) triangles += s.indices.size() / 3;
  struct Row {
    const char* what;
    render::RenderQuality quality;
    bool tool;
    std::vector<double> ms;
  };
  Row ours[] = {{"ours, every surface drawn", {1, false, 20, false, false, 0, {}}, false, {}},
                {"ours, hidden parts asked for", {1, false, 20, false, true, 0, {}}, false, {}},
                {"and grain", {1, false, 20, true, true, 0, {}}, false, {}},
                {"and a burr", {1, false, 20, true, true, 0, {}}, true, {}},
                {"and its shadow", {1, false, 20, true, true, 1, {}}, true, {}},
                {"and darkened creases", {1, true, 20, true, true, 1, {}}, true, {}},
                {"hidden parts asked for, within 2.5 mm", {1, false, 20, false, true, 0, {2.5, 30}}, false, {}}};
  std::vector<double> vtk;
  Result a, b;
  for (int round = 0; round < 3; ++round) {
    vtk.push_back((a = by_vtk(scene, frames)).ms);
    for (Row& row : ours) {
      const Result r = by_us(scene, frames, row.quality, row.tool);
      if (&row == ours) b = r;
      row.ms.push_back(r.ms);
    }
  }
  {
    const render::OffscreenContext context;
    std::cout << fmt::format("{} surfaces, {} triangles, {} x {}, {} pictures in each of 3 rounds, {}\n",
                             scene.surfaces.size(), triangles, width, height, frames, render::driver_facts().renderer);
  }
  std::cout << fmt::format("covered by VTK {:.4f}, by us {:.4f}\n", a.covered, b.covered);
  const auto row = [](const char* what, const std::vector<double>& ms) {
    std::cout << fmt::format("{:44} {:6.1f} CPU ms a picture ({:.1f} to {:.1f})\n", what, median(ms),
                             *std::min_element(ms.begin(), ms.end()), *std::max_element(ms.begin(), ms.end()));
  };
  row("VTK", vtk);
  for (const Row& r : ours) row(r.what, r.ms);
  return std::abs(a.covered - b.covered) < 0.01 ? 0 : 80;
}
