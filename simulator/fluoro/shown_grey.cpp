// SPDX-License-Identifier: GPL-3.0-or-later
#include "fluoro/fluoroscope.h"

#include <algorithm>

namespace trephine::fluoro {

std::vector<std::uint8_t> shown_grey(const FluoroPicture& picture, MetalShown how, bool flipped) {
  std::vector<std::uint8_t> grey = picture.grey;
  if (flipped)
    for (auto row = grey.begin(); row != grey.end(); row += picture.size) std::reverse(row, row + picture.size);
  if (how == MetalShown::dark)
    for (std::uint8_t& g : grey) g = std::uint8_t(255 - g);
  return grey;
}

}  // namespace trephine::fluoro
