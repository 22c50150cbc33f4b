// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/refusal.h"
#include "base/warning.h"
#include "head/head_figures.h"

namespace trephine::consistency {

struct AnatomyGateParams : head::HeadClassParams {
  double min_skin_skull_gap_mm = 0.3;
  double min_skull_brain_gap_mm = 0;
  double min_brain_ventricles_gap_mm = 0;
  double max_near_mm2 = 20;
  double max_outside_ml = 0.1;
  double max_outside_skull_ml = 20;
  double max_loose_brain_ml = 2;
  std::string accepted_places_mm;

  template <class V>
  static void describe(V& v) {
    using P = AnatomyGateParams;
    v.number(&P::min_skin_skull_gap_mm, "min_skin_skull_gap_mm", Range{0, 20},
             "Least distance from the skull's surface to the skin's.");
    v.number(&P::min_skull_brain_gap_mm, "min_skull_brain_gap_mm", Range{0, 20},
             "Least distance from the brain's surface to the skull's.");
    v.number(&P::min_brain_ventricles_gap_mm, "min_brain_ventricles_gap_mm", Range{0, 20},
             "Least distance from the ventricles' surface to the brain's.");
    v.number(&P::max_near_mm2, "max_near_mm2", Range{0, 1e6},
             "How much of a surface may be nearer than the least distance; of skull and skin times slice/1.5 in slices "
             "thicker "
             "than 1.5 mm.");
    v.number(&P::max_outside_ml, "max_outside_ml", Range{0, 10000},
             "How much of an anatomy may lie where it must not: outside of the one that holds it, or in the bone.");
    v.number(&P::max_outside_skull_ml, "max_outside_skull_ml", Range{0, 10000},
             "How much of the brain may lie outside of the cranial cavity (the brainstem below the foramen magnum).");
    v.number(&P::max_loose_brain_ml, "max_loose_brain_ml", Range{0, 10000},
             "How much of the brain may be in pieces beside the largest.");
    v.text(
        &P::accepted_places_mm, "accepted_places_mm",
        "Places (LPS, x,y,z with semicolons between places) about which a person has looked and found the surfaces "
        "right: within 20 mm of them nothing is refused for lying outside or too near. The rest is checked as ever.");
    head::HeadClassParams::describe(v);
  }
};

/// One thing that is wrong with a head's anatomies.
struct AnatomyFault {
  std::string what;  ///< "3.2 ml of the ventricles lie outside of the brain, by up to 4.1 mm, farthest at (12, -3, 55)"
  /// What a person can do about it, with names of keys in backticks (base/refusal.h); the same of several faults is
  /// said once. And where the shape is right: keys of the stage `anatomy` with values that let it pass, this fault
  /// alone; of several faults each key is said once, with the largest.
  Message remedy;
  std::vector<std::pair<std::string, double>> values_to_set;
  /// What to add to accepted_places_mm so that this fault passes, and no other; empty where it is too wide for that.
  std::vector<Vec3> places_to_accept_mm;
  Vec3 place_mm;              ///< where it is worst
  std::string first, second;  ///< the anatomies it is about; second may be empty
};

/// The stage's result: the head's figures, and what the check measured of each pair of anatomies that is there: what of
/// one lies where it cannot be, and the least distance of their surfaces (0 where they cross).
struct AnatomyResult {
  head::HeadFigures head;
  std::optional<double> ventricles_outside_brain_ml, brain_ventricles_gap_mm, ventricles_in_skull_ml,
      skull_ventricles_gap_mm, brain_in_skull_ml, skull_brain_gap_mm, skull_outside_skin_ml, skin_skull_gap_mm,
      brain_outside_skin_ml, skin_brain_gap_mm, cranial_cavity_ml, brain_outside_skull_ml, ventricles_outside_skull_ml;
  std::optional<std::int64_t> brain_pieces_count, ventricles_pieces_count;
  std::size_t faults_count = 0;
  template <class V>
  static void describe(V& v) {
    using P = AnatomyResult;
    v.all_of(&P::head);
    v.number(&P::ventricles_outside_brain_ml, "ventricles_outside_brain_ml", "Ventricles outside of the brain.");
    v.number(&P::brain_ventricles_gap_mm, "brain_ventricles_gap_mm", "Least distance of brain and ventricles.");
    v.number(&P::ventricles_in_skull_ml, "ventricles_in_skull_ml", "Ventricles in the skull's bone.");
    v.number(&P::skull_ventricles_gap_mm, "skull_ventricles_gap_mm", "Least distance of skull and ventricles.");
    v.number(&P::brain_in_skull_ml, "brain_in_skull_ml", "Brain in the skull's bone.");
    v.number(&P::skull_brain_gap_mm, "skull_brain_gap_mm", "Least distance of skull and brain.");
    v.number(&P::skull_outside_skin_ml, "skull_outside_skin_ml", "Skull outside of the skin.");
    v.number(&P::skin_skull_gap_mm, "skin_skull_gap_mm", "Least distance of skin and skull.");
    v.number(&P::brain_outside_skin_ml, "brain_outside_skin_ml", "Brain outside of the skin.");
    v.number(&P::skin_brain_gap_mm, "skin_brain_gap_mm", "Least distance of skin and brain.");
    v.number(&P::cranial_cavity_ml, "cranial_cavity_ml", "Volume of the cranial cavity.");
    v.number(&P::brain_outside_skull_ml, "brain_outside_skull_ml", "Brain outside of the cranial cavity.");
    v.number(&P::ventricles_outside_skull_ml, "ventricles_outside_skull_ml", "Ventricles outside of it.");
    v.integer(&P::brain_pieces_count, "brain_pieces_count", "Pieces of the brain.");
    v.integer(&P::ventricles_pieces_count, "ventricles_pieces_count", "Pieces of the ventricles.");
    v.integer(&P::faults_count, "faults_count", Range{}, "How many faults were found.");
  }
};

struct AnatomyFindings {
  AnatomyResult result;
  Warnings warnings;
  std::vector<AnatomyFault> faults;  ///< the worst first
};

/// The error that require_anatomy throws: exit code 80, all faults in one line, then each remedy once. It is about the
/// anatomies of the worst fault.
class AnatomyError : public Error {
 public:
  explicit AnatomyError(std::vector<AnatomyFault> faults);
  const std::vector<AnatomyFault>& faults() const { return faults_; }
  std::string picture_png;  ///< picture of the worst place, set by code that had the volume

 private:
  std::vector<AnatomyFault> faults_;
};

struct Clearance;
/// Gives what `measure` gives, which depends on `what`, on the fields of the anatomies named and, where it is named, on
/// "volume" alone: for callers who may have measured it before.
using MeasuredOnce = std::function<Clearance(const std::string& what, const std::vector<std::string>& of,
                                             const std::function<Clearance()>& measure)>;

/// The consistency check of a head's anatomies: is each given anatomy where it can be? It checks that
/// - the ventricles lie inside the brain; brain and ventricles lie apart from the bone and inside the cranial cavity,
///   which is found from the skull; the skull (without one, the brain) lies inside the skin; and the surfaces keep the
///   required distances;
/// - the brain is in one piece.
///
/// Where bone and skin are too near to each other, the places where the scanned field ends within the head
/// (mask/field_edge.h, and the lateral sides of `volume`, which may be null) are left out, for there both end: a
/// warning says so, and the figures of skin and skull are then those of the rest. A face that was taken off counts as
/// such a place.
///
/// It also measures the head (head_figures.h). Surfaces are those of the fields, to a fraction of a voxel; where the
/// volume cuts an anatomy there is no surface. Volumes count voxels by their centre.
///
/// An anatomy without a voxel is a fault. Throws Error 65 where rasters differ or a
/// voxel is not finite; Cancelled.
AnatomyFindings examine_anatomy(const head::HeadFields& fields, const head::HeadLandmarks* landmarks,
                                const AnatomyGateParams& params, const Progress& progress = {},
                                const MeasuredOnce& once = {}, const grid::HuVolume* volume = nullptr);

/// Throws AnatomyError where there are faults.
void require_anatomy(const AnatomyFindings& findings);

/// The axial, coronal and sagittal slices through the place of the fault, side by side as PNG, with the outlines of the
/// anatomies and a cross at the place. Deterministic. A place outside of the volume is moved to the volume's edge.
std::string anatomy_picture(const grid::HuVolume& volume, const head::HeadFields& fields, const AnatomyFault& fault);

}  // namespace trephine::consistency
