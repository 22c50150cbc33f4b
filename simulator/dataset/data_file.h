// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/temporary_folder.h"

namespace trephine::dataset {

/// An HDF5 file that is written row by row. It is made in the system's temporary folder and copied to its place by
/// commit(), through FileWriter; without that there is none. Numbers are little endian, and no dates are kept: the same
/// content gives the same bytes. All functions throw Error 74 where the disk does not take it.
class DataFile {
 public:
  /// Throws Error 70 where the library that writes HDF5 is missing, 73 where there is no temporary folder.
  DataFile();
  ~DataFile();
  DataFile(const DataFile&) = delete;
  DataFile& operator=(const DataFile&) = delete;

  void group(const std::string& path);
  void text(const std::string& path, const std::string& text);
  void texts(const std::string& path, const std::vector<std::string>& texts);
  /// Whole data sets of as many numbers as the sides multiply to; no sides: one number. Those of more than one side are
  /// packed.
  void numbers(const std::string& path, const std::vector<double>& data, const std::vector<std::uint64_t>& sides);
  void whole_numbers(const std::string& path, const std::vector<std::int64_t>& data,
                     const std::vector<std::uint64_t>& sides);
  void bytes(const std::string& path, const std::vector<std::uint8_t>& data, const std::vector<std::uint64_t>& sides);
  /// Data sets whose rows along the first side follow, each once.
  void begin_numbers(const std::string& path, const std::vector<std::uint64_t>& sides);
  void begin_bytes(const std::string& path, const std::vector<std::uint64_t>& sides);
  void row(const std::string& path, std::uint64_t row, const std::vector<double>& data);
  void row(const std::string& path, std::uint64_t row, const std::vector<std::uint8_t>& data);
  void attribute(const std::string& path, const std::string& name, const std::string& text);
  /// Returns its size. Throws Error 73 where it cannot be made at its place.
  std::uint64_t commit(const std::filesystem::path& target);

 private:
  TemporaryFolder folder_;
  void* file_ = nullptr;
};

}  // namespace trephine::dataset
