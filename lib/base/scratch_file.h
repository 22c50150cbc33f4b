// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>

#include "base/file_descriptor.h"

namespace trephine {

/// A file without a name, which goes with the object, and with the process however that ends: for what a run lays aside
/// and reads again. Its mode is 0600. A file system that knows no such files shows a hidden one instead (NFS: .nfs...),
/// which goes likewise.
class ScratchFile {
 public:
  /// In that folder. Throws Error 73 where it cannot be made there.
  explicit ScratchFile(const std::filesystem::path& folder);
  /// Throws Error 74 where the disk does not take it.
  void append(const void* data, std::size_t size);
  /// Throws Error 74 where the file does not give as many bytes.
  void read(std::uint64_t offset, void* data, std::size_t size) const;

 private:
  std::filesystem::path folder_;
  FileDescriptor fd_;
};

}  // namespace trephine
