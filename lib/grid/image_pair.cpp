// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/image_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/error.h"
#include "base/memory_budget.h"
#include "base/text.h"
#include "grid/gzip_limit.h"
#include "grid/nrrd_header.h"

namespace trephine::grid {
namespace {

constexpr std::size_t header_bytes = 348, one_file_offset = 352;

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

/// The fields of both headers, in the file's byte order.
class Header {
 public:
  explicit Header(std::string_view bytes) : bytes_(bytes.substr(0, header_bytes)) {
    if (bytes_.size() < header_bytes) refuse("header", "is shorter than 348 bytes");
    swapped_ = get<std::int32_t>(0) != int{header_bytes};
    if (get<std::int32_t>(0) != int{header_bytes}) refuse("header", "is of neither NIfTI nor Analyze 7.5");
  }
  template <class T>
  T get(std::size_t at) const {
    T v;
    std::memcpy(&v, bytes_.data() + at, sizeof v);
    return swapped_ ? turned(v) : v;
  }
  template <class T>
  void put(std::size_t at, T v) {
    if (swapped_) v = turned(v);
    std::memcpy(bytes_.data() + at, &v, sizeof v);
  }
  std::string text(std::size_t at, std::size_t count) const {
    const std::string t = bytes_.substr(at, count);
    return trimmed(t.substr(0, t.find('\0')));
  }
  const std::string& bytes() const { return bytes_; }

 private:
  template <class T>
  static T turned(T v) {
    char b[sizeof v];
    std::memcpy(b, &v, sizeof v);
    std::reverse(b, b + sizeof v);
    std::memcpy(&v, b, sizeof v);
    return v;
  }
  std::string bytes_;
  bool swapped_ = false;
};

/// Which row of the world (right, front, up) each letter means, and whether the axis rises or falls along it.
std::array<std::pair<std::size_t, float>, 3> sides_of(const std::string& axes) {
  if (axes.empty())
    throw Error(ExitCode::usage, "", "analyze_axes",
                "must be given: Analyze does not say which side is left. "
                "`trephine convert HEAD.hdr --analyze-axes LAS --output head.nii.gz` writes one that does; "
                "ask who made it for the three letters");
  constexpr std::string_view letters = "RLAPSI";
  std::array<std::pair<std::size_t, float>, 3> sides;
  std::array<bool, 3> taken{};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t at = a < axes.size() ? letters.find(axes[a]) : std::string_view::npos;
    if (axes.size() != 3 || at == std::string_view::npos || taken[at / 2])
      throw Error(ExitCode::usage, "", "analyze_axes",
                  "must be three letters, one of R and L, one of A and P, one of S and I, such as LAS");
    taken[at / 2] = true;
    sides[a] = {at / 2, at % 2 == 0 ? 1.0f : -1.0f};
  }
  return sides;
}

void say_place(Header& h, const std::string& axes, std::vector<std::string>& warnings) {
  const auto sides = sides_of(axes);
  if (const std::string units = h.text(56, 4); !units.empty() && units != "mm") refuse("vox_units", "must be mm");
  for (std::size_t at = 280; at < 328; at += 4) h.put(at, 0.0f);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto pixdim = h.get<float>(80 + 4 * a);
    if (!(pixdim > 0 && std::isfinite(pixdim))) refuse("pixdim", "must be positive along each axis");
    h.put(280 + 16 * sides[a].first + 4 * a, sides[a].second * pixdim);
  }
  h.put<std::int16_t>(252, 0);
  h.put<std::int16_t>(254, 1);
  h.put<std::uint8_t>(123, 2);  // mm
  warnings.push_back("Analyze does not say which side is left: it is taken as " + axes +
                     ", as the option asks; nor where it lies: its first voxel is taken as 0");
  const auto slope = h.get<float>(112), offset = h.get<float>(116);
  if (!std::isfinite(slope) || !std::isfinite(offset)) refuse("funused1", "the scale is not finite");
  if (slope == 0 && offset != 0) refuse("funused2", "is an offset without a scale");
  if (slope != 0 && (slope != 1 || offset != 0))
    warnings.push_back("the values are scaled as SPM does: times " + to_text(double(slope)) + " plus " +
                       to_text(double(offset)));
}

/// How many bytes the voxels need.
std::uint64_t image_bytes(const Header& h) {
  const int axes = h.get<std::int16_t>(40);
  std::uint64_t count = 1;
  if (axes < 3 || axes > 7) refuse("dim", "has " + std::to_string(axes) + " axes, must have 3");
  for (int a = 1; a <= axes; ++a) {
    const int n = h.get<std::int16_t>(40 + 2 * std::size_t(a));
    if (n < 1 || (a > 3 && n != 1)) refuse("dim", "axis " + std::to_string(a) + " has " + std::to_string(n));
    count *= std::uint64_t(n);
  }
  const int type = h.get<std::int16_t>(70), bits = h.get<std::int16_t>(72);
  const int wanted = type == 2 ? 8 : type == 4 ? 16 : type == 8 || type == 16 ? 32 : type == 64 ? 64 : bits;
  if (bits != wanted || bits < 8 || bits > 64 || bits % 8 != 0)
    refuse("bitpix", std::to_string(bits) + " does not go with the values' type");
  return count * std::uint64_t(bits / 8);
}

}  // namespace

ImagePair join_image_pair(std::string_view header, std::string_view image, bool gzip, const std::string& analyze_axes) {
  Header h(header);
  const std::string_view magic(h.bytes().data() + 344, 4);
  ImagePair out;
  out.is_analyze = magic != std::string_view("ni1\0", 4);
  if (magic.substr(0, 2) == "n+") refuse("magic", "says that the image is in the same file: name it .nii");
  if (out.is_analyze)
    say_place(h, analyze_axes, out.warnings);
  else if (!analyze_axes.empty())
    throw Error(ExitCode::usage, "", "analyze_axes", "is given, but the file is NIfTI and says its axes itself");
  const double offset = double(h.get<float>(108));
  if (!(offset >= 0 && offset <= 1e9 && offset == std::floor(offset))) refuse("vox_offset", "is no place in the image");
  const std::uint64_t begins = std::uint64_t(offset), need = begins + image_bytes(h);
  std::string expanded;
  if (gzip) {
    if (need / 1032 > image.size()) refuse("data", "more voxels than the file can hold");
    if (need > scan_limit.bytes(image.size()))
      refuse("data",
             std::to_string(image.size()) + " bytes would grow to " + std::to_string(need) + ", which no scan's do");
    require_memory(2 * need, "an image of " + std::to_string(need) + " bytes");
    expanded.resize(need);
    detail::gzip_expand(image, expanded.data(), need);
    image = expanded;
  }
  if (image.size() != need)  // more would be passed over, or read from the wrong place
    refuse("data", "the image has " + std::to_string(image.size()) + " bytes, the header says " + std::to_string(need));
  h.put(108, float{one_file_offset});
  out.nifti.reserve(one_file_offset + need - begins);
  out.nifti = h.bytes();
  out.nifti.replace(344, 4, std::string_view("n+1\0", 4));
  out.nifti.append(one_file_offset - header_bytes, '\0');
  out.nifti.append(image.substr(begins, need - begins));
  return out;
}

}  // namespace trephine::grid
