// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "stages/stage.h"

namespace trephine {

/// Outputs of stages on disk, by key. It holds patient data: the folder is made with mode 0700. An entry is a data file
/// and a JSON file with the report and the data's SHA-256, written last; a torn or damaged entry is no entry.
class StageCache {
 public:
  /// An empty folder means no cache: nothing is found and nothing stored. Throws 73 where the folder cannot be made.
  explicit StageCache(std::filesystem::path folder);

  /// Whether there is an entry (its data not yet verified).
  bool has(const std::string& key) const;
  struct Entry {
    StageData data;
    Report report;
  };
  /// The entry, verified; nothing where it is absent or damaged (then it is removed).
  std::optional<Entry> load(const std::string& key, DataKind kind) const;
  void store(const std::string& key, DataKind kind, const StageData& data, const Report& report) const;

  /// Removes the entries used least recently until the rest is at most that large.
  void shrink_to(std::uint64_t max_bytes) const;

 private:
  std::filesystem::path file(const std::string& key, const char* extension) const;
  std::filesystem::path folder_;
};

}  // namespace trephine
