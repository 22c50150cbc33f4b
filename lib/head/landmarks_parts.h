// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How find_landmarks finds each kind of landmark; for the sources of this room only.
#include <array>
#include <optional>
#include <vector>

#include "base/report.h"
#include "head/head_landmarks.h"
#include "head/skin_arc.h"

namespace trephine::segmentation {

/// The head's own axes: the origin lies in the midsagittal plane, inside the skull.
struct HeadFrame {
  Vec3 origin_mm, left{1, 0, 0}, back{0, 1, 0}, up{0, 0, 1};
};

/// A point and its confidence from 0 to 1.
struct FoundPoint {
  Vec3 position_mm;
  double confidence = 0;
};

/// Throws Error 65, with the landmark's name as field, where one is not finite, occurs twice, or lies further outside
/// of the skin than a landmark marked on a cut-off part can. Warns where a name is not searched for (with the nearest
/// one that is), where a landmark of the skin lies deep below it, and where a foramen is far from the ventricles (null:
/// not known).
void check_given(const std::vector<CaseLandmark>& given, const Field& skin, const Field* ventricles, Report& report);
/// Throws Error 65 where a left landmark lies to the right of the plane, or the reverse.
void check_sides(const std::vector<CaseLandmark>& given, const MidsagittalPlane& plane);
/// Warns where the given landmark is far from where it would be found.
void doubt_given(const CaseLandmark& given, const std::optional<FoundPoint>& found, Report& report);

/// 0 at `zero`, 1 at `one`, linear between them; `one` may be the smaller.
double ramp(double value, double zero, double one);

/// Signed distance in mm to the field's zero crossing (positive inside): the distance to the nearest of its crossings
/// between voxels, up to `reach` voxels, and that limit beyond. The spacing must be the same along all axes. Much
/// faster than signed_distance_mm where only the surroundings of the surface matter.
Grid<float> near_distance_mm(const Field& field, int reach);

/// The skin of the midline from the vertex down over the face, or over the back of the head: smoothed points every 0.5
/// mm.
std::vector<Vec3> midline_profile(const FieldView& view, const HeadFrame& head, bool front, double sigma_mm);

std::optional<FoundPoint> find_nasion(const FieldView& skin, const FieldView& skull, const HeadFrame& head);
/// `level_mm`: from where to where it is searched for, along `up` from the origin.
std::optional<FoundPoint> find_inion(const FieldView& skin, const FieldView& skull, const HeadFrame& head,
                                     std::array<double, 2> level_mm);
/// side: 1 left, -1 right.
std::optional<FoundPoint> find_tragus(const FieldView& skin, const HeadFrame& head, int side);
std::optional<FoundPoint> find_vertex(const FieldView& skin, const HeadFrame& head);

/// The foramina of Monro, left and right.
std::array<std::optional<FoundPoint>, 2> find_monro(const FieldView& ventricles, const HeadFrame& head);

}  // namespace trephine::segmentation
