// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "mask/bits.h"
#include "place/place_head.h"

namespace trephine::place {

/// The template's end of the medulla, in the foramen magnum.
constexpr Vec3 template_medulla_end{0, 27, -26};

/// Signed distance to the template's brainstem, mm, negative inside: midbrain and pons, then the medulla down to its
/// end. As the synthetic head's, which follows an atlas.
double brainstem_mm(Vec3 template_mm, Vec3 medulla_end = template_medulla_end);

/// Where the medulla ends in this head, in the template: the middle of the cavity's sections at the foramen magnum, at
/// the template's level. Heads differ there by 10 mm and more, forward and back, where the template lies well by the
/// vault. Nothing where the scan does not show all of a section, the cavity does not reach there or is as wide as a
/// posterior fossa, or where it lies 15 mm and more beside the template's.
std::optional<Vec3> find_medulla_end(const mask::BitMask& cavity, const HeadPlace& place);

/// How far that end lies beside the template's, in mm of the head.
double beside_mm(Vec3 medulla_end, const HeadPlace& place);

}  // namespace trephine::place
