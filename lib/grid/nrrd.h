// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "grid/grid.h"
#include "grid/gzip_limit.h"

namespace trephine::grid {

/// NRRD 4 (teem.sourceforge.net/nrrd/format.html), 3 axes, one attached file, space left-posterior-superior, encoding
/// raw or gzip, little endian. Only the fields that the format needs and the `keys` given are written: size, spacing,
/// origin, direction and nothing of a patient. Where spacing times direction does not give both back to the last bit
/// (oblique axes), the keys trephine-spacing and trephine-direction hold them apart; read_nrrd takes them and hides
/// them, and ignores them where they no longer agree with the space directions.
using NrrdKeys = std::map<std::string, std::string>;
enum class NrrdEncoding { raw, gzip };

/// Writes through the checked writer (base/write_file.h); throws Error 73 and 74. Gzip output holds no time or name.
void write_nrrd(const std::filesystem::path& file, const HuVolume& volume, const NrrdKeys& keys = {},
                NrrdEncoding encoding = NrrdEncoding::raw);
void write_nrrd(const std::filesystem::path& file, const Field& field, const NrrdKeys& keys = {},
                NrrdEncoding encoding = NrrdEncoding::raw);
void write_nrrd(const std::filesystem::path& file, const Mask& mask, const NrrdKeys& keys = {},
                NrrdEncoding encoding = NrrdEncoding::gzip);

using AnyGrid = std::variant<Grid<std::int16_t>, Grid<float>, Grid<std::uint8_t>>;
struct Nrrd {
  AnyGrid grid;
  NrrdKeys keys;
  std::vector<std::string> warnings{};  ///< of fields that the format does not know
};
/// Reads what write_nrrd wrote and what 3D Slicer and ITK write of the same types (spaces LPS and RAS; int16, uint8,
/// float, and uint16, int32, double converted where exact or to float). Throws 66; 65 naming the field: wrong
/// dimension, sizes that disagree with the bytes there (checked before anything is allocated), spacing not positive and
/// finite, directions not orthogonal, a place beyond 1 km, voxels not finite, compressed bytes that would grow beyond
/// the limit. A stranger's file is read in a bounded child (grid/bounded_read.h).
Nrrd read_nrrd(const std::filesystem::path& file, GzipLimit limit = labels_limit);

/// The same in memory: the bytes that write_nrrd writes, and read_nrrd of bytes (65 without a file; never 66).
std::string encode_nrrd(const HuVolume& volume, const NrrdKeys& keys = {}, NrrdEncoding encoding = NrrdEncoding::raw);
std::string encode_nrrd(const Mask& mask, const NrrdKeys& keys = {}, NrrdEncoding encoding = NrrdEncoding::gzip);
Nrrd decode_nrrd(std::string_view bytes, GzipLimit limit = labels_limit);

/// Labels as 3D Slicer writes them (.seg.nrrd): as above, or with a list axis before the three of space, a layer an
/// entry. Sample (layer, i, j, k) is samples.voxels[lattice.index(i, j, k) * layers + layer].
struct LayeredNrrd {
  Lattice lattice;
  int layers = 1;
  AnyGrid samples;  ///< `layers` times as many along i as the lattice has
  NrrdKeys keys;
};
LayeredNrrd decode_layered_nrrd(std::string_view bytes);
/// The bytes (gzip) that decode_layered_nrrd reads back, of samples of uint8; with one layer those of encode_nrrd.
/// Throws Error 70 for other samples.
std::string encode_layered_nrrd(const LayeredNrrd& layered);

/// Voxels for a caller that needs HU, or a field; a mask (uint8) becomes a field of -0.5 and 0.5; or a mask or labels
/// (65 where a voxel is no whole number from 0 to 255).
HuVolume to_hu(AnyGrid grid);
Field to_field(AnyGrid grid);
Mask to_mask(AnyGrid grid);
/// read_nrrd with that.
HuVolume read_hu_nrrd(const std::filesystem::path& file);
Field read_field_nrrd(const std::filesystem::path& file);
Mask read_mask_nrrd(const std::filesystem::path& file);

}  // namespace trephine::grid
