// SPDX-License-Identifier: GPL-3.0-or-later
// Which tissue is where, and its HU. Tissues are painted over each other from the outside in, each with the share of
// the sub-voxel that it covers; what lies under bone is painted a little way into it, so that the share left by the
// bone's edge holds the right neighbour.
#include "phantom/apparatus.h"

namespace trephine::phantom {
namespace {

// HU at 120 kV. Soft tissues are as in the Hounsfield tables of CT textbooks [Kalender]; the cortical bone of the
// calvaria and the diploe are within what [Lillie2015] and clinical head CT show; teeth are after [Mah2010].
constexpr double air = -1000, skin_hu = 40, fat = -90, muscle = 55, cortical = 1400, diploe = 550, tooth = 2200,
                 csf = 8, grey = 37, white = 29, vitreous = 12, lens = 75, nerve = 35, mucosa = 50, suture = 250,
                 cell = -900, metal = 6000;
// Fresh blood is as dense as its haemoglobin makes it; contrast agent as in a venous phase; a catheter holds barium.
constexpr double clot = 68, oedema = 20, opacified = 190, enhanced_plexus = 75, calcified = 320;
constexpr double under_bone_mm = 1.4, table_mm = 1.8;

/// The brush: paints a tissue and keeps the distance to the nearest edge seen.
struct Brush {
  double width, hu = air, clearance = 1e3;
  /// `slope`: how much f may change a mm, where that is clearly more than 1.
  double cover(double f, double slope = 1) {
    clearance = std::min(clearance, std::fabs(f) / slope);
    return clamped(0.5 - f / width, 0, 1);
  }
  /// Whether a shape whose f is at least `bound` can change hu or clearance.
  bool reaches(double bound) const { return bound < std::max(clearance, 0.5 * width); }
  void paint(double tissue, double f, double slope = 1) { hu += (tissue - hu) * cover(f, slope); }
};

void paint_soft(Brush& b, const Model::Base<double>& base, double skin, double orbit, double nasal) {
  const PointD& m = base.m;
  b.paint(fat, skin + 1.6);
  double f = std::min(base.hull - 2.4, skin + 14);                    // galea and deep muscle
  f = std::min(f, slab(m, {61, -24, 26}, 9, 31, 36));                 // temporal
  f = std::min(f, capsule(m, {60, -44, -10}, {52, -32, -62}, 7, 8));  // masseter
  f = std::max(f, skin + 2.6);
  b.paint(muscle, f);
  if (orbit < under_bone_mm + 3) {
    b.paint(fat, std::max(orbit - under_bone_mm, skin + 3.0));
    b.paint(muscle, std::min({capsule(m, {31, -68, 29}, {17, -44, 20}, 1.8, 1.6),
                              capsule(m, {31, -68, 5}, {17, -44, 14}, 1.8, 1.6),
                              capsule(m, {41, -70, 17}, {20, -44, 17}, 1.6, 1.6),
                              capsule(m, {20, -66, 17}, {13, -44, 17}, 1.6, 1.5)}));
    b.paint(nerve, capsule(m, {31, -60, 17}, {16, -43, 17}, 2.2, 2.2));
    b.paint(muscle, sphere(m, {32, -71, 17}, 12.2));  // sclera
    b.paint(vitreous, sphere(m, {32, -71, 17}, 11.2));
    b.paint(lens, ellipsoid(m, {32, -79.5, 17}, {4.5, 2.2, 4.5}));
  } else {
    b.clearance = std::min(b.clearance, orbit - under_bone_mm);
  }
  b.paint(mucosa, std::max(nasal - under_bone_mm, skin + 3.0));
  b.paint(air, std::max(nasal + 1.3, skin + 4.2));
}

void paint_brain(Brush& b, const Model& model, const Model::Base<double>& base, double f) {
  const double brain = model.brain(base);
  b.paint(csf, f);
  const double slope = model.clinical ? sulcus_slope : 1;
  b.paint(grey, brain, slope);
  b.paint(white, brain + 3.0, slope);
  const HardParams& life = model.hard.is;  // has an effect at level hard only
  if (life.blood == Blood::subdural) {
    const double thick = model.subdural_mm(base);
    b.paint(clot, std::max(-(base.vault + thick + 0.2), base.vault + 0.6), 1.3);
  } else if (life.blood == Blood::intracerebral) {
    const double wobble = 1.5 * std::sin(base.p.x * 0.4) * std::sin(base.p.y * 0.33) * std::sin(base.p.z * 0.37);
    const double bleed = ellipsoid(base.p, model.hard.bleed_centre, model.hard.bleed_radii) + wobble;
    b.paint(oedema, std::max(bleed - 5, brain + 3.0), slope);
    b.paint(clot, std::max(bleed, brain + 1.0), slope);
  }
  // Deep grey: the thalami beside the third ventricle.
  const PointD p = model.shifted(base.p);
  b.paint(grey, ellipsoid(PointD{std::fabs(p.x), p.y, p.z}, model.thalamus_centre, {7, 12, 7}));
  if (b.reaches(model.ventricles_within.at_least(p))) b.paint(csf, model.ventricles(base.p));
  if (b.reaches(model.passages_within.at_least(p))) b.paint(csf, model.passages(base.p));
  if (!model.hard.on) return;
  const double ventricles =
      life.blood == Blood::intraventricular || life.contrast ? model.ventricles(base.p) : 0;  // not asked for
  if (life.blood == Blood::intraventricular) b.paint(clot, std::max(ventricles, model.hard.settled_y - base.p.y));
  if (life.contrast) {
    b.paint(opacified, std::max(model.vessels(base), base.cavity + 0.4));
    for (const double side : {-1.0, 1.0})
      b.paint(enhanced_plexus,
              std::max(ventricles + 0.6, capsule(base.p, {side * model.lateral[4].at.x, 22, model.lateral[4].at.z - 3},
                                                 {side * model.lateral[5].at.x, 36, model.lateral[5].at.z}, 1.2, 2.4)));
  }
  for (const Model::Ball& ball : model.hard.calcified) b.paint(calcified, sphere(base.p, ball.centre, ball.radius));
}

/// Vertebrae, air under the bone, catheter and other metal.
void paint_hard(Brush& b, const Model& model, const Model::Base<double>& base, double skin) {
  if (skin < b.width) {
    const double column = std::max(model.vertebrae(base), skin + 4);
    b.paint(cortical * 0.75, column, 1.3);
    b.paint(diploe * 0.6, column + 1.5, 1.3);
    // Only the bone's edges are painted: what is cut out of it must be known as an edge too.
    b.clearance = std::min(b.clearance, std::fabs(model.defects(base)) / 1.2);
  }
  for (const Model::Ball& ball : model.hard.air)
    b.paint(air, std::max(sphere(base.p, ball.centre, ball.radius), base.cavity + 0.8));
  for (const Model::Tube& t : model.hard.catheter) {
    const double far = std::max(b.clearance, 0.5 * b.width) + 1e-6, tube = t.lesser_of(far, base.p);
    if (tube == far) continue;  // neither hu nor clearance changes
    b.paint(model.hard.catheter_hu, tube);
    b.paint(csf, tube + 0.52 * std::min(t.radius_from, 1.25));
  }
  for (const Model::Ball& ball : model.hard.metal) b.paint(metal, sphere(base.p, ball.centre, ball.radius));
}

/// Coronal, sagittal and lambdoid sutures: wavy gaps of half a millimetre through the outer table and the diploe,
/// closed in the inner table as in adults.
double suture_distance(const Model::Base<double>& base) {
  const PointD& m = base.m;
  const double wiggle = 1.2 * std::sin(0.7 * (m.x + m.z));
  const double coronal = std::fabs(m.y + 22 + 0.25 * (m.z - 110) + wiggle) / 1.7;
  const double sagittal = std::max({std::fabs(base.p.x + 1.2 * std::sin(0.7 * m.y)) / 1.4, -22 - m.y, m.y - 62});
  const double lambdoid = std::fabs(m.y - 62 + 0.45 * m.x + wiggle) / 2.0;
  return std::max({std::min({coronal, sagittal, lambdoid}) - 0.2, 3.0 - base.vault, 35 - m.z});
}

/// Bone with all that is enclosed in it; `whole`: before it was drilled, which bares the diploe.
void paint_bone(Brush& b, const Model& model, const Model::Base<double>& base, double bone, double whole) {
  const PointD& m = base.m;
  const double bone_cover = b.cover(bone);
  if (bone > b.width) return;
  Brush inside{b.width, cortical, b.clearance};
  inside.paint(diploe, whole + table_mm);
  const double wall = bone + 2.3;
  static const ShapeBounds sinuses{{0, -90, -31}, {32, -11, 53}, 0.75, 0}, teeth{{0, -96, -68}, {36, -50, -32}, 1, 4};
  if (inside.reaches(sinuses.at_least(m) - 1.2)) {
    double sinus = std::min({ellipsoid(m, {11, -84, 42}, {10, 6, 11}), ellipsoid(m, {6.5, -21, -4}, {5, 10, 7}),
                             ellipsoid(m, {21, -66, -15}, {11, 16, 14})});
    sinus = std::max(sinus, wall);
    inside.paint(cortical, sinus - 1.2);
    inside.paint(cell, sinus);
  }
  if (m.x > 40 && m.x < 72 && m.y > -2 && m.y < 36) {
    double cells = 1e3;
    for (const Model::Ball& ball : model.cells) cells = std::min(cells, sphere(base.p, ball.centre, ball.radius));
    inside.paint(cell, std::max(cells, wall));
  } else {
    inside.clearance = std::min(inside.clearance, std::max({40 - m.x, m.x - 72, -2 - m.y, m.y - 36}));
  }
  inside.paint(suture, suture_distance(base));
  if (inside.reaches(teeth.at_least(m))) inside.paint(tooth, model.teeth(m));
  b.clearance = inside.clearance;
  b.hu += (inside.hu - b.hu) * bone_cover;
}

}  // namespace

Head::Sample Head::sample(Vec3 lps, double width_mm) const {
  const Model& model = *model_;
  Brush b{width_mm};
  double outside = 0, skin = -1e3;  // stays so within the dura, where the skin is far away
  const PointD world{lps.x, lps.y, lps.z};
  auto base = model.base(world, false);
  const double deep = -(under_bone_mm + width_mm);
  if (base.cavity < deep) {  // within the dura: nothing of the outside can matter
    b.clearance = -base.cavity - under_bone_mm;
    paint_brain(b, model, base, base.cavity);
  } else {
    base.hull = model.bone_hull(base.m, base.vault);
    skin = model.skin(base);
    outside = 1 - b.cover(skin);
    b.paint(skin_hu, skin);
    if (skin < width_mm) {
      const double orbit = phantom::orbit(base), nasal = phantom::nasal(base);
      paint_soft(b, base, skin, orbit, nasal);
      double under = clamped(-base.hull, 0, under_bone_mm);
      if (model.hard.on) under = clamped(std::min(-base.hull, model.defects(base)), 0, under_bone_mm);
      if (base.cavity < under_bone_mm + width_mm) paint_brain(b, model, base, base.cavity - under);
      b.clearance = std::min(b.clearance, std::fabs(base.cavity));
      const double bone = model.skull(base, orbit, nasal);
      paint_bone(b, model, base, bone, model.implants.empty() ? bone : model.skull(base, orbit, nasal, true));
    }
  }
  for (const Vec3& filling : model.fillings) {
    b.paint(metal, sphere(base.p, filling, 2.6));
  }
  if (model.hard.on) {
    paint_hard(b, model, base, skin);
    if (outside > 0) {
      const ApparatusSample around = apparatus_at(model, lps, width_mm);
      b.hu += outside * (around.hu - air);
      b.clearance = std::min(b.clearance, around.clearance_mm);
    }
    if (model.hard.moves) {  // tissue on the other side of the cut may be nearer by the length of the motion
      const double cut = std::fabs(lps.z - model.hard.is.motion_z_mm + 1) - 1;
      b.clearance = std::max(std::min(b.clearance, cut), b.clearance - 1.25 * model.hard.is.motion_mm);
    }
  }
  return {b.hu, std::max(0.0, b.clearance - 0.5 * width_mm) * 0.8, outside};
}

}  // namespace trephine::phantom
