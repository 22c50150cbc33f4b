// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/report_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/base64.h"
#include "base/png.h"
#include "fluoro/fluoroscope.h"

namespace trephine::lessons::detail {
namespace {

constexpr int pixels = 160;  // of a mm

struct Plane {
  texts::Wording name;
  Vec3 right, down;
  const char *at_left, *at_right, *at_top, *at_bottom;  // the patient's side there, as all pictures letter it
};
// As radiologists look at them: the patient's left on the right; the nose on the left.
const std::array<Plane, 3> planes{{{{{"axial", "axial"}}, {1, 0, 0}, {0, 1, 0}, "R", "L", "A", "P"},
                                   {{{"coronal", "koronal"}}, {1, 0, 0}, {0, 0, -1}, "R", "L", "S", "I"},
                                   {{{"sagittal", "sagittal"}}, {0, 1, 0}, {0, 0, -1}, "A", "P", "S", "I"}}};
constexpr texts::Wording slice_word{{"slice", "Schicht"}};

// The letters at the edges, and a bar of 50 mm (a unit of the picture is a mm).
std::string marks_of(const Plane& plane) {
  constexpr int middle = pixels / 2, bar_mm = 50, edge = 4;
  std::string out;
  const auto letter = [&](const char* text, int x, int y) {
    out += fmt::format("<text text-anchor=\"middle\" x=\"{}\" y=\"{}\">{}</text>", x, y, text);
  };
  letter(plane.at_left, edge + 3, middle + 3);
  letter(plane.at_right, pixels - edge - 3, middle + 3);
  letter(plane.at_top, middle, edge + 7);
  letter(plane.at_bottom, middle, pixels - edge - 1);
  out += fmt::format("<line class=\"scale\" x1=\"{0}\" x2=\"{1}\" y1=\"{2}\" y2=\"{2}\"/>", edge, edge + bar_mm,
                     pixels - edge);
  return out + fmt::format("<text x=\"{}\" y=\"{}\">{} mm</text>", edge, pixels - edge - 3, bar_mm);
}

double hu_at(const grid::Grid<std::int16_t>& ct, Vec3 world_mm) {
  const Vec3 p = ct.to_index(world_mm);
  const int i = int(std::floor(p.x)), j = int(std::floor(p.y)), k = int(std::floor(p.z));
  if (!ct.contains(i, j, k) || !ct.contains(i + 1, j + 1, k + 1)) return -1000;
  double sum = 0;
  for (int n = 0; n < 8; ++n) {
    const int a = n & 1, b = n >> 1 & 1, c = n >> 2;
    const double w = (a ? p.x - i : 1 - p.x + i) * (b ? p.y - j : 1 - p.y + j) * (c ? p.z - k : 1 - p.z + k);
    sum += w * ct.at(i + a, j + b, k + c);
  }
  return sum;
}

std::string picture_of(const grid::Grid<std::int16_t>& ct, Vec3 middle, const Plane& plane, const PictureWindow& w) {
  std::vector<std::uint8_t> grey(std::size_t(pixels) * pixels);
  for (int y = 0; y < pixels; ++y)
    for (int x = 0; x < pixels; ++x) {
      const Vec3 p = middle + plane.right * (x + 0.5 - pixels / 2) + plane.down * (y + 0.5 - pixels / 2);
      const double share = (hu_at(ct, p) - w.low_hu) / (w.high_hu - w.low_hu);
      grey[std::size_t(y * pixels + x)] = std::uint8_t(std::lround(255 * std::clamp(share, 0.0, 1.0)));
    }
  return "data:image/png;base64," + base64(png_of(pixels, pixels, 1, grey));
}

}  // namespace

std::string slices_html(const cases::LoadedCase& loaded, Vec3 through, const std::vector<PictureMark>& marks,
                        texts::Language language, const PictureWindow& window) {
  std::string out = "<div class=\"slices\">\n";
  for (const Plane& plane : planes) {
    const auto at = [&](Vec3 p) {
      return fmt::format("{:.1f},{:.1f}", dot(p - through, plane.right) + pixels / 2,
                         dot(p - through, plane.down) + pixels / 2);
    };
    out += fmt::format("<figure><svg viewBox=\"0 0 {0} {0}\" role=\"img\" aria-label=\"{1} {2}\">", pixels,
                       plane.name.of(language), slice_word.of(language));
    if (loaded.has_ct())
      out += fmt::format("<image width=\"{0}\" height=\"{0}\" href=\"{1}\"/>", pixels,
                         picture_of(loaded.ct, through, plane, window));
    for (const PictureMark& mark : marks) {
      if (mark.points_mm.size() == 1) {
        const std::string p = at(mark.points_mm[0]);
        const std::size_t comma = p.find(',');
        out += fmt::format("<circle class=\"{}\" cx=\"{}\" cy=\"{}\" r=\"2.5\"/>", mark.kind, p.substr(0, comma),
                           p.substr(comma + 1));
        continue;
      }
      out += fmt::format("<polyline class=\"{}\" points=\"", mark.kind);
      for (const Vec3& p : mark.points_mm) out += at(p) + " ";
      out += "\"/>";
    }
    out += marks_of(plane);
    out += fmt::format("</svg><figcaption>{}</figcaption></figure>\n", plane.name.of(language));
  }
  return out + "</div>\n";
}

}  // namespace trephine::lessons::detail
