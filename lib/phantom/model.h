// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "phantom/field.h"
#include "phantom/head.h"

namespace trephine::phantom {

/// Where the brain ends and the cord begins, model coordinates.
constexpr double foramen_magnum_z = -27;

/// With sulci the brain's function may change by up to this much a mm; all others by hardly more than 1.
constexpr double sulcus_slope = 3.2;

/// The anatomy's numbers, drawn once from parameters and seed, and its implicit functions. Everything is in model
/// coordinates: mm, those of `Head` after `to_model`, a smooth warp that carries the individual's size and asymmetry.
struct Model {
  explicit Model(const HeadParams& params);

  bool clinical = false;  ///< or hard
  Vec3 scale{1, 1, 1};    ///< individual size
  double lean = 0;        ///< left half wider than the right one, share
  double skew = 0;        ///< plagiocephaly: y shifts with x, share
  double scalp_mm = 5.5, bone_mm = 6.8, csf_mm = 2.4;
  double nose = 1, jaw = 1;
  double shift_mm = 0;   ///< of the ventricles, to the right
  double phase[6] = {};  ///< of the undulations of bone, CSF gap and sulci
  struct Ball {
    Vec3 centre;
    double radius;
  };
  std::vector<Ball> cells;                  ///< mastoid air cells, right side and left
  std::vector<Vec3> fillings, metal_world;  ///< of metal, in model coordinates and in the world's

  // Lateral ventricle of the left side (the right one is its mirror image): a chain of tapered capsules.
  struct Node {
    Vec3 at;
    double radius;
  };
  std::vector<Node> lateral, temporal_horn;
  Node monro_top, monro_bottom;
  Vec3 third_centre, third_radii, thalamus_centre;
  Vec3 passages_start;                             ///< where the aqueduct begins
  ShapeBounds ventricles_within, passages_within;  ///< of what ventricles() and passages() join, after shifted()

  struct Tube {
    Tube(Vec3 from_, Vec3 to_, double radius_from_, double radius_to_)
        : from(from_),
          to(to_),
          middle((from_ + to_) * 0.5),
          radius_from(radius_from_),
          radius_to(radius_to_),
          reach(0.5 * norm(to_ - from_) + std::max(radius_from_, radius_to_)) {}
    Vec3 from, to, middle;
    double radius_from, radius_to, reach;
    /// Its capsule, or `far` where that is less: then the capsule need not be computed.
    template <class S>
    S lesser_of(const S& far, const Point<S>& p) const {
      const double x = value(p.x) - middle.x, y = value(p.y) - middle.y, z = value(p.z) - middle.z,
                   within = reach + value(far);
      if (within < 0 || x * x + y * y + z * z > within * within) return far;
      return lesser(far, capsule(p, from, to, radius_from, radius_to));
    }
  };
  /// Of level hard; model coordinates but for motion, couch and markers, which are the world's.
  struct Hard {
    bool on = false;
    HardParams is;
    double thin_side = 1;          ///< where the thinner ventricle is: 1 left, -1 right
    bool moves = false;            ///< the upper part lies aside
    Vec3 motion_mm;                ///< by that much, without z
    std::vector<Tube> holes;       ///< through the bone
    Vec3 flap_centre, flap_radii;  ///< an ellipsoid without bone
    Vec3 subdural_centre, bleed_centre, bleed_radii;
    double subdural_scale = 1, settled_y = 0;  ///< what lies behind the latter in the ventricles is blood
    std::vector<Tube> vessels, catheter;
    std::vector<Ball> calcified, metal, markers, air;
    double catheter_hu = 330;  ///< of its wall
    double couch_mm = 0;       ///< y of the couch's plate, behind the head
  } hard;
  void make_hard(const HeadParams& params);  ///< after everything else is drawn
  std::vector<ImplantTruth> implants;
  /// Holes, catheters, air and staples; `landmarks` are those of the head without them.
  void add_implants(const ImplantParams& params, const Landmarks& landmarks);

  template <class S>
  Point<S> to_model(const Point<S>& p) const {
    const Point<S> rest = hard.moves ? unmoved(p) : p;
    const S x = rest.x * S(1 / scale.x), y = rest.y * S(1 / scale.y), z = rest.z * S(1 / scale.z);
    return {x + x * x * S(lean / 100), y + x * S(skew), z};
  }
  Vec3 to_world(Vec3 model) const;  ///< inverse of to_model

  /// What several functions share, computed once a point.
  template <class S>
  struct Base {
    Point<S> p;  ///< model coordinates
    Point<S> m;  ///< with x >= 0: the mirrored half
    S vault;     ///< cranial cavity without the spinal canal
    S cavity;    ///< with it
    S hull;      ///< all bones, their cavities filled
  };
  /// `hull` is filled in where asked for.
  template <class S>
  Base<S> base(const Point<S>& p, bool with_hull) const;

  template <class S>
  S cranial_vault(const Point<S>& m) const;
  template <class S>
  S bone_hull(const Point<S>& m, const S& vault) const;
  template <class S>
  S teeth(const Point<S>& m) const;
  template <class S>
  S skin(const Base<S>& b) const;
  /// orbit(b) and nasal(b), as skull_of() gives them; `whole`: where nothing is missing.
  template <class S>
  S skull(const Base<S>& b, const S& orbit, const S& nasal, bool whole = false) const;
  template <class S>
  S brain(const Base<S>& b) const;  ///< with the cord, unclipped
  template <class S>
  S brain_clipped(const Base<S>& b) const;
  template <class S>
  S sulci(const Base<S>& b) const;
  template <class S>
  S ventricles(const Point<S>& p) const;
  template <class S>
  S passages(const Point<S>& p) const;  ///< aqueduct, fourth ventricle, Magendie
  template <class S>
  Point<S> shifted(const Point<S>& p) const;

  // Level hard (hard_shapes.cpp).
  /// Where a point of the world was before the head moved: full above the height of the motion, none 2 mm below.
  template <class S>
  Point<S> unmoved(const Point<S>& p) const {
    const S share = clamped((p.z - S(hard.is.motion_z_mm)) * S(0.5) + S(1.0), 0, 1);
    return {p.x - share * S(hard.motion_mm.x), p.y - share * S(hard.motion_mm.y), p.z};
  }
  template <class S>
  S defects(const Base<S>& b) const;  ///< where bone is missing
  template <class S>
  S vertebrae(const Base<S>& b) const;
  template <class S>
  S hard_skin(const Base<S>& b, S f) const;  ///< with shoulders, and dented where bone is missing
  template <class S>
  S subdural_mm(const Base<S>& b) const;  ///< thickness of the blood under the dura
  template <class S>
  S vessels(const Base<S>& b) const;
  template <class S>
  S uneven_ventricles(const Point<S>& p, const Point<S>& m) const;  ///< both lateral ones, with foramina

  template <class S>
  S solid(Anatomy anatomy, const Point<S>& p) const;
};

template <class S>
S orbit(const Model::Base<S>& b);
template <class S>
S nasal(const Model::Base<S>& b);
template <class S>
S skull_of(const Model& model, const Model::Base<S>& b) {
  // Deep in the cavity neither has a part.
  return value(b.cavity) < -8 ? model.skull(b, S(0.0), S(0.0)) : model.skull(b, orbit(b), nasal(b));
}

}  // namespace trephine::phantom
