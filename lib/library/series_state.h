// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "base/progress.h"
#include "dicom/import.h"

namespace trephine::library {

/// What is known of a series' content.
struct SeriesContent {
  std::string sha256;        ///< from hash_of_series_input; empty: not known
  std::uint64_t voxels = 0;  ///< count of stored voxels
};

/// One hash over number, size, inode, mtime and ctime of all files of a folder (five levels deep) or of one file; no
/// name goes into it. `latest_change_s` is the newest ctime in seconds since the epoch. Empty where the files cannot be
/// read.
struct FileSignature {
  std::string sha256;
  double latest_change_s = 0;
};
FileSignature sign_files(const std::filesystem::path& folder_or_file);

/// Remembers the content of series by the signature of their files, so that unchanged series need not be read again
/// (acceptance case B8). Holds neither names nor paths. Safe from several threads.
class SeriesMemory {
 public:
  /// With a damaged or missing file nothing is remembered.
  explicit SeriesMemory(std::filesystem::path file);

  /// The content of a series: remembered where the signature of the files is known and `rehash` is not set, else read.
  /// Throws what hash_of_series_input throws.
  SeriesContent content_of(const std::filesystem::path& series, const dicom::ImportParams& params, bool rehash,
                           const Progress& progress);
  /// Writes what is new, at most once a second unless `now` is set. Throws Error 73 and 74.
  void save(bool now);
  /// Forgets the series for which content_of was not called since this object was made.
  void forget_others();

 private:
  struct Entry {
    SeriesContent content;
    bool used = false;
  };
  std::filesystem::path file_;
  std::mutex mutex_;
  std::map<std::string, Entry> entries_;
  bool changed_ = false;
  double saved_s_ = 0;
};

}  // namespace trephine::library
