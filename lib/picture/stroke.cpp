// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/stroke.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"

namespace trephine::picture {
namespace detail {

void blend_pixel(std::uint8_t* pixel, Rgb colour, double opacity) {
  for (int c = 0; c < 3; ++c)
    pixel[c] = static_cast<std::uint8_t>(pixel[c] + (colour[c] * 255 - pixel[c]) * opacity + 0.5);
}

void StrokeMask::add_segment(double x0, double y0, double x1, double y1, double line_width) {
  const double half = line_width / 2, reach = half + 0.5;
  const double dx = x1 - x0, dy = y1 - y0, length2 = dx * dx + dy * dy;
  const auto first = [](double v, int most) { return static_cast<int>(std::floor(std::clamp(v, 0.0, double(most)))); };
  const int i0 = first(std::min(x0, x1) - reach, width_), i1 = first(std::max(x0, x1) + reach + 1, width_);
  const int j0 = first(std::min(y0, y1) - reach, height_), j1 = first(std::max(y0, y1) + reach + 1, height_);
  if (i0 >= i1 || j0 >= j1) return;
  left_ = std::min(left_, i0), right_ = std::max(right_, i1);
  top_ = std::min(top_, j0), bottom_ = std::max(bottom_, j1);
  for (int j = j0; j < j1; ++j)
    for (int i = i0; i < i1; ++i) {
      const double px = i + 0.5 - x0, py = j + 0.5 - y0;
      const double t = length2 > 0 ? std::clamp((px * dx + py * dy) / length2, 0.0, 1.0) : 0.0;
      const double ex = px - t * dx, ey = py - t * dy;
      const float cover = static_cast<float>(std::clamp(reach - std::sqrt(ex * ex + ey * ey), 0.0, 1.0));
      float& c = coverage_[std::size_t(j) * width_ + i];
      c = std::max(c, cover);
    }
}

void StrokeMask::blend(Image& image, Rgb colour, double opacity) const {
  const int w = std::min(right_, image.width), h = std::min(bottom_, image.height);
  for (int j = top_; j < h; ++j)
    for (int i = left_; i < w; ++i) {
      const float c = coverage_[std::size_t(j) * width_ + i];
      if (c > 0) blend_pixel(image.at(i, j), colour, c * opacity);
    }
}

void StrokeMask::clear() {
  for (int j = top_; j < bottom_; ++j) {
    const auto row = coverage_.begin() + std::ptrdiff_t(j) * width_;
    std::fill(row + left_, row + std::max(left_, right_), 0.f);
  }
  left_ = width_, right_ = 0, top_ = height_, bottom_ = 0;
}

void fill_rectangle(Image& image, double x0, double y0, double x1, double y1, Rgb colour, double opacity) {
  const auto overlap = [](double a0, double a1, int i) { return std::min(a1, i + 1.0) - std::max(a0, double(i)); };
  for (int j = std::max(0, int(y0)); j < std::min(image.height, int(std::ceil(y1))); ++j)
    for (int i = std::max(0, int(x0)); i < std::min(image.width, int(std::ceil(x1))); ++i)
      blend_pixel(image.at(i, j), colour, opacity * overlap(x0, x1, i) * overlap(y0, y1, j));
}

void draw_scale_bar(Image& image, double mm_per_px, double max_px, double text_px, Rgb colour, Rgb halo) {
  double length_mm = 0;
  for (double decade = 1e-3; decade < 1e6; decade *= 10)
    for (const double step : {1.0, 2.0, 5.0})
      if (decade * step / mm_per_px <= max_px) length_mm = decade * step;
  if (!(length_mm > 0)) return;
  const double length = length_mm / mm_per_px, margin = text_px, thick = std::max(2.0, text_px * 0.22);
  const double x1 = image.width - margin, x0 = x1 - length, y = image.height - margin;
  fill_rectangle(image, x0 - 1, y - thick - 1, x1 + 1, y + 1, halo, 0.6);
  fill_rectangle(image, x0, y - thick, x1, y, colour, 1);
  const std::string label = to_text(length_mm < 1 ? length_mm : std::round(length_mm)) + " mm";
  draw_text(image, x0 + (length - text_width(label, text_px)) / 2, y - thick - text_px * 1.6, label, text_px, colour,
            halo);
}

void draw_edge_letters(Image& image, std::string_view left, std::string_view right, std::string_view top,
                       std::string_view bottom, double text_px, Rgb colour, Rgb halo) {
  const double margin = text_px * 0.7, middle_y = (image.height - text_px) / 2;
  const auto middle_x = [&](std::string_view s) { return (image.width - text_width(s, text_px)) / 2.0; };
  draw_text(image, margin, middle_y, left, text_px, colour, halo);
  draw_text(image, image.width - margin - text_width(right, text_px), middle_y, right, text_px, colour, halo);
  draw_text(image, middle_x(top), margin, top, text_px, colour, halo);
  draw_text(image, middle_x(bottom), image.height - margin - text_px, bottom, text_px, colour, halo);
}

}  // namespace detail

int text_width(std::string_view text, double height_px) {
  double width = 0;
  for (const char c : text) width += detail::glyph_of(static_cast<unsigned char>(c)).advance;
  return static_cast<int>(std::ceil(width * height_px));
}

void draw_text(Image& image, double x, double y, std::string_view text, double height_px, Rgb colour, Rgb halo) {
  if (text.empty()) return;
  // A mask that is as large as the text and lies at whole pixels.
  const double line = std::max(1.0, height_px * 0.145), pad = line + 4;
  const int x0 = static_cast<int>(std::floor(x - pad)), y0 = static_cast<int>(std::floor(y - pad));
  const int w = text_width(text, height_px) + static_cast<int>(2 * pad) + 2;
  const int h = static_cast<int>(height_px * 1.4 + 2 * pad) + 2;
  detail::StrokeMask ink(w, h), glow(w, h);
  double pen = x - x0;
  for (const char c : text) {
    const auto& glyph = detail::glyph_of(static_cast<unsigned char>(c));
    for (const auto& l : glyph.lines)
      for (std::size_t i = 1; i < l.points.size(); ++i) {
        const auto &a = l.points[i - 1], &b = l.points[i];
        const double ax = pen + a[0] * height_px, ay = y - y0 + a[1] * height_px;
        const double bx = pen + b[0] * height_px, by = y - y0 + b[1] * height_px;
        ink.add_segment(ax, ay, bx, by, a == b ? line * 1.3 : line);
        glow.add_segment(ax, ay, bx, by, line + 3);
      }
    pen += glyph.advance * height_px;
  }
  // Only the part within the picture is drawn, so that text may extend beyond its edges.
  Image part(w, h);
  const auto each = [&](const auto& f) {
    for (int j = std::max(0, -y0); j < std::min(h, image.height - y0); ++j)
      for (int i = std::max(0, -x0); i < std::min(w, image.width - x0); ++i) f(part.at(i, j), image.at(i + x0, j + y0));
  };
  each([](std::uint8_t* p, const std::uint8_t* q) { std::copy(q, q + 3, p); });
  glow.blend(part, halo, 0.55);
  ink.blend(part, colour);
  each([](const std::uint8_t* p, std::uint8_t* q) { std::copy(p, p + 3, q); });
}

}  // namespace trephine::picture
