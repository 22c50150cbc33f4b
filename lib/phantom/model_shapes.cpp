// SPDX-License-Identifier: GPL-3.0-or-later
// The implicit functions of the head: which shapes, where. Measures follow textbook adults: head 190 x 150 mm, calvaria
// 5 to 8 mm with tables of about 1.8 mm, scalp 5 to 6 mm, subarachnoid space 1.5 to 4 mm, ventricles 20 ml.
#include "phantom/model.h"

namespace trephine::phantom {
namespace {

/// Joins b's value to a where b can have an effect: `bound` encloses the shapes of b, with slack for inexact distances.
template <class S, class F>
S joined(const S& a, double k, const Point<S>& p, const Vec3& centre, double radius, F&& shapes) {
  const double dx = value(p.x) - centre.x, dy = value(p.y) - centre.y, dz = value(p.z) - centre.z;
  const double far = std::sqrt(dx * dx + dy * dy + dz * dz) - radius;
  if (far > std::max(value(a), 0.0) + k + 2) return a;
  return smooth_union(a, shapes(), k);
}

template <class S>
S cisterns(const Model::Base<S>& b) {
  // Basal, from the sella's region down to the dura and around the brainstem to the back; magna; quadrigeminal.
  S f = ellipsoid(b.m, {0, -14, 18}, {16, 9, 9});
  f = smooth_union(f, capsule(b.m, {0, -14, 14}, {0, -13, 0}, 10, 11), 4);
  f = smooth_union(f, capsule(b.m, {13, -8, 14}, {17, 8, 20}, 2.6, 2.2), 3);
  f = smooth_union(f, capsule(b.m, {17, 8, 20}, {13, 28, 30}, 2.2, 2.4), 2);
  f = smooth_union(f, capsule(b.m, {13, 28, 30}, {0, 33, 33}, 2.4, 3.8), 2);
  f = smooth_union(f, ellipsoid(b.m, {0, 50, -11}, {13, 8, 11}), 3);
  return f;
}

}  // namespace

template <class S>
S Model::cranial_vault(const Point<S>& m) const {
  S f = ellipsoid(m, {0, -2, 60}, {63.5, 82.5, 58});
  f = smooth_union(f, ellipsoid(m, {18, 40, 15}, {31, 37, 31}), 20);   // posterior fossa
  f = smooth_union(f, ellipsoid(m, {36, -16, 21}, {22, 28, 21}), 16);  // middle fossa
  return smooth_union(f, ellipsoid(m, {0, 22, 8}, {22, 30, 23}), 8);   // clivus
}

template <class S>
S Model::teeth(const Point<S>& m) const {
  // Two arches of seven teeth a side: crowns with roots, on a parabola.
  S f(1e3);
  for (int upper = 0; upper < 2; ++upper)
    for (int i = 0; i < 7; ++i) {
      const double x = 3.6 + i * (i < 3 ? 6.6 : 6.0) * (i < 2 ? 0.95 : 0.72),
                   y = -92 + 0.036 * x * x * (upper ? 0.96 : 1);
      const double width = i < 3 ? 3.1 : 3.9;
      const double crown = upper ? -49.2 : -50.6, root_z = upper ? -37 : -64;
      f = smooth_union(f, capsule(m, {x, y, crown + (upper ? 2.5 : -2.5)}, {x, y * 0.985, root_z}, width, 2.3), 1.0);
    }
  return f;
}

template <class S>
S Model::bone_hull(const Point<S>& m, const S& vault) const {
  // The calvaria: thinner at the temples, undulating a little.
  const S t = S(bone_mm) - S(1.7) * lesser(m.x * m.x * S(1 / (63.5 * 63.5)), S(1.2)) +
              S(0.35) * sine(m.y * S(0.09) + S(phase[0])) + S(0.25) * sine(m.z * S(0.11) + S(phase[1]));
  S f = vault - t;
  f = joined(f, 8, m, {0, 88, 10}, 14, [&] { return ellipsoid(m, {0, 78, 10}, {12, 9, 7}); });  // protuberance
  f = joined(f, 6, m, {54, 15, -10}, 24, [&] {
    return smooth_union(ellipsoid(m, {55, 16, -10}, {12, 14, 19}), capsule(m, {30, -2, -2}, {58, 2, 2}, 8, 8), 6.0);
  });  // mastoid process, petrous bone
  f = joined(f, 6, m, {0, -18, -4}, 26, [&] { return ellipsoid(m, {0, -18, -2}, {17, 20, 12}); });  // sphenoid body
  // Face: brow, zygoma and its arch, maxilla, nasal bones, orbital rims.
  f = joined(f, 7, m, {25, -66, 10}, 78, [&] {
    S g = capsule(m, {6, -82, 37}, {30, -80, 39}, 7.0, 6.0);
    g = smooth_union(g, capsule(m, {30, -80, 39}, {50, -63, 27}, 6.0, 5.0), 4);
    g = smooth_union(g, capsule(m, {50, -63, 27}, {51, -62, 2}, 4.6, 5.5), 4);
    g = smooth_union(g, ellipsoid(m, {46, -66, -6}, {12, 11, 11}), 5);
    g = smooth_union(g, capsule(m, {50, -60, -6}, {66, -30, -5}, 4.0, 3.3), 5);
    g = smooth_union(g, capsule(m, {66, -30, -5}, {60, -2, 1}, 3.3, 4.0), 4);
    g = smooth_union(g, capsule(m, {46, -70, -3}, {18, -84, -2}, 5.5, 4.5), 5);
    g = smooth_union(g, ellipsoid(m, {12, -66, -21}, {25, 25, 21}), 6);
    g = smooth_union(g, capsule(m, {17, -83, 0}, {5, -89, 30}, 4.5, 4.5), 5);
    g = smooth_union(g, capsule(m, {2.5, -89, 28}, {2.5, -98 - 3 * nose, 9}, 3.8, 3.2), 5);
    g = smooth_union(g, capsule(m, {16, -80, -32}, {24, -50, -30}, 7.5, 6.5), 5);  // alveolar process
    g = smooth_union(g, capsule(m, {34, -42, 20}, {46, -55, 18}, 6, 5), 5);        // greater wing
    return smooth_union(g, capsule(m, {16, -36, 6}, {20, -36, -28}, 5, 4), 5);     // pterygoid
  });
  // Mandible: condyle and ramus, angle, body, chin; and all teeth.
  const double j = jaw;
  f = joined(f, 1.5, m, {28, -50, -45}, 78, [&] {
    S g = capsule(m, {53, -15, -15}, {50, -20, -30}, 4.6, 5.5);
    g = smooth_union(g, capsule(m, {50, -20, -30}, {46 * j, -26, -64}, 6, 6.5), 5);
    g = smooth_union(g, capsule(m, {49, -38, -18}, {47 * j, -34, -56}, 3.6, 6), 6);
    g = smooth_union(g, capsule(m, {46 * j, -28, -64}, {27 * j, -68, -74}, 6.5, 7), 6);
    g = smooth_union(g, capsule(m, {27 * j, -68, -74}, {9, -86, -78}, 7, 7), 6);
    g = smooth_union(g, capsule(m, {9, -86, -78}, {0, -88, -80}, 7, 9), 6);
    g = smooth_union(g, capsule(m, {42, -46, -62}, {15, -82, -68}, 5.0, 5.5), 6);
    return g;
  });
  return joined(f, 1.5, m, {18, -70, -50}, 48, [&] { return teeth(m); });
}

template <class S>
typename Model::Base<S> Model::base(const Point<S>& world, bool with_hull) const {
  Base<S> b;
  b.p = to_model(world);
  b.m = {root(b.p.x * b.p.x + S(2.25)), b.p.y, b.p.z};  // rounded, so that there is no crease in the midline
  b.vault = cranial_vault(b.m);
  const S canal = capsule(b.p, {0, 26, -12}, {0, 30, -260}, 14.5, 9.5);
  b.cavity = smooth_union(b.vault, canal, 5);
  if (with_hull) b.hull = bone_hull(b.m, b.vault);
  return b;
}

template <class S>
S orbit(const Model::Base<S>& b) {
  const S cone = capsule(b.m, {32, -84, 17}, {16, -42, 17}, 17.5, 6);
  // The orbit's roof: the orbit stays 3 mm away from the cavity of the brain.
  return smooth_intersection(cone, S(3.2) - b.vault, 3.0);
}

template <class S>
S nasal(const Model::Base<S>& b) {
  S f = slab(b.m, {6.6, -70, -6}, 4.9, 26, 18);
  f = smooth_union(f, capsule(b.m, {4.5, -46, -12}, {0, -26, -24}, 5.0, 7.0), 4);
  f = smooth_union(f, capsule(b.m, {0, -26, -24}, {0, -21, -42}, 7.0, 6.0), 4);
  f = smooth_union(f, ellipsoid(b.m, {6.5, -92, -9}, {4.6, 12, 11}), 3);
  return smooth_intersection(f, S(3.5) - b.vault, 3.0);
}

template <class S>
S Model::skull(const Base<S>& b, const S& orbit, const S& nasal, bool whole) const {
  S f = smooth_intersection(b.hull, -b.cavity, 1.5);
  if (value(b.cavity) < -8) return f;
  f = smooth_intersection(f, -orbit, 1.5);
  f = smooth_intersection(f, -nasal, 1.5);
  return hard.on && !whole ? smooth_intersection(f, -defects(b), 0.8) : f;
}

template <class S>
S Model::skin(const Base<S>& b) const {
  S f = b.hull - S(scalp_mm);
  if (value(f) < -30) return f;
  const Point<S>& m = b.m;
  f = joined(f, 14, m, {0, -40, -50}, 92, [&] {
    S g = ellipsoid(m, {0, -50, -22}, {60, 54, 56});
    return smooth_union(g, ellipsoid(m, {0, -50, -62}, {48, 48, 36}), 14);
  });
  f = joined(f, 14, m, {36, 2, -70}, 85, [&] { return capsule(m, {40, -2, -26}, {36, 10, -120}, 22, 22); });
  f = joined(f, 14, m, {0, 32, -140}, 150, [&] { return capsule(m, {0, 24, -20}, {0, 36, -280}, 50, 56); });
  f = joined(f, 7, m, {0, -104, -2}, 40, [&] {
    S g = capsule(m, {0, -93, 24}, {0, -106 - 8 * nose, -10}, 5, 8.5);
    g = smooth_union(g, ellipsoid(m, {11.5, -102, -13}, {6.5, 9.5, 7.5}), 5);
    return smooth_union(g, capsule(m, {0, -101, -40}, {16, -97, -40}, 9, 8), 8);
  });
  f = joined(f, 5, m, {32, -71, 17}, 17, [&] { return sphere(m, {32, -71, 17}, 16.2); });  // lids over the globe
  f = joined(f, 8, m, {76, 12, 4}, 44, [&] {
    // The pinna: a disc that stands off the head to the back, hollow in the middle; the tragus before it.
    const double c = 0.91, s = 0.4146;
    const Point<S> q{(m.x - S(75.5)) * S(c) - (m.y - S(13)) * S(s), (m.x - S(75.5)) * S(s) + (m.y - S(13)) * S(c),
                     m.z - S(4)};
    S g = slab(q, {0, 0, 0}, 3.8, 17, 30);
    g = smooth_intersection(g, -ellipsoid(q, {7, -3, 1}, {6.0, 11, 19}), 3);
    return smooth_union(g, ellipsoid(m, {72, -3, 0}, {5.5, 5, 7}), 4);
  });
  return hard.on ? hard_skin(b, f) : f;
}

template <class S>
S Model::brain(const Base<S>& b) const {
  const Point<S>& p = b.p;
  S gap = S(csf_mm) + S(0.4) * sine(p.y * S(0.12) + S(phase[2])) + S(0.3) * sine(p.x * S(0.13) + S(phase[3]));
  if (hard.on) gap = gap + subdural_mm(b);
  S f = b.vault + gap;
  f = smooth_intersection(f, -cisterns(b), 2.0);
  if (clinical) f = smooth_intersection(f, -sulci(b), 1.0);
  if (hard.on) f = smooth_intersection(f, S(0.7) - vessels(b), 0.5);
  // At least 3 mm of brain stay around the ventricles, however deep sulci and cisterns are.
  if (ventricles_within.at_least(shifted(p)) - 3 < value(f) + 2)
    f = joined(f, 2, p, {0, 5, 45}, 80, [&] { return ventricles(p) - S(3.0); });
  const S stem =
      smooth_union(capsule(p, {0, 6, 30}, {0, 16, 4}, 11.5, 12.0), capsule(p, {0, 16, 4}, {0, 27, -26}, 9, 6.0), 6);
  f = smooth_union(f, stem, 3);
  return smooth_union(f, capsule(p, {0, 27, -26}, {0, 30, -260}, 6.0, 5.5), 3);
}

template <class S>
S Model::brain_clipped(const Base<S>& b) const {
  return smooth_intersection(brain(b), S(foramen_magnum_z) - b.p.z, 3.0);
}

template <class S>
S Model::sulci(const Base<S>& b) const {
  // Wavy sheets that stand upright on the cortex, to 11 mm of depth; none in the innermost brain.
  const Point<S>& p = b.p;
  const S wx = p.x + S(5.0) * sine(p.y * S(0.13) + S(phase[4])) + S(4.0) * sine(p.z * S(0.15) + S(phase[5]));
  const S wy = p.y + S(5.0) * sine(p.z * S(0.14) + S(phase[0])) + S(4.0) * sine(p.x * S(0.16) + S(phase[3]));
  const S wz = p.z + S(5.0) * sine(p.x * S(0.12) + S(phase[1])) + S(4.0) * sine(p.y * S(0.15) + S(phase[2]));
  const S g = sine(wx * S(0.21)) * sine(wy * S(0.21) + S(0.6)) + sine(wy * S(0.21)) * sine(wz * S(0.21) + S(0.6)) +
              sine(wz * S(0.21)) * sine(wx * S(0.21) + S(0.6));
  const S sheet = magnitude(g) * S(sulcus_slope) - S(0.9);
  const S depth = -(b.vault + S(13.0));
  const S convexity = smooth_intersection(sheet, depth, 2.0);
  // The fissure between the hemispheres, down to the corpus callosum.
  const S fissure = smooth_intersection(S(magnitude(shifted(p).x) - S(1.1)), S(-(b.vault + S(30.0))), 2.0);
  return smooth_union(convexity, smooth_intersection(fissure, S(72.0) - p.z, 2.0), 1.0);
}

template <class S>
Point<S> Model::shifted(const Point<S>& p) const {
  if (shift_mm == 0) return p;
  // Full in the midline at the level of the bodies, fading to the sides and to the base.
  const S side = greater(S(1.0) - p.x * p.x * S(1 / (64.0 * 64.0)), S(0.0));
  const S level = clamped(S((p.z - S(12.0)) * S(1 / 30.0)), 0, 1);
  return {p.x + S(shift_mm) * side * level * level * (S(3.0) - S(2.0) * level), p.y, p.z};
}

template <class S>
S Model::ventricles(const Point<S>& model) const {
  const Point<S> p = shifted(model);
  const Point<S> m{magnitude(p.x), p.y, p.z};  // the septum lies in the midline
  if (hard.on && hard.is.asymmetry_ratio > 0)
    return smooth_union(uneven_ventricles(p, m), slab(p, third_centre, third_radii.x, third_radii.y, third_radii.z),
                        1.5);
  S f(1e3);
  for (std::size_t i = 0; i + 1 < lateral.size(); ++i)
    f = smooth_union(f, capsule(m, lateral[i].at, lateral[i + 1].at, lateral[i].radius, lateral[i + 1].radius), 2.0);
  for (std::size_t i = 0; i + 1 < temporal_horn.size(); ++i)
    f = smooth_union(
        f,
        capsule(m, temporal_horn[i].at, temporal_horn[i + 1].at, temporal_horn[i].radius, temporal_horn[i + 1].radius),
        2.0);
  f = smooth_union(f, capsule(m, monro_top.at, monro_bottom.at, monro_top.radius, monro_bottom.radius), 1.2);
  return smooth_union(f, slab(p, third_centre, third_radii.x, third_radii.y, third_radii.z), 1.5);
}

template <class S>
S Model::passages(const Point<S>& model) const {
  const Point<S> p = shifted(model);
  S f = capsule(p, passages_start, {0, 29, 9}, 1.0, 1.1);                        // aqueduct
  f = smooth_union(f, ellipsoid(p, {0, 31, 4}, {7.5, 5, 11}), 2);                // fourth
  return smooth_union(f, capsule(p, {0, 33, -4}, {0, 45, -11}, 1.2, 1.2), 1.5);  // Magendie, to the cisterna magna
}

template <class S>
S Model::solid(Anatomy anatomy, const Point<S>& p) const {
  if (anatomy == Anatomy::ventricles) return ventricles(to_model(p));
  const Base<S> b = base(p, anatomy != Anatomy::brain);
  return anatomy == Anatomy::skin ? skin(b) : anatomy == Anatomy::skull ? skull_of(*this, b) : brain_clipped(b);
}

#define TREPHINE_INSTANTIATE(S)                                                   \
  template struct Model::Base<S>;                                                 \
  template Model::Base<S> Model::base(const Point<S>&, bool) const;               \
  template S orbit(const Model::Base<S>&);                                        \
  template S nasal(const Model::Base<S>&);                                        \
  template S Model::skin(const Model::Base<S>&) const;                            \
  template S Model::skull(const Model::Base<S>&, const S&, const S&, bool) const; \
  template S Model::teeth(const Point<S>&) const;                                 \
  template S Model::brain(const Model::Base<S>&) const;                           \
  template S Model::bone_hull(const Point<S>&, const S&) const;                   \
  template Point<S> Model::shifted(const Point<S>&) const;                        \
  template S Model::brain_clipped(const Model::Base<S>&) const;                   \
  template S Model::ventricles(const Point<S>&) const;                            \
  template S Model::passages(const Point<S>&) const;                              \
  template S Model::solid(Anatomy, const Point<S>&) const;
TREPHINE_INSTANTIATE(double)
TREPHINE_INSTANTIATE(Dual)
#undef TREPHINE_INSTANTIATE

}  // namespace trephine::phantom
