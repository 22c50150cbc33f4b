// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "cases/case.h"

namespace trephine::cases {

/// A pedicle of the case, from the landmarks NAME_entry and NAME_target (pedicle_1_left_entry, ...). LPS, mm.
struct CasePedicle {
  std::string name;
  Vec3 entry_mm, target_mm;
  double confidence = 1;
  /// The axes of its vertebra, unit and at right angles, however the patient lay in the scanner: to the patient's left
  /// from the right pedicle to the left one, to the head along the vertebrae beside it.
  Vec3 left{1, 0, 0}, cranial{0, 0, 1};
  Vec3 forwards() const { return normalized(target_mm - entry_mm); }
  Vec3 anterior() const { return cross(left, cranial); }
  bool on_left() const { return name.find("_left") != std::string::npos; }
  /// To the head and away from the midline, at right angles to the pedicle's own axis.
  Vec3 up() const { return across(cranial); }
  Vec3 outer() const { return across(on_left() ? left : -left); }

 private:
  Vec3 across(Vec3 way) const { return normalized(way - forwards() * dot(way, forwards())); }
};
/// Where neither side's partner nor another vertebra is surely known, the axes are those of the scanner (LPS).
std::vector<CasePedicle> pedicles_of(const CaseManifest& manifest);

}  // namespace trephine::cases
