// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/child.h"
#include "base/progress.h"

namespace trephine::dicom {

/// Limits on what is taken out of an archive. CT compresses to about a third, a decompression bomb to a thousandth.
struct ArchiveLimits {
  std::uint64_t members = 200000;
  std::uint64_t member_bytes = std::uint64_t{4} << 30;  ///< uncompressed, of each member
  std::uint64_t bytes = std::uint64_t{16} << 30;        ///< uncompressed, of all members together
  std::uint64_t ratio = 200;                            ///< uncompressed size divided by the archive's size
  std::uint64_t free_of_ratio = 64 << 20;               ///< up to this many bytes the ratio is not checked
};

/// The members of a ZIP archive, uncompressed in shared memory; of what does not begin as a DICOM file does only the
/// beginning. Nothing is written to
/// disk, and no member's name is ever used as a path.
struct Archive {
  struct Member {
    std::string name;        ///< for messages; '/' between folders
    std::string_view bytes;  ///< within `memory`; only the beginning where that is not one of a DICOM file
  };
  std::vector<Member> members;  ///< ascending by name; without folders, hidden files and links
  int hidden = 0, links = 0;
  ChildResult memory;
};

/// Whether the file begins as a ZIP archive does.
bool is_zip(const std::filesystem::path& file);

/// Reads an archive in the bounded child (libzip). Archives within it are members like any other and are not opened.
/// Throws Error 65, field "archive", where it is damaged or truncated (checksums included), encrypted, compressed by an
/// unsupported method, above a limit, or has a member whose name leads out of it ("..", an absolute path); 70 where the
/// child dies; 74 where the archive cannot be read. Of a member whose name is, or ends in, one of `whole` all bytes are
/// taken, under the limits of images, whatever they are.
Archive read_archive(const std::filesystem::path& file, const Progress& progress, const ArchiveLimits& limits = {},
                     const std::vector<std::string>& whole = {});

}  // namespace trephine::dicom
