// SPDX-License-Identifier: GPL-3.0-or-later
#include "trunk/clavicle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/refusal.h"
#include "mask/filters.h"
#include "mask/hu_view.h"
#include "mask/surface_field.h"
#include "trunk/clavicle_parts.h"

namespace trephine::trunk {
namespace {

constexpr double joint_reach_mm = 20;  ///< beyond a chain's ends its bone may go on so far
constexpr double cut_sigma_mm = 1.0;
constexpr double cut_scale_hu = 100;

mask::BitMask bone_mask(const grid::Field& bone) {
  if (std::abs(bone.direction.column[0].x) < 0.7 || std::abs(bone.direction.column[2].z) < 0.7)
    throw refusal("clavicle", "the volume's slices are not axial",
                  {"take the axial series (`import --list` shows all)"});
  mask::BitMask mask = mask::positive(bone, bone);
  if (!mask.any())
    throw refusal("bone", fmt::format("the mask is empty: 0 of {} voxels", bone.count()),
                  {"lower `lower_hu` of its `segment`"});
  return mask;
}

const char* name_of(BodySide side) { return side == BodySide::right ? "right" : "left"; }

bool wanted(BodySide side, BodySide found) { return side == BodySide::both || side == found; }

std::vector<BlobChain> chains_of(const mask::BitMask& bone, const ClavicleParams& p, const Progress& progress) {
  const mask::BitMask core = p.core_mm > 0 ? mask::eroded(bone, p.core_mm, progress) : bone;
  return clavicle_chains(core, p, progress);
}

/// Of a plane in which the chain has no blob, where it goes through, by the blobs beside the gap. In one that has a
/// blob the radius is 0, and beyond the chain's ends endless.
struct Middle {
  double j = 0, k = 0, radius_mm = std::numeric_limits<double>::infinity();
  double off_mm(int at_j, int at_k, const grid::Lattice& l) const {
    return std::hypot((at_j - j) * l.spacing_mm.y, (at_k - k) * l.spacing_mm.z);
  }
};
std::vector<Middle> middles_of(const BlobChain& chain, const grid::Lattice& l) {
  std::vector<Middle> out(std::size_t(l.size[0]));
  for (std::size_t n = 0; n < chain.blobs.size(); ++n) {
    const Blob &a = chain.blobs[n], &b = chain.blobs[std::min(n + 1, chain.blobs.size() - 1)];
    out[std::size_t(a.i)].radius_mm = 0;
    for (int i = a.i + 1; i < b.i; ++i) {
      const Vec3 at = a.middle + (b.middle - a.middle) * (double(i - a.i) / (b.i - a.i));
      out[std::size_t(i)] = {at.y, at.z, std::sqrt((a.area_mm2 + b.area_mm2) / 2 / M_PI)};
    }
  }
  return out;
}

/// 1 in the chain, its gaps too; 2 in all other bone that is not just beyond its ends, where the joints are.
grid::Mask seeds_of(const mask::BitMask& bone, const BlobChain& chain, const std::vector<Middle>& middles) {
  const grid::Lattice& l = bone.lattice();
  grid::Mask seeds(l);
  const int reach = int(std::lround(joint_reach_mm / l.spacing_mm.x));
  const int from = chain.blobs.front().i, to = chain.blobs.back().i;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        if (!bone.get(i, j, k)) continue;
        if (i < from - reach || i > to + reach) seeds.at(i, j, k) = 2;
        const Middle& at = middles[std::size_t(i)];
        if (i > from && i < to && at.off_mm(j, k, l) < at.radius_mm) seeds.at(i, j, k) = 1;
      }
  for (const Blob& b : chain.blobs)
    for (const Blob::Run& r : b.runs)
      for (int j = r.begin; j < r.end; ++j) seeds.at(b.i, j, r.k) = 1;
  return seeds;
}

mask::BitMask of_chain(const grid::Mask& seeds) {
  return mask::make_mask(seeds, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < seeds.size[0]; ++i) row[i] = seeds.at(i, j, k) == 1;
  });
}

/// Also 2 in what lies beside the chain in its planes, and in what lies beyond them and joins it only by a narrow neck.
void add_others(grid::Mask& seeds, const mask::BitMask& bone, const std::vector<Middle>& middles, double core_mm,
                const Progress& progress) {
  const mask::BitMask mine = of_chain(seeds);
  const auto is_beside = [&](int i, int j, int k) {
    const Middle& at = middles[std::size_t(i)];
    return at.radius_mm == 0 || at.off_mm(j, k, seeds) > 1.4 * at.radius_mm;
  };
  for (int step = 0; step <= 3; ++step) {
    const mask::BitMask core = step == 0 ? bone : mask::eroded(bone, step * core_mm, progress);
    const mask::Components pieces = mask::components(core);
    const mask::BitMask hanging = mask::select(pieces, mask::touching(pieces, mine));
    const bool in_planes = step == (core_mm > 0 ? 1 : 0);
    for (int k = 0; k < seeds.size[2]; ++k)
      for (int j = 0; j < seeds.size[1]; ++j)
        for (int i = 0; i < seeds.size[0]; ++i)
          if (seeds.at(i, j, k) == 0 && core.get(i, j, k)) {
            if (!hanging.get(i, j, k) || (in_planes && is_beside(i, j, k))) seeds.at(i, j, k) = 2;
          }
    if (core_mm == 0) break;
  }
}

struct Parted {
  mask::BitMask mask;
  double joint_mm2 = 0;
};

Parted parted(const mask::BitMask& bone, const BlobChain& chain, const ClavicleParams& p, const Progress& progress) {
  const grid::Lattice& whole = bone.lattice();
  // Only the bone around the chain takes part.
  grid::Box box;
  box.begin = {whole.size[0], whole.size[1], whole.size[2]};
  for (const Blob& b : chain.blobs)
    for (const Blob::Run& r : b.runs) {
      box.begin = {std::min(box.begin[0], b.i), std::min(box.begin[1], r.begin), std::min(box.begin[2], r.k)};
      box.end = {std::max(box.end[0], b.i + 1), std::max(box.end[1], r.end), std::max(box.end[2], r.k + 1)};
    }
  for (int a = 0; a < 3; ++a) {
    const int margin = int(std::lround(1.5 * joint_reach_mm / whole.spacing_mm[a]));
    box.begin[a] = std::max(0, box.begin[a] - margin);
    box.end[a] = std::min(whole.size[a], box.end[a] + margin);
  }
  const mask::BitMask here = mask::crop(bone, box);
  const grid::Lattice& l = here.lattice();
  BlobChain moved = chain;
  for (Blob& b : moved.blobs) {
    b.i -= box.begin[0];
    b.middle = b.middle - Vec3{double(box.begin[0]), double(box.begin[1]), double(box.begin[2])};
    for (Blob::Run& r : b.runs) r.k -= box.begin[2], r.begin -= box.begin[1], r.end -= box.begin[1];
  }
  const std::vector<Middle> middles = middles_of(moved, l);
  grid::Mask seeds = seeds_of(here, moved, middles);
  add_others(seeds, here, middles, p.core_mm, progress);
  mask::BitMask air = here;
  air.invert();
  const grid::Mask labels = mask::flood(mask::distance_mm(air, progress), here, seeds, progress);
  // More than one piece where the clavicle is broken.
  const mask::Components pieces = mask::components(of_chain(labels));
  const mask::BitMask mine = mask::select(pieces, mask::touching(pieces, of_chain(seeds)));
  Parted out;
  const double face[3] = {l.spacing_mm.y * l.spacing_mm.z, l.spacing_mm.x * l.spacing_mm.z,
                          l.spacing_mm.x * l.spacing_mm.y};
  // By axis and direction: a slanted plane's area is the length of this vector, not the sum of its steps.
  std::array<double, 3> area{0, 0, 0};
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        if (!mine.get(i, j, k)) continue;
        for (int a = 0; a < 3; ++a)
          for (int side : {-1, 1}) {
            const int x = i + (a == 0) * side, y = j + (a == 1) * side, z = k + (a == 2) * side;
            if (here.at(x, y, z) && !mine.get(x, y, z)) area[a] += face[a];
          }
      }
  out.joint_mm2 = std::sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
  out.mask = mask::placed(mine, whole);
  return out;
}

}  // namespace

std::vector<ClavicleCourse> clavicle_courses(const grid::Field& bone, const ClavicleParams& params,
                                             const Progress& progress) {
  std::vector<ClavicleCourse> courses;
  for (const BlobChain& chain : chains_of(bone_mask(bone), params, progress)) {
    if (!wanted(params.side, chain.side)) continue;
    ClavicleCourse course;
    course.side = chain.side;
    std::vector<double> areas_mm2;
    const int n = int(chain.blobs.size()), reach = std::max(1, int(std::lround(6 / bone.spacing_mm.x)));
    for (int b = 0; b < n; ++b) {
      const int around = std::min({reach, b, n - 1 - b});
      Vec3 sum;
      double area = 0;
      for (int o = b - around; o <= b + around; ++o) {
        sum += chain.blobs[o].middle;
        area += chain.blobs[o].area_mm2;
      }
      course.points_mm.push_back(bone.to_world_mm(sum / (2 * around + 1)));
      areas_mm2.push_back(area / (2 * around + 1));
    }
    for (int b = 0; b < n; ++b) {
      const Vec3 along =
          normalized(course.points_mm[std::min(b + reach, n - 1)] - course.points_mm[std::max(b - reach, 0)]);
      const double across = std::abs(dot(along, bone.direction.column[0]));
      course.radius_mm.push_back(std::sqrt(areas_mm2[b] * across / M_PI) + params.core_mm);
    }
    if (course.points_mm.front().y > course.points_mm.back().y) {
      std::reverse(course.points_mm.begin(), course.points_mm.end());
      std::reverse(course.radius_mm.begin(), course.radius_mm.end());
    }
    courses.push_back(std::move(course));
  }
  return courses;
}

Outcome<grid::Field, ClaviclesResult> find_clavicles(const grid::Field& bone, const ClavicleParams& params,
                                                     const Progress& progress, const grid::Field* without) {
  ClaviclesResult result;
  Warnings warnings;
  const mask::BitMask whole = bone_mask(bone);
  const auto chains = chains_of(whole, params, progress);
  progress.report(0.3);
  mask::BitMask all(bone);
  double found[2] = {0, 0};
  for (const BlobChain& chain : chains) {
    if (!wanted(params.side, chain.side)) continue;
    const Parted one = parted(whole, chain, params, progress);
    const std::string name = name_of(chain.side);
    const double ml = double(one.mask.count()) * bone.voxel_volume_mm3() / 1000;
    found[chain.side == BodySide::left] = ml;
    const double length_mm =
        norm(bone.to_world_mm(chain.blobs.front().middle) - bone.to_world_mm(chain.blobs.back().middle));
    result.sides.emplace_back(name, ClavicleFigures{length_mm, ml, one.joint_mm2});
    if (params.part == ClaviclePart::clavicle && one.joint_mm2 > params.max_joint_mm2)
      warnings.push_back({"clavicle_hangs_on_bone",
                          "the {side} clavicle hangs on other bone over {joint_mm2:.0f} mm^2: it is cut from it where "
                          "the bone is narrow, which may not be its joint",
                          {{"side", name}, {"joint_mm2", one.joint_mm2}}});
    if (ml < 8 || ml > 80)
      warnings.push_back({"unusual_clavicle",
                          "the {side} clavicle has {clavicle_ml:.0f} ml, which is not of the size of a whole adult one",
                          {{"side", name}, {"clavicle_ml", ml}}});
    all |= one.mask;
  }
  for (const BodySide side : {BodySide::right, BodySide::left})
    if (found[side == BodySide::left] == 0 && wanted(params.side, side)) {
      if (params.side == BodySide::both && all.any()) {
        warnings.push_back({"no_clavicle", "no {side} clavicle is found", {{"side", name_of(side)}}});
      } else if (params.side != BodySide::both || side == BodySide::left) {
        throw refusal(
            "clavicle",
            fmt::format("nothing in front of the other bone is round and at least {:.0f} mm long from side to "
                        "side: is this a chest with its shoulders?",
                        params.min_length_mm),
            {"lower `min_length_mm`, or take the bone whole (configs/ct_chest_bone.yaml)"});
      }
    }
  progress.report(0.8);
  if (params.part == ClaviclePart::rest) {
    mask::BitMask rest = whole;
    all = rest.remove(all);
    if (without) all.remove(mask::positive(*without, whole.lattice()));
  }
  result.size = mask::check_mask(all, whole.lattice().count());
  const grid::Box box = grid::grown(all.bounds(), 2, bone);
  grid::Field field = trephine::grid::crop(bone, box);
  result.cut_voxels_count = mask::place_surface(field, mask::crop(all, box), cut_sigma_mm, cut_scale_hu, progress);
  progress.report(1);
  return {std::move(field), std::move(result), std::move(warnings)};
}

}  // namespace trephine::trunk
