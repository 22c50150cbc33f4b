// SPDX-License-Identifier: GPL-3.0-or-later
// What the voxels of a MINC 2 file mean by its own words: valid_range says which stored numbers image-min and image-max
// stand for. libminc takes the type's range, 0 and 1 for those that are missing, and so would one damaged letter of a
// name, or one damaged byte of a table, make other HU.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "hdf5_file.h"
#include "minc.h"

namespace trephine::itk {
namespace {

using namespace hdf5;

constexpr const char* folder = "/minc-2.0/image/0/";

/// HDF5 reads zeros where an address leads beyond the file's end.
void require_in_file(hid_t file, haddr_t at, hsize_t bytes, const char* name) {
  hsize_t whole = 0;
  if (H5Fget_filesize(file, &whole) < 0 || at == HADDR_UNDEF || at > whole || bytes > whole - at)
    bad(name, "lies beyond the file's end: the file is cut short or damaged");
}

void require_contiguous_in_file(hid_t file, hid_t data, const char* name) {
  const Id layout(H5Dget_create_plist(data), H5Pclose);
  if (H5Pget_layout(layout) == H5D_CONTIGUOUS)
    require_in_file(file, H5Dget_offset(data), H5Dget_storage_size(data), name);
}

/// The pieces that an image is stored in: each must be found where it is looked for, for HDF5 reads zeros in place of
/// one that its index has lost, and stored as it says, packed or whole.
void require_all_pieces(hid_t file, hid_t image) {
  const Id layout(H5Dget_create_plist(image), H5Pclose), space(H5Dget_space(image), H5Sclose),
      type(H5Dget_type(image), H5Tclose);
  if (H5Pget_layout(layout) != H5D_CHUNKED) {
    H5D_space_status_t stored = H5D_SPACE_STATUS_NOT_ALLOCATED;
    if (H5Dget_space_status(image, &stored) < 0 || stored != H5D_SPACE_STATUS_ALLOCATED)
      bad("image", "lacks its voxels: the file is damaged");
    return;
  }
  std::array<hsize_t, 3> size{}, piece{}, at{};
  H5Sget_simple_extent_dims(space, size.data(), nullptr);
  if (H5Pget_chunk(layout, 3, piece.data()) != 3 || std::find(piece.begin(), piece.end(), 0u) != piece.end())
    bad("image", "is damaged");
  const hsize_t whole_bytes = piece[0] * piece[1] * piece[2] * H5Tget_size(type);
  if (whole_bytes > (hsize_t{1} << 31)) bad("image", "is stored in pieces of more than 2 GB");
  const bool packed = H5Pget_nfilters(layout) > 0;
  std::vector<char> stored;
  for (at[0] = 0; at[0] < size[0]; at[0] += piece[0])
    for (at[1] = 0; at[1] < size[1]; at[1] += piece[1])
      for (at[2] = 0; at[2] < size[2]; at[2] += piece[2]) {
        hsize_t bytes = 0;
        if (H5Dget_chunk_storage_size(image, at.data(), &bytes) < 0 || bytes == 0)
          bad("image", "lacks some of its voxels: the file is damaged");
        if (bytes > 2 * whole_bytes + 4096) bad("image", "is damaged");
        stored.resize(bytes);
        std::uint32_t filters_left_out = 0;
        if (H5Dread_chunk(image, H5P_DEFAULT, at.data(), &filters_left_out, stored.data()) < 0 ||
            (filters_left_out != 0 && bytes != whole_bytes))
          bad("image", "is damaged");
        if (packed && filters_left_out == 0) continue;  // zeros would not be unpacked
        unsigned mask = 0;
        haddr_t address = HADDR_UNDEF;
        if (H5Dget_chunk_info_by_coord(image, at.data(), &mask, &address, &bytes) < 0) bad("image", "is damaged");
        require_in_file(file, address, bytes, "image");
      }
}

/// Of image-min or image-max: one number, or one for each slice along the file's first dimension.
std::vector<double> numbers_of_slices(hid_t file, const char* name, hsize_t slices) {
  const std::string path = folder + std::string(name);
  if (H5Lexists(file, path.c_str(), H5P_DEFAULT) <= 0)
    bad(name, "is missing: the file does not say what its voxels mean");
  const Id data(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose);
  if (!data.valid()) bad(name, "is damaged");
  require_contiguous_in_file(file, data, name);
  const Id type(H5Dget_type(data), H5Tclose), space(H5Dget_space(data), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space);
  if (H5Sget_simple_extent_ndims(space) > 1 || (count != 1 && static_cast<hsize_t>(count) != slices))
    bad(name, "must hold one number, or one for each slice");
  std::vector<double> numbers(static_cast<std::size_t>(count));
  // What is not stored is read as zero.
  if (!is_usual(type) || H5Dget_storage_size(data) < numbers.size() ||
      H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.data()) < 0)
    bad(name, "is damaged");
  if (!std::all_of(numbers.begin(), numbers.end(), [](double v) { return std::isfinite(v); }))
    bad(name, "is not finite");
  numbers.resize(slices, numbers[0]);
  return numbers;
}

/// The range of stored numbers that valid_range says, which must lie in the type's.
std::array<double, 2> stored_range(hid_t file, hid_t type) {
  const std::vector<double> said = numbers_of(file, folder + std::string("image"), "valid_range");
  if (said.size() != 2) bad("valid_range", "is missing: the file does not say what its voxels mean");
  const int bits = static_cast<int>(8 * H5Tget_size(type));
  const bool has_sign = H5Tget_sign(type) == H5T_SGN_2;
  const std::array<double, 2> range{std::min(said[0], said[1]), std::max(said[0], said[1])};
  const double lowest = has_sign ? -std::ldexp(1, bits - 1) : 0, highest = std::ldexp(1, has_sign ? bits - 1 : bits);
  if (!(range[0] < range[1] && range[0] >= lowest && range[1] <= highest))
    bad("valid_range", "is no range of the type that the voxels are stored as");
  return range;
}

}  // namespace

ValueFigures minc_values(const std::string& name) {
  const Id file(H5Fopen(name.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  const Id image(H5Dopen2(file, (folder + std::string("image")).c_str(), H5P_DEFAULT), H5Dclose);
  if (!image.valid()) bad("image", "is missing");
  require_all_pieces(file, image);
  require_contiguous_in_file(file, image, "image");
  const Id space(H5Dget_space(image), H5Sclose), type(H5Dget_type(image), H5Tclose);
  std::array<hsize_t, 3> size{}, from{};
  H5Sget_simple_extent_dims(space, size.data(), nullptr);
  const std::vector<double> low = numbers_of_slices(file, "image-min", size[0]),
                            high = numbers_of_slices(file, "image-max", size[0]);
  const bool whole_numbers = H5Tget_class(type) == H5T_INTEGER;
  const std::array<double, 2> stored = whole_numbers ? stored_range(file, type) : std::array<double, 2>{0, 1};

  const std::array<hsize_t, 3> count{1, size[1], size[2]};
  const Id memory(H5Screate_simple(3, count.data(), nullptr), H5Sclose);
  std::vector<double> slice(size[1] * size[2]);
  ValueFigures figures;
  for (hsize_t k = 0; k < size[0]; ++k) {
    if (low[k] > high[k]) bad("image-min", "is above image-max");
    from[0] = k;
    H5Sselect_hyperslab(space, H5S_SELECT_SET, from.data(), nullptr, count.data(), nullptr);
    if (H5Dread(image, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, slice.data()) < 0) bad("image", "is damaged");
    const double scale = whole_numbers ? (high[k] - low[k]) / (stored[1] - stored[0]) : 1;
    for (const double v : slice) figures.add(whole_numbers ? low[k] + (v - stored[0]) * scale : v);
  }
  return figures;
}

}  // namespace trephine::itk
