// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "base/params.h"
#include "base/vec3.h"

namespace trephine::fluoro {

/// Where a C-arm stands, and what its detector sees.
///
/// At 0 degrees the beam goes from the patient's front to the back, and the picture shows the patient's left on its
/// right and the head above. `orbit_deg` turns the arm about the patient's long axis: at 90 the beam goes from the
/// patient's left to the right. `tilt_deg` then tips the beam towards the head.
struct CArmParams {
  enum class View { free, ap, lateral, oblique };
  View view = View::ap;
  double orbit_deg = 0, tilt_deg = 0;
  std::array<double, 3> centre_mm{0, 0, 0};
  double source_to_centre_mm = 600, source_to_detector_mm = 1000, detector_mm = 300;
  template <class V>
  static void describe(V& v) {
    using P = CArmParams;
    v.choice(&P::view, "view",
             {{"free", View::free}, {"ap", View::ap}, {"lateral", View::lateral}, {"oblique", View::oblique}},
             "Where the arm stands: ap is 0 degrees, lateral 90, oblique 45; free: as orbit_deg and tilt_deg say.");
    v.number(&P::orbit_deg, "orbit_deg", Range{-360, 360}, "Turn about the patient's long axis, with view free.");
    v.number(&P::tilt_deg, "tilt_deg", Range{-80, 80}, "Tilt towards the head, with view free.");
    v.numbers(&P::centre_mm, "centre_mm", Range{-1e5, 1e5}, "What the arm turns about, LPS.");
    v.number(&P::source_to_centre_mm, "source_to_centre_mm", Range{0, 5000},
             "From the source to the centre; 0: parallel beams.");
    v.number(&P::source_to_detector_mm, "source_to_detector_mm", Range{1, 10000}, "From the source to the detector.");
    v.number(&P::detector_mm, "detector_mm", Range{1, 2000}, "Side of the square detector.");
  }
  std::string fault() const {
    return source_to_centre_mm > 0 && source_to_detector_mm < source_to_centre_mm
               ? "source_to_detector_mm: is below source_to_centre_mm"
               : std::string();
  }
};

/// The arm's geometry for pictures of size x size pixels; (0, 0) is the upper left corner of the first pixel.
class CArm {
 public:
  CArm(const CArmParams& params, int size);
  struct Ray {
    Vec3 from_mm, direction;  ///< unit; from the source, or from far before the patient
  };
  Ray ray(double x, double y) const;
  /// Where a point appears, in pixels.
  std::array<double, 2> project(Vec3 point_mm) const;
  /// How far it lies before the source, along the beam; of parallel beams, any amount.
  double before_source_mm(Vec3 point_mm) const {
    return to_centre_ > 0 ? to_centre_ + dot(point_mm - centre_, beam_) : 1e9;
  }
  int size() const { return size_; }
  Vec3 beam() const { return beam_; }
  /// The patient's side at the picture's left and right edge: R and L, or where those lie along the beam, A and P.
  std::array<const char*, 2> side_letters() const;

 private:
  Vec3 centre_, beam_, right_, up_;
  double to_centre_, to_detector_, pixel_mm_;
  int size_;
};

/// A straight piece of metal in the picture.
struct MetalRod {
  Vec3 tip_mm, tail_mm;
  double diameter_mm = 1;
};
/// How much of the ray lies within the rod, a cylinder with flat ends; mm.
double chord_mm(const MetalRod& rod, const CArm::Ray& ray);

}  // namespace trephine::fluoro
