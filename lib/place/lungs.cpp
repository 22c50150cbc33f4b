// SPDX-License-Identifier: GPL-3.0-or-later
#include "place/lungs.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/refusal.h"

namespace trephine::place {

constexpr double lung_hu = -300, max_air_ratio = 0.25;  ///< heads have up to a hundredth, also after an operation

void require_no_lungs(const mask::BitMask& enclosed, const mask::HuView& hu) {
  mask::BitMask air = enclosed;
  air.remove(mask::above(hu, lung_hu));
  const double share = double(air.count()) / double(std::max<std::size_t>(1, enclosed.count()));
  if (share < max_air_ratio) return;
  throw refusal(
      "cranial cavity",
      fmt::format("{:.0f} % of the space that bone encloses is air, as in a chest: no head was scanned, or its "
                  "skull is empty",
                  100 * share),
      {"take a series of a head; a chest is made by configs/ct_chest.yaml, an empty skull's bone by "
       "configs/ct_skull.yaml"});
}

}  // namespace trephine::place
