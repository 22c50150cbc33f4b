// SPDX-License-Identifier: GPL-3.0-or-later
#include "scenes.h"

#include <cmath>
#include <limits>

#include "base/error.h"
#include "body_samples.h"
#include "meshing/contour.h"
#include "stages/burr_hole.h"
#include "stages/cut.h"
#include "stages/haptic.h"

namespace trephine::extremes {
namespace {

constexpr std::int16_t air_hu = -1000, soft_hu = 50, bone_hu = 1000;

Field sampled(const Lattice& l, const std::function<double(Vec3)>& f) {
  Field field(l);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        field.at(i, j, k) = float(f(l.to_world_mm({double(i), double(j), double(k)})));
  return field;
}

TriMesh surface_of(const Field& field) {
  ContourParams p;
  p.min_component_mm3 = 0;
  Report r;
  return contour(field, p, r);
}

// The surfaces of all fields under their names; none where the one that counts has none.
void add_meshes(Scene& s) {
  for (const auto& [name, field] : s.fields) {
    if (name == "speed") continue;
    try {
      s.meshes[name] = surface_of(field);
    } catch (const Error& e) {
      if (name.empty()) s.no_surface = e.what();
    }
  }
}

Cutter drill(Vec3 at, double radius_mm, double depth_mm) {
  Cutter c;
  c.name = "drill";
  c.position_mm = at;
  c.radius_mm = radius_mm;
  c.above_mm = c.depth_mm = depth_mm;
  return c;
}

CaseLandmark landmark(const std::string& name, Vec3 at) {
  CaseLandmark l;
  l.name = name;
  l.position_mm = at;
  l.source = "given";
  return l;
}

HuVolume scan_of(const Lattice& l, const std::function<double(Vec3)>& hu) {
  Grid<std::int16_t> g(l);
  const Field f = sampled(l, hu);
  for (std::size_t v = 0; v < g.count(); ++v) g.voxels[v] = std::int16_t(std::lround(f.voxels[v]));
  return g;
}

// From a to b as the surface at 0 runs through a voxel.
double blend(double inside_mm, double width_mm, double a, double b) {
  return a + (b - a) * std::clamp(0.5 + inside_mm / width_mm, 0.0, 1.0);
}

}  // namespace

Shape balls(double radius_mm, Vec3 centre) {
  return {[=](Vec3 p) { return radius_mm - norm(p - centre); },
          [=](Vec3 p) { return radius_mm / 2 - norm(p - centre); }};
}

Lattice cube(std::array<int, 3> size, Vec3 spacing_mm, Vec3 centre) {
  Lattice l;
  l.size = size;
  l.spacing_mm = spacing_mm;
  for (int a = 0; a < 3; ++a) l.origin_mm[a] = centre[a] - spacing_mm[a] * (size[a] - 1) / 2.0;
  return l;
}

Scene scene_of(const std::string& name, const Lattice& l, const Shape& shape) {
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

const Scene& base_scene() {
  static const Scene s = scene_of("a sphere in a sphere", cube({32, 32, 32}, {0.5, 0.5, 0.5}), balls(6, {}));
  return s;
}

const Scene& spine_scene() {
  static const Scene scene = [] {
    Scene s;
    s.name = "a spine";
    const auto bone_mm = [](Vec3 p) {
      const double r = std::hypot(p.x, p.y), at = std::fabs(std::remainder(p.z, 30.0));
      const double body = std::min(11 - at, 16 - std::hypot(p.x, p.y + 24));
      const double arch = std::min(9 - at, 14 - r);
      return std::min(std::max(body, arch), r - 9);
    };
    const Lattice l = cube({36, 44, 40}, {1.5, 1.5, 2.5}, {0, -12, 0});
    s.volume = scan_of(l, [&](Vec3 p) { return blend(bone_mm(p), 1.5, 20, 600); });
    s.fields[""] = s.fields["bone"] = sampled(l, bone_mm);
    add_meshes(s);
    return s;
  }();
  return scene;
}

const Scene& chest_scene() {
  static const Scene scene = [] {
    Scene s;
    s.name = "a chest";
    const auto clavicle_mm = [](Vec3 p) {
      std::vector<Vec3> line;
      for (double t = 0; t <= 1.01; t += 0.2)
        line.push_back({18 + 105 * t, -60 + 45 * t - 7 * std::sin(2 * M_PI * t), 10 + 22 * t});
      return 6 - body::to_line(line, {std::fabs(p.x), p.y, p.z});
    };
    const auto other_mm = [](Vec3 p) {
      const double sternum = std::min({11 - std::fabs(p.x), 6 - std::fabs(p.y + 62), 8 - p.z});
      const double ring = (std::hypot(p.x / 75, (p.y + 5) / 62) - 1) * 62;
      const double rib = 4 - std::hypot(ring, p.z + 20 - 0.3 * p.y);
      return std::max({sternum, 14 - std::hypot(p.x, p.y - 45), rib});
    };
    const Lattice l = cube({104, 60, 40}, {3, 3, 3}, {0, -5, -5});
    const auto bone_mm = [&](Vec3 p) { return std::max(clavicle_mm(p), other_mm(p)); };
    s.volume = scan_of(l, [&](Vec3 p) {
      const double body = (1 - std::hypot(p.x / 150, (p.y + 5) / 85)) * 85;
      const double lung = (1 - norm(Vec3{(std::fabs(p.x) - 28) / 22, (p.y + 2) / 40, (p.z + 60) / 45})) * 22;
      return blend(bone_mm(p), 3, blend(lung, 3, blend(body, 3, air_hu, soft_hu), -850), 600);
    });
    s.fields[""] = s.fields["bone"] = sampled(l, bone_mm);
    add_meshes(s);
    return s;
  }();
  return scene;
}

const Scene& head_scene() {
  static const Scene scene = [] {
    Scene s;
    s.name = "a head";
    const auto ellipsoid = [](Vec3 radii, Vec3 centre) {
      return [=](Vec3 p) {
        const Vec3 q = p - centre;
        return (1 - norm(Vec3{q.x / radii.x, q.y / radii.y, q.z / radii.z})) * std::min({radii.x, radii.y, radii.z});
      };
    };
    const auto skin = ellipsoid({78, 98, 92}, {0, 0, 30}), outer = ellipsoid({71, 91, 85}, {0, 0, 30}),
               brain = ellipsoid({64, 84, 78}, {0, 0, 30}), nose = ellipsoid({12, 16, 20}, {0, -95, -10});
    const auto ventricles = [&](Vec3 p) { return ellipsoid({9, 30, 14}, {16, 0, 45})({std::fabs(p.x), p.y, p.z}); };
    const auto head = [&](Vec3 p) { return std::max(skin(p), nose(p)); };
    const auto skull = [&](Vec3 p) { return std::min(outer(p), -brain(p)); };
    const Lattice l = cube({60, 76, 72}, {3, 3, 3}, {0, -5, 30});
    s.volume = scan_of(l, [&](Vec3 p) {
      return blend(ventricles(p), 3,
                   blend(brain(p), 3, blend(outer(p), 3, blend(head(p), 3, air_hu, soft_hu), bone_hu), 35), 8);
    });
    s.fields[""] = s.fields["skin"] = sampled(l, head);
    s.fields["skull"] = s.fields["bone"] = sampled(l, skull);
    s.fields["brain"] = s.fields["within"] = sampled(l, brain);
    s.fields["ventricles"] = sampled(l, ventricles);
    add_meshes(s);
    s.landmarks.landmarks = {landmark("nasion", {0, -95, 12}), landmark("inion", {0, 97, 15}),
                             landmark("tragus_left", {73, 0, -5}), landmark("tragus_right", {-73, 0, -5}),
                             landmark("vertex", {0, 0, 122})};
    s.landmarks.midsagittal.confidence = 1;
    s.cutters = {drill({30, -40, 100}, 7, 20)};
    return s;
  }();
  return scene;
}

const std::vector<std::function<Scene()>>& extreme_scenes() {
  const auto with_volume = [](const char* name, const std::function<void(Scene&)>& change) {
    return [=] {
      Scene s = scene_of(name, cube({16, 16, 16}, {1, 1, 1}), balls(6, {}));
      change(s);
      return s;
    };
  };
  const auto constant = [](std::int16_t hu) {
    return [=](Scene& s) { s.volume = Grid<std::int16_t>(lattice_of(s.volume), hu); };
  };
  const auto of_float = [](float first) {
    return [=](Scene& s) {
      Grid<float> g(lattice_of(s.volume), 50);
      g.voxels[g.count() / 2] = first;
      s.volume = g;
      for (auto& [name, field] : s.fields) field.voxels[field.count() / 2] = first;
      for (auto& [name, mesh] : s.meshes) mesh.points_mm[0].x = first;
    };
  };
  const auto fields_of = [](float value) {
    return [=](Scene& s) {
      for (auto& [name, field] : s.fields) field = Field(field, value);
      s.volume = Grid<std::int16_t>(lattice_of(s.volume), value > 0 ? bone_hu : air_hu);
      s.meshes.clear();
      add_meshes(s);
    };
  };
  static const std::vector<std::function<Scene()>> scenes = {
      [] {
        return scene_of("2 x 2 x 2 voxels", cube({2, 2, 2}, {1, 1, 1}), balls(0.95, {0.2, 0.1, 0}));
      },
      [] {
        return scene_of("1 x 1 x 1 voxel", cube({1, 1, 1}, {1, 1, 1}), balls(0.6, {}));
      },
      [] {
        return scene_of(
            "2,000 slices of 8 x 8", cube({8, 8, 2000}, {0.5, 0.5, 0.5}),
            {[](Vec3 p) { return 1.4 - std::hypot(p.x, p.y); }, [](Vec3 p) { return 0.7 - std::hypot(p.x, p.y); }});
      },
      [] {
        return scene_of("voxels of 0.05 mm", cube({32, 32, 32}, {0.05, 0.05, 0.05}), balls(0.6, {}));
      },
      [] {
        return scene_of("voxels of 10 mm", cube({32, 32, 32}, {10, 10, 10}), balls(120, {}));
      },
      [] {
        return scene_of("voxels of 0.5 x 0.5 x 10 mm", cube({48, 48, 8}, {0.5, 0.5, 10}), balls(10, {0, 0, 3}));
      },
      [] {
        return scene_of("voxels of 10 x 0.5 x 0.5 mm", cube({8, 48, 48}, {10, 0.5, 0.5}), balls(10, {3, 0, 0}));
      },
      [] {
        const Vec3 far{1e6, -1e6, 1e6};
        return scene_of("1 km from the frame's origin", cube({32, 32, 32}, {0.5, 0.5, 0.5}, far), balls(6, far));
      },
      [] {
        return scene_of("cut by the border", cube({24, 24, 24}, {0.5, 0.5, 0.5}), balls(6, {4, 5, 5.5}));
      },
      with_volume("all -32768 HU", constant(-32768)),
      with_volume("all 32767 HU", constant(32767)),
      with_volume("-32768 and 32767 HU by turns",
                  [](Scene& s) {
                    auto& g = std::get<Grid<std::int16_t>>(s.volume);
                    for (std::size_t v = 0; v < g.count(); ++v)
                      g.voxels[v] = (v + v / 16 + v / 256) % 2 ? 32767 : -32768;
                  }),
      with_volume("HU beyond 16 bits (float32, 3e38)",
                  [](Scene& s) {
                    Grid<float> g(lattice_of(s.volume), -3e38F);
                    for (std::size_t v = 0; v < g.count(); ++v)
                      if (s.fields[""].voxels[v] > 0) g.voxels[v] = 3e38F;
                    s.volume = g;
                  }),
      with_volume("a voxel and a point that are NaN", of_float(std::numeric_limits<float>::quiet_NaN())),
      with_volume("a voxel and a point that are infinite", of_float(std::numeric_limits<float>::infinity())),
      with_volume("fields whose values are whole numbers, 0 among them",
                  [](Scene& s) {
                    for (auto& [name, field] : s.fields)
                      if (name != "speed")
                        for (float& v : field.voxels) v = std::round(v);
                    s.meshes.clear();
                    add_meshes(s);
                  }),
      with_volume("one voxel",
                  [](Scene& s) {
                    for (auto& [name, field] : s.fields) {
                      field = Field(field, -1);
                      field.at(8, 8, 8) = 1;
                    }
                    Grid<std::int16_t> g(lattice_of(s.volume), air_hu);
                    g.at(8, 8, 8) = bone_hu;
                    s.volume = g;
                    s.meshes.clear();
                    add_meshes(s);
                  }),
      with_volume("a wall of one voxel",
                  [](Scene& s) {
                    for (auto& [name, field] : s.fields) {
                      field = Field(field, -1);
                      for (int j = 3; j < 13; ++j)
                        for (int i = 3; i < 13; ++i) field.at(i, j, 8) = 1;
                    }
                    Grid<std::int16_t> g(lattice_of(s.volume), air_hu);
                    for (std::size_t v = 0; v < g.count(); ++v)
                      if (s.fields[""].voxels[v] > 0) g.voxels[v] = bone_hu;
                    s.volume = g;
                    s.meshes.clear();
                    add_meshes(s);
                  }),
      with_volume("voxels that touch at edges and corners",
                  [](Scene& s) {
                    for (auto& [name, field] : s.fields)
                      for (std::size_t v = 0; v < field.count(); ++v)
                        field.voxels[v] = (v + v / 16 + v / 256) % 2 ? 1.F : -1.F;
                    s.meshes.clear();
                    add_meshes(s);
                  }),
      with_volume("nothing inside", fields_of(-1)),
      with_volume("everything inside", fields_of(1)),
  };
  return scenes;
}

const std::vector<StageType>& all_stages() {
  static const std::vector<StageType> stages = [] {
    std::vector<StageType> all = stage_types();
    HapticSpec haptic;
    haptic.shapes.resize(1);
    haptic.shapes[0].name = "outer";
    haptic.shapes[0].drilled = true;
    for (StageType s : {deface_stage(), resample_stage(), burr_hole_stage("hole", {}), boolean_stage(),
                        voxelize_stage(haptic), mismatch_stage()})
      all.push_back(std::move(s));
    return all;
  }();
  return stages;
}

bool fill(StageInputs& inputs, const StageType& stage, const Scene& scene, const std::vector<std::string>& ports) {
  const auto by_name = [](const auto& all, const std::string& name) {
    const auto found = all.find(name);
    return found != all.end() ? found : all.find("");
  };
  for (const Port& port : stage.ports) {
    const bool asked = std::find(ports.begin(), ports.end(), port.name) != ports.end();
    if (!port.required && !asked) continue;
    const auto dot = port.name.find(".*");
    const std::string name = dot == std::string::npos ? port.name : port.name.substr(0, dot) + ".outer";
    StageData& data = inputs.by_port[name];
    if (port.kind == DataKind::volume) data = std::make_shared<const HuVolume>(scene.volume);
    if (port.kind == DataKind::field) data = std::make_shared<const Field>(by_name(scene.fields, port.name)->second);
    if (port.kind == DataKind::mesh) {
      const auto mesh = by_name(scene.meshes, port.name);
      if (mesh == scene.meshes.end()) return false;
      data = std::make_shared<const TriMesh>(mesh->second);
    }
    if (port.kind == DataKind::landmarks) data = std::make_shared<const HeadLandmarks>(scene.landmarks);
    if (port.kind == DataKind::cutters) data = std::make_shared<const std::vector<Cutter>>(scene.cutters);
    if (port.kind == DataKind::haptic) {
      const auto mesh = by_name(scene.meshes, "outer");
      if (mesh == scene.meshes.end()) return false;
      VoxelizeParams p;
      const Vec3 spacing = scene.fields.at("").spacing_mm;
      p.spacing_mm = {spacing.x, spacing.y, spacing.z};
      Bounds b = bounds_of(mesh->second);
      for (int a = 0; a < 3; ++a) b.min_mm[a] -= 3 * spacing[a], b.max_mm[a] += 3 * spacing[a];
      Report r;
      data = std::make_shared<const HapticVolume>(voxelize(
          haptic_lattice(b, scene.fields.at("").direction, b.min_mm, p), {{"outer", &mesh->second, nullptr, 0}}, r));
    }
  }
  return true;
}

}  // namespace trephine::extremes
