// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How find_findings looks for each kind; for the sources of this room only.
#include "base/pi.h"
#include "findings/findings.h"
#include "mask/coarse.h"
#include "place/place_head.h"

namespace trephine::findings {

/// Of what is as bright as vessels with contrast medium: from here on tubes, and dense tissue that hangs on what is so
/// bright, may be vessels. Between the most of a head without medium (0.53 ml, with a shunt in it) and the only one
/// known to have it (0.79 ml).
constexpr double vessels_ml = 0.65;

/// Of the template, 70 mm from the middle of the head: from here on a ray meets the vault. Below lie orbits, ears and
/// thin temporal bone.
constexpr double vault_mm = 52;

/// Unit vectors that lie evenly over the sphere, along a spiral, and what each has of it.
constexpr int directions_count = 16000;
constexpr double direction_sr = 4 * pi / directions_count;
std::vector<Vec3> even_directions();

/// The inside of the head on cells of about 1.5 mm.
struct Inside {
  mask::CoarseRaster raster;
  mask::BitMask skull;         ///< cells that hold bone
  mask::BitMask all;           ///< what the skull encloses; where it is open, what the brain's closed envelope does
  mask::BitMask envelope;      ///< the brain with its sulci closed
  mask::BitMask ventricles;    ///< may be empty
  grid::Grid<float> depth_mm;  ///< of a cell of `all` below its surface
  grid::Grid<float> tissue;    ///< HU, smoothed, brain at 30; -1000 where there is bone, air or something dense
  mask::BitMask dense;         ///< cells with something denser than soft tissue that is no bone of the skull
  mask::BitMask air;
  mask::BitMask vessels;     ///< what is as bright as vessels with contrast medium, away from bone
  double contrast_ml = 0;    ///< of it
  double noise_hu = 0;       ///< of `tissue`
  bool noise_known = false;  ///< there is tissue to measure it in; else noise_hu is 0
  place::HeadPlace place;

  const grid::Lattice& cells() const { return raster.cells; }
  Vec3 lps(int i, int j, int k) const { return raster.cells.to_world_mm({double(i), double(j), double(k)}); }
  double cell_ml() const { return raster.cells.voxel_volume_mm3() / 1000; }
};
Inside inside_of(const grid::HuVolume& volume, const FindingShapes& shapes, const Progress& progress);

/// The voxels of a finding: their middle, number, and extent along their principal axes (standard deviations, mm).
struct Extent {
  Vec3 middle_mm, axis;  ///< axis: unit, the longest
  double count = 0, mean = 0;
  double sigma_mm[3] = {0, 0, 0};
  double longest_mm() const { return 3.46 * sigma_mm[0]; }  ///< of an even rod; 0.9 of a ball's width
};
Extent extent_of(const std::vector<Vec3>& points_mm);

struct Seen {
  Finding finding;
  mask::BitMask cells;  ///< on Inside::cells(); empty where nothing of it is outlined
};
/// `implants`: about tubes and metal, blur and streaks are as dense as blood.
std::vector<Seen> dense_tissue(const Inside& in, const std::vector<Seen>& implants, const FindingsParams& params,
                               const Progress& progress);
std::vector<Seen> dark_tissue(const Inside& in, const FindingsParams& params, const Progress& progress);
/// Air inside the skull, away from its base.
std::vector<Seen> air_inside(const Inside& in);
std::vector<Seen> bone_gaps(const Inside& in, const grid::HuVolume& volume, const grid::Field& skull,
                            const FindingsParams& params);
/// Where the vault's outer table is dented over a round place, and the bone is thin there, but closed.
std::vector<Seen> bone_dents(const Inside& in, const grid::Field& skull, const grid::Lattice& scan);
std::vector<Seen> metal(const Inside& in, const grid::HuVolume& volume, const grid::Field& skull,
                        const FindingsParams& params, const Progress& progress);
std::vector<Seen> tubes(const Inside& in, const grid::HuVolume& volume, const FindingShapes& shapes,
                        const FindingsParams& params, const Progress& progress);

/// "1.2 ml", "34 ml".
std::string ml_text(double ml);

}  // namespace trephine::findings
