// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "base/error.h"
#include "stages/stage.h"

namespace trephine::pipeline {

/// Outputs of stages on disk, by key. The cache holds patient data, so its folder is made with mode 0700. An entry is a
/// JSON file with the key, the stage's result and warnings and, where the output was worth its space, the SHA-256 of
/// the key and a data file; it has a SHA-256 of its own and is written last. An entry that is torn, damaged, that of
/// another key, or written by another user counts as missing. That is no protection against who may act as the user: he
/// can compute checksums too.
class StageCache {
 public:
  /// An empty folder name means no cache: nothing is found and nothing is stored. Throws Error 73 where the folder
  /// cannot be made, belongs to another user, or may be written by others.
  explicit StageCache(std::filesystem::path folder);

  /// How a stage ended: at most one of both; neither where the cache knows nothing, or what it had is damaged.
  struct Outcome {
    std::optional<stages::StageOutcome> made;  ///< without its data
    std::optional<Error> refusal;
  };
  Outcome load_outcome(const std::string& key, const stages::StageType& type) const;
  /// The verified output; nothing where it was not stored or is damaged (then the entry is removed).
  std::optional<stages::StageData> load_data(const std::string& key, stages::DataKind kind) const;
  /// Stores an output. With empty data only result and warnings are kept. `seconds` is the time that the stage took,
  /// for later estimates.
  void store(const std::string& key, stages::DataKind kind, const stages::StageOutcome& made, double seconds) const;

  /// A refusal (Error 80 without a file) is an outcome too: the same inputs and parameters are refused again.
  void store_refusal(const std::string& key, const Error& refusal) const;

  /// What each node took, by its name, in the runs before: for estimates of the time left alone. Damaged or missing
  /// counts as empty, and a failure to write is ignored.
  std::map<std::string, double> seconds_before() const;
  void remember_seconds(const std::map<std::string, double>& newer) const;

  struct Entry {
    bool has_result = false, has_data = false;
    std::optional<double> seconds;
  };
  /// What the entry holds; it is not verified and does not count as used.
  Entry look_up(const std::string& key) const;

  /// Removes the entries that were used least recently until the rest is at most this large.
  void shrink_to(std::uint64_t max_bytes) const;

 private:
  struct Index {
    std::optional<Error> refusal;
    std::string outcome;  ///< as JSON; empty after a refusal
    std::string sha256;   ///< of the data; empty where there is none
  };
  std::optional<Index> load_index(const std::string& key) const;
  void write_index(const std::string& key, const std::string& entry) const;
  std::filesystem::path file(const std::string& key, const char* extension) const;
  std::filesystem::path folder_;
};

/// An output is worth its space on disk if it took much longer to make than to write and read, or if it is small: then
/// what the cache holds does not hang on how fast the machine is, and the pictures of a refused run can be made of it.
bool worth_storing(const stages::StageData& data, double seconds);

}  // namespace trephine::pipeline
