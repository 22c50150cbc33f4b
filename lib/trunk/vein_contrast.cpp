// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/rank.h"
#include "mask/filters.h"
#include "mask/surface_field.h"
#include "trunk/vein_parts.h"

namespace trephine::trunk {

double followed(const mask::BitMask& mask, const VeinCourse& course, double reach_mm) {
  const grid::Lattice& l = mask.lattice();
  std::size_t beside = 0;
  for (const Vec3& p : course.points_mm) {
    VeinCourse point;
    point.points_mm = {p};
    const grid::Box box = box_around(point, l, reach_mm);
    bool met = false;
    for (int k = box.begin[2]; k < box.end[2] && !met; ++k)
      for (int j = box.begin[1]; j < box.end[1] && !met; ++j)
        for (int i = box.begin[0]; i < box.end[0] && !met; ++i)
          met = mask.get(i, j, k) && norm(l.to_world_mm({double(i), double(j), double(k)}) - p) <= reach_mm;
    beside += met;
  }
  return double(beside) / double(course.points_mm.size());
}

namespace {

constexpr double sigma_mm = 1.0;
constexpr double clear_of_noise = 4;                 ///< times the spread of the tissue without contrast medium
constexpr double bone_blur_mm = 1.5;                 ///< HU this near to bone are not believed
constexpr float soft_from_hu = 0, soft_to_hu = 120;  ///< tissue without contrast medium
constexpr float known_from_hu = -150;                ///< neither air nor lung
constexpr double open_mm = 1.0;                      ///< bridges to other vessels and specks of noise
constexpr double min_follow = 0.6;                   ///< share of the course along which the vein must be found
constexpr double min_radius_mm = 1.5, max_radius_mm = 11;
constexpr double cut_sigma_mm = 1.0;

/// The piece of the mask that follows the largest part of the course; of equal ones the largest piece.
mask::BitMask best_piece(const mask::BitMask& mask, const VeinCourse& course, double reach_mm, double& share) {
  const mask::Components pieces = mask::components(mask);
  share = 0;
  mask::BitMask best(mask.lattice());
  std::vector<std::size_t> order;
  for (std::size_t c = 0; c < pieces.list.size(); ++c)
    if (double(pieces.list[c].voxels) * mask.lattice().voxel_volume_mm3() >= 200) order.push_back(c);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return pieces.list[a].voxels > pieces.list[b].voxels; });
  for (std::size_t c : order) {
    std::vector<char> keep(pieces.list.size());
    keep[c] = 1;
    mask::BitMask piece = mask::select(pieces, keep);
    const double s = followed(piece, course, reach_mm);
    if (s > share) share = s, best = std::move(piece);
  }
  return best;
}

float percentile(std::vector<float>& v, double share) {
  return value_at_rank(v, std::min(v.size() - 1, std::size_t(share * double(v.size()))));
}

}  // namespace

EnhancedVein enhanced_vein(const mask::HuView& hu, const mask::BitMask& bone, const VeinCourse& course,
                           const VeinParams& p, const Progress& progress) {
  EnhancedVein vein;
  const grid::Box box = box_around(course, hu.lattice(), p.search_mm + 3);
  const grid::Grid<float> raw = mask::crop(hu, box);
  const grid::Lattice& l = raw;
  mask::BitMask known = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = raw.at(i, j, k) > known_from_hu;
  });
  known.remove(mask::dilated(mask::placed(bone, l), bone_blur_mm, progress));
  grid::Field soft = mask::masked_gaussian(raw, known, sigma_mm, -1000, 0.1, progress);
  const grid::Grid<float> away = distance_to(course, l, p.search_mm);
  mask::BitMask region = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) row[i] = away.at(i, j, k) < float(p.search_mm);
  });
  region &= known;
  std::vector<float> tissue;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (region.get(i, j, k) && soft.at(i, j, k) > soft_from_hu && soft.at(i, j, k) < soft_to_hu)
          tissue.push_back(soft.at(i, j, k));
  const float usual = mask::median(tissue, 40);
  for (float& v : tissue) v = std::abs(v - usual);
  const float least = std::max(float(p.min_contrast_hu), float(clear_of_noise * 1.48) * mask::median(tissue, 0));
  const auto above = [&](float threshold) {
    mask::BitMask mask = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i) row[i] = soft.at(i, j, k) > threshold;
    });
    return mask &= region;
  };
  const auto opened = [&](const mask::BitMask& mask) {
    mask::BitMask open = mask::dilated(mask::eroded(mask, open_mm, progress), open_mm, progress);
    return open &= mask;
  };
  double share = 0;
  mask::BitMask piece = best_piece(opened(above(usual + 0.5f * least)), course, p.search_mm * 0.75, share);
  if (!piece.any()) return vein;
  std::vector<float> inside;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i)
        if (piece.get(i, j, k)) inside.push_back(soft.at(i, j, k));
  const float bright = percentile(inside, 0.75);
  vein.contrast_hu = bright - usual;
  if (vein.contrast_hu < least) return vein;
  const float threshold = 0.5f * (bright + usual);
  const mask::BitMask material = above(threshold);
  mask::BitMask open = opened(material);
  mask::BitMask shape = best_piece(open, course, p.search_mm * 0.75, share);
  if (share < min_follow) return vein;
  // Gives back what the opening took from its corners.
  shape = mask::grown_within(shape, material, 2 * open_mm, progress);
  const double volume_mm3 = double(shape.count()) * l.voxel_volume_mm3();
  vein.length_mm = share * course.length_mm();
  vein.radius_mm = std::sqrt(volume_mm3 / vein.length_mm / M_PI);
  if (vein.radius_mm < min_radius_mm || vein.radius_mm > max_radius_mm) return vein;
  const float scale = float(sigma_mm * 2 / vein.contrast_hu);  // about mm: the blurred edge's slope
  for (float& v : soft.voxels) v = (v - threshold) * scale;
  mask::place_surface(soft, shape, cut_sigma_mm, 1, progress);
  vein.field = std::move(soft);
  vein.found = true;
  return vein;
}

}  // namespace trephine::trunk
