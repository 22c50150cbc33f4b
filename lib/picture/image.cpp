// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/image.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <csetjmp>

#include "base/error.h"

namespace trephine::picture {
namespace {

png_image header() {
  png_image p{};
  p.version = PNG_IMAGE_VERSION;
  return p;
}

[[noreturn]] void silent_error(png_structp png, png_const_charp) { png_longjmp(png, 1); }
void silent_warning(png_structp, png_const_charp) {}

[[noreturn]] void refuse_to_encode() { throw Error(ExitCode::internal, "", "png", "cannot be encoded"); }

}  // namespace

Image::Image(int w, int h, Rgb fill) : width(w), height(h), rgb(std::size_t(w) * h * 3) {
  std::array<std::uint8_t, 3> bytes{};
  for (int c = 0; c < 3; ++c) bytes[c] = static_cast<std::uint8_t>(std::lround(std::clamp(fill[c], 0.0, 1.0) * 255));
  for (std::size_t i = 0; i < rgb.size(); i += 3) std::copy(bytes.begin(), bytes.end(), rgb.data() + i);
}

struct PngRows::Writer {
  png_structp png = nullptr;
  png_infop info = nullptr;
  int width = 0, height = 0, rows = 0;
  std::string out;

  ~Writer() { png_destroy_write_struct(&png, &info); }
  static void append(png_structp png, png_bytep data, std::size_t size) {
    auto* writer = static_cast<Writer*>(png_get_io_ptr(png));
    try {
      writer->out.append(reinterpret_cast<const char*>(data), size);
    } catch (const std::exception&) {  // must not pass through libpng
      png_error(png, "out of memory");
    }
  }
  // libpng jumps out of what it calls; no object with a destructor may live in between.
  bool begin() {
    if (setjmp(png_jmpbuf(png))) return false;
    png_set_write_fn(png, this, append, nullptr);
    png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8, PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);  // which would choose all filters after PNG_NO_FILTERS
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_NO_FILTERS);
    png_set_compression_level(png, 3);  // a fifth larger; a case spent more time here than on its files
    return true;
  }
  bool write(const Image& image) {
    if (setjmp(png_jmpbuf(png))) return false;
    for (int y = 0; y < image.height; ++y) png_write_row(png, image.at(0, y));
    return true;
  }
  bool end() {
    if (setjmp(png_jmpbuf(png))) return false;
    png_write_end(png, nullptr);
    return true;
  }
};

PngRows::PngRows(int width, int height) : writer_(std::make_unique<Writer>()) {
  Writer& w = *writer_;
  w.width = width;
  w.height = height;
  w.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, silent_error, silent_warning);
  if (w.png) w.info = png_create_info_struct(w.png);
  if (width < 1 || height < 1 || !w.info || !w.begin()) refuse_to_encode();
}

PngRows::~PngRows() = default;

void PngRows::add(const Image& rows) {
  Writer& w = *writer_;
  const bool fits = rows.width == w.width && rows.height >= 0 && rows.height <= w.height - w.rows &&
                    rows.rgb.size() == std::size_t(rows.width) * rows.height * 3;
  if (!fits || !w.write(rows)) refuse_to_encode();
  w.rows += rows.height;
}

std::string PngRows::take() {
  if (writer_->rows != writer_->height || !writer_->end()) refuse_to_encode();
  return std::move(writer_->out);
}

std::string encode_png(const Image& image) {
  PngRows rows(image.width, image.height);
  rows.add(image);
  return rows.take();
}

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
