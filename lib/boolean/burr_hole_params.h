// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <map>
#include <string>

#include "base/params.h"
#include "boolean/burr_hole.h"

namespace trephine::boolean {

/// How far a trajectory must keep from a zone; stands for the number alone: `avoid: {sagittal_sinus: 3}`.
struct AvoidedZone {
  double clear_mm = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&AvoidedZone::clear_mm, "", Range{0, 100}, "Least distance from the zone, mm.");
  }
};

/// A burr hole as a configuration or a command line requests it.
struct BurrHoleParams {
  std::string name;
  BurrHoleRequest::At at = BurrHoleRequest::At::kocher;
  BurrHoleRequest::Side side = BurrHoleRequest::Side::right;
  double diameter_mm = BurrHoleRequest().diameter_mm;
  double along_mm = BurrHoleRequest().along_mm;
  double lateral_mm = BurrHoleRequest().lateral_mm;
  std::array<double, 3> position_mm{0, 0, 0};
  std::array<double, 3> direction{0, 0, 0};
  std::array<double, 3> target_mm{0, 0, 0};
  std::string toward;
  double min_confidence = 0.5;
  double min_before_suture_mm = 5;
  double max_before_suture_mm = 25;
  Named<AvoidedZone> avoid;

  template <class V>
  static void describe(V& v) {
    using P = BurrHoleParams;
    v.text(&P::name, "name", "Name of the hole in the case; empty: burr_hole_1 and so on.");
    v.choice(&P::at, "at", {{"kocher", BurrHoleRequest::At::kocher}, {"position", BurrHoleRequest::At::position}},
             "Where the hole is: at Kocher's point, measured from the landmarks, or at position_mm.");
    v.choice(&P::side, "side", {{"right", BurrHoleRequest::Side::right}, {"left", BurrHoleRequest::Side::left}},
             "Side of the patient on which Kocher's point lies.");
    v.number(&P::diameter_mm, "diameter_mm", Range{1, 60}, "Diameter of the hole.");
    v.number(&P::along_mm, "along_mm", Range{10, 250},
             "Kocher's point: distance from the nasion, over the midline of the skin.");
    v.number(&P::lateral_mm, "lateral_mm", Range{0, 100}, "Kocher's point: distance to the side, over the skin.");
    v.numbers(&P::position_mm, "position_mm", Range{-1e5, 1e5},
              "Position with at: position, on or above the skull, LPS; 0, 0, 0: not given.");
    v.numbers(
        &P::direction, "direction", Range{-1, 1},
        "Axis, pointing into the head; 0, 0, 0: towards `target_mm` or `toward`, else perpendicular to the skull.");
    v.numbers(&P::target_mm, "target_mm", Range{-1e5, 1e5}, "Place at which the axis points, LPS; 0, 0, 0: not given.");
    v.text(&P::toward, "toward", "Landmark at which the axis points.").names("landmark");
    v.number(&P::min_confidence, "min_confidence", Range{0, 1},
             "Landmarks that were found with less confidence than this are not used.");
    v.number(&P::min_before_suture_mm, "min_before_suture_mm", Range{-200, 200},
             "Kocher's point: least distance before the coronal suture, where that is seen or its bregma is given.");
    v.number(&P::max_before_suture_mm, "max_before_suture_mm", Range{-200, 200},
             "Kocher's point: largest distance before the coronal suture, where that is seen or its bregma is given.");
    v.map(&P::avoid, "avoid",
          "Zones (anatomies of the recipe) that the trajectory must keep clear of, each with the least distance in mm "
          "from the hole's wall and from the line to `toward`, such as {sagittal_sinus: 3}.")
        .at_most(16);
  }
};

/// Throws Error with that code, naming the field, where the parameters contradict each other.
void check_request(const BurrHoleParams& params, ExitCode code);

/// The landmark that the hole needs and that is not among these; empty where none is missing.
std::string missing_landmark(const BurrHoleParams& params, const std::map<std::string, Vec3>& landmarks_mm);

/// Throws Error with that code, naming the field, for a contradiction or a landmark that is missing.
BurrHoleRequest request_of(const BurrHoleParams& params, const std::map<std::string, Vec3>& landmarks_mm,
                           ExitCode code);

/// The end of a message: what to do about a landmark that is missing or has too little confidence.
constexpr const char* how_to_give_a_landmark =
    "give it in mm, LPS: `landmarks: {NAME: [x, y, z]}`, or a `landmarks_file` (.mrk.json or .fcsv of 3D Slicer)";

}  // namespace trephine::boolean
