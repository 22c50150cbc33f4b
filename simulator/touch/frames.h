// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How a tool is turned.
#include "base/vec3.h"

namespace trephine::touch {

/// The vector turned about a unit axis, right-handed (Rodrigues' formula).
Vec3 turned_about(Vec3 v, Vec3 unit, double rad);
/// A frame whose third column is the axis; the other two follow from it.
Mat3 frame_along(Vec3 axis);
/// The direction across the axis, or zero where it gives no plane with the axis: it is parallel to it, or not finite,
/// as a recording of another program may have it.
Vec3 usable_across(Vec3 across, Vec3 axis);
/// A frame whose third column is the axis, and whose first lies in the plane of the axis and `across`, which are not
/// parallel; frame_along() where `across` is zero.
Mat3 frame_of(Vec3 axis, Vec3 across);
/// The rotation that takes one frame to another, as its axis by its angle in radians, at most pi.
Vec3 rotation_between(const Mat3& from, const Mat3& to);
/// The frame turned towards another, by at most `max_rad`.
Mat3 turned_to(const Mat3& frame, const Mat3& aim, double max_rad);
/// The frame turned by the smallest rotation that takes its third column towards the axis, by at most `max_rad`.
Mat3 turned(const Mat3& frame, Vec3 axis, double max_rad = 4);

}  // namespace trephine::touch
