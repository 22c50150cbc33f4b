// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace trephine::picture {

/// sRGB, 0 to 1.
using Rgb = std::array<double, 3>;

/// 8-bit sRGB, row by row from the top, three bytes a pixel.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;

  Image() = default;
  Image(int w, int h, Rgb fill = {0, 0, 0});
  std::uint8_t* at(int x, int y) { return rgb.data() + (std::size_t(y) * width + x) * 3; }
  const std::uint8_t* at(int x, int y) const { return rgb.data() + (std::size_t(y) * width + x) * 3; }
};

/// As png_of (base/png.h).
std::string encode_png(const Image& image);
/// Reads an 8-bit RGB PNG, at most 2^28 pixels. Throws Error 65 where it is damaged.
Image decode_png(std::string_view bytes);

/// The pictures side by side in rows of `columns`, each cell as large as the largest, with a gap between them.
Image contact_sheet(const std::vector<Image>& images, int columns, Rgb background = {1, 1, 1}, int gap_px = 4);

/// Width and height of one line of text; the built-in font knows printable ASCII and draws other bytes as a box.
int text_width(std::string_view text, double height_px);
/// Draws a line of text with its upper left corner there, antialiased, over a soft halo in `halo` so that it is
/// readable on anything. `height_px` is that of a capital letter.
void draw_text(Image& image, double x, double y, std::string_view text, double height_px, Rgb colour, Rgb halo);

}  // namespace trephine::picture
