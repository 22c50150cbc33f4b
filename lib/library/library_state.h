// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace trephine::library {

/// What `library build` keeps beside the cases, in <library>/.library/: only tokens, hashes and figures, never a
/// patient's path, name or identifier. All of it may be lost: then everything is examined again and built where
/// necessary.
///   cases/CASE.inputs.json   what the case should be made of; rewritten only when that changes
///   cases/CASE.built.json    what it was made of when it was published last
///   cases/CASE.result.json   how its last build ended
///   settings/HASH.json       settings that these two name
///   phantoms/NAME.json       what a phantom was made of
///   series.json              content of series by signature of their files
///   timeline.json            when each job of the last build ran
///   slurm/                   what a cluster has of the library (library/batch.h)
///   shared                   other hosts work on it too: locks are leases (publish/case_lock.h)
///   logs/CASE.log            the whole output of the case's last build
class LibraryState {
 public:
  explicit LibraryState(std::filesystem::path library) : library_(std::move(library)) {}

  const std::filesystem::path& library() const { return library_; }
  std::filesystem::path folder() const { return library_ / ".library"; }
  std::filesystem::path series_file() const { return folder() / "series.json"; }
  std::filesystem::path timeline_file() const { return folder() / "timeline.json"; }
  std::filesystem::path log_file(const std::string& job) const { return folder() / "logs" / (job + ".log"); }
  /// What a job at work writes of how far it is (json/job_status.h); gone once the job has ended.
  std::filesystem::path status_file(const std::string& job) const { return folder() / "logs" / (job + status_suffix); }
  static constexpr const char* status_suffix = ".status";
  std::filesystem::path phantom_folder(const std::string& name) const { return library_ / ".phantoms" / name; }
  std::filesystem::path phantom_record(const std::string& name) const {
    return folder() / "phantoms" / (name + ".json");
  }
  std::filesystem::path settings_file(const std::string& sha256) const {
    return folder() / "settings" / (sha256 + ".json");
  }
  std::filesystem::path case_file(const std::string& token, const char* what) const {
    return folder() / "cases" / (token + "." + what + ".json");
  }
  /// Makes the folders (mode 0700). Throws Error 73.
  void make_folders() const;

 private:
  std::filesystem::path library_;
};

/// What a case is made of, or should be made of.
struct CaseInputs {
  std::string settings_sha256, series_sha256;
};

/// A case that was published by a library build.
struct BuiltCase {
  CaseInputs inputs;
  std::string case_sha256;                                   ///< hash of case.json
  std::vector<std::pair<std::string, std::uint64_t>> files;  ///< the files that case.json names, and their sizes
};

/// For want of what a job was ended.
enum class Lack { nothing, memory, time };

struct JobResult {
  int code = 0;
  std::string reason;  ///< the error's line; empty where there was none
  double seconds = 0, memory_mb = 0;
  double cpu_s = 0;  ///< of all its threads and processes
  Lack lack = Lack::nothing;
  int signal = 0;  ///< that killed it from outside; 0: none
};

/// Reads a record; nothing where the file is missing or damaged.
std::optional<CaseInputs> read_inputs(const LibraryState& state, const std::string& token);
std::optional<BuiltCase> read_built(const LibraryState& state, const std::string& token);
std::optional<JobResult> read_result(const LibraryState& state, const std::string& token);
std::optional<std::map<std::string, std::string>> read_settings(const LibraryState& state, const std::string& sha256);

/// These write a record. They throw Error 73 and 74. write_inputs leaves a file alone that holds the same already.
void write_inputs(const LibraryState& state, const std::string& token, const CaseInputs& inputs);
void write_built(const LibraryState& state, const std::string& token, const BuiltCase& built);
void write_result(const LibraryState& state, const std::string& token, const JobResult& result);

/// Reads case.json as it is now and makes its record. Throws what parse_case_json throws.
BuiltCase describe_built(const std::filesystem::path& case_folder, const std::string& settings_sha256);

/// Says why the case's folder is not what was built: case.json or a file that it names is missing or has another size.
/// Empty where it is. Contents are not read (library verify reads them).
std::string fault_of_built(const std::filesystem::path& case_folder, const BuiltCase& built);

}  // namespace trephine::library
