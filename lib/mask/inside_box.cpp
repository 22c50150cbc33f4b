// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/inside_box.h"

#include <algorithm>

namespace trephine::mask {

InsideBox inside_box(const grid::Field& field) {
  InsideBox box;
  box.begin = field.size;
  for (int k = 0; k < field.size[2]; ++k)
    for (int j = 0; j < field.size[1]; ++j)
      for (int i = 0; i < field.size[0]; ++i) {
        if (!(field.at(i, j, k) > 0)) continue;
        const int at[3] = {i, j, k};
        for (std::size_t a = 0; a < 3; ++a) {
          box.begin[a] = std::min(box.begin[a], at[a]);
          box.end[a] = std::max(box.end[a], at[a] + 1);
        }
        ++box.count;
      }
  return box;
}

}  // namespace trephine::mask
