// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/image.h"

#include <png.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/png.h"

namespace trephine::picture {
namespace {

png_image header() {
  png_image p{};
  p.version = PNG_IMAGE_VERSION;
  return p;
}

}  // namespace

Image::Image(int w, int h, Rgb fill) : width(w), height(h), rgb(std::size_t(w) * h * 3) {
  std::array<std::uint8_t, 3> bytes{};
  for (int c = 0; c < 3; ++c) bytes[c] = static_cast<std::uint8_t>(std::lround(std::clamp(fill[c], 0.0, 1.0) * 255));
  for (std::size_t i = 0; i < rgb.size(); i += 3) std::copy(bytes.begin(), bytes.end(), rgb.data() + i);
}

std::string encode_png(const Image& image) { return png_of(image.width, image.height, 3, image.rgb); }

Image decode_png(std::string_view bytes) {
  png_image p = header();
  Image out;
  const auto refuse = [&](const char* what) {
    png_image_free(&p);
    throw Error(ExitCode::bad_input, "", "png", what);
  };
  if (!png_image_begin_read_from_memory(&p, bytes.data(), bytes.size())) refuse("is damaged");
  if (p.format & (PNG_FORMAT_FLAG_ALPHA | PNG_FORMAT_FLAG_LINEAR)) refuse("must be 8-bit RGB");
  if (p.width == 0 || p.height == 0 || std::uint64_t{p.width} * p.height > (1u << 28)) refuse("is too large");
  // Deflate gains at most a factor of 1032.
  if (std::uint64_t{p.width} * p.height / 1032 > std::uint64_t{bytes.size()}) refuse("is damaged");
  p.format = PNG_FORMAT_RGB;
  out = Image(static_cast<int>(p.width), static_cast<int>(p.height));
  if (!png_image_finish_read(&p, nullptr, out.rgb.data(), 0, nullptr) || PNG_IMAGE_FAILED(p)) refuse("is damaged");
  return out;
}

Image contact_sheet(const std::vector<Image>& images, int columns, Rgb background, int gap_px) {
  int cell_w = 0, cell_h = 0;
  for (const auto& i : images) {
    cell_w = std::max(cell_w, i.width);
    cell_h = std::max(cell_h, i.height);
  }
  columns = std::clamp(columns, 1, std::max(1, static_cast<int>(images.size())));
  const int rows = (static_cast<int>(images.size()) + columns - 1) / columns;
  Image out(columns * (cell_w + gap_px) + gap_px, rows * (cell_h + gap_px) + gap_px, background);
  for (std::size_t n = 0; n < images.size(); ++n) {
    const Image& i = images[n];
    const int x = gap_px + static_cast<int>(n % columns) * (cell_w + gap_px) + (cell_w - i.width) / 2;
    const int y = gap_px + static_cast<int>(n / columns) * (cell_h + gap_px) + (cell_h - i.height) / 2;
    for (int j = 0; j < i.height; ++j) std::copy(i.at(0, j), i.at(0, j) + std::size_t(i.width) * 3, out.at(x, y + j));
  }
  return out;
}

}  // namespace trephine::picture
