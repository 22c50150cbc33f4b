// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Whether landmarks can be those of one adult's head.
#include <string>
#include <vector>

#include "cases/case.h"

namespace trephine::craniometry {

/// How much a landmark's confidence has to be lowered, and why.
struct LandmarkDoubt {
  std::string name;
  double factor = 1;   ///< 0 to 1
  std::string reason;  ///< "183 mm from the tragi, 78 to 125 are plausible"
};

/// A pair of landmarks and the distance that they may have in an adult; with an `at`, the angle there, in degrees.
/// "tragi" and "foramina" stand for the middle between left and right, in the midsagittal plane.
struct LandmarkRange {
  const char *from, *to, *at;
  double least, most;
};

/// The ranges that are checked: our own choice, wide on purpose, for they are to find what is grossly wrong and nothing
/// else. They lie a fifth or more to either side of the same lengths of the real heads in
/// docs/validation/real-scans.md, and of adult means where a survey has them (bitragion breadth and tragion to top of
/// head [Gordon2014], tragion to nasion [Young1993], nasion to bregma on bone [Howells1973]).
const std::vector<LandmarkRange>& landmark_ranges();

/// Judges them together: which pairs and angles are out of range, and which landmark is to blame. That is the one which
/// is out of range most often; of several the ones that had a confidence below 0.4 before, and where nothing tells
/// which of them it is, all; they are taken out and the rest is judged again. What a person gave (source "given") is
/// never to blame, and an estimate judges nobody. A landmark to blame gets the factor 0.4, so that it is doubtful
/// whatever it was before. Landmarks that no range names are not judged. In the order of `landmarks`; only those with a
/// doubt.
std::vector<LandmarkDoubt> implausible(const std::vector<cases::CaseLandmark>& landmarks);

/// How far a point lies before the coronal suture, along the midline (below 0: behind it). `centre_mm` lies inside the
/// skull between nasion and inion.
double before_suture_mm(Vec3 point_mm, Vec3 bregma_mm, Vec3 centre_mm, Vec3 nasion_mm);
/// Kocher's point lies 1 to 2 cm before the suture; 5 mm on either side are left to the arcs.
constexpr double min_before_suture_mm = 5, max_before_suture_mm = 25;

}  // namespace trephine::craniometry
