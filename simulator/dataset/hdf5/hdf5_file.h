// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Inside of dataset: what the HDF5 library does, in hdf5_writer.so, which is loaded by the first call.
#include <cstdint>
#include <vector>

namespace trephine::dataset {

/// The types of numbers that are written: little endian.
enum class Number : std::uint8_t { float64, int64, uint8 };

/// A data set: its path, its type, its sides (none: one number), and whether it is packed (gzip of level 4 after the
/// bytes were sorted by their place, chunks of one row along the first side, or of some thousand rows of few numbers).
struct DataForm {
  const char* path;
  Number type;
  std::vector<std::uint64_t> sides;
  bool packed;
};

/// The functions of hdf5_writer.so. A file keeps no dates, so the same content gives the same bytes. They throw Error
/// 74.
struct Hdf5Functions {
  void* (*create)(const char* file);
  void (*group)(void* file, const char* path);
  void (*text)(void* file, const char* path, const char* text);
  void (*texts)(void* file, const char* path, const char* const* texts, std::uint64_t count);
  /// Null data: the rows follow by `row`.
  void (*numbers)(void* file, const DataForm* form, const void* data);
  void (*row)(void* file, const char* path, std::uint64_t row, const void* data);
  void (*attribute)(void* file, const char* path, const char* name, const char* text);
  void (*close)(void* file);   ///< throws where the last bytes cannot be written
  void (*forget)(void* file);  ///< closes it without a word
};
/// Throws Error 70 where the library is missing.
const Hdf5Functions& hdf5();

}  // namespace trephine::dataset
