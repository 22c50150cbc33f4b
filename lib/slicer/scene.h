// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "grid/grid.h"
#include "meshio/markups.h"
#include "pacs/object.h"
#include "surface/trimesh.h"

namespace trephine::slicer {

/// A case as a scene of 3D Slicer: one file, a bundle (.mrb) of a scene (MRML, slicer.readthedocs.io, developer guide,
/// MRML Overview) and the files that it names. Files hold LPS, which the scene says of each; the scene's own places
/// (camera, slices, the volume's matrix) are RAS, as all of MRML's are. Lengths are mm.

/// A surface that the scene shows: a .vtp file with its name, colour and unit.
struct SceneModel {
  std::string name;  ///< [A-Za-z0-9_.-]{1,64}
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  double opacity = 1;
  std::string vtp;
};

/// A line with a width: a hole in the bone, from its entry along its axis.
struct SceneHole {
  meshio::Markup line;
  double diameter_mm = 0;
};

struct CaseScene {
  std::string name;  ///< of the bundle and its folder: the case's token
  std::string program;
  std::vector<SceneModel> models;
  surface::Bounds bounds_mm;  ///< of all that is shown: what the views look at
  std::vector<pacs::Segment> segments;
  grid::Lattice segmented;  ///< where their voxels lie
  std::string ct_nrrd;      ///< the case's CT as it lies there; empty: it has none
  grid::Lattice ct;
  std::vector<meshio::Markup> markups;
  std::vector<SceneHole> holes;
};

/// The bytes of CASE.mrb; the same for the same scene. Throws as encode_segmentation and bundle_of do.
std::string encode_scene(const CaseScene& scene);

}  // namespace trephine::slicer
