// SPDX-License-Identifier: GPL-3.0-or-later
#include "scenes.h"

#include <cmath>

#include "../report_of.h"
#include "base/error.h"
#include "meshing/contour.h"
#include "stages/voxelize.h"

namespace trephine::extremes {

namespace {

surface::TriMesh surface_of(const grid::Field& field) {
  meshing::ContourParams p;
  p.min_component_mm3 = 0;
  Report r;
  return value_of(r, meshing::contour(field, p));
}

}  // namespace

grid::Field sampled(const grid::Lattice& l, const std::function<double(Vec3)>& f) {
  grid::Field field(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        field.at(i, j, k) = float(f(l.to_world_mm({double(i), double(j), double(k)})));
  return field;
}

void add_meshes(Scene& s) {
  s.meshes.clear();
  for (const auto& [name, field] : s.fields) {
    if (name == "speed") continue;
    try {
      s.meshes[name] = surface_of(field);
    } catch (const Error& e) {
      if (name.empty()) s.no_surface = e.what();
    }
  }
}

boolean::Cutter drill(Vec3 at, double radius_mm, double depth_mm) {
  boolean::Cutter c;
  c.name = "drill";
  c.position_mm = at;
  c.radius_mm = radius_mm;
  c.above_mm = c.depth_mm = depth_mm;
  return c;
}

cases::CaseLandmark landmark(const std::string& name, Vec3 at) {
  cases::CaseLandmark l;
  l.name = name;
  l.position_mm = at;
  l.source = "found";
  return l;
}

grid::HuVolume scan_of(const grid::Lattice& l, const std::function<double(Vec3)>& hu) {
  grid::Grid<std::int16_t> g(l);
  const grid::Field f = sampled(l, hu);
  for (std::size_t v = 0; v < g.count(); ++v) g.voxels[v] = std::int16_t(std::lround(f.voxels[v]));
  return g;
}

double blend(double inside_mm, double width_mm, double a, double b) {
  return a + (b - a) * std::clamp(0.5 + inside_mm / width_mm, 0.0, 1.0);
}

void move(Scene& s, Vec3 by_mm) {
  std::visit([&](auto& g) { g.origin_mm = g.origin_mm + by_mm; }, s.volume);
  for (auto& [name, field] : s.fields) field.origin_mm = field.origin_mm + by_mm;
  for (cases::CaseLandmark& l : s.landmarks.landmarks) l.position_mm = l.position_mm + by_mm;
  for (boolean::Cutter& c : s.cutters) c.position_mm = c.position_mm + by_mm;
  add_meshes(s);
}

Shape balls(double radius_mm, Vec3 centre) {
  return {[=](Vec3 p) { return radius_mm - norm(p - centre); },
          [=](Vec3 p) { return radius_mm / 2 - norm(p - centre); }};
}

grid::Lattice cube(std::array<int, 3> size, Vec3 spacing_mm, Vec3 centre) {
  grid::Lattice l;
  l.size = size;
  l.spacing_mm = spacing_mm;
  for (int a = 0; a < 3; ++a) l.origin_mm[a] = centre[a] - spacing_mm[a] * (size[a] - 1) / 2.0;
  return l;
}

Scene scene_of(const std::string& name, const grid::Lattice& l, const Shape& shape) {
  Scene s;
  s.name = name;
  const double voxel_mm = std::cbrt(l.voxel_volume_mm3());
  s.volume = scan_of(l, [&](Vec3 p) {
    return blend(shape.inner_mm(p), voxel_mm, blend(shape.outer_mm(p), voxel_mm, air_hu, bone_hu), soft_hu);
  });
  s.fields[""] = s.fields["skin"] = sampled(l, shape.outer_mm);
  s.fields["bone"] = s.fields["skull"] =
      sampled(l, [&](Vec3 p) { return std::min(shape.outer_mm(p), -shape.inner_mm(p)); });
  s.fields["brain"] = s.fields["within"] = sampled(l, shape.inner_mm);
  s.fields["speed"] = sampled(l, [&](Vec3 p) { return std::clamp(shape.outer_mm(p) / voxel_mm, -1.0, 1.0); });
  add_meshes(s);
  const Vec3 size{l.spacing_mm.x * l.size[0], l.spacing_mm.y * l.size[1], l.spacing_mm.z * l.size[2]};
  const Vec3 middle = l.to_world_mm({(l.size[0] - 1) / 2.0, (l.size[1] - 1) / 2.0, (l.size[2] - 1) / 2.0});
  s.cutters = {drill(middle, 0.06 * std::min(size.x, size.y), size.z)};
  s.landmarks.landmarks = {landmark("nasion", middle - Vec3{0, size.y * 0.4, 0}),
                           landmark("tragus_left", middle + Vec3{size.x * 0.4, 0, 0}),
                           landmark("tragus_right", middle - Vec3{size.x * 0.4, 0, 0})};
  return s;
}

const Scene& usual_scene(Body body) {
  static const Scene balls_scene = scene_of("a sphere in a sphere", cube({32, 32, 32}, {0.5, 0.5, 0.5}), balls(6, {}));
  static const Scene head = head_on("a head", head_lattice()), spine = spine_on("a spine", spine_lattice()),
                     chest = chest_on("a chest", chest_lattice()),
                     lumbar = lumbar_on("two vertebrae", lumbar_lattice());
  switch (body) {
    case Body::head:
      return head;
    case Body::spine:
      return spine;
    case Body::chest:
      return chest;
    case Body::lumbar:
      return lumbar;
    case Body::balls:
      break;
  }
  return balls_scene;
}

const std::vector<stages::StageType>& all_stages() {
  static const std::vector<stages::StageType> stages = [] {
    std::vector<stages::StageType> all = stages::stage_types();
    for (stages::StageType& s : all)
      if (s.name == "voxelize")
        s.make_params = [] {
          stages::VoxelizeStageParams params;
          params.shapes.emplace_back("outer", stages::HapticShapeParams());
          params.drill.emplace_back("outer", stages::DrillParams());
          return AnyParams::make(params);
        };
    return all;
  }();
  return stages;
}

bool fill(stages::StageInputs& inputs, const stages::StageType& stage, const Scene& scene,
          const std::vector<std::string>& ports) {
  const auto by_name = [](const auto& all, const std::string& name) {
    const auto found = all.find(name);
    return found != all.end() ? found : all.find("");
  };
  for (const stages::Port& port : stage.ports) {
    const bool asked = std::find(ports.begin(), ports.end(), port.name) != ports.end();
    if (!port.required && !asked) continue;
    const auto dot = port.name.find(".*");
    const std::string name = dot == std::string::npos ? port.name : port.name.substr(0, dot) + ".outer";
    stages::StageData& data = inputs.by_port[name];
    if (port.kind == stages::DataKind::volume) data = std::make_shared<const grid::HuVolume>(scene.volume);
    if (port.kind == stages::DataKind::field)
      data = std::make_shared<const grid::Field>(by_name(scene.fields, port.name)->second);
    if (port.kind == stages::DataKind::mesh) {
      const auto mesh = by_name(scene.meshes, port.name);
      if (mesh == scene.meshes.end()) return false;
      data = std::make_shared<const surface::TriMesh>(mesh->second);
    }
    if (port.kind == stages::DataKind::landmarks) data = std::make_shared<const head::HeadLandmarks>(scene.landmarks);
    if (port.kind == stages::DataKind::cutters)
      data = std::make_shared<const std::vector<boolean::Cutter>>(scene.cutters);
    if (port.kind == stages::DataKind::haptic) {
      const auto mesh = by_name(scene.meshes, "outer");
      if (mesh == scene.meshes.end()) return false;
      voxel::VoxelizeParams p;
      const Vec3 spacing = scene.fields.at("").spacing_mm;
      p.spacing_mm = {spacing.x, spacing.y, spacing.z};
      surface::Bounds b = surface::bounds_of(mesh->second);
      for (int a = 0; a < 3; ++a) b.min_mm[a] -= 3 * spacing[a], b.max_mm[a] += 3 * spacing[a];
      Report r;
      data = std::make_shared<const voxel::HapticVolume>(
          value_of(r, voxel::voxelize(voxel::haptic_lattice(b, scene.fields.at("").direction, b.min_mm, p),
                                      {{"outer", &mesh->second, nullptr, 0}})));
    }
  }
  return true;
}

}  // namespace trephine::extremes
