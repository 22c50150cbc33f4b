// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/png.h"

#include <zlib.h>

#include "base/error.h"

namespace trephine::scene {
namespace {

void put_u32(std::string& out, std::uint32_t v) {
  for (int shift = 24; shift >= 0; shift -= 8) out += char(v >> shift);
}

void chunk(std::string& out, const char* name, const std::string& data) {
  put_u32(out, std::uint32_t(data.size()));
  const std::string body = name + data;
  out += body;
  put_u32(out, std::uint32_t(::crc32(0, reinterpret_cast<const Bytef*>(body.data()), uInt(body.size()))));
}

}  // namespace

std::string png_of(const Picture& picture) {
  const std::size_t row = std::size_t(picture.width) * 3;
  if (picture.width < 1 || picture.height < 1 || picture.rgb.size() != row * std::size_t(picture.height))
    throw Error(ExitCode::internal, "", "picture", "has no pixels, or not as many as it says");
  // Filter "up" after the first row: what is flat or shaded compresses well with it.
  std::string raw;
  raw.reserve((row + 1) * std::size_t(picture.height));
  for (int y = 0; y < picture.height; ++y) {
    const std::uint8_t *here = picture.rgb.data() + row * std::size_t(y), *above = y > 0 ? here - row : nullptr;
    raw += char(above ? 2 : 0);
    for (std::size_t n = 0; n < row; ++n) raw += char(here[n] - (above ? above[n] : 0));
  }
  uLongf size = ::compressBound(uLong(raw.size()));
  std::string packed(size, '\0');
  if (::compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(raw.data()),
                  uLong(raw.size()), 6) != Z_OK)
    throw Error(ExitCode::internal, "", "picture", "cannot be compressed");
  packed.resize(size);
  std::string out("\x89PNG\r\n\x1a\n", 8), head;
  put_u32(head, std::uint32_t(picture.width));
  put_u32(head, std::uint32_t(picture.height));
  head += std::string("\x08\x02\x00\x00\x00", 5);
  chunk(out, "IHDR", head);
  chunk(out, "IDAT", packed);
  chunk(out, "IEND", "");
  return out;
}

}  // namespace trephine::scene
