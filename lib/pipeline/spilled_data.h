// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <memory>

#include "base/scratch_file.h"
#include "stages/stage.h"

namespace trephine::pipeline {

/// Bytes from which on a result that nobody reads at the moment is laid aside on disk. Smaller ones are not worth it.
constexpr double spilled_from_bytes = 16e6;

/// A large volume or field on disk, in a file without a name, while nobody needs it in memory ("spilled"). What the
/// kernel still holds of the file counts for no process and is given up where memory is short.
class SpilledData {
 public:
  /// Whether the data are large enough, and volume or field.
  static bool takes(const stages::StageData& data);
  /// Of what it takes. Empty where the folder lies in memory itself (tmpfs), or where the disk has not the room or
  /// fails: it keeps 1 GB free for what the run will write. Never throws for the disk's sake.
  static std::shared_ptr<const SpilledData> write(const stages::StageData& data, const std::filesystem::path& folder);
  /// The same bytes. Throws Error 74 where the disk fails. May be called from several threads.
  stages::StageData read() const;
  /// Its lattice without voxels.
  const stages::StageData& lattice() const { return without_voxels_; }

 private:
  explicit SpilledData(const std::filesystem::path& folder) : file_(folder) {}
  ScratchFile file_;
  stages::StageData without_voxels_;  ///< the same with its lattice alone
};

}  // namespace trephine::pipeline
