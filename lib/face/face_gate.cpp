// SPDX-License-Identifier: GPL-3.0-or-later
#include "face/face_gate.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/error.h"
#include "face/deface_distance.h"

namespace trephine::face {
namespace {

constexpr double node_mm = 2;
constexpr double slack_mm = 0.1;                     // a place that could be nearer only by less than this is skipped
constexpr double triangle_mm = 0.1, cell_mm = 0.25;  // the size down to which triangles and cells are divided

/// The least distance so far; places that cannot be nearer are skipped.
class Nearest {
 public:
  Nearest(const SkinDistance& skin, const FaceRegion& region) : skin_(skin), region_(region), error_(skin.error_mm()) {}
  double distance_mm() const { return least_ < face_search_mm ? std::max(0.0, least_ - slack_mm) : face_search_mm; }

  void triangle(Vec3 a, Vec3 b, Vec3 c) {
    if (beyond(a, b, c, &FaceRegion::in_front_mm) || beyond(a, b, c, &FaceRegion::below_mm)) return;
    const Vec3 middle = (a + b + c) / 3;
    const double radius = std::max({norm(a - middle), norm(b - middle), norm(c - middle)});
    if (skin_.about_mm(middle) - SkinDistance::loose_mm - error_ - radius >= least_ - slack_mm) return;
    const double d = skin_.distance_mm(middle) - error_;
    if (d - radius >= least_ - slack_mm) return;
    if (region_.contains(middle)) least_ = std::min(least_, std::max(0.0, d));
    if (radius < triangle_mm) {
      least_ = std::min(least_, std::max(0.0, d - radius));
      return;
    }
    // Divides the longest edge in two.
    const double ab = norm(b - a), bc = norm(c - b), ca = norm(a - c);
    if (bc >= ab && bc >= ca)
      std::tie(a, b, c) = std::make_tuple(b, c, a);
    else if (ca >= ab)
      std::tie(a, b, c) = std::make_tuple(c, a, b);
    const Vec3 m = 0.5 * (a + b);
    triangle(a, m, c);
    triangle(m, b, c);
  }

  /// A box about `middle`, half its sides along the lattice's axes.
  void cell(const grid::Lattice& l, Vec3 middle, Vec3 half) {
    const double radius = norm(half);
    if (region_.in_front_mm(middle) < -support(l, region_.front, half) ||
        region_.below_mm(middle) < -support(l, region_.up, half))
      return;
    if (skin_.about_mm(middle) - SkinDistance::loose_mm - error_ - radius >= least_ - slack_mm) return;
    const double d = skin_.distance_mm(middle) - error_;
    if (d - radius >= least_ - slack_mm) return;
    if (region_.contains(middle)) least_ = std::min(least_, std::max(0.0, d));
    if (radius < cell_mm) {
      least_ = std::min(least_, std::max(0.0, d - radius));
      return;
    }
    const int axis = half.x >= half.y && half.x >= half.z ? 0 : half.y >= half.z ? 1 : 2;
    half[axis] /= 2;
    const Vec3 step = l.direction.column[axis] * half[axis];
    cell(l, middle - step, half);
    cell(l, middle + step, half);
  }

 private:
  static double support(const grid::Lattice& l, Vec3 n, Vec3 half) {
    double sum = 0;
    for (int a = 0; a < 3; ++a) sum += std::abs(dot(l.direction.column[a], n)) * half[a];
    return sum;
  }
  bool beyond(Vec3 a, Vec3 b, Vec3 c, double (FaceRegion::*inside)(Vec3) const) const {
    return !((region_.*inside)(a) > 0) && !((region_.*inside)(b) > 0) && !((region_.*inside)(c) > 0);
  }

  const SkinDistance& skin_;
  const FaceRegion& region_;
  double error_, least_ = face_search_mm;
};

double distance_of(const FaceSurface& surface, const SkinDistance& skin, const FaceRegion& region,
                   const Progress& progress) {
  Nearest nearest(skin, region);
  const surface::TriMesh& m = *surface.mesh;
  for (std::size_t t = 0; t < m.triangles.size(); ++t) {
    if (t % 65536 == 0) progress.check();
    nearest.triangle(m.world_mm(m.triangles[t][0]), m.world_mm(m.triangles[t][1]), m.world_mm(m.triangles[t][2]));
  }
  return nearest.distance_mm();
}

template <class T>
double distance_of(const grid::Grid<T>& g, double empty_at_most, const SkinDistance& skin, const FaceRegion& region,
                   const Progress& progress) {
  Nearest nearest(skin, region);
  const Vec3 half = 0.5 * g.spacing_mm;
  // Cells, by their first corner; one more on either side, whose other corners are beyond the border.
  const grid::Box box = box_of(region, g, 2 * norm(half));
  for (int k = box.begin[2] - 1; k < box.end[2]; ++k) {
    progress.check();
    for (int j = box.begin[1] - 1; j < box.end[1]; ++j)
      for (int i = box.begin[0] - 1; i < box.end[0]; ++i) {
        bool differs = false, border = false;
        T first{};
        int seen = 0;
        double largest = -1e300;
        for (int corner = 0; corner < 8 && !differs; ++corner) {
          const int ci = i + (corner & 1), cj = j + (corner >> 1 & 1), ck = k + (corner >> 2);
          if (!g.contains(ci, cj, ck)) {
            border = true;
            continue;
          }
          const T v = g.at(ci, cj, ck);
          if (seen++ == 0) first = v;
          differs = v != first;
          largest = std::max(largest, double(v));
        }
        if (!differs && !(border && seen > 0 && largest > empty_at_most)) continue;
        nearest.cell(g, g.to_world_mm({i + 0.5, j + 0.5, k + 0.5}), half);
      }
  }
  return nearest.distance_mm();
}

}  // namespace

FaceVolume face_volume(const std::string& name, const grid::HuVolume& volume) {
  FaceVolume out{name, {}, -900};
  std::visit([&](const auto& g) { out.grid = &g; }, volume);
  return out;
}
FaceVolume face_volume(const std::string& name, const voxel::HapticVolume& volume) {
  return {name, &volume.voxels, volume.encoding == voxel::HapticEncoding::hu ? -900.0 : double(voxel::haptic_empty)};
}
FaceVolume face_volume(const std::string& name, const grid::Mask& mask) { return {name, &mask, 0}; }

std::vector<FaceDistance> face_distances(const grid::Field& original_skin, const FaceRegion& region,
                                         const std::vector<FaceSurface>& surfaces,
                                         const std::vector<FaceVolume>& volumes, const Progress& progress) {
  for (const float v : original_skin.voxels)
    if (!std::isfinite(v)) throw Error(ExitCode::bad_input, "", "skin", "a voxel is not finite");
  for (const FaceSurface& s : surfaces)
    for (const Vec3& p : s.mesh->points_mm)
      if (!is_finite(p)) throw Error(ExitCode::bad_input, "", s.name, "a point is not finite");
  // The skin's raster, grown by the limit of the search: nothing farther away matters.
  grid::Box box = box_of(region, original_skin, face_search_mm);
  std::vector<FaceDistance> out;
  for (const FaceSurface& s : surfaces) out.push_back({s.name, face_search_mm});
  for (const FaceVolume& v : volumes) out.push_back({v.name, face_search_mm});
  if (box.empty()) return out;
  for (int a = 0; a < 3; ++a) {
    const int reach = int(std::ceil(face_search_mm / original_skin.spacing_mm[a]));
    box.begin[a] -= reach;
    box.end[a] += reach;
  }
  const SkinDistance skin(original_skin, box, node_mm, progress.part(0, 0.5));
  if (skin.empty()) return out;
  std::size_t at = 0;
  for (const FaceSurface& s : surfaces) out[at++].distance_mm = distance_of(s, skin, region, progress);
  for (const FaceVolume& v : volumes)
    out[at++].distance_mm =
        std::visit([&](const auto* g) { return distance_of(*g, v.empty_at_most, skin, region, progress); }, v.grid);
  return out;
}

namespace {

FaceDistance least_distance(const grid::Field& skin, const std::vector<FaceRegion>& regions,
                            const std::vector<FaceSurface>& surfaces, const std::vector<FaceVolume>& volumes,
                            const Progress& progress) {
  FaceDistance least{"", face_search_mm};
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const double share = 1.0 / double(regions.size());
    const Progress part = progress.part(double(r) * share, double(r + 1) * share);
    for (const FaceDistance& d : face_distances(skin, regions[r], surfaces, volumes, part))
      if (d.distance_mm < least.distance_mm) least = d;
  }
  return least;
}

void require_clear(const FaceDistance& least, const std::string& of_scan, const std::string& remedy) {
  if (least.distance_mm < face_clearance_mm)
    throw Error(ExitCode::privacy, "", least.name,
                "shows the patient's face: " + to_text(ParameterValue(std::floor(least.distance_mm * 100) / 100)) +
                    " mm from the skin " + of_scan + ", must be at least " +
                    to_text(ParameterValue(face_clearance_mm)) +
                    " mm; the scene's face policy can be deface, crop, or keep with a reason; " + remedy);
}

}  // namespace

FaceGateResult check_face_removed(const grid::Field& original_skin, const std::vector<FaceRegion>& regions,
                                  const std::vector<FaceSurface>& surfaces, const std::vector<FaceVolume>& volumes,
                                  const Progress& progress) {
  const FaceDistance least = least_distance(original_skin, regions, surfaces, volumes, progress);
  require_clear(least, "that was scanned",
                "where it is deface already, a larger deface.side_depth_mm or a finer haptic.spacing_mm helps");
  return {least.distance_mm};
}

FaceGateResult check_face_removed(const std::vector<ScanSkin>& skins, const std::vector<FaceRegion>& regions,
                                  const std::vector<FaceSurface>& surfaces, const std::vector<FaceVolume>& volumes,
                                  const Progress& progress) {
  FaceGateResult out{face_search_mm};
  for (std::size_t i = 0; i < skins.size(); ++i) {
    const Progress part = progress.part(double(i) / double(skins.size()), double(i + 1) / double(skins.size()));
    const FaceDistance least = least_distance(skins[i].skin, regions, surfaces, volumes, part);
    require_clear(least, "that the scan " + skins[i].scan + " shows",
                  "what is made of a scan with a face must not come near it");
    out.face_distance_mm = std::min(out.face_distance_mm, least.distance_mm);
  }
  return out;
}

}  // namespace trephine::face
