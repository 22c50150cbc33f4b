// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How far a picture of rays is from the reference's.
#include <algorithm>

#include "base/srgb.h"
#include "cast_phantoms.h"
#include "render_scene.h"

namespace trephine::drawing {

struct Difference {
  double median = 255, p95 = 255;
  int covered = 0;
};

inline Difference compare(const trephine::scene::Picture& is, const cast::CastPicture& reference,
                          const trephine::scene::Picture& behind) {
  std::vector<int> off;
  int covered = 0;
  for (std::size_t n = 0; n < reference.rgba.size(); ++n) {
    const std::array<float, 4>& r = reference.rgba[n];
    const bool drawn = !std::equal(is.rgb.begin() + std::ptrdiff_t(3 * n), is.rgb.begin() + std::ptrdiff_t(3 * n + 3),
                                   behind.rgb.begin() + std::ptrdiff_t(3 * n));
    if (!(r[3] > 0) && !drawn) continue;
    ++covered;
    for (std::size_t c = 0; c < 3; ++c) {
      const double light = double(r[c]) + (1 - double(r[3])) * linear_of_srgb(behind.rgb[3 * n + c] / 255.0);
      off.push_back(std::abs(int(is.rgb[3 * n + c]) - int(std::lround(255 * srgb_of_linear(std::min(1.0, light))))));
    }
  }
  if (off.empty()) return {};
  std::sort(off.begin(), off.end());
  return {double(off[off.size() / 2]), double(off[off.size() * 95 / 100]), covered};
}

inline scene::EyeView eye_of_picture(const grid::Lattice& l, Vec3 toward) {
  scene::EyeView e = casting::eye_at(l, toward, 40);
  e.left *= double(width) / height;
  e.right_edge *= double(width) / height;
  return e;
}

constexpr double median_most = 2, p95_most = 8;  // of 255

}  // namespace trephine::drawing
