// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where things lie in a head: a template of our own.
#include "base/vec3.h"

namespace trephine::place {

/// The template is an analytic head in mm: origin in the middle between the ear canals, x to the patient's left, y to
/// the back, z up, Frankfurt plane level. Cavity, lateral ventricles and cisterns have the numbers of the synthetic
/// head (lib/phantom) without its individual variation. The third ventricle reaches farther forward and the fourth lies
/// farther forward than there, as four real heads showed; the Sylvian fissure is a rough line. A test holds the
/// ventricles against all variants of the synthetic head.
enum class Place {
  lateral_left,
  lateral_right,
  third,
  fourth,
  fissure,        ///< between the hemispheres, above and before the corpus callosum
  quadrigeminal,  ///< and what lies behind it: the cisterns above the cerebellum
  basal,          ///< suprasellar, interpeduncular, prepontine
  sylvian,
};

/// Signed distance to the structure's mean shape in the template, mm, negative inside, to about 1 mm.
double place_mm(Place place, Vec3 template_mm);

/// The same of the temporal and occipital horns of both sides alone.
double horns_mm(Vec3 template_mm);

/// Signed distance to the template's cranial cavity without the spinal canal, mm, negative inside; an estimate.
double template_cavity_mm(Vec3 template_mm);

/// Whether the point lies in a box about the brainstem, from the midbrain down, with 4 mm for the differences of heads.
inline bool in_brainstem(Vec3 p) { return p.x > -15 && p.x < 15 && p.y > -9 && p.y < 34 && p.z > -32 && p.z < 26; }

/// The plane of the foramen magnum. Measured in four real heads, medullae reach down to -30 and cords begin at -34; the
/// synthetic head's brain ends at -27.
constexpr double template_foramen_z = -31.5;
constexpr Vec3 template_foramen_mm{0, 26, -24};

}  // namespace trephine::place
