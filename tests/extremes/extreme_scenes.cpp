// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>
#include <memory>

#include "scenes.h"

namespace trephine::extremes {
namespace {

// |far| is 1 km.
constexpr Vec3 far{6e5, -6.4e5, 4.8e5};

ExtremeScene later(const std::string& name, const std::function<Scene()>& make) {
  const auto made = std::make_shared<std::unique_ptr<const Scene>>();
  return {name, [=]() -> const Scene& {
            if (!*made) {
              Scene scene = make();
              scene.name = name;
              *made = std::make_unique<const Scene>(std::move(scene));
            }
            return **made;
          }};
}

void fill_fields(Scene& s, float value) {
  for (auto& [name, field] : s.fields) field = grid::Field(field, value);
  s.volume = grid::Grid<std::int16_t>(grid::lattice_of(s.volume), value > 0 ? bone_hu : air_hu);
  add_meshes(s);
}

// Every field is 1 at these voxels, -1 elsewhere, and bone in air.
void draw(Scene& s, const std::function<bool(int, int, int)>& inside) {
  grid::Grid<std::int16_t> g(grid::lattice_of(s.volume), air_hu);
  for (auto& [name, field] : s.fields) field = grid::Field(field, -1);
  for (int k = 0; k < g.size[2]; ++k)
    for (int j = 0; j < g.size[1]; ++j)
      for (int i = 0; i < g.size[0]; ++i) {
        if (!inside(i, j, k)) continue;
        g.at(i, j, k) = bone_hu;
        for (auto& [name, field] : s.fields) field.at(i, j, k) = 1;
      }
  s.volume = g;
  add_meshes(s);
}

// The voxel in the middle, and a point of each surface.
void spoil(Scene& s, float value) {
  const grid::Lattice l = grid::lattice_of(s.volume);
  grid::Grid<float> g(l, 50);
  g.at(l.size[0] / 2, l.size[1] / 2, l.size[2] / 2) = value;
  s.volume = g;
  for (auto& [name, field] : s.fields) field.at(l.size[0] / 2, l.size[1] / 2, l.size[2] / 2) = value;
  for (auto& [name, mesh] : s.meshes) mesh.points_mm[0].x = value;
}

// HU of a checkerboard, or of bone and air so far apart.
void set_hu(Scene& s, float low, float high, bool by_turns) {
  const grid::Field shape = s.fields.at("");
  grid::Grid<float> g(shape, low);
  for (int k = 0; k < g.size[2]; ++k)
    for (int j = 0; j < g.size[1]; ++j)
      for (int i = 0; i < g.size[0]; ++i)
        if (by_turns ? (i + j + k) % 2 : shape.at(i, j, k) > 0) g.at(i, j, k) = high;
  if (std::fabs(high) > 32767)
    s.volume = g;
  else {
    grid::Grid<std::int16_t> whole(g);
    for (std::size_t v = 0; v < g.count(); ++v) whole.voxels[v] = std::int16_t(g.voxels[v]);
    s.volume = whole;
  }
}

// What can be done to any scene.
void add_changes(std::vector<ExtremeScene>& all, const std::function<Scene()>& make) {
  const auto with = [&](const std::string& name, const std::function<void(Scene&)>& change) {
    all.push_back(later(name, [=] {
      Scene s = make();
      change(s);
      return s;
    }));
  };
  with("1 km from the frame's origin", [](Scene& s) { move(s, far); });
  with("all -32768 HU", [](Scene& s) { set_hu(s, -32768, -32768, false); });
  with("all 32767 HU", [](Scene& s) { set_hu(s, 32767, 32767, false); });
  with("-32768 HU and 32767 HU inside", [](Scene& s) { set_hu(s, -32768, 32767, false); });
  with("-32768 and 32767 HU by turns", [](Scene& s) { set_hu(s, -32768, 32767, true); });
  with("HU beyond 16 bits (float32, 3e38)", [](Scene& s) { set_hu(s, -3e38F, 3e38F, false); });
  with("a voxel and a point that are NaN", [](Scene& s) { spoil(s, std::numeric_limits<float>::quiet_NaN()); });
  with("a voxel and a point that are infinite", [](Scene& s) { spoil(s, std::numeric_limits<float>::infinity()); });
  with("values that are whole numbers, the isovalue among them", [](Scene& s) {
    for (auto& [name, field] : s.fields)
      if (name != "speed")
        for (float& v : field.voxels) v = std::round(v);
    add_meshes(s);
  });
  with("one voxel", [](Scene& s) {
    const auto n = grid::lattice_of(s.volume).size;
    draw(s, [=](int i, int j, int k) { return i == n[0] / 2 && j == n[1] / 2 && k == n[2] / 2; });
  });
  with("a wall of one voxel", [](Scene& s) {
    const auto n = grid::lattice_of(s.volume).size;
    draw(s, [=](int i, int j, int k) { return k == n[2] / 2 && i > 2 && j > 2 && i < n[0] - 3 && j < n[1] - 3; });
  });
  with("an oblique wall of one voxel", [](Scene& s) {
    const auto n = grid::lattice_of(s.volume).size;
    draw(s, [=](int i, int j, int k) {
      return (i + j + k) == (n[0] + n[1] + n[2]) / 2 && std::min({i, j, k}) > 2 && i < n[0] - 3 && j < n[1] - 3 &&
             k < n[2] - 3;
    });
  });
  with("nothing inside", [](Scene& s) { fill_fields(s, -1); });
  with("everything inside", [](Scene& s) { fill_fields(s, 1); });
}

std::vector<ExtremeScene> of_balls() {
  std::vector<ExtremeScene> all;
  const auto add = [&](const std::string& name, const grid::Lattice& l, const Shape& shape) {
    all.push_back(later(name, [=] { return scene_of(name, l, shape); }));
  };
  add("2 x 2 x 2 voxels", cube({2, 2, 2}, {1, 1, 1}), balls(0.95, {0.2, 0.1, 0}));
  add("1 x 1 x 1 voxel", cube({1, 1, 1}, {1, 1, 1}), balls(0.6, {}));
  add("2,000 slices of 8 x 8", cube({8, 8, 2000}, {0.5, 0.5, 0.5}),
      {[](Vec3 p) { return 1.4 - std::hypot(p.x, p.y); }, [](Vec3 p) { return 0.7 - std::hypot(p.x, p.y); }});
  add("voxels of 0.05 mm", cube({32, 32, 32}, {0.05, 0.05, 0.05}), balls(0.6, {}));
  add("voxels of 10 mm", cube({32, 32, 32}, {10, 10, 10}), balls(120, {}));
  add("voxels of 0.5 x 0.5 x 10 mm", cube({48, 48, 8}, {0.5, 0.5, 10}), balls(10, {0, 0, 3}));
  add("voxels of 10 x 0.5 x 0.5 mm", cube({8, 48, 48}, {10, 0.5, 0.5}), balls(10, {3, 0, 0}));
  add("cut by the border", cube({24, 24, 24}, {0.5, 0.5, 0.5}), balls(6, {4, 5, 5.5}));
  add_changes(all, [] { return scene_of("", cube({16, 16, 16}, {1, 1, 1}), balls(6, {})); });
  all.push_back(later("voxels that touch at edges and corners", [] {
    Scene s = scene_of("", cube({16, 16, 16}, {1, 1, 1}), balls(6, {}));
    draw(s, [](int i, int j, int k) { return (i + j + k) % 2 == 1; });
    return s;
  }));
  return all;
}

std::vector<ExtremeScene> of_body(Scene (*on)(const std::string&, const grid::Lattice&), const grid::Lattice& usual) {
  std::vector<ExtremeScene> all;
  const auto add = [&](const std::string& name, std::array<int, 3> size, Vec3 spacing, Vec3 moved = {}) {
    grid::Lattice l =
        cube(size, spacing,
             usual.to_world_mm({(usual.size[0] - 1) / 2.0, (usual.size[1] - 1) / 2.0, (usual.size[2] - 1) / 2.0}));
    l.origin_mm = l.origin_mm + moved;
    all.push_back(later(name, [=] { return on(name, l); }));
  };
  const Vec3 s = usual.spacing_mm;
  const Vec3 extent{s.x * usual.size[0], s.y * usual.size[1], s.z * usual.size[2]};
  const auto sized = [&](Vec3 spacing) {
    return std::array<int, 3>{int(std::ceil(extent.x / spacing.x)), int(std::ceil(extent.y / spacing.y)),
                              int(std::ceil(extent.z / spacing.z))};
  };
  add("2 x 2 x 2 voxels", {2, 2, 2}, extent * 0.5);
  add("2,000 slices of 2 x 2", {2, 2, 2000}, {extent.x * 0.5, extent.y * 0.5, extent.z / 2000});
  add("voxels of 0.05 mm", usual.size, {0.05, 0.05, 0.05});
  add("voxels of 10 mm", sized({10, 10, 10}), {10, 10, 10});
  add("voxels of 2 x 2 x 10 mm", sized({2, 2, 10}), {2, 2, 10});
  add("voxels of 10 x 2 x 2 mm", sized({10, 2, 2}), {10, 2, 2});
  add("cut by the border", usual.size, s, {extent.x * 0.4, 0, extent.z * 0.4});
  add_changes(all, [=] { return on("", usual); });
  return all;
}

}  // namespace

const std::vector<ExtremeScene>& extreme_scenes(Body body) {
  static const std::vector<ExtremeScene> all[] = {
      of_balls(), of_body(head_on, head_lattice()), of_body(spine_on, spine_lattice()),
      of_body(chest_on, chest_lattice()), of_body(lumbar_on, lumbar_lattice())};
  return all[int(body)];
}

}  // namespace trephine::extremes
