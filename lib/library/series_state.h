// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>

#include "base/progress.h"
#include "dicom/import.h"

namespace trephine {

/// What is known of a series' content.
struct SeriesContent {
  std::string sha256;        ///< hash_of_series_input; empty: not known
  std::uint64_t voxels = 0;  ///< as stored
};

/// Number, size, inode, mtime and ctime of all files of a folder (five levels deep) or of one file, as one hash: no
/// name goes into it. `latest_change_s`: the newest ctime, seconds since the epoch. Empty where it cannot be read.
struct FileSignature {
  std::string sha256;
  double latest_change_s = 0;
};
FileSignature sign_files(const std::filesystem::path& folder_or_file);

/// Remembers the content of series by the signature of their files, so that unchanged ones need not be read again
/// (acceptance B8). Holds neither names nor paths. Safe from several threads.
class SeriesMemory {
 public:
  /// A damaged or missing file remembers nothing.
  explicit SeriesMemory(std::filesystem::path file);

  /// The content of a series: remembered where the files' signature is known and `rehash` is not set, else read.
  /// Throws as hash_of_series_input does.
  SeriesContent content_of(const std::filesystem::path& series, const ImportParams& params, bool rehash,
                           const Progress& progress);
  /// Writes what is new, at most once a second unless `now`. Throws 73 and 74.
  void save(bool now);
  /// Forgets what content_of was not asked for since this object was made.
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

}  // namespace trephine
