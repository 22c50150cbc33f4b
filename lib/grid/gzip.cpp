// SPDX-License-Identifier: GPL-3.0-or-later
#define ZLIB_CONST
#include <zlib.h>

#include <algorithm>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "grid/nrrd_header.h"

namespace trephine::grid::detail {
namespace {

// Level 1 by default: a mask of a head has 2 % of its size, and higher levels cost more than they save.
constexpr std::size_t chunk_bytes = std::size_t{4} << 20;

struct Chunk {
  std::string deflated;
  uLong crc = 0;
};

// Raw deflate blocks of one chunk; all but the last end at a byte boundary, so that they can be put one after the
// other.
Chunk deflate_chunk(std::string_view bytes, int level, GzipSearch search, bool last) {
  Chunk out;
  z_stream z{};
  const int strategy = search == GzipSearch::runs ? Z_RLE : Z_DEFAULT_STRATEGY;
  if (deflateInit2(&z, level, Z_DEFLATED, -15, 8, strategy) != Z_OK)
    throw Error(ExitCode::internal, "", "gzip", "cannot start");
  out.deflated.resize(deflateBound(&z, bytes.size()) + 64);
  z.next_in = reinterpret_cast<const Bytef*>(bytes.data());
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(out.deflated.data());
  z.avail_out = static_cast<uInt>(out.deflated.size());
  const int result = deflate(&z, last ? Z_FINISH : Z_SYNC_FLUSH);
  const bool done = z.avail_in == 0 && z.avail_out > 0 && result == (last ? Z_STREAM_END : Z_OK);
  out.deflated.resize(out.deflated.size() - z.avail_out);
  deflateEnd(&z);
  if (!done) throw Error(ExitCode::internal, "", "gzip", "compression failed");
  out.crc = crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()));
  return out;
}

void append_le32(std::string& out, std::uint64_t v) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<char>((v >> shift) & 0xff));
}

}  // namespace

std::string gzip_compress(std::string_view bytes, int level, GzipSearch search) {
  const std::size_t count = std::max<std::size_t>(1, (bytes.size() + chunk_bytes - 1) / chunk_bytes);
  std::vector<Chunk> chunks(count);
  parallel_for(0, static_cast<std::int64_t>(count), 1, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t c = from; c < to; ++c)
      chunks[c] =
          deflate_chunk(bytes.substr(c * chunk_bytes, chunk_bytes), level, search, c + 1 == std::int64_t(count));
  });
  std::string out("\x1f\x8b\x08\0\0\0\0\0\x04\x03", 10);  // no name, no time; fastest, Unix
  uLong crc = crc32(0, nullptr, 0);
  std::size_t total = out.size() + 8;
  for (const auto& c : chunks) total += c.deflated.size();
  out.reserve(total);
  for (std::size_t c = 0; c < count; ++c) {
    out += chunks[c].deflated;
    crc = crc32_combine(crc, chunks[c].crc, static_cast<z_off_t>(bytes.substr(c * chunk_bytes, chunk_bytes).size()));
  }
  append_le32(out, crc);
  append_le32(out, bytes.size());
  return out;
}

void gzip_expand(std::string_view compressed, char* out, std::uint64_t size) {
  struct Stream : z_stream {
    Stream() : z_stream{} {
      if (inflateInit2(this, 15 + 16) != Z_OK) throw Error(ExitCode::internal, "", "gzip", "cannot start");
    }
    ~Stream() { inflateEnd(this); }
  } z;
  constexpr std::uint64_t step = std::uint64_t{1} << 30;  // zlib counts in unsigned int
  std::vector<char> scratch(out ? 1 : 1 << 18);
  std::uint64_t read = 0, written = 0;
  for (;;) {
    if (z.avail_in == 0 && read < compressed.size()) {
      z.next_in = reinterpret_cast<const Bytef*>(compressed.data()) + read;
      z.avail_in = static_cast<uInt>(std::min(step, std::uint64_t(compressed.size()) - read));
      read += z.avail_in;
    }
    // At the end one byte of room is left, so that data beyond what the header says shows.
    char spare = 0;
    const std::uint64_t left = size - written;
    const uInt room = left == 0 ? 1 : static_cast<uInt>(std::min(left, out ? step : std::uint64_t(scratch.size())));
    z.next_out = reinterpret_cast<Bytef*>(left == 0 ? &spare : out ? out + written : scratch.data());
    z.avail_out = room;
    const uInt in_before = z.avail_in;
    const int result = inflate(&z, Z_NO_FLUSH);
    const uInt produced = room - z.avail_out;
    if (left == 0 && produced > 0) throw Error(ExitCode::bad_input, "", "data", "longer than the sizes say");
    written += produced;
    if (result == Z_STREAM_END) break;
    const bool starved = produced == 0 && z.avail_in == in_before;
    if ((result != Z_OK && result != Z_BUF_ERROR) || (starved && read == compressed.size()))
      throw Error(ExitCode::bad_input, "", "data", "the gzip stream is damaged or cut short");
  }
  if (written != size) throw Error(ExitCode::bad_input, "", "data", "shorter than the sizes say");
  if (z.avail_in > 0 || read < compressed.size())
    throw Error(ExitCode::bad_input, "", "data", "bytes follow the gzip stream");
}

}  // namespace trephine::grid::detail
