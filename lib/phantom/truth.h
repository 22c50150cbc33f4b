// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "base/params.h"
#include "base/progress.h"
#include "grid/grid.h"
#include "phantom/head.h"
#include "phantom/scan.h"
#include "surface/trimesh.h"

namespace trephine::phantom {

struct TruthParams {
  double mesh_step_mm = 1.0;
  bool labels = true;

  template <class V>
  static void describe(V& v) {
    using P = TruthParams;
    v.number(&P::mesh_step_mm, "mesh_step_mm", Range{0, 10},
             "Lattice step of the truth's meshes, whose points lie on the analytic surface; 0 writes no meshes.");
    v.flag(&P::labels, "labels", "Write the truth's labels on the scan's voxels (not for tilted or uneven slices).");
  }
};

/// Where a scan's voxel centres lie: a box along the axes, of a tilted or oblique scan the part of it between `faces`.
struct ScannedRegion {
  struct Face {
    Vec3 normal;  ///< of length 1, outwards
    double offset_mm;
  };
  surface::Bounds box_mm;
  std::vector<Face> faces;
  ScannedRegion(const surface::Bounds& box = {}) : box_mm(box) {}
  /// How far beyond the farthest of its planes, mm; negative inside: less the distance to the nearest.
  double beyond_mm(Vec3 p) const;
};
ScannedRegion scanned_region(const ScanParams& params);

/// The truth's mesh of one anatomy within a region: marching tetrahedra on a lattice of at most `step_mm`, each point
/// then moved onto the analytic surface. It is closed, 2-manifold and oriented outwards; where the region cuts the
/// anatomy the mesh is capped in the region's face. Empty where no part of the anatomy lies within.
surface::TriMesh truth_mesh(const Head& head, Anatomy anatomy, const ScannedRegion& region, double step_mm,
                            const Progress& progress = {});

/// Head::label at every voxel centre of the lattice.
grid::Mask truth_labels(const Head& head, const grid::Lattice& lattice, const Progress& progress = {});

/// Head::thing at every voxel centre of the lattice; level hard.
grid::Mask truth_things(const Head& head, const grid::Lattice& lattice, const Progress& progress = {});

/// Writes into `folder` (made where missing): truth.json (the head's parameters, from which read_truth rebuilds it; the
/// scan's; landmarks; fiducials' centres; volumes within the scanned region; the lattice), labels.nrrd, at level
/// hard things.nrrd, and skin.vtp, skull.vtp, brain.vtp and ventricles.vtp. Returns
/// those volumes, ml, by the name of the anatomy. Throws 73 and
/// 74 as FileWriter, Cancelled.
Named<double> write_truth(const std::filesystem::path& folder, const Head& head, const Scan& scan,
                          const ScanParams& scan_params, const TruthParams& params, const Progress& progress = {});

/// The content of truth.json.
struct Truth {
  Head head;
  std::vector<Fiducial> fiducials;
  ScannedRegion scanned;  ///< beyond it nothing was seen
};
/// Reads truth.json and rebuilds the head. Throws Error 66 where it cannot be read, 65 naming the field where it is not
/// a truth file of ours or of a version that this program does not know.
Truth read_truth(const std::filesystem::path& file);

}  // namespace trephine::phantom
