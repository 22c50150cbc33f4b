// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "grid/grid.h"
#include "grid/nrrd.h"

namespace trephine::grid::detail {

enum class NrrdType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
std::size_t bytes_of(NrrdType type);

struct NrrdHeader {
  Lattice lattice;  ///< LPS, checked: sizes positive, spacing positive and finite, direction orthonormal
  NrrdType type = NrrdType::int16;
  bool big_endian = false, gzip = false;
  int layers = 1;  ///< of a list axis before the three of space
  NrrdKeys keys;
  std::vector<std::string> unknown;  ///< fields that the format does not know, as they may be told
};

/// The header with its closing empty line. `type` is int16, uint8 or float32. Several layers are a list axis before the
/// three of space.
std::string nrrd_header_text(const Lattice& lattice, NrrdType type, NrrdEncoding encoding, const NrrdKeys& keys,
                             int layers = 1);

/// Parses the text before the empty line; with `layered` a list axis may come before the three of space, as in
/// .seg.nrrd. Throws Error 65 naming the field, without a file.
NrrdHeader parse_nrrd_header(std::string_view text, bool layered = false);

/// Spacing and direction of the lattice from its axes' steps; nearly orthogonal ones are put right. Throws Error 65
/// naming `field` where a step is 0, not finite, or the axes are not orthogonal.
void take_axes(Lattice& lattice, const std::array<Vec3, 3>& steps, const std::string& field);

/// Throws Error 65 naming `field` where a corner of the lattice lies more than 1 km (1e6 mm) from the origin of space:
/// float32 no longer tells the voxels of a scan apart there.
void require_place(const Lattice& lattice, const std::string& field);

/// The name of a key of a stranger's file where it looks like one, else "?": a key may hold anything, a name too.
std::string tellable_key(const std::string& key);
/// "ignored, because they are not known: a, b": of at most 20 keys; empty where there are none.
std::string told_unknown(const std::vector<std::string>& keys);

/// One gzip member without time and name; level 1 (fastest) to 9, or for bytes of noise, in which nothing but runs
/// repeats, `runs`: of a CT's predicted slices as small as level 6 in a sixth of its time. The same bytes whatever the
/// thread count.
enum class GzipSearch { strings, runs };
std::string gzip_compress(std::string_view bytes, int level = 1, GzipSearch search = GzipSearch::strings);
/// Inflates one member of exactly `size` bytes into `out` (null: only checks that it is so).
/// Throws Error 65 where it is damaged, or longer or shorter.
void gzip_expand(std::string_view compressed, char* out, std::uint64_t size);

}  // namespace trephine::grid::detail
