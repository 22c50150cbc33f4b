// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "stages/stage.h"

namespace trephine::extremes {

/// Everything that stages take, of one small patient: data by the names of ports; what a port of that kind and another
/// name gets is under "".
struct Scene {
  std::string name;
  grid::HuVolume volume;
  std::map<std::string, grid::Field> fields;
  std::map<std::string, surface::TriMesh> meshes;  ///< empty where no surface can be had
  head::HeadLandmarks landmarks;
  std::vector<boolean::Cutter> cutters;
  std::string no_surface;  ///< what contour said where it refused
};

/// HU and the shapes of a sphere (50 HU, a shell of 1,000 HU around it) as functions of the place.
struct Shape {
  std::function<double(Vec3)> outer_mm, inner_mm;  ///< positive inside
};

/// A sphere of `radius_mm` that holds one of half its radius, `centre` in the middle of the lattice.
Shape balls(double radius_mm, Vec3 centre);
/// Its scan, fields (in mm) and surfaces.
Scene scene_of(const std::string& name, const grid::Lattice& lattice, const Shape& shape);
/// The lattice of that many voxels about the centre.
grid::Lattice cube(std::array<int, 3> size, Vec3 spacing_mm, Vec3 centre = {});

/// What a stage can work on: a sphere in a sphere (32^3 voxels of 0.5 mm, 6 mm), a head (skin, skull, brain and
/// ventricles as ellipsoids, landmarks given), a spine (rings and bodies of bone around a canal), a chest (sternum,
/// clavicles, ribs, lungs), and two vertebrae with pedicles.
enum class Body { balls, head, spine, chest, lumbar };
const Scene& usual_scene(Body body);
Scene head_on(const std::string& name, const grid::Lattice& lattice);
Scene spine_on(const std::string& name, const grid::Lattice& lattice);
Scene chest_on(const std::string& name, const grid::Lattice& lattice);
Scene lumbar_on(const std::string& name, const grid::Lattice& lattice);
inline grid::Lattice head_lattice() { return cube({60, 76, 72}, {3, 3, 3}, {0, -5, 30}); }
inline grid::Lattice spine_lattice() { return cube({36, 44, 40}, {1.5, 1.5, 2.5}, {0, -12, 0}); }
inline grid::Lattice lumbar_lattice() { return cube({60, 60, 42}, {1.5, 1.5, 2}, {0, 22, 0}); }
inline grid::Lattice chest_lattice() { return cube({104, 60, 40}, {3, 3, 3}, {0, -5, -5}); }

/// One for each extreme of the input; made when it is first asked for.
struct ExtremeScene {
  std::string name;
  std::function<const Scene&()> scene;
};
const std::vector<ExtremeScene>& extreme_scenes(Body body);

constexpr std::int16_t air_hu = -1000, soft_hu = 50, bone_hu = 1000;
grid::Field sampled(const grid::Lattice& lattice, const std::function<double(Vec3)>& f);
grid::HuVolume scan_of(const grid::Lattice& lattice, const std::function<double(Vec3)>& hu);
/// From a to b as the surface at 0 runs through a voxel.
double blend(double inside_mm, double width_mm, double a, double b);
/// The surfaces of all fields under their names, anew; none where the one that counts has none.
void add_meshes(Scene& scene);
void move(Scene& scene, Vec3 by_mm);
boolean::Cutter drill(Vec3 at, double radius_mm, double depth_mm);
cases::CaseLandmark landmark(const std::string& name, Vec3 at);

/// The stage's inputs of the scene. `ports` names optional ports that are to be filled. False where the scene has no
/// surface for it.
bool fill(stages::StageInputs& inputs, const stages::StageType& stage, const Scene& scene,
          const std::vector<std::string>& ports);

/// All stages: those of recipes and those that serve the whole case.
const std::vector<stages::StageType>& all_stages();

}  // namespace trephine::extremes
