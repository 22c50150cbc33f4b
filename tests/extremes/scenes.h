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
  HuVolume volume;
  std::map<std::string, Field> fields;
  std::map<std::string, TriMesh> meshes;  ///< empty where no surface can be had
  HeadLandmarks landmarks;
  std::vector<Cutter> cutters;
  std::string no_surface;  ///< what contour said where it refused
};

/// HU and the shapes of a sphere (50 HU, a shell of 1,000 HU around it) as functions of the place.
struct Shape {
  std::function<double(Vec3)> outer_mm, inner_mm;  ///< positive inside
};

/// A sphere of `radius_mm` that holds one of half its radius, `centre` in the middle of the lattice.
Shape balls(double radius_mm, Vec3 centre);
/// Its scan, fields (in mm) and surfaces.
Scene scene_of(const std::string& name, const Lattice& lattice, const Shape& shape);
/// The lattice of that many voxels about the centre.
Lattice cube(std::array<int, 3> size, Vec3 spacing_mm, Vec3 centre = {});

/// 32^3 voxels of 0.5 mm, an outer sphere of 6 mm: the valid input that the sweeps begin with.
const Scene& base_scene();
const Scene& spine_scene();  ///< rings and bodies of bone around a canal
const Scene& chest_scene();  ///< sternum, clavicles, ribs, lungs
const Scene& head_scene();   ///< skin, skull, brain and ventricles as ellipsoids, landmarks given
/// One scene for each extreme of the input.
const std::vector<std::function<Scene()>>& extreme_scenes();

/// The stage's inputs of the scene. `ports` names optional ports that are to be filled. False where the scene has no
/// surface for it.
bool fill(StageInputs& inputs, const StageType& stage, const Scene& scene, const std::vector<std::string>& ports);

/// All stages: those of recipes and those that serve the whole case.
const std::vector<StageType>& all_stages();

}  // namespace trephine::extremes
