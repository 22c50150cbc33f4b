// SPDX-License-Identifier: GPL-3.0-or-later
#include "print/print_frame.h"

#include <algorithm>

#include "base/error.h"

namespace trephine::print {
namespace {

constexpr double least_line_mm = 80;  ///< from nasion to inion

}  // namespace

Vec3 landmark_of(const cases::CaseManifest& manifest, const std::string& name, const std::string& needed_by) {
  for (const cases::CaseLandmark& l : manifest.landmarks)
    if (l.name == name) return l.position_mm;
  throw Error(ExitCode::bad_input, "case.json", "landmarks",
              "the case has no `" + name + "`, which " + needed_by +
                  " needs; give it in the case's configuration (`landmarks`)");
}

PrintFrame frame_of(const cases::LoadedCase& loaded, double cut_above_mm) {
  const auto landmark = [&](const char* name) { return landmark_of(loaded.manifest, name, "the cut of the print"); };
  const Vec3 nasion = landmark("nasion"), line = landmark("inion") - nasion,
             left = landmark("kocher_left") - landmark("kocher_right"), up = normalized(cross(left, line));
  if (norm(line) < least_line_mm || up.z < 0.5)
    throw Error(
        ExitCode::bad_input, "case.json", "landmarks",
        "`nasion`, `inion` and Kocher's points do not lie as on a head, so that its cut is not known; give them "
        "in the case's configuration (`landmarks`)");
  const Vec3 back = normalized(line), aside = cross(back, up);
  const grid::Lattice& l = loaded.haptic.voxels;
  const Vec3 middle = l.to_world_mm({0.5 * (l.size[0] - 1), 0.5 * (l.size[1] - 1), 0.5 * (l.size[2] - 1)});
  PrintFrame frame;
  frame.to_case.matrix.column = {aside, back, up};
  frame.to_case.offset_mm = middle + up * (dot(nasion - middle, up) + cut_above_mm);
  frame.to_print = itk::inverse(frame.to_case);
  return frame;
}

FeltShape::FeltShape(const cases::LoadedCase& loaded, const PrintFrame& frame, const std::string& shape)
    : loaded_(loaded), frame_(frame), shape_(shape), decoder_(loaded.haptic) {
  const voxel::HapticShape* found = loaded.has_haptic() ? loaded.haptic.find_shape(shape) : nullptr;
  if (!found)
    throw Error(ExitCode::bad_input, "case.json", "haptic.shapes",
                "the case has no `" + shape +
                    "` to be felt, of which the print is made; make it with the scene of a "
                    "ventriculostomy (configs/ct_head.yaml)");
  number_ = found->number;
}

surface::Bounds FeltShape::bounds(double from_z_mm) const {
  const grid::Lattice& l = loaded_.haptic.voxels;
  surface::Bounds box;
  for (int k = 0; k < l.size[2]; ++k)
    for (int j = 0; j < l.size[1]; ++j)
      for (int i = 0; i < l.size[0]; ++i) {
        if (decoder_.shape_at(i, j, k) != number_) continue;
        const Vec3 p = frame_.to_print(l.to_world_mm({double(i), double(j), double(k)}));
        if (p.z < from_z_mm) continue;
        for (int a = 0; a < 3; ++a) {
          box.min_mm[a] = std::min(box.min_mm[a], p[a]);
          box.max_mm[a] = std::max(box.max_mm[a], p[a]);
        }
      }
  if (box.min_mm.x > box.max_mm.x)
    throw Error(ExitCode::bad_input, "case.json", "haptic.shapes",
                "nothing of `" + shape_ + "` lies above the cut of the print; set a lower `cut_above_mm`");
  return box;
}

}  // namespace trephine::print
