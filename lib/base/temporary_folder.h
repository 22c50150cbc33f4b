// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>

#include "base/file_descriptor.h"

namespace trephine {

/// A folder in the system's temporary folder that only its owner may enter; it goes with the object, with all that is
/// in it. Throws Error 73 where it cannot be made.
///
/// A process that is killed leaves its folder, which may hold a patient's CT. So each folder is locked (flock) while
/// its process lives, and whoever makes one first removes those of the same user whose lock nobody holds. Where the
/// file system knows no locks, none is removed.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

  /// Calls what writes up to that many bytes into the folder. Where it throws Error 74, and fewer are free, throws
  /// Error 74 that names the system's temporary folder and TMPDIR: the file that was asked for is not what lacks room.
  void fill(std::uint64_t bytes, const std::function<void()>& write) const;

 private:
  std::filesystem::path path_;
  FileDescriptor lock_;
};

}  // namespace trephine
