// SPDX-License-Identifier: GPL-3.0-or-later
#include "face/deface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "face/deface_distance.h"
#include "mask/filters.h"
#include "mask/hu_view.h"

namespace trephine::face {
namespace {

using mask::BitMask;

constexpr double soft_low_hu = 0, soft_high_hu = 80;  // what covers the cut
constexpr double node_mm = 1.5;                       // raster of the distances
constexpr double smoothing_mm = 4;                    // of the cut's surface: dents of eyes and lips
constexpr float level_reach_mm = 10;                  // distances beyond this have no effect
constexpr double side_to_front_mm = 40;               // from the tragi on, over which the depth grows
constexpr double crop_under_nasion_mm = 10;
constexpr double landmark_off_skin_mm = 25;  // what is found lies a few mm off, a nasion in the brain more

double longest_side_mm(const grid::Lattice& l) { return std::max({l.spacing_mm.x, l.spacing_mm.y, l.spacing_mm.z}); }

/// How deep the removal goes at each place.
class Cut {
 public:
  Cut(const FaceRegion& region, const DefaceParams& params, const grid::Lattice& lattice)
      : region_(region), params_(params) {
    const double voxel = longest_side_mm(lattice);
    above_ = std::max(params.above_mm, 2 * voxel + 1);
    behind_ = std::max(params.behind_mm, 2 * voxel + 1);
    ramp_ = 1.5 * std::cbrt(lattice.voxel_volume_mm3());
    // The errors of the distances and of the gate's steps, and the outer half of the ramp.
    min_depth_ = face_clearance_mm + 1 + ramp_ / 2;
    side_depth_ = std::max(params.side_depth_mm, min_depth_);
    depth_ = std::max(params.depth_mm, side_depth_);
    for (int a = 0; a < 3; ++a) {
      front_ramp_ += std::abs(dot(lattice.direction.column[a], region.front)) * lattice.spacing_mm[a];
      up_ramp_ += std::abs(dot(lattice.direction.column[a], region.up)) * lattice.spacing_mm[a];
    }
    const Vec3 low = region.tragi_mm - params.crop_under_tragi_mm * region.up,
               high = region.nasion_mm - crop_under_nasion_mm * region.up;
    crop_point_ = low;
    crop_normal_ = normalized(cross(high - low, region.left));
  }
  double ramp_mm() const { return ramp_; }
  double margin_mm() const { return std::max(above_, behind_); }
  double forward(Vec3 p) const {
    const double t = std::clamp(region_.in_front_mm(p) / side_to_front_mm, 0.0, 1.0);
    return t * t * (3 - 2 * t);
  }
  double depth_mm(Vec3 p) const { return side_depth_ + (depth_ - side_depth_) * forward(p); }
  double cover_mm(Vec3 p) const { return params_.cover_mm * forward(p); }
  /// Positive in the region and its margins.
  double zone_mm(Vec3 p) const { return std::min(region_.in_front_mm(p) + behind_, region_.below_mm(p) + above_); }
  /// 1 where the zone has ended, with a ramp of a voxel across its walls.
  double beyond_share(Vec3 p) const {
    const double front = region_.in_front_mm(p) + behind_, up = region_.below_mm(p) + above_;
    return std::clamp(0.5 - std::min(front / front_ramp_, up / up_ramp_), 0.0, 1.0);
  }
  /// Of what is left, without the reach of a voxel's cell.
  double min_depth_mm() const { return min_depth_; }
  /// Positive above the plane of `crop`.
  double above_crop_mm(Vec3 p) const { return dot(p - crop_point_, crop_normal_); }

 private:
  const FaceRegion& region_;
  const DefaceParams& params_;
  double min_depth_, side_depth_, depth_, above_, behind_, ramp_, front_ramp_ = 0, up_ramp_ = 0;
  Vec3 crop_point_, crop_normal_;
};

/// How far the cell of a voxel reaches towards the skin: what differs from its neighbours has a surface up to there.
double voxel_reach_mm(const SkinDistance& skin, int i, int j, int k) {
  const grid::Grid<float>& depth = skin.signed_mm();
  double reach = 0;
  for (int a = 0; a < 3; ++a) {
    double step = 0;
    for (int side = -1; side <= 1; side += 2) {
      const int n[3] = {i + (a == 0) * side, j + (a == 1) * side, k + (a == 2) * side};
      if (depth.contains(n[0], n[1], n[2]))
        step = std::max(step, double(std::abs(depth.at(n[0], n[1], n[2]) - depth.at(i, j, k))));
    }
    reach += std::min(step, depth.spacing_mm[a]) / skin.voxels()[a];
  }
  return reach;
}

/// The distance to the cut's surface in mm at the nodes of the skin's distances; positive where something is left.
grid::Grid<float> kept_mm(const SkinDistance& skin, const Cut& cut, const DefaceParams& params,
                          const Progress& progress) {
  const grid::Lattice& l = skin.nodes();
  const bool crop = params.policy == FaceRemoval::crop;
  grid::Grid<float> kept(l);
  const auto limit = [&](Vec3 p, float d) { return crop ? std::min(d, float(cut.above_crop_mm(p))) : d; };
  BitMask gone = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
    for (int i = 0; i < l.size[0]; ++i) {
      const std::size_t n = l.index(i, j, k);
      const Vec3 p = l.to_world_mm({double(i), double(j), double(k)});
      const float deep = limit(p, skin.signed_mm().voxels[n] - float(cut.depth_mm(p)));
      kept.voxels[n] = deep;
      row[i] = cut.zone_mm(p) > 0 ? !(deep > 0) : !(skin.signed_mm().voxels[n] > 0);
    }
  });
  if (params.rounding_mm > 0) {
    // Opened by a ball: what is left of the body is what balls within it reach.
    const grid::Grid<float> inwards = mask::distance_mm(gone, progress);
    const BitMask middles = mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i) row[i] = inwards.at(i, j, k) > params.rounding_mm;
    });
    const grid::Grid<float> off = mask::distance_mm(middles, progress);
    for (std::size_t n = 0; n < l.count(); ++n)
      kept.voxels[n] = std::min(kept.voxels[n], float(params.rounding_mm) - off.voxels[n]);
  }
  for (float& v : kept.voxels) v = std::clamp(v, -level_reach_mm, level_reach_mm);
  mask::gaussian(kept, smoothing_mm, progress);
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        const float depth = skin.signed_mm().at(i, j, k);
        float& v = kept.at(i, j, k);
        v = std::min(v, depth - float(cut.min_depth_mm() + voxel_reach_mm(skin, i, j, k)));
      }
  return kept;
}

/// A row of the fine raster between the nodes: values by linear interpolation.
class NodeRow {
 public:
  NodeRow(const SkinDistance& skin, const grid::Grid<float>& values, int j, int k) : step_(skin.voxels()[0]) {
    const grid::Lattice& l = skin.nodes();
    const int at[2] = {j, k};
    int begin[2], end[2];
    float part[2];
    for (int a = 0; a < 2; ++a) {
      const int n = skin.voxels()[a + 1];
      begin[a] = std::min(at[a] / n, l.size[a + 1] - 1);
      end[a] = std::min(begin[a] + 1, l.size[a + 1] - 1);
      part[a] = float(at[a] - begin[a] * n) / float(n);
    }
    row_.resize(l.size[0]);
    for (int i = 0; i < l.size[0]; ++i) {
      const auto mix = [&](int kk) {
        return (1 - part[0]) * values.at(i, begin[0], kk) + part[0] * values.at(i, end[0], kk);
      };
      row_[i] = (1 - part[1]) * mix(begin[1]) + part[1] * mix(end[1]);
    }
  }
  float operator()(int i) const {
    const int node = std::min(i / step_, int(row_.size()) - 1), next = std::min(node + 1, int(row_.size()) - 1);
    const float part = float(i - node * step_) / float(step_);
    return (1 - part) * row_[node] + part * row_[next];
  }

 private:
  int step_;
  std::vector<float> row_;
};

struct Removed {
  std::int64_t body = 0, changed = 0;
  double min_depth_mm = std::numeric_limits<double>::infinity();
};

template <class T>
T stored(double hu) {
  if constexpr (std::is_integral_v<T>)
    return T(std::lround(hu));
  else
    return T(hu);
}

template <class T>
Removed remove(grid::Grid<T>& volume, const grid::Box& box, const grid::Box& known, const SkinDistance& skin,
               const grid::Grid<float>& kept, const Cut& cut, const FaceRegion& region, const Progress& progress) {
  std::vector<Removed> by_slice(box.end[2] - box.begin[2]);
  const double ramp = cut.ramp_mm();
  parallel_for(box.begin[2], box.end[2], 2, [&](std::int64_t from, std::int64_t to) {
    progress.check();
    for (int k = int(from); k < to; ++k) {
      Removed& out = by_slice[k - box.begin[2]];
      for (int j = box.begin[1]; j < box.end[1]; ++j) {
        const NodeRow depths(skin, skin.signed_mm(), j - known.begin[1], k - known.begin[2]);
        const NodeRow lefts(skin, kept, j - known.begin[1], k - known.begin[2]);
        T* row = &volume.at(0, j, k);
        for (int i = box.begin[0]; i < box.end[0]; ++i) {
          const float left = lefts(i - known.begin[0]), depth = depths(i - known.begin[0]);
          const Vec3 p = volume.to_world_mm({double(i), double(j), double(k)});
          const double zone = cut.zone_mm(p);
          const double keep_mm = std::max(double(left), -zone);
          const double share = std::max(std::clamp(0.5 + double(left) / ramp, 0.0, 1.0), cut.beyond_share(p));
          const T before = row[i];
          double hu = before;
          // Covers what would lie open; outside the zone in the wall of the cut only, and never the skin.
          const double cover = cut.cover_mm(p);
          if (share > 0 && keep_mm < cover + ramp / 2 && depth > 2) {
            const double open = std::clamp(0.5 + (cover - keep_mm) / ramp, 0.0, 1.0) *
                                std::clamp(depth - 2.0, 0.0, 1.0) * (cover > 0 ? 1 : 0);
            hu += open * (std::clamp(hu, soft_low_hu, soft_high_hu) - hu);
          }
          hu = removed_hu + share * (hu - removed_hu);
          if (share == 1 && hu == double(before)) {
            // untouched
          } else {
            row[i] = stored<T>(hu);
            out.changed += row[i] != before;
          }
          out.body += share < 0.5 && depth > 0;
          if (share > 0 && region.contains(p)) out.min_depth_mm = std::min(out.min_depth_mm, double(depth));
        }
      }
    }
  });
  Removed sum;
  for (const Removed& r : by_slice) {
    sum.body += r.body;
    sum.changed += r.changed;
    sum.min_depth_mm = std::min(sum.min_depth_mm, r.min_depth_mm);
  }
  return sum;
}

void check_landmark(const char* name, Vec3 p, const SkinDistance& skin, const grid::Lattice& lattice) {
  const Vec3 at = lattice.to_index(p);
  for (int a = 0; a < 3; ++a)
    if (!(at[a] >= 0 && at[a] <= lattice.size[a] - 1)) return;
  const double off_mm = skin.distance_mm(p);
  if (off_mm > landmark_off_skin_mm)
    throw Error(ExitCode::privacy, "", std::string("landmarks.") + name,
                "lies " + to_text(ParameterValue(std::round(std::min(off_mm, 999.0)))) +
                    " mm off the skin, must be within " + to_text(ParameterValue(landmark_off_skin_mm)) +
                    " mm: the face would not be found");
}

}  // namespace

Outcome<grid::HuVolume, DefaceResult> deface(const grid::HuVolume& volume, const grid::Field& skin,
                                             const FaceRegion& region, const DefaceParams& params,
                                             const Progress& progress) {
  const grid::Lattice& l = grid::lattice_of(volume);
  if (const auto* g = std::get_if<grid::Grid<float>>(&volume))
    for (const float v : g->voxels)
      if (!std::isfinite(v)) throw Error(ExitCode::bad_input, "", "volume", "a voxel is NaN or infinite");
  const grid::Box placed = grid::place_in(skin, l);
  mask::check_varies(volume);
  const Cut cut(region, params, l);
  grid::HuVolume out = volume;
  // The cut's own box, and around it what decides its shape.
  const grid::Box zone = box_of(region, l, cut.margin_mm() + cut.ramp_mm() + params.cover_mm);
  const grid::Box known = box_of(region, l, cut.margin_mm() + params.rounding_mm + 6);
  Removed removed;
  if (!zone.empty()) {
    // In the skin's own indices.
    grid::Box in_skin = known;
    for (int a = 0; a < 3; ++a) {
      in_skin.begin[a] -= placed.begin[a];
      in_skin.end[a] -= placed.begin[a];
    }
    const SkinDistance distance(skin, in_skin, node_mm, progress.part(0, 0.4));
    if (!distance.empty()) {
      check_landmark("nasion", region.nasion_mm, distance, l);
      const grid::Grid<float> kept = kept_mm(distance, cut, params, progress.part(0.4, 0.6));
      removed = std::visit(
          [&](auto& g) { return remove(g, zone, known, distance, kept, cut, region, progress.part(0.6, 1)); }, out);
    }
  }
  DefaceResult result;
  result.policy = params.policy;
  result.removed_ml = double(removed.body) * l.voxel_volume_mm3() / 1000;
  result.removed_voxels_count = removed.changed;
  if (std::isfinite(removed.min_depth_mm)) result.depth_mm = removed.min_depth_mm;
  Warnings warnings;
  if (removed.body == 0) warnings.push_back({"no_face", "no face in the volume: nothing was removed", {}});
  return {std::move(out), result, std::move(warnings)};
}

}  // namespace trephine::face
