// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>

#include "fluoro/fluoroscope.h"
#include "grid/nrrd_header.h"

namespace trephine::fluoro {
namespace {

std::uint32_t crc_of(const std::string& bytes) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t n = 0; n < 256; ++n) {
      std::uint32_t c = n;
      for (int k = 0; k < 8; ++k) c = c & 1 ? 0xedb88320u ^ c >> 1 : c >> 1;
      t[n] = c;
    }
    return t;
  }();
  std::uint32_t crc = 0xffffffffu;
  for (const char b : bytes) crc = table[(crc ^ std::uint8_t(b)) & 255] ^ crc >> 8;
  return ~crc;
}

std::string big_endian(std::uint32_t v) { return {char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; }

std::string chunk(const std::string& name, const std::string& data) {
  return big_endian(std::uint32_t(data.size())) + name + data + big_endian(crc_of(name + data));
}

// zlib's form of what gzip's form holds.
std::string zlib_of(const std::string& bytes) {
  std::string gzip = grid::detail::gzip_compress(bytes, 6);
  std::uint32_t a = 1, b = 0;
  for (const char c : bytes) {
    a = (a + std::uint8_t(c)) % 65521;
    b = (b + a) % 65521;
  }
  return std::string("\x78\x9c", 2) + gzip.substr(10, gzip.size() - 18) + big_endian(b << 16 | a);
}

}  // namespace

std::vector<std::uint8_t> shown_grey(const FluoroPicture& picture, MetalShown how) {
  std::vector<std::uint8_t> grey = picture.grey;
  if (how == MetalShown::dark)
    for (std::uint8_t& g : grey) g = std::uint8_t(255 - g);
  return grey;
}

std::string grey_png(int width, int height, const std::vector<std::uint8_t>& grey) {
  std::string rows;
  for (int y = 0; y < height; ++y) {
    rows += '\0';  // no filter
    rows.append(reinterpret_cast<const char*>(grey.data()) + std::size_t(y) * std::size_t(width), std::size_t(width));
  }
  std::string head = big_endian(std::uint32_t(width)) + big_endian(std::uint32_t(height));
  head += std::string("\x08\x00\x00\x00\x00", 5);
  return std::string("\x89PNG\r\n\x1a\n", 8) + chunk("IHDR", head) + chunk("IDAT", zlib_of(rows)) + chunk("IEND", "");
}

}  // namespace trephine::fluoro
