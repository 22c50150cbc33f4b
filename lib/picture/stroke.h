// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string_view>
#include <vector>

#include "picture/image.h"

namespace trephine::picture::detail {

/// How much of each pixel is covered by strokes. Segments are joined by their largest coverage, so that a line of many
/// short segments has no dots at the joints, and are blended into the picture once.
class StrokeMask {
 public:
  StrokeMask(int width, int height) : width_(width), height_(height), coverage_(std::size_t(width) * height, 0.f) {}
  /// Continuous pixel coordinates; round ends.
  void add_segment(double x0, double y0, double x1, double y1, double line_width);
  void blend(Image& image, Rgb colour, double opacity = 1) const;
  /// Empty again, for the next line.
  void clear();

 private:
  int width_, height_;
  int left_ = width_, right_ = 0, top_ = height_, bottom_ = 0;  // of what the segments reached
  std::vector<float> coverage_;
};

void blend_pixel(std::uint8_t* pixel, Rgb colour, double opacity);
void fill_rectangle(Image& image, double x0, double y0, double x1, double y1, Rgb colour, double opacity);

/// A bar of a round length in mm with its label, right-aligned in the lower right corner; at most `max_px` long.
void draw_scale_bar(Image& image, double mm_per_px, double max_px, double text_px, Rgb colour, Rgb halo);
/// Letters at the middle of the left, right, upper and lower edge.
void draw_edge_letters(Image& image, std::string_view left, std::string_view right, std::string_view top,
                       std::string_view bottom, double text_px, Rgb colour, Rgb halo);

struct Polyline {
  std::vector<std::array<double, 2>> points;  ///< in capital heights; y down from the capitals' top
};
struct Glyph {
  std::vector<Polyline> lines;
  double advance = 0;
};
const Glyph& glyph_of(unsigned char c);

}  // namespace trephine::picture::detail
