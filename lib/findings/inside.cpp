// SPDX-License-Identifier: GPL-3.0-or-later
// The inside of the head on coarse cells, and what its tissue is like.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/refusal.h"
#include "findings/findings_parts.h"
#include "head/soft_tissue.h"
#include "mask/filters.h"
#include "place/cranium.h"

namespace trephine::findings {
namespace {

constexpr double cell_mm = 1.5, smooth_mm = 1.2;
constexpr double envelope_mm = 8;                ///< by which the brain's sulci are closed
constexpr double bone_blur_mm = 1.5;             ///< HU this near to bone are not reliable
constexpr float soft_from = -30, soft_to = 120;  ///< HU of tissue, fluid and blood
constexpr float air_hu = -300;
constexpr float vessel_from = 130, vessel_to = 500;
constexpr double dense_blur_mm = 2;
constexpr double noise_depth_mm = 6;  ///< below the edge of tissue, where tissue_noise() measures
const char* const remedy = "take a series that shows the brain, or give another field of it";

mask::BitMask cavity_of(const mask::BitMask& bone, const Progress& progress) {
  try {
    return place::cranial_cavity(bone, progress).value;
  } catch (const Error& e) {  // an open skull encloses nothing: the brain's envelope is all there is
    if (e.code() != ExitCode::quality) throw;
    return mask::BitMask(bone.lattice());
  }
}

}  // namespace

Inside inside_of(const grid::HuVolume& volume, const FindingShapes& shapes, const Progress& progress) {
  const mask::HuView hu(volume);
  const grid::Lattice& l = hu.lattice();
  const mask::BitMask bone = mask::positive(*shapes.skull, l), brain = mask::positive(*shapes.brain, l);
  if (!brain.any()) throw refusal("brain", "is empty", {remedy});
  Inside in;
  in.raster = mask::coarse_raster(l, cell_mm, true);
  in.skull = mask::coarse_mask(bone, in.raster, 0);
  in.envelope = mask::closed(mask::coarse_mask(brain, in.raster, 0.5), envelope_mm, progress);
  in.ventricles = shapes.ventricles ? mask::coarse_mask(mask::positive(*shapes.ventricles, l), in.raster, 0.5)
                                    : mask::BitMask(in.cells());
  in.all = mask::coarse_mask(shapes.cavity ? *shapes.cavity : cavity_of(bone, progress), in.raster, 0.5);
  progress.report(0.3);
  in.all |= in.envelope;
  mask::BitMask beyond = in.all;
  in.depth_mm = mask::distance_mm(beyond.invert(), progress);

  const mask::BitMask whole = mask::fine_mask(in.all, in.raster);
  const auto within = [&](float from, float to) {
    mask::BitMask m = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
      const std::size_t start = l.index(0, j, k);
      for (int i = 0; i < l.size[0]; ++i) row[i] = hu(start + i) > from && hu(start + i) < to;
    });
    return m &= whole;
  };
  // In thick slices what bone shows of itself in the slice above or below is no vessel.
  const double thick_mm = 1.05 * std::max({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z});
  const mask::BitMask soft = within(soft_from, soft_to);
  in.air = mask::coarse_mask(within(-1e6f, air_hu), in.raster, 0.5);
  in.dense = mask::coarse_mask(within(soft_to, 1e6f), in.raster, 0.3);
  in.dense.remove(mask::dilated(in.skull, std::max(1.5 * bone_blur_mm, thick_mm), progress));
  in.vessels = mask::coarse_mask(within(vessel_from, vessel_to), in.raster, 0.5);
  in.vessels.remove(mask::dilated(in.skull, std::max(2 * bone_blur_mm, thick_mm), progress));
  in.contrast_ml = double(in.vessels.count()) * in.cell_ml();

  mask::BitMask known = mask::coarse_mask(soft, in.raster, 0.5);
  known.remove(mask::dilated(in.skull, bone_blur_mm, progress));
  known.remove(mask::dilated(in.dense, dense_blur_mm, progress));
  in.tissue = mask::coarse_mean(hu, soft, in.raster, -1000);
  mask::BitMask of_brain = known;
  of_brain &= in.envelope;
  if (!of_brain.any()) throw refusal("brain", "has no soft tissue", {remedy});
  const double level = [&] {
    std::vector<float> values;
    for (int k = 0; k < in.cells().size[2]; ++k)
      for (int j = 0; j < in.cells().size[1]; ++j)
        for (int i = 0; i < in.cells().size[0]; ++i)
          if (of_brain.get(i, j, k)) values.push_back(in.tissue.at(i, j, k));
    return double(mask::median(values, 30));
  }();
  // By one value and not by a surface: a large bleed must not bend the level about itself.
  for (float& v : in.tissue.voxels)
    if (v > -1000) v += float(head::tissue_level_hu - level);
  in.noise_known = mask::eroded(of_brain, noise_depth_mm, progress).any();
  const double white = head::tissue_noise(in.tissue, of_brain, progress);  // HU mm^1.5
  in.tissue = mask::masked_gaussian(std::move(in.tissue), known, smooth_mm, -1000, 0.15, progress);
  const double effective_mm3 = std::pow(3.545 * smooth_mm, 3) + in.cells().voxel_volume_mm3();
  in.noise_hu = white / std::sqrt(effective_mm3);
  in.place = place::place_head(in.envelope, in.ventricles.any() ? &in.ventricles : nullptr, l, progress);
  progress.report(1);
  return in;
}

std::vector<Vec3> even_directions() {
  std::vector<Vec3> all;
  all.reserve(directions_count);
  for (int n = 0; n < directions_count; ++n) {
    const double z = 1 - 2 * (n + 0.5) / directions_count, r = std::sqrt(1 - z * z),
                 turn = pi * (3 - std::sqrt(5.0)) * n;
    all.push_back({r * std::cos(turn), r * std::sin(turn), z});
  }
  return all;
}

Extent extent_of(const std::vector<Vec3>& points) {
  Extent e;
  e.count = double(points.size());
  if (points.empty()) return e;
  for (const Vec3& p : points) e.middle_mm += p;
  e.middle_mm = e.middle_mm / e.count;
  Eigen::Matrix3d c = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points) {
    const Vec3 d = p - e.middle_mm;
    const Eigen::Vector3d v(d.x, d.y, d.z);
    c += v * v.transpose() / e.count;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(c);  // ascending
  for (int a = 0; a < 3; ++a) e.sigma_mm[a] = std::sqrt(std::max(0.0, axes.eigenvalues()[2 - a]));
  const Eigen::Vector3d longest = axes.eigenvectors().col(2);
  e.axis = {longest.x(), longest.y(), longest.z()};
  return e;
}

}  // namespace trephine::findings
