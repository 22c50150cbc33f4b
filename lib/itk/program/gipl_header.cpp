// SPDX-License-Identifier: GPL-3.0-or-later
// ITK 5.2 reads a GIPL file's size, type, voxels' size and origin, and passes over everything else.
#include <zlib.h>

#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <vector>

#include "base/error.h"
#include "base/text.h"
#include "base/write_file.h"
#include "grid/gzip_limit.h"
#include "grid/nrrd_header.h"
#include "itk/header_numbers.h"
#include "plain_header.h"

namespace trephine::itk {
namespace {

using detail::bad;

constexpr std::size_t header_bytes = 256;
constexpr std::uint32_t magic = 0xefffe9b0, other_magic = 0x2ae389b8;
// Where the fields lie.
constexpr std::size_t type_at = 8, spacing_at = 10, matrix_at = 106, orientation_at = 186, origin_at = 204,
                      offset_at = 236, scale_at = 240, gap_at = 244, magic_at = 252;

/// A number of the header, which is big-endian.
template <class T>
T number_at(const std::array<unsigned char, header_bytes>& header, std::size_t at) {
  std::array<unsigned char, sizeof(T)> bytes{};
  for (std::size_t n = 0; n < sizeof(T); ++n) bytes[n] = header[at + sizeof(T) - 1 - n];
  T v;
  std::memcpy(&v, bytes.data(), sizeof v);
  return v;
}

std::uint64_t bytes_of_type(std::uint16_t type) {
  switch (type) {
    case 7:  // char, unsigned char
    case 8:
      return 1;
    case 15:  // short, unsigned short
    case 16:
      return 2;
    case 31:  // unsigned int, int, float
    case 32:
    case 64:
      return 4;
    case 65:
      return 8;
    default:
      bad("image_type", "is not read: 8, 16 and 32 bits, float and double are");
  }
}

void require_plain(const std::array<unsigned char, header_bytes>& header) {
  for (std::size_t n = 0; n < 20; ++n)
    if (number_at<float>(header, matrix_at + 4 * n) != 0)
      bad("matrix", "is not read: the voxels may lie elsewhere than size and origin say; convert the file");
  const int orientation = header[orientation_at];
  if (orientation != 0 && orientation != 1 && orientation != 8 && orientation != 9)
    bad("orientation", "must be axial (9) or unsaid (0, 1, 8)");
  if (number_at<float>(header, offset_at) != 0)
    bad("pixval_offset", "must be 0: convert the file to one whose values are what is meant");
  if (const float scale = number_at<float>(header, scale_at); scale != 0 && scale != 1)
    bad("pixval_cal", "must be 0 or 1: convert the file to one whose values are what is meant");
  if (number_at<float>(header, gap_at) != 0)
    bad("interslice_gap", "must be 0: the slices may lie farther apart than pixdim says");
}

/// The header of a file, inflated where it is compressed.
std::array<unsigned char, header_bytes> header_of(const std::string& file, bool& compressed) {
  std::array<unsigned char, header_bytes> header{};
  const gzFile in = gzopen(file.c_str(), "rb");
  if (!in) bad("", "cannot be opened");
  const bool whole = gzread(in, header.data(), header_bytes) == static_cast<int>(header_bytes);
  compressed = gzdirect(in) == 0;
  gzclose_r(in);
  if (!whole) bad("data", "is cut short or damaged");
  return header;
}

}  // namespace

VolumeHeader check_gipl_file(const std::string& file) {
  bool compressed = false;
  const std::array<unsigned char, header_bytes> header = header_of(file, compressed);
  if (const auto m = number_at<std::uint32_t>(header, magic_at); m != magic && m != other_magic)
    bad("magic_number", "is not GIPL's");
  VolumeHeader out;
  ItkVolume said;
  std::uint64_t count = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto size = number_at<std::uint16_t>(header, 2 * a);
    if (size == 0) bad("dim", "must be 1 to 65535");
    said.size[a] = size;
    count *= size;
    said.spacing[a] = number_at<float>(header, spacing_at + 4 * a);
    said.origin[a] = number_at<double>(header, origin_at + 8 * a);
    said.axis[a][a] = 1;
    if (!std::isfinite(said.origin[a])) bad("origin", "is not finite");
    if (!(said.spacing[a] > 0)) bad("pixdim", "is not positive");
  }
  if (number_at<std::uint16_t>(header, 6) > 1) bad("dim", "says several volumes");
  require_plain(header);
  out.said = said;

  const std::uint64_t bytes = count * bytes_of_type(number_at<std::uint16_t>(header, type_at));
  std::error_code none;
  const std::uint64_t stored = std::filesystem::file_size(file, none);
  if (!compressed && stored != bytes + header_bytes)
    bad("data", "holds " + to_text(double(stored) - double(header_bytes)) + " bytes, the header says " +
                    to_text(double(bytes)));
  if (!compressed) return out;
  if (bytes > grid::scan_limit.bytes(stored))
    bad("data", to_text(double(stored)) + " bytes would grow to " + to_text(double(bytes)) + ", which no scan's do");
  const std::vector<char> packed = read_file(file);  // gzread would pass over what follows the stream
  grid::detail::gzip_expand({packed.data(), packed.size()}, nullptr, header_bytes + bytes);
  return out;
}

}  // namespace trephine::itk
