// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cases/load_case.h"
#include "itk/transform.h"
#include "print/solid.h"
#include "voxel/decode.h"

namespace trephine::print {

/// How the parts of a head lie: x to the patient's left, y along the line from nasion to inion, z up and perpendicular
/// to it, with the cut at z = 0 and its origin below the middle of the felt volume.
struct PrintFrame {
  itk::LinearMap to_print, to_case;
};

/// Where a case's landmark is. Throws Error 65, naming what needs it, where the case has none.
Vec3 landmark_of(const cases::CaseManifest& manifest, const std::string& name, const std::string& needed_by);

/// Throws Error 65 where the case lacks nasion, inion or Kocher's points.
PrintFrame frame_of(const cases::LoadedCase& loaded, double cut_above_mm);

/// A felt shape of a case, in the frame of the parts: its occupancy less 1/2, which is 0 on its surface. Refers to the
/// case.
class FeltShape {
 public:
  /// Throws Error 65, naming the shape, where the case has none to be felt.
  FeltShape(const cases::LoadedCase& loaded, const PrintFrame& frame, const std::string& shape);
  double operator()(Vec3 print_mm) const { return decoder_.trilinear(number_, frame_.to_case(print_mm)) - 0.5; }
  /// The box of its voxels at z >= `from_z_mm`, in the frame of the parts. Throws Error 65 where nothing lies there.
  surface::Bounds bounds(double from_z_mm) const;

 private:
  const cases::LoadedCase& loaded_;
  const PrintFrame& frame_;
  std::string shape_;
  voxel::HapticDecoder decoder_;
  int number_ = 0;
};

}  // namespace trephine::print
