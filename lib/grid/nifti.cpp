// SPDX-License-Identifier: GPL-3.0-or-later
#include "grid/nifti.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "base/error.h"
#include "base/memory_budget.h"
#include "base/text.h"
#include "grid/byte_source.h"
#include "grid/nifti_place.h"
#include "grid/nrrd_header.h"

namespace trephine::grid {
namespace {

constexpr std::uint64_t max_extension_bytes = std::uint64_t{64} << 20;
constexpr std::uint64_t max_place_bytes = 4096;
constexpr std::int64_t label_intent = 1002;
constexpr std::size_t piece_bytes = std::size_t{8} << 20;

using detail::ByteSource;

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

/// The fields that are needed of either version of the header.
struct Header {
  int version = 1;
  bool swapped = false;
  std::array<std::int64_t, 8> dim{};
  std::int64_t datatype = 0, bitpix = 0, qform_code = 0, sform_code = 0, units = 0, intent = 0;
  std::array<double, 8> pixdim{};
  double vox_offset = 0, slope = 0, inter = 0;
  std::array<double, 3> quaternion{}, offset{};
  std::array<std::array<double, 4>, 3> srow{};
};

class Fields {
 public:
  Fields(const std::string& bytes, bool swapped) : bytes_(bytes), swapped_(swapped) {}
  template <class T>
  T get(std::size_t at) const {
    char b[sizeof(T)];
    std::memcpy(b, bytes_.data() + at, sizeof(T));
    if (swapped_) std::reverse(b, b + sizeof(T));
    T v;
    std::memcpy(&v, b, sizeof(T));
    return v;
  }

 private:
  const std::string& bytes_;
  bool swapped_;
};

using detail::meant;

template <class Real, class Code, class Size>
void take_fields(Header& h, const Fields& f, const std::array<std::size_t, 10>& at) {
  for (std::size_t i = 0; i < 8; ++i) {
    h.dim[i] = f.get<Size>(at[0] + i * sizeof(Size));
    h.pixdim[i] = meant(f.get<Real>(at[1] + i * sizeof(Real)));
  }
  h.slope = f.get<Real>(at[2]);
  h.inter = f.get<Real>(at[2] + sizeof(Real));
  h.qform_code = f.get<Code>(at[3]);
  h.sform_code = f.get<Code>(at[4]);
  for (std::size_t i = 0; i < 3; ++i) {
    h.quaternion[i] = f.get<Real>(at[5] + i * sizeof(Real));
    h.offset[i] = meant(f.get<Real>(at[6] + i * sizeof(Real)));
    for (std::size_t c = 0; c < 4; ++c) h.srow[i][c] = meant(f.get<Real>(at[7] + (i * 4 + c) * sizeof(Real)));
  }
  h.datatype = f.get<std::int16_t>(at[8]);
  h.bitpix = f.get<std::int16_t>(at[8] + 2);
}

/// Reads the header from the beginning of the source.
Header header_of(ByteSource& in) {
  std::string bytes(348, '\0');
  if (!in.may_hold(348)) refuse("header", "not a NIfTI file");
  in.read(bytes.data(), 4);
  Header h;
  int version = 0;
  for (const bool swapped : {false, true}) {
    const auto size = Fields(bytes, swapped).get<std::int32_t>(0);
    if (size != 348 && size != 540) continue;
    version = size == 348 ? 1 : 2;
    h.swapped = swapped;
  }
  if (!version) refuse("header", "not a NIfTI file");
  h.version = version;
  bytes.resize(version == 1 ? 348 : 540);
  in.read(bytes.data() + 4, bytes.size() - 4);
  const Fields f(bytes, h.swapped);
  const std::string_view magic(bytes.data() + (version == 1 ? 344 : 4), version == 1 ? 4 : 8);
  if (magic.substr(0, 3) == "ni1" || magic.substr(0, 3) == "ni2")
    refuse("magic", "header and image in two files: convert them to one .nii");
  if (magic != (version == 1 ? std::string_view("n+1\0", 4) : std::string_view("n+2\0\r\n\x1a\n", 8)))
    refuse("magic", "not a NIfTI file");
  if (version == 1) {
    take_fields<float, std::int16_t, std::int16_t>(h, f, {40, 76, 112, 252, 254, 256, 268, 280, 70, 0});
    h.vox_offset = f.get<float>(108);
    h.units = f.get<std::uint8_t>(123);
    h.intent = f.get<std::int16_t>(68);
  } else {
    take_fields<double, std::int32_t, std::int64_t>(h, f, {16, 104, 176, 344, 348, 352, 376, 400, 12, 0});
    h.vox_offset = double(f.get<std::int64_t>(168));
    h.units = f.get<std::int32_t>(500);
    h.intent = f.get<std::int32_t>(504);
  }
  return h;
}

std::string number_text(std::int64_t n) { return std::to_string(n); }

std::array<int, 3> sizes_of(const Header& h) {
  if (h.dim[0] < 3 || h.dim[0] > 7) refuse("dim", "has " + number_text(h.dim[0]) + " axes, must have 3");
  std::array<int, 3> size{};
  std::int64_t count = 1;
  for (std::size_t a = 1; a <= 3; ++a) {
    if (h.dim[a] < 1 || h.dim[a] > std::numeric_limits<int>::max() || h.dim[a] > (std::int64_t{1} << 40) / count)
      refuse("dim", "axis " + number_text(std::int64_t(a)) + " has " + number_text(h.dim[a]) + " voxels");
    count *= h.dim[a];
    size[a - 1] = int(h.dim[a]);
  }
  for (std::int64_t a = 4; a <= h.dim[0]; ++a)
    if (h.dim[std::size_t(a)] != 1)
      refuse("dim", number_text(h.dim[std::size_t(a)]) + " volumes in one file, must be one");
  return size;
}

Mat3 rotation_of(const Header& h) {
  double b = h.quaternion[0], c = h.quaternion[1], d = h.quaternion[2];
  const double sum = b * b + c * c + d * d;
  if (!(sum <= 1.0001)) refuse("quatern", "is no rotation");
  double a = std::sqrt(std::max(0.0, 1 - sum));
  if (sum > 1) {
    const double k = 1 / std::sqrt(sum);
    a = 0, b *= k, c *= k, d *= k;
  }
  Mat3 m;
  m.column[0] = {a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)};
  m.column[1] = {2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b)};
  m.column[2] = {2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - c * c - b * b};
  return m;
}

struct Affine {
  std::array<Vec3, 3> steps;
  Vec3 origin;
};

Affine sform_of(const Header& h) {
  Affine a;
  for (int axis = 0; axis < 3; ++axis)
    for (int row = 0; row < 3; ++row) a.steps[axis][row] = h.srow[row][axis];
  a.origin = {h.srow[0][3], h.srow[1][3], h.srow[2][3]};
  return a;
}

Affine qform_of(const Header& h) {
  Affine a;
  const Mat3 m = rotation_of(h);
  for (int axis = 0; axis < 3; ++axis) {
    if (!(h.pixdim[axis + 1] > 0)) refuse("pixdim", "axis " + number_text(axis + 1) + " is not positive");
    a.steps[axis] = m.column[axis] * (h.pixdim[axis + 1] * (axis == 2 && h.pixdim[0] < 0 ? -1 : 1));
  }
  a.origin = {h.offset[0], h.offset[1], h.offset[2]};
  return a;
}

Affine pixdim_of(const Header& h) {
  Affine a;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(h.pixdim[axis + 1] > 0)) refuse("pixdim", "axis " + number_text(axis + 1) + " is not positive");
    a.steps[axis][axis] = h.pixdim[axis + 1];
  }
  return a;
}

/// The distance between the places at which the two transforms put a corner of the volume.
double disagreement(const Affine& a, const Affine& b, const std::array<int, 3>& size) {
  double most = 0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 off = a.origin - b.origin;
    for (int axis = 0; axis < 3; ++axis)
      if (corner >> axis & 1) off += (a.steps[axis] - b.steps[axis]) * double(size[axis] - 1);
    most = std::max(most, norm(off));
  }
  return most;
}

Lattice lattice_of(const Header& h, Nifti& out) {
  Lattice l;
  l.size = sizes_of(h);
  Affine affine;
  if (h.sform_code > 0) {
    out.frame = "sform";
    affine = sform_of(h);
    if (h.qform_code > 0) {
      double off = std::numeric_limits<double>::infinity();
      try {
        off = disagreement(affine, qform_of(h), l.size);
      } catch (const Error&) {
        // The qform is invalid, so the sform holds.
      }
      if (!(off <= 0.5 * norm(affine.steps[0])))
        out.warnings.push_back("sform and qform place the volume differently; the sform is taken");
    }
  } else if (h.qform_code > 0) {
    out.frame = "qform";
    affine = qform_of(h);
  } else {
    out.frame = "pixdim";
    affine = pixdim_of(h);
    out.warnings.push_back("the file does not say where its volume lies (neither sform nor qform)");
  }
  if ((h.units & 7) > 3) refuse("xyzt_units", number_text(h.units) + " is no unit of length");
  const double unit = (h.units & 7) == 1 ? 1000 : (h.units & 7) == 3 ? 0.001 : 1;
  const auto to_lps = [&](Vec3 v) { return Vec3{0 - v.x * unit, 0 - v.y * unit, v.z * unit}; };
  for (Vec3& s : affine.steps) s = to_lps(s);
  detail::take_axes(l, affine.steps, out.frame);
  l.origin_mm = to_lps(affine.origin);
  detail::require_place(l, out.frame);
  return l;
}

template <class T>
Grid<T> grid_with(const Lattice& l) {
  Grid<T> g;
  static_cast<Lattice&>(g) = l;
  return g;
}

/// Reads all samples in pieces, so that memory grows only with what the file really holds.
template <class S>
std::vector<S> samples_of(ByteSource& in, const Header& h, std::size_t count) {
  std::vector<S> samples;
  constexpr std::size_t piece = piece_bytes / sizeof(S);
  while (samples.size() < count) {
    const std::size_t from = samples.size(), n = std::min(piece, count - from);
    if (samples.capacity() < from + n) samples.reserve(std::min(count, std::max(from + n, 2 * from)));
    samples.resize(from + n);
    in.read(reinterpret_cast<char*>(samples.data() + from), n * sizeof(S));
  }
  if (h.swapped && sizeof(S) > 1)
    for (S& s : samples) {
      char* p = reinterpret_cast<char*>(&s);
      std::reverse(p, p + sizeof(S));
    }
  in.require_end();
  return samples;
}

template <class S>
AnyGrid grid_of(ByteSource& in, const Header& h, const Lattice& l) {
  const std::size_t count = l.count();
  const std::uint64_t wanted = std::uint64_t(count) * sizeof(S);
  if (!in.may_hold(wanted)) refuse("dim", "more voxels than the file can hold");
  in.require_growth(wanted);
  require_memory(wanted + std::uint64_t(count) * sizeof(float), "a volume of " + number_text(l.size[0]) + " x " +
                                                                    number_text(l.size[1]) + " x " +
                                                                    number_text(l.size[2]) + " voxels");
  std::vector<S> samples = samples_of<S>(in, h, count);
  if (std::isinf(h.slope)) refuse("scl_slope", "is not finite");  // NaN stands for none
  const bool scaled = h.slope != 0 && std::isfinite(h.slope) && !(h.slope == 1 && h.inter == 0);
  if (!scaled && std::is_same_v<S, std::uint8_t>) {
    auto g = grid_with<std::uint8_t>(l);
    if constexpr (std::is_same_v<S, std::uint8_t>) g.voxels = std::move(samples);
    return g;
  }
  if (scaled && !std::isfinite(h.inter)) refuse("scl_inter", "is not finite");
  const auto value = [&](S s) { return scaled ? h.slope * double(s) + h.inter : double(s); };
  bool whole = true;
  for (std::size_t i = 0; i < count; ++i) {
    const double v = value(samples[i]);
    if (!(std::abs(v) <= 3e38)) refuse("data", "voxel " + number_text(std::int64_t(i)) + " is not finite");
    whole = whole && v >= -32768 && v <= 32767 && v == std::floor(v);
  }
  const auto converted = [&](auto grid) {
    using T = typename decltype(grid)::Sample;
    grid.voxels.resize(count);
    for (std::size_t i = 0; i < count; ++i) grid.voxels[i] = static_cast<T>(value(samples[i]));
    return grid;
  };
  if (whole) return converted(grid_with<std::int16_t>(l));
  return converted(grid_with<float>(l));
}

}  // namespace

bool may_be_nifti(std::string_view bytes) {
  if (detail::is_gzip(bytes)) return true;
  if (bytes.size() < 348) return false;
  const std::string head(bytes.substr(0, 4));
  for (const bool swapped : {false, true}) {
    const auto size = Fields(head, swapped).get<std::int32_t>(0);
    if (size == 348 || size == 540) return true;
  }
  return false;
}

Nifti decode_nifti(std::string_view bytes, GzipLimit limit) {
  ByteSource in(bytes, limit);
  const Header h = header_of(in);
  Nifti out;
  Lattice l = lattice_of(h, out);
  if (h.intent != 0 && h.intent != label_intent)
    out.warnings.push_back("intent_code " + number_text(h.intent) + ": the file says that its values are no picture's");
  // Four bytes that say whether extensions follow stand before the earliest place of data.
  const double header_bytes = h.version == 1 ? 348 : 540;
  if (!(h.vox_offset >= header_bytes + 4 && h.vox_offset <= header_bytes + double(max_extension_bytes)) ||
      h.vox_offset != std::floor(h.vox_offset))
    refuse("vox_offset", to_text(std::isfinite(h.vox_offset) ? h.vox_offset : -1) + " is no place of data");
  if (!in.may_hold(std::uint64_t(h.vox_offset - header_bytes))) refuse("vox_offset", "lies beyond the file");
  const auto between = std::uint64_t(h.vox_offset - header_bytes);
  if (h.version == 1 && out.frame == "sform" && h.units == 2 && !h.swapped && between <= max_place_bytes) {
    std::string extension(between, '\0');
    in.read(extension.data(), extension.size());
    std::array<std::array<float, 4>, 3> sform{};
    for (std::size_t i = 0; i < 12; ++i) sform[i / 4][i % 4] = static_cast<float>(h.srow[i / 4][i % 4]);
    detail::take_place_extension(extension, sform, l);
  } else {
    in.skip(between);
  }

  struct Type {
    std::int64_t code, bits;
    AnyGrid (*read)(ByteSource&, const Header&, const Lattice&);
  };
  static const Type types[] = {{2, 8, grid_of<std::uint8_t>},     {4, 16, grid_of<std::int16_t>},
                               {8, 32, grid_of<std::int32_t>},    {16, 32, grid_of<float>},
                               {64, 64, grid_of<double>},         {256, 8, grid_of<std::int8_t>},
                               {512, 16, grid_of<std::uint16_t>}, {768, 32, grid_of<std::uint32_t>},
                               {1024, 64, grid_of<std::int64_t>}, {1280, 64, grid_of<std::uint64_t>}};
  for (const Type& t : types) {
    if (t.code != h.datatype) continue;
    if (t.bits != h.bitpix)
      refuse("bitpix", number_text(h.bitpix) + " does not belong to datatype " + number_text(h.datatype));
    out.grid = t.read(in, h, l);
    return out;
  }
  refuse("datatype", number_text(h.datatype) + " is not supported");
}

}  // namespace trephine::grid
