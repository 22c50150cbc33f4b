// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "meshio/export_mesh.h"

namespace trephine::meshio {

struct SdfParams {
  double collision_mm = 1, density_kg_per_m3 = 1000;
  std::string densities;
  template <class V>
  static void describe(V& v) {
    using P = SdfParams;
    v.number(&P::collision_mm, "collision_mm", Range{0.05, 20},
             "sdf: how far the surfaces for collisions may lie off those that are seen.");
    v.number(&P::density_kg_per_m3, "density_kg_per_m3", Range{1, 30000},
             "sdf: density of what densities does not name.");
    v.text(&P::densities, "densities", "sdf: densities of anatomies in kg/m³, such as skull=1900,brain=1040.");
  }
};

struct SdfCollision {
  std::size_t triangles_count = 0;
  double deviation_max_mm = 0;
  template <class V>
  static void describe(V& v) {
    v.integer(&SdfCollision::triangles_count, "triangles_count", Range{}, "Triangles of the surface for collisions.");
    v.number(&SdfCollision::deviation_max_mm, "deviation_max_mm", Range{}, "Its largest distance from the surface.");
  }
};

struct SdfResult {
  double mass_kg = 0;
  std::array<double, 3> centre_m{};
  std::array<double, 6> inertia_kg_m2{};
  Named<SdfCollision> collisions;
  template <class V>
  static void describe(V& v) {
    using P = SdfResult;
    v.number(&P::mass_kg, "mass_kg", Range{}, "Mass of all.");
    v.numbers(&P::centre_m, "centre_m", Range{}, "Centre of mass, in the model's frame.");
    v.numbers(&P::inertia_kg_m2, "inertia_kg_m2", Range{}, "About it, along the model's axes: xx, yy, zz, xy, xz, yz.");
    v.map(&P::collisions, "collisions", "By anatomy.");
  }
};

/// A model of SDFormat 1.7 (Gazebo): one link that holds all surfaces, model.sdf last. The model's frame is x to the
/// front, y to the left, z upwards (REP 103), in metres, with the origin of the patient's coordinates: a place (x, y,
/// z) mm of LPS is
/// (-y, x, z) / 1000. Visuals are .obj files in mm and LPS, as the format obj writes them, which the frame `ct_lps` and
/// a scale bring there; collisions are .obj files of a decimation whose bound is kept (meshing/decimate.h). Mass and
/// inertia are exact integrals over the surfaces; within a surface that lies in another one, the inner one's density
/// holds.
///
/// Throws Error 64 for densities that name no surface; 65 for a surface that encloses nothing; as encode_surfaces and
/// decimate.
Outcome<std::vector<ExportFile>, SdfResult> sdf_model(const std::vector<ExportSurface>& surfaces,
                                                      const std::string& name, const SdfParams& params,
                                                      const Progress& progress = {});

}  // namespace trephine::meshio
