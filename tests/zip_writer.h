// SPDX-License-Identifier: GPL-3.0-or-later
// ZIP archives by hand: any field of them can lie.
#pragma once
#include <zlib.h>

#include <cstdint>
#include <string>
#include <vector>

namespace synthetic {

struct ZipMember {
  std::string name, bytes;
  bool deflate = true;
  std::uint16_t flags = 0;                ///< 1: encrypted
  std::uint32_t unix_mode = 0100644;      ///< 0120777: a link
  int method = -1;                        ///< claimed instead of the true one
  std::int64_t size = -1, checksum = -1;  ///< claimed
  int same_data_as = -1;                  ///< points to that member's data: overlapping, as a bomb's
};

inline std::string raw_deflate(const std::string& bytes) {
  z_stream z{};
  deflateInit2(&z, 9, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&z, bytes.size()) + 64, '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}

/// APPNOTE 6.3: local headers with their data, the central directory, its end.
inline std::string zip_bytes(const std::vector<ZipMember>& members) {
  const auto put = [](std::string& s, std::uint64_t v, int bytes) {
    for (int i = 0; i < bytes; ++i) s += static_cast<char>(v >> (8 * i));
  };
  std::string out, directory;
  std::vector<std::uint64_t> offsets, packed_sizes;
  for (const ZipMember& m : members) {
    const std::string data = m.deflate ? raw_deflate(m.bytes) : m.bytes;
    const auto truth = static_cast<std::uint64_t>(
        crc32(0, reinterpret_cast<const Bytef*>(m.bytes.data()), static_cast<uInt>(m.bytes.size())));
    std::string common;
    put(common, 20, 2);
    put(common, m.flags, 2);
    put(common, static_cast<std::uint64_t>(m.method >= 0 ? m.method : m.deflate ? 8 : 0), 2);
    put(common, 0x00210000, 4);  // the first of January 1980
    put(common, m.checksum >= 0 ? static_cast<std::uint64_t>(m.checksum) : truth, 4);
    const auto same = static_cast<std::size_t>(m.same_data_as);
    put(common, m.same_data_as >= 0 ? packed_sizes[same] : data.size(), 4);
    put(common, m.size >= 0 ? static_cast<std::uint64_t>(m.size) : m.bytes.size(), 4);
    put(common, m.name.size(), 2);
    put(common, 0, 2);
    offsets.push_back(m.same_data_as >= 0 ? offsets[same] : out.size());
    packed_sizes.push_back(data.size());
    if (m.same_data_as < 0) out += std::string("PK\3\4", 4) + common + m.name + data;
    directory += std::string("PK\1\2", 4);
    put(directory, (3 << 8) | 20, 2);  // made on unix
    directory += common;
    put(directory, 0, 6);  // comment, disk, internal attributes
    put(directory, std::uint64_t{m.unix_mode} << 16, 4);
    put(directory, offsets.back(), 4);
    directory += m.name;
  }
  const std::uint64_t begin = out.size();
  out += directory + std::string("PK\5\6", 4);
  put(out, 0, 4);
  put(out, members.size(), 2);
  put(out, members.size(), 2);
  put(out, directory.size(), 4);
  put(out, begin, 4);
  put(out, 0, 2);
  return out;
}

}  // namespace synthetic
