// SPDX-License-Identifier: GPL-3.0-or-later
#include "codecs/transfer_syntax.h"

#include <fmt/format.h>

#include <cstdint>

namespace trephine::codecs {
namespace {

constexpr TransferSyntax syntaxes[] = {
    {"1.2.840.10008.1.2", "implicit VR little endian", Encoding::native, false},
    {"1.2.840.10008.1.2.1", "explicit VR little endian", Encoding::native},
    {"1.2.840.10008.1.2.1.99", "deflated explicit VR little endian", Encoding::unreadable},
    {"1.2.840.10008.1.2.2", "explicit VR big endian", Encoding::unreadable},
    {"1.2.840.10008.1.2.4.50", "JPEG baseline", Encoding::jpeg, true, true},
    {"1.2.840.10008.1.2.4.51", "JPEG extended", Encoding::jpeg, true, true},
    {"1.2.840.10008.1.2.4.57", "JPEG lossless", Encoding::jpeg},
    {"1.2.840.10008.1.2.4.70", "JPEG lossless first order", Encoding::jpeg},
    {"1.2.840.10008.1.2.4.80", "JPEG-LS lossless", Encoding::jpeg_ls},
    {"1.2.840.10008.1.2.4.81", "JPEG-LS near-lossless", Encoding::jpeg_ls, true, true},
    {"1.2.840.10008.1.2.4.90", "JPEG 2000 lossless", Encoding::jpeg_2000},
    {"1.2.840.10008.1.2.4.91", "JPEG 2000", Encoding::jpeg_2000, true, true},
    {"1.2.840.10008.1.2.4.92", "JPEG 2000 part 2 lossless", Encoding::unsupported},
    {"1.2.840.10008.1.2.4.93", "JPEG 2000 part 2", Encoding::unsupported},
    {"1.2.840.10008.1.2.4.94", "JPIP referenced", Encoding::unsupported},
    {"1.2.840.10008.1.2.4.95", "JPIP referenced deflate", Encoding::unsupported},
    {"1.2.840.10008.1.2.4.100", "MPEG-2", Encoding::unsupported},
    {"1.2.840.10008.1.2.4.102", "MPEG-4", Encoding::unsupported},
    {"1.2.840.10008.1.2.4.201", "high-throughput JPEG 2000 lossless", Encoding::unsupported},
    {"1.2.840.10008.1.2.4.202", "high-throughput JPEG 2000 RPCL lossless", Encoding::unsupported},
    {"1.2.840.10008.1.2.4.203", "high-throughput JPEG 2000", Encoding::unsupported},
    {"1.2.840.10008.1.2.5", "RLE lossless", Encoding::rle},
};

const std::uint8_t* bytes_of(std::string_view s) { return reinterpret_cast<const std::uint8_t*>(s.data()); }
unsigned be16(const std::uint8_t* p) { return (unsigned{p[0]} << 8) | p[1]; }
unsigned be32(const std::uint8_t* p) { return (be16(p) << 16) | be16(p + 2); }
unsigned le32(const std::uint8_t* p) { return p[0] | (p[1] << 8) | (p[2] << 16) | (unsigned{p[3]} << 24); }

/// The stream must end in FF D9; only the padding to an even length may follow.
bool has_end_marker(std::string_view s) {
  while (!s.empty() && s.back() == '\0') s.remove_suffix(1);
  if (s.size() >= 3 && be16(bytes_of(s) + s.size() - 3) == 0xffd9) s.remove_suffix(1);
  return s.size() >= 2 && be16(bytes_of(s) + s.size() - 2) == 0xffd9;
}

std::string compare(unsigned w, unsigned h, unsigned components, unsigned precision, int columns, int rows,
                    int bits_allocated) {
  if (w != static_cast<unsigned>(columns) || h != static_cast<unsigned>(rows))
    return fmt::format("its stream is {} x {}, the header says {} x {}", w, h, columns, rows);
  if (components != 1) return fmt::format("its stream has {} components, must be 1", components);
  const unsigned bytes = precision <= 8 ? 1 : 2;
  if (precision < 2 || precision > 16 || bytes > static_cast<unsigned>(bits_allocated) / 8)
    return fmt::format("its stream has {} bits, BitsAllocated is {}", precision, bits_allocated);
  return "";
}

// ITU T.81 B.1.1.3, T.87 C.1.1: markers up to the frame header.
std::string check_jpeg(std::string_view s, int columns, int rows, int bits_allocated) {
  const std::uint8_t* p = bytes_of(s);
  if (s.size() < 4 || be16(p) != 0xffd8) return "no JPEG stream";
  for (std::size_t at = 2; at + 4 <= s.size();) {
    if (p[at] != 0xff) return "no JPEG stream";
    const unsigned marker = p[at + 1];
    if (marker == 0xff) {  // fill byte
      ++at;
      continue;
    }
    const unsigned length = be16(p + at + 2);
    if (length < 2 || at + 2 + length > s.size()) break;
    const bool frame =
        (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) || marker == 0xf7;
    if (frame) {
      if (length < 8) break;
      if (!has_end_marker(s)) return "its stream is cut short: no end marker";
      return compare(be16(p + at + 7), be16(p + at + 5), p[at + 9], p[at + 4], columns, rows, bits_allocated);
    }
    if (marker == 0xda || marker == 0xd9) break;
    at += 2 + length;
  }
  return "its stream has no frame header";
}

// ITU T.800 A.5.1: SIZ comes first.
std::string check_jpeg_2000(std::string_view s, int columns, int rows, int bits_allocated) {
  const std::uint8_t* p = bytes_of(s);
  if (s.size() < 43 || be16(p) != 0xff4f || be16(p + 2) != 0xff51) return "no JPEG 2000 codestream";
  const unsigned w = be32(p + 8) - be32(p + 16), h = be32(p + 12) - be32(p + 20);
  if (!has_end_marker(s)) return "its stream is cut short: no end marker";
  return compare(w, h, be16(p + 40), (p[42] & 0x7fu) + 1, columns, rows, bits_allocated);
}

// PS3.5 annex G: a header of 16 numbers, then a segment for each byte of a word, most significant first.
std::string check_rle(std::string_view s, int columns, int rows, int bits_allocated) {
  if (s.size() < 64) return "its RLE header is cut short";
  const std::uint8_t* p = bytes_of(s);
  const unsigned segments = le32(p);
  if (segments != static_cast<unsigned>(bits_allocated) / 8)
    return fmt::format("{} RLE segments for {} bits", segments, bits_allocated);
  const std::uint64_t wanted = std::uint64_t(columns) * std::uint64_t(rows);
  for (unsigned k = 0; k < segments; ++k) {
    const std::uint64_t begin = le32(p + 4 + 4 * k), end = k + 1 < segments ? le32(p + 8 + 4 * k) : s.size();
    if (begin < 64 || begin > end || end > s.size()) return "wrong RLE segment offsets";
    std::uint64_t made = 0;
    for (std::uint64_t at = begin; at < end && made < wanted;) {
      const int n = static_cast<std::int8_t>(p[at]);
      if (n >= 0) {
        at += 2 + static_cast<std::uint64_t>(n);
        if (at > end) break;
        made += static_cast<std::uint64_t>(n) + 1;
      } else {
        at += n == -128 ? 1 : 2;
        if (at > end) break;
        if (n != -128) made += static_cast<std::uint64_t>(1 - n);
      }
    }
    if (made < wanted) return fmt::format("RLE segment {} holds {} of {} pixels", k + 1, made, wanted);
  }
  return "";
}

}  // namespace

const TransferSyntax* find_transfer_syntax(std::string_view uid) {
  for (const auto& s : syntaxes)
    if (uid == s.uid) return &s;
  return nullptr;
}

const TransferSyntax& implicit_little_endian() { return syntaxes[0]; }
const TransferSyntax& explicit_little_endian() { return syntaxes[1]; }

std::string check_codestream(Encoding encoding, std::string_view stream, int columns, int rows, int bits_allocated) {
  switch (encoding) {
    case Encoding::jpeg:
    case Encoding::jpeg_ls:
      return check_jpeg(stream, columns, rows, bits_allocated);
    case Encoding::jpeg_2000:
      return check_jpeg_2000(stream, columns, rows, bits_allocated);
    case Encoding::rle:
      return check_rle(stream, columns, rows, bits_allocated);
    default:
      return "not a compressed encoding";
  }
}

}  // namespace trephine::codecs
