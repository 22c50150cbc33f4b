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

  bool clinical = false;
  Vec3 scale{1, 1, 1};  ///< individual size
  double lean = 0;      ///< left half wider than the right one, share
  double skew = 0;      ///< plagiocephaly: y shifts with x, share
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

  template <class S>
  Point<S> to_model(const Point<S>& p) const {
    const S x = p.x * S(1 / scale.x), y = p.y * S(1 / scale.y), z = p.z * S(1 / scale.z);
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
  S orbit(const Base<S>& b) const;
  template <class S>
  S nasal(const Base<S>& b) const;
  template <class S>
  S skin(const Base<S>& b) const;
  template <class S>
  S skull(const Base<S>& b) const;
  template <class S>
  S brain(const Base<S>& b) const;  ///< with the cord, unclipped
  template <class S>
  S brain_clipped(const Base<S>& b) const;
  template <class S>
  S cisterns(const Base<S>& b) const;
  template <class S>
  S sulci(const Base<S>& b) const;
  template <class S>
  S ventricles(const Point<S>& p) const;
  template <class S>
  S passages(const Point<S>& p) const;  ///< aqueduct, fourth ventricle, Magendie
  template <class S>
  Point<S> shifted(const Point<S>& p) const;

  template <class S>
  S solid(Anatomy anatomy, const Point<S>& p) const;
};

}  // namespace trephine::phantom
