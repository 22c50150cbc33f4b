// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "base/params.h"

namespace trephine::stages {

/// A landmark that a person gives.
struct PointParams {
  std::array<double, 3> position_mm{0, 0, 0};
  double confidence = 1;
  std::string source = "given";
  template <class V>
  static void describe(V& v) {
    using P = PointParams;
    v.numbers(&P::position_mm, "position_mm", Range{-1e5, 1e5}, "Position of the landmark, LPS, in mm.");
    v.number(&P::confidence, "confidence", Range{0, 1}, "Confidence of the landmark.");
    v.text(&P::source, "source", "Where the landmark comes from: given, found, estimated or truth.");
  }
};

/// Parameters of the stage points: the landmarks of a case that need not be found.
struct PointsParams {
  Named<PointParams> landmarks;
  template <class V>
  static void describe(V& v) {
    v.map(&PointsParams::landmarks, "landmarks", "Landmarks by name: nasion, inion, tragus_left, tragus_right, ...");
  }
};

}  // namespace trephine::stages
