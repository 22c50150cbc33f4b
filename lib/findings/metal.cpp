// SPDX-License-Identifier: GPL-3.0-or-later
// Metal, and dense bone that looks like it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "findings/findings_parts.h"
#include "mask/filters.h"

namespace trephine::findings {
namespace {

constexpr double above_base_mm = -5;   ///< of the template: teeth and their fillings lie below
constexpr double not_placed_mm = -35;  ///< the same, of the brain's middle, where the template does not fit
constexpr double head_mm = 25;         ///< from the brain outward: bone and scalp, and no clamp of a couch
constexpr double min_metal_mm3 = 15;
constexpr double vault_mm = 25;  ///< of the template: above it the bone is that of the vault
constexpr double vault_share = 0.99;
/// Of a piece's mean HU to those of the vault's densest hundredth: metal is denser than that. The bone about the inner
/// ear is the densest of the body, and a slice thinner than it shows it at up to 1.5 times the vault's.
constexpr double metal_ratio = 1.3, ear_ratio = 1.7;
constexpr double blur_mm = 3;
constexpr double doubtful = 0.42;

/// Where the template has the petrous bones.
bool is_at_ear(Vec3 t) { return std::abs(t.x) > 18 && std::abs(t.x) < 60 && t.y > -15 && t.y < 25 && t.z < 18; }

/// What only the densest hundredth of the vault's bone exceeds (HU); 0 without a vault. What is judged by it, and its
/// blur, is left out of it: a large implant would hide itself.
double densest_hu(const Inside& in, const mask::HuView& hu, const grid::Field& skull, const mask::BitMask& judged,
                  const Progress& progress) {
  const grid::Lattice& l = hu.lattice();
  const mask::BitMask bone = mask::without(mask::positive(skull, l), mask::dilated(judged, blur_mm, progress));
  std::vector<std::int64_t> of(4096, 0);
  std::int64_t all = 0;
  const double middle = in.envelope.centre_mm().z;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        if (!bone.get(i, j, k)) continue;
        const Vec3 lps = l.to_world_mm({double(i), double(j), double(k)});
        if (in.place.sure ? in.place.to_template(lps).z < vault_mm : lps.z < middle) continue;
        ++of[std::size_t(std::clamp(int(hu(i, j, k)), 0, 4095))], ++all;
      }
  std::int64_t below = 0;
  for (std::size_t v = 0; v < of.size() && all > 0; ++v)
    if ((below += of[v]) >= std::int64_t(vault_share * double(all))) return double(v);
  return 0;
}

/// The voxel of a piece that is nearest to its middle: between two pieces, or in a ring, the middle itself is none.
Vec3 within_piece(const mask::Components& all, std::size_t piece, const grid::Lattice& lattice) {
  std::vector<Vec3> cells;
  mask::for_each_voxel(all, [&](int c, int i, int j, int k) {
    if (std::size_t(c) == piece) cells.push_back(lattice.to_world_mm({double(i), double(j), double(k)}));
  });
  const Vec3 middle = extent_of(cells).middle_mm;
  return *std::min_element(cells.begin(), cells.end(),
                           [&](Vec3 a, Vec3 b) { return norm(a - middle) < norm(b - middle); });
}

/// Pieces that are told as one finding.
struct Pieces {
  int count = 0;
  double ml = 0, sum_hu = 0;
  std::int64_t voxels = 0, voxels_of_largest = 0;
  std::size_t largest = 0;  ///< of the components
};

Seen told(const Pieces& p, bool sure, Vec3 at_mm) {
  Seen s;
  s.finding.kind = FindingKind::metal;
  s.finding.where = "in the head";
  s.finding.position_mm = at_mm;
  s.finding.confidence = 0.9 * mask::ramp(1000 * p.ml, 0.5 * min_metal_mm3, 3 * min_metal_mm3);
  if (!sure) s.finding.confidence = std::min(s.finding.confidence, doubtful);
  s.finding.figures = {
      {"volume_ml", p.ml}, {"pieces_count", std::int64_t{p.count}}, {"mean_hu", p.sum_hu / double(p.voxels)}};
  s.finding.text =
      fmt::format("{} piece{} {} above the base of the skull, {}", p.count, p.count == 1 ? "" : "s",
                  sure ? "of metal" : "as dense as metal, or as the densest bone of this scan,", ml_text(p.ml));
  return s;
}

}  // namespace

std::vector<Seen> metal(const Inside& in, const grid::HuVolume& volume, const grid::Field& skull,
                        const FindingsParams& params, const Progress& progress) {
  const mask::HuView hu(volume);
  const grid::Lattice& l = hu.lattice();
  // Cut off where the head ends: a frame may hold on to the skull, and go around the head.
  const mask::BitMask head = mask::dilated(in.envelope, head_mm, progress);
  const mask::BitMask dense =
      mask::both(mask::above(hu, params.metal_hu), mask::placed(mask::fine_mask(head, in.raster), l));
  const mask::Components pieces = mask::components(dense, true);
  if (pieces.list.empty()) return {};
  std::vector<double> sum_hu(pieces.list.size(), 0);
  mask::for_each_voxel(pieces, [&](int c, int i, int j, int k) { sum_hu[std::size_t(c)] += hu(i, j, k); });
  const double densest = densest_hu(in, hu, skull, dense, progress), lowest = in.envelope.centre_mm().z + not_placed_mm;
  Pieces sure, not_sure;
  for (std::size_t c = 0; c < pieces.list.size(); ++c) {
    const std::int64_t voxels = std::int64_t(pieces.list[c].voxels);
    const grid::Box& box = pieces.list[c].box;
    Vec3 at;
    for (int a = 0; a < 3; ++a) at[a] = 0.5 * (box.begin[a] + box.end[a] - 1);
    at = l.to_world_mm(at);
    const double mm3 = double(voxels) * l.voxel_volume_mm3(), mean = sum_hu[c] / double(voxels);
    const Vec3 t = in.place.to_template(at);
    const bool above = in.place.sure ? t.z > above_base_mm : at.z > lowest;
    if (mm3 < min_metal_mm3 || !above) continue;
    const double ratio = in.place.sure && is_at_ear(t) ? ear_ratio : metal_ratio;
    Pieces& with = mean >= ratio * densest ? sure : not_sure;
    if (voxels > with.voxels_of_largest) with.largest = c, with.voxels_of_largest = voxels;
    with.ml += mm3 / 1000, with.sum_hu += sum_hu[c], with.voxels += voxels, ++with.count;
  }
  std::vector<Seen> all;
  if (sure.count > 0) all.push_back(told(sure, true, within_piece(pieces, sure.largest, l)));
  if (not_sure.count > 0) all.push_back(told(not_sure, false, within_piece(pieces, not_sure.largest, l)));
  return all;
}

}  // namespace trephine::findings
