// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "itk/volume_message.h"

namespace trephine::itk {

/// How the voxels' bytes lie in their file: as they are, as one stream of zlib or gzip, or as numbers in a text.
enum class Stored { plain, deflated, otherwise };

/// What our own look at a file's header found, before ITK reads the file.
struct VolumeHeader {
  std::filesystem::path data_file;  ///< beside the header; empty where the data is in the same file
  Stored stored = Stored::otherwise;
  std::uint64_t data_at = 0;         ///< where they begin in that file
  std::optional<ItkVolume> said;     ///< the geometry, where we read it
  std::string modality;              ///< as VolumeFile's
  std::vector<std::string> unknown;  ///< keys that the format does not know, as they may be told

  /// Throws Error 65 where ITK understood another geometry.
  void require_same(const ItkVolume& itk) const;
};

/// The largest part of a file that is looked at as text.
std::string head_of(const std::filesystem::path& file);

/// The text header of a MetaImage (itk.org/Wiki/MetaIO). Throws Error 65 naming the key: one of NDims, BinaryData,
/// BinaryDataByteOrderMSB, DimSize,
/// ElementSpacing, Offset (or Position, Origin), TransformMatrix (or Rotation, Orientation), ElementType or
/// ElementDataFile missing or given twice; not 3 dimensions; several channels; a data file elsewhere or a list of
/// files; bytes that are not as many as the voxels need; compressed ones that would grow beyond what a scan's do; keys
/// that would scale the values or the space, or contradict another (docs/reference/volume-files.md has all keys).
VolumeHeader check_meta_header(std::string_view head, const std::filesystem::path& file);

/// The text header of a NRRD that ITK is to read. Throws Error 65: a data file elsewhere or several, skipped lines or
/// bytes, units that are not mm, no space directions, no space origin.
VolumeHeader check_nrrd_text(std::string_view head, const std::filesystem::path& file);

}  // namespace trephine::itk
