// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/case_head.h"

#include <cmath>

#include "base/error.h"

namespace trephine::outcome {
namespace {

constexpr double cell_mm = 1.6, closed_mm = 5, off_bone_mm = 1.6;
constexpr double step_mm = 0.25;
constexpr double bone_hu = 250;
constexpr double least_area_mm2 = 500;  ///< of the triangle of three landmarks, or the plane is not known

int number_of(const cases::LoadedCase& loaded, const char* name) {
  const voxel::HapticShape* shape = loaded.haptic.find_shape(name);
  return shape ? shape->number : 0;
}

// The plane of the largest triangle of landmarks of the midline; across x without one.
void find_plane(CaseHead& head) {
  std::vector<Vec3> on;
  for (const char* name : {"nasion", "bregma", "vertex", "inion"})
    for (const cases::CaseLandmark& l : head.loaded.manifest.landmarks)
      if (l.name == name) on.push_back(l.position_mm);
  double best = least_area_mm2;
  head.plane_mm = head.middle_mm.x;
  for (std::size_t a = 0; a < on.size(); ++a)
    for (std::size_t b = a + 1; b < on.size(); ++b)
      for (std::size_t c = b + 1; c < on.size(); ++c) {
        const Vec3 normal = cross(on[b] - on[a], on[c] - on[a]);
        if (0.5 * norm(normal) <= best) continue;
        best = 0.5 * norm(normal);
        head.left = normalized(normal.x < 0 ? -normal : normal);
        head.plane_mm = dot(head.left, on[a]);
      }
}

}  // namespace

CaseHead::CaseHead(const cases::LoadedCase& of, const Progress& progress) : loaded(of), decoder(of.haptic) {
  bone = number_of(of, "skull");
  const int brain = number_of(of, "brain"), ventricles = number_of(of, "ventricles"), dura = number_of(of, "dura");
  if (!of.has_haptic() || bone == 0 || brain == 0)
    throw Error(ExitCode::bad_input, "", "haptic.shapes",
                "the case has no `skull` and `brain` to be felt, by which a procedure on a head is measured, and is no "
                "spine or chest; make it by configs/ct_head.yaml, ct_spine.yaml or ct_chest.yaml (marks are of a "
                "head's print)");
  const grid::Lattice& l = of.haptic.voxels;
  const auto of_shapes = [&](bool wanted_bone) {
    return mask::make_mask(l, [&](int j, int k, std::uint8_t* row) {
      for (int i = 0; i < l.size[0]; ++i) {
        const int shape = decoder.shape_at(i, j, k);
        row[i] = wanted_bone ? shape == bone : shape != 0 && (shape == brain || shape == ventricles || shape == dura);
      }
    });
  };
  const mask::CoarseRaster raster = mask::coarse_raster(l, cell_mm);
  inside = mask::closed(mask::coarse_mask(of_shapes(false), raster, 0.5), closed_mm, progress);
  middle_mm = inside.centre_mm();
  inside.remove(mask::dilated(mask::coarse_mask(of_shapes(true), raster, 0), off_bone_mm, progress));
  find_plane(*this);
}

bool CaseHead::shows_bone(Vec3 p) const {
  if (!loaded.has_ct()) return true;
  return grid::sampled(loaded.ct, loaded.ct.to_index(p), grid::value_beyond(3000)) > bone_hu;
}

bool CaseHead::is_inside(Vec3 p) const {
  const Vec3 at = inside.lattice().to_index(p);
  return inside.at(int(std::lround(at.x)), int(std::lround(at.y)), int(std::lround(at.z)));
}

std::optional<Passage> passage_of(const CaseHead& head, Vec3 from, Vec3 way, double reach_mm, double least_mm) {
  double begin = -1, before = head.decoder.trilinear(head.bone, from);
  if (before >= 0.5) begin = 0;
  for (double d = step_mm; d <= reach_mm; d += step_mm) {
    const double now = head.decoder.trilinear(head.bone, from + way * d);
    const double at = d - step_mm + step_mm * (now == before ? 0.5 : (0.5 - before) / (now - before));
    if (before < 0.5 && now >= 0.5) begin = at;
    if (before >= 0.5 && now < 0.5) {
      if (at - begin >= least_mm) return Passage{begin, at};
      begin = -1;
    }
    before = now;
  }
  return {};
}

}  // namespace trephine::outcome
