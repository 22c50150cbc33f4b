// SPDX-License-Identifier: GPL-3.0-or-later
#include "fluoro/fluoroscope.h"

namespace trephine::fluoro {

std::vector<std::uint8_t> shown_grey(const FluoroPicture& picture, MetalShown how) {
  std::vector<std::uint8_t> grey = picture.grey;
  if (how == MetalShown::dark)
    for (std::uint8_t& g : grey) g = std::uint8_t(255 - g);
  return grey;
}

}  // namespace trephine::fluoro
