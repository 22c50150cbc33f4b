// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/png.h"

#include <zlib.h>

#include "base/error.h"

namespace trephine {
namespace {

constexpr std::size_t piece_bytes = 8192;  // of an IDAT chunk

[[noreturn]] void refuse_to_encode() { throw Error(ExitCode::internal, "", "png", "cannot be encoded"); }

std::string big_endian(std::uint32_t v) { return {char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; }

void add_chunk(std::string& out, const std::string& name, const std::string& data) {
  const std::string body = name + data;
  const auto crc = ::crc32(0, reinterpret_cast<const Bytef*>(body.data()), uInt(body.size()));
  out += big_endian(std::uint32_t(data.size())) + body + big_endian(std::uint32_t(crc));
}

}  // namespace

struct PngRows::Writer {
  std::size_t row_bytes;
  int rows_left;
  z_stream z{};
  std::string piece = std::string(piece_bytes, '\0');
  std::string out = std::string("\x89PNG\r\n\x1a\n", 8);

  Writer(int width, int height, int channels)
      : row_bytes(std::size_t(width) * std::size_t(channels)), rows_left(height) {
    add_chunk(out, "IHDR",
              big_endian(std::uint32_t(width)) + big_endian(std::uint32_t(height)) +
                  std::string{'\x08',
                              channels == 4   ? '\x06'
                              : channels == 3 ? '\x02'
                                              : '\x00',
                              '\0', '\0', '\0'});
    add_chunk(out, "sRGB", std::string(1, '\0'));
    // Level 3: a fifth larger; a case spent more time here than on its files.
    if (deflateInit2(&z, 3, Z_DEFLATED, window_bits(), 8, Z_DEFAULT_STRATEGY) != Z_OK) refuse_to_encode();
    begin_piece();
  }
  ~Writer() { deflateEnd(&z); }
  /// No larger a window than a small picture fills, as libpng has it.
  int window_bits() const {
    const std::size_t bytes = (row_bytes + 1) * std::size_t(rows_left);
    int bits = 15;
    while (bytes <= 16384 && bits > 8 && bytes + 262 <= std::size_t{1} << (bits - 1)) --bits;
    return bits;
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void begin_piece() {
    z.next_out = reinterpret_cast<Bytef*>(piece.data());
    z.avail_out = uInt(piece_bytes);
  }
  void compress(const std::uint8_t* bytes, std::size_t size, int flush) {
    z.next_in = const_cast<Bytef*>(bytes);
    z.avail_in = uInt(size);
    for (int result = Z_OK; z.avail_in > 0 || (flush == Z_FINISH && result != Z_STREAM_END);) {
      result = deflate(&z, flush);
      if (result != Z_OK && result != Z_STREAM_END) refuse_to_encode();
      if (z.avail_out == 0 || result == Z_STREAM_END) {
        if (z.avail_out < piece_bytes) add_chunk(out, "IDAT", piece.substr(0, piece_bytes - z.avail_out));
        begin_piece();
      }
    }
  }
};

PngRows::PngRows(int width, int height, int channels) {
  if (width < 1 || height < 1 || (channels != 1 && channels != 3 && channels != 4)) refuse_to_encode();
  writer_ = std::make_unique<Writer>(width, height, channels);
}

PngRows::~PngRows() = default;

void PngRows::add(const std::vector<std::uint8_t>& rows) {
  Writer& w = *writer_;
  if (rows.size() % w.row_bytes != 0 || rows.size() / w.row_bytes > std::size_t(w.rows_left)) refuse_to_encode();
  const std::uint8_t no_filter = 0;
  for (std::size_t at = 0; at < rows.size(); at += w.row_bytes) {
    w.compress(&no_filter, 1, Z_NO_FLUSH);
    w.compress(&rows[at], w.row_bytes, Z_NO_FLUSH);
    --w.rows_left;
  }
}

std::string PngRows::take() {
  if (writer_->rows_left != 0) refuse_to_encode();
  writer_->compress(nullptr, 0, Z_FINISH);
  add_chunk(writer_->out, "IEND", "");
  return std::move(writer_->out);
}

std::string png_of(int width, int height, int channels, const std::vector<std::uint8_t>& rows) {
  PngRows png(width, height, channels);
  png.add(rows);
  return png.take();
}

}  // namespace trephine
