// SPDX-License-Identifier: GPL-3.0-or-later
#include "stored_data.h"

#include <zlib.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "itk/header_numbers.h"

namespace trephine::itk {
namespace {

using detail::bad;
constexpr unsigned char gzip_begin = 0x1f;

struct Inflating {
  z_stream z{};
  Inflating() {
    if (inflateInit2(&z, 15 + 32) != Z_OK) throw Error(ExitCode::internal, "", "zlib", "cannot start");
  }
  ~Inflating() { inflateEnd(&z); }
};

// Counts what comes out, and keeps none of it; ends as soon as it is more than is wanted.
void require_inflated(std::ifstream& in, std::uint64_t wanted) {
  Inflating stream;
  std::vector<unsigned char> packed(std::size_t{1} << 16), out(std::size_t{1} << 18);
  std::uint64_t count = 0;
  const auto refill = [&] {
    if (stream.z.avail_in > 0) return true;
    in.read(reinterpret_cast<char*>(packed.data()), static_cast<std::streamsize>(packed.size()));
    stream.z.next_in = packed.data();
    stream.z.avail_in = static_cast<uInt>(in.gcount());
    return stream.z.avail_in > 0;
  };
  int state = Z_OK;
  while (refill()) {
    if (state == Z_STREAM_END && *stream.z.next_in != gzip_begin)
      bad("data", "something follows the compressed voxels");
    if (state == Z_STREAM_END) inflateReset(&stream.z);  // a gzip stream may have several members
    stream.z.next_out = out.data();
    stream.z.avail_out = static_cast<uInt>(out.size());
    state = inflate(&stream.z, Z_NO_FLUSH);
    if (state != Z_OK && state != Z_STREAM_END) bad("data", "the compressed data is damaged");
    count += out.size() - stream.z.avail_out;
    if (count > wanted)
      bad("data", "holds more than the " + std::to_string(wanted) + " bytes that the header says, once inflated");
  }
  if (state != Z_STREAM_END) bad("data", "the file is cut short");
  if (count < wanted)
    bad("data", "holds " + std::to_string(count) + " bytes once inflated, the header says " + std::to_string(wanted));
}

}  // namespace

void require_as_many(const VolumeHeader& header, const std::filesystem::path& file, std::uint64_t wanted) {
  if (header.stored == Stored::otherwise) return;
  const std::filesystem::path& data = header.data_file.empty() ? file : header.data_file;
  std::ifstream in(data, std::ios::binary);
  in.seekg(0, std::ios::end);
  const auto size = static_cast<std::uint64_t>(std::max<std::streamoff>(0, in.tellg()));
  if (!in || size < header.data_at) bad("data", "the file is cut short");
  const std::uint64_t there = size - header.data_at;
  if (header.stored == Stored::plain && there != wanted)
    bad("data", "holds " + std::to_string(there) + " bytes, the header says " + std::to_string(wanted));
  if (header.stored == Stored::plain) return;
  in.seekg(static_cast<std::streamoff>(header.data_at));
  require_inflated(in, wanted);
}

}  // namespace trephine::itk
