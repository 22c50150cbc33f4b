// SPDX-License-Identifier: GPL-3.0-or-later
// MINC 2 (en.wikibooks.org/wiki/MINC/Reference/MINC2.0_File_Format_Reference): a volume in HDF5.
#include "minc.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "base/text.h"
#include "base/write_file.h"
#include "hdf5_file.h"

namespace trephine::itk {
namespace {

using namespace hdf5;

constexpr const char* image_name = "/minc-2.0/image/0/image";
constexpr std::array<const char*, 3> axes{"xspace", "yspace", "zspace"};
std::string path_of(const char* axis) { return std::string("/minc-2.0/dimensions/") + axis; }

// HDF5 1.10 believes the sizes within an attribute's message, and reads what lies elsewhere, zeros mostly, where one is
// damaged. They follow from the message's own type and space, so they are checked in the file's bytes (HDF5 File Format
// Specification 3.0, IV.A.2.b, d and m; newer versions of the message have a checksum over them).
void require_sound_messages(std::string_view bytes, std::string_view name) {
  const auto byte = [&](std::size_t at) { return at < bytes.size() ? static_cast<unsigned char>(bytes[at]) : 0u; };
  const auto two = [&](std::size_t at) { return byte(at) + 256u * byte(at + 1); };
  const auto padded = [](std::size_t n) { return (n + 7) / 8 * 8; };
  const std::string whole = std::string(name) + '\0';
  for (std::size_t at = 0; (at = bytes.find(whole, at)) != std::string_view::npos; ++at) {
    if (at < 8 || byte(at - 8) != 1 || byte(at - 7) != 0 || two(at - 6) != whole.size()) continue;
    const std::size_t type = at + padded(whole.size()), type_bytes = two(at - 4), space = type + padded(type_bytes);
    const unsigned kind = byte(type) & 15, numbers = byte(space + 1) * (1 + (byte(space + 2) & 1u));
    const bool type_fits = (kind == 0 && type_bytes == 12) || (kind == 1 && type_bytes == 20) || kind > 1;
    if (!type_fits || two(at - 2) != (byte(space) == 1 ? 8u : 4u) + 8 * numbers)
      bad(std::string(name), "is damaged: its sizes do not go with its type");
  }
}

void require_sound_messages(const std::string& file) {
  const std::vector<char> bytes = read_file(file);
  for (const char* name : {"start", "step", "length", "direction_cosines", "valid_range"})
    require_sound_messages({bytes.data(), bytes.size()}, name);
}

// libminc takes 0, 1 and the patient's axes for what is missing, and so would one damaged letter of a name.
[[noreturn]] void missing(const char* name) {
  bad(name, "is missing: the file does not say where it lies (minc_modify_header writes it)");
}

double one_number(hid_t file, const std::string& object, const char* name) {
  const std::vector<double> found = numbers_of(file, object, name);
  if (found.empty()) missing(name);
  if (found.size() != 1 || !std::isfinite(found[0])) bad(name, "must be one finite number");
  return found[0];
}

void take_axis(hid_t file, std::size_t a, ItkVolume& head) {
  const std::string object = path_of(axes[a]);
  if (H5Lexists(file, object.c_str(), H5P_DEFAULT) <= 0) bad(axes[a], "is missing");
  const std::string spacing = text_of(file, object, "spacing"), units = text_of(file, object, "units");
  if (!spacing.empty() && spacing.rfind("regular", 0) != 0) bad(axes[a], "has slices at irregular places");
  if (!units.empty() && trimmed(units) != "mm") bad("units", "must be mm");
  const double length = one_number(file, object, "length");
  if (!(length >= 1 && length <= 65535 && length == std::floor(length))) bad("length", "must be 1 to 65535");
  head.size[a] = static_cast<std::int32_t>(length);
  double start = one_number(file, object, "start"), step = one_number(file, object, "step");
  const std::vector<double> cosines = numbers_of(file, object, "direction_cosines");
  if (cosines.empty()) missing("direction_cosines");
  if (cosines.size() != 3) bad("direction_cosines", "must be three numbers");
  if (step < 0) {  // libminc gives the voxels in the order in which the coordinate rises
    start += step * (length - 1);
    step = -step;
  }
  if (!(step > 0)) bad("step", "is zero");
  head.spacing[a] = step;
  for (std::size_t r = 0; r < 3; ++r) {
    if (!std::isfinite(cosines[r])) bad("direction_cosines", "is not finite");
    head.axis[a][r] = r < 2 ? 0 - cosines[r] : cosines[r];
    head.origin[r] += start * head.axis[a][r];
  }
}

void require_three_axes(hid_t file, const ItkVolume& head) {
  const Id image(H5Dopen2(file, image_name, H5P_DEFAULT), H5Dclose);
  if (!image.valid()) bad("image", "is missing");
  const Id space(H5Dget_space(image), H5Sclose), type(H5Dget_type(image), H5Tclose);
  if (!is_usual(type)) bad("image", "is stored in no usual type");
  std::array<hsize_t, 3> size{};
  if (H5Sget_simple_extent_ndims(space) != 3) bad("image", "must have three dimensions");
  H5Sget_simple_extent_dims(space, size.data(), nullptr);
  const std::vector<std::string> order = split_at(text_of(file, image_name, "dimorder"), ',');
  if (order.size() != 3) bad("dimorder", "must name xspace, yspace and zspace");
  for (std::size_t a = 0; a < 3; ++a) {
    const auto at = std::find(order.begin(), order.end(), axes[a]);
    if (at == order.end()) bad("dimorder", "must name xspace, yspace and zspace");
    if (size[static_cast<std::size_t>(at - order.begin())] != static_cast<hsize_t>(head.size[a]))
      bad("length", std::string("of ") + axes[a] + " is not what the image has");
  }
}

template <class T>
std::array<double, 2> range_of(std::string_view voxels) {
  std::array<double, 2> range{0, 0};
  for (std::size_t at = 0; at + sizeof(T) <= voxels.size(); at += sizeof(T)) {
    T v;
    std::memcpy(&v, voxels.data() + at, sizeof v);
    range[0] = at == 0 ? double(v) : std::min(range[0], double(v));
    range[1] = at == 0 ? double(v) : std::max(range[1], double(v));
  }
  return range;
}

struct Stored {
  hid_t file, memory;
  std::size_t bytes;
  std::array<double, 2> range;  ///< of the type: voxels of this range mean themselves
};

Stored stored_as(ItkSample sample, std::string_view voxels) {
  if (sample == ItkSample::uint8) return {H5T_STD_U8LE, H5T_NATIVE_UCHAR, 1, {0, 255}};
  if (sample == ItkSample::int16) return {H5T_STD_I16LE, H5T_NATIVE_SHORT, 2, {-32768, 32767}};
  return {H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, 4, range_of<float>(voxels)};
}

void put_axis(hid_t file, std::size_t a, const ItkVolume& head) {
  const Id space(made(H5Screate(H5S_SCALAR)), H5Sclose), plain(dateless(H5P_DATASET_CREATE), H5Pclose);
  const Id axis(made(H5Dcreate2(file, path_of(axes[a]).c_str(), H5T_STD_I32LE, space, H5P_DEFAULT, plain, H5P_DEFAULT)),
                H5Dclose);
  std::vector<double> cosines(3);
  double start = 0;
  // The origin is the sum of start times axis; the axes are orthogonal, so each start is a projection.
  for (std::size_t r = 0; r < 3; ++r) {
    cosines[r] = (r < 2 ? -1 : 1) * head.axis[a][r] + 0.0;
    start += head.origin[r] * head.axis[a][r];
  }
  put_text(axis, "varid", "MINC standard variable");
  put_text(axis, "vartype", "dimension____");
  put_text(axis, "version", "MINC Version    1.0");
  put_text(axis, "alignment", "centre");
  put_text(axis, "spacing", "regular__");
  put_text(axis, "units", "mm");
  put_text(axis, "spacetype", "native____");
  put_integer(axis, "length", head.size[a]);
  put_numbers(axis, "direction_cosines", cosines);
  put_numbers(axis, "start", {start});
  put_numbers(axis, "step", {head.spacing[a]});
}

void put_scalar(hid_t file, const char* name, double value) {
  const Id space(made(H5Screate(H5S_SCALAR)), H5Sclose), plain(dateless(H5P_DATASET_CREATE), H5Pclose);
  const Id data(made(H5Dcreate2(file, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, plain, H5P_DEFAULT)), H5Dclose);
  made(H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value));
  put_text(data, "dimorder", "");
}

}  // namespace

ItkVolume minc_geometry(const std::string& name) {
  const Id file(H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.valid() || H5Lexists(file, "/minc-2.0", H5P_DEFAULT) <= 0)
    bad("", "is no MINC 2 file (MINC 1 is not read: convert it with mincconvert -2)");
  require_self_contained(file);
  require_sound_messages(name);
  ItkVolume head;
  for (std::size_t a = 0; a < 3; ++a) take_axis(file, a, head);
  require_three_axes(file, head);
  return head;
}

void write_minc(const std::string& name, const ItkVolume& head, ItkSample sample, std::string_view voxels) {
  const Id file(made(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)), H5Fclose);
  for (const char* group :
       {"/minc-2.0", "/minc-2.0/dimensions", "/minc-2.0/info", "/minc-2.0/image", "/minc-2.0/image/0"})
    H5Gclose(made_group(file, group));
  for (std::size_t a = 0; a < 3; ++a) put_axis(file, a, head);
  const Stored stored = stored_as(sample, voxels);
  std::array<hsize_t, 3> size{}, chunk{};
  for (std::size_t a = 0; a < 3; ++a) {
    size[a] = static_cast<hsize_t>(head.size[2 - a]);
    chunk[a] = std::min<hsize_t>(size[a], a == 0 ? 1 : 256);
  }
  const Id space(made(H5Screate_simple(3, size.data(), nullptr)), H5Sclose);
  const Id packed(dateless(H5P_DATASET_CREATE), H5Pclose);
  made(H5Pset_chunk(packed, 3, chunk.data()));
  made(H5Pset_deflate(packed, 4));
  const Id image(made(H5Dcreate2(file, image_name, stored.file, space, H5P_DEFAULT, packed, H5P_DEFAULT)), H5Dclose);
  made(H5Dwrite(image, stored.memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, voxels.data()));
  put_text(image, "dimorder", "zspace,yspace,xspace");
  put_text(image, "varid", "MINC standard variable");
  put_text(image, "vartype", "group________");
  put_text(image, "version", "MINC Version    1.0");
  put_text(image, "complete", "true_");
  put_numbers(image, "valid_range", {stored.range[0], stored.range[1]});
  put_scalar(file, "/minc-2.0/image/0/image-max", stored.range[1]);
  put_scalar(file, "/minc-2.0/image/0/image-min", stored.range[0]);
  made(H5Fflush(file, H5F_SCOPE_GLOBAL));
}

}  // namespace trephine::itk
