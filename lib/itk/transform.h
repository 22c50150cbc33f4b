// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/vec3.h"

namespace trephine::itk {

/// A linear map of space: p -> matrix * p + offset_mm, DICOM patient LPS, mm. As the result of a registration it leads
/// from a place of the fixed scan (the CT) to the same place of the patient in the moving scan, as ITK's transforms do.
struct LinearMap {
  Mat3 matrix;
  Vec3 offset_mm;
  Vec3 operator()(Vec3 p) const { return matrix * p + offset_mm; }
};

/// first, then second.
LinearMap then(const LinearMap& first, const LinearMap& second);
/// Throws Error 65 where the map cannot be inverted.
LinearMap inverse(const LinearMap& map);
/// Turned about x, then y, then z through `centre_mm`, then shifted.
LinearMap rigid_map(Vec3 angles_deg, Vec3 shift_mm, Vec3 centre_mm);
/// The angle by which the map turns, of a rigid one.
double angle_deg(const LinearMap& map);
/// Whether the matrix is a rotation, to 1e-6.
bool is_rigid(const LinearMap& map);

/// ITK's transform file as text (.tfm), which 3D Slicer, ITK-SNAP, elastix and ANTs read and write: one
/// AffineTransform_double_3_3 with every digit. In 3D Slicer it is a linear transform that, applied to the moving scan,
/// lays it on the CT.
std::string encode_tfm(const LinearMap& map);

/// Reads AffineTransform, MatrixOffsetTransformBase, Euler3DTransform,
/// VersorRigid3DTransform and TranslationTransform of three dimensions, double or float. Throws Error 65 naming the
/// line's key: another kind, several transforms, a number that is none or not finite, a map that cannot be inverted.
LinearMap decode_tfm(std::string_view text);

/// The map that an ITK transform of that kind ("Euler3DTransform_double_3_3"), parameters and fixed parameters is; the
/// kinds and errors of decode_tfm.
LinearMap linear_map(const std::string& kind, const std::vector<double>& parameters, const std::vector<double>& fixed);

/// Throws 66, 65 with the file.
LinearMap read_tfm(const std::filesystem::path& file);

}  // namespace trephine::itk
