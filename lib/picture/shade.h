// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

namespace trephine::picture::detail {

using Light = std::array<float, 3>;  ///< linear red, green, blue

/// What is lit: normals of any length and positions, in camera coordinates (mm), and what the lights make of each.
/// Lists of one length for each number, so that four are computed at a time.
class LitPoints {
 public:
  std::array<std::vector<float>, 3> normal;    ///< of unit length after light(); zero vectors stay zero
  std::array<std::vector<float>, 3> position;  ///< mm
  std::vector<float> diffuse;                  ///< by what the surface's colour is multiplied
  std::vector<float> shine;                    ///< white light that is added
  std::vector<float> grazing;                  ///< 0 where the surface faces the eye, 1 where it is seen along itself

  std::size_t count = 0;  ///< of the points; the lists may be longer

  void add(const Light& n, const Light& p) {
    if (count == normal[0].size()) grow();
    for (int a = 0; a < 3; ++a) normal[a][count] = n[a], position[a][count] = p[a];
    ++count;
  }

 private:
  void grow();
};

/// A key light from the upper left, a weak one from the right, and a rim light from behind; the sky is a little
/// brighter than the ground. The eye is at that distance from the origin; 0: infinitely far away.
void light(LitPoints& points, float eye_distance_mm);

}  // namespace trephine::picture::detail
