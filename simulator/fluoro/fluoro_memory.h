// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <list>
#include <vector>

#include "fluoro/carm.h"

namespace trephine::fluoro {

/// A picture of attenuation: line integrals of the linear attenuation coefficient, without a unit.
struct FluoroIntegrals {
  int size = 0;
  std::vector<float> integral;  ///< row by row
};

/// What a patient attenuates, seen from one place of the arm: all of a picture that does not hang on the needle.
struct KeptFluoro {
  CArmParams arm;
  FluoroIntegrals integrals;
  double bright = 1;
};

bool same_arm(const CArmParams& a, const CArmParams& b);

/// Pictures of the places where a C-arm stood, so that one which it comes back to is there at once. There are no more
/// than that many of them, of no more bytes; those that were asked for longest ago go first, and the newest always
/// stays. Of one place the larger picture takes the place of the smaller.
class FluoroMemory {
 public:
  explicit FluoroMemory(std::size_t max_places = 32, std::size_t max_bytes = std::size_t{64} << 20)
      : max_places_(max_places), max_bytes_(max_bytes) {}
  /// Null where there is none of that size. What is returned stays until the next call of keep().
  const KeptFluoro* find(const CArmParams& arm, int size);
  const KeptFluoro& keep(KeptFluoro picture);
  std::size_t places() const { return kept_.size(); }
  std::size_t bytes() const;

 private:
  std::size_t max_places_, max_bytes_;
  std::list<KeptFluoro> kept_;  ///< what was asked for last comes first
};

}  // namespace trephine::fluoro
