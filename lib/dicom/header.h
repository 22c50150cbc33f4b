// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/vec3.h"
#include "dicom/elements.h"
#include "dicom/identity.h"
#include "dicom/values.h"

namespace trephine::dicom {

/// A tag that is missing or wrong, and how; holds no free text of the file.
struct TagFault {
  std::uint32_t tag = 0;
  std::string what;
};

/// Geometry and rescale of one slice. Absent in the file: nullopt; there but unreadable: a TagFault of the header.
struct Frame {
  std::optional<Vec3> position_mm;
  std::optional<std::array<Vec3, 2>> orientation;   ///< direction of rising columns, of rising rows; orthonormal
  std::optional<std::array<double, 2>> spacing_mm;  ///< x (between columns), y (between rows)
  std::optional<double> slope, intercept;
  std::optional<double> thickness_mm;
};

/// What a file says that the import depends on, from its raw tags.
struct FileHeader {
  Origin origin;
  std::string name;  ///< relative to the folder or archive given, for messages

  const TransferSyntax* syntax = nullptr;
  const SopClass* sop_class = nullptr;  ///< null: unknown or absent
  bool has_sop_class = false;
  std::string series_uid, frame_uid, study_uid, acquisition;  ///< never to leave this module
  Identity identity;
  std::vector<std::uint64_t> said;  ///< digests of the values, by the place in attributes(); 0: absent, or rule own
  std::string modality;             ///< known_modality
  std::string image_type, kernel, patient_position;
  std::string contrast;  ///< known_contrast
  std::string raw_image_type;
  bool burned_in = false;  ///< the pixels are said to hold text
  bool lossy = false, quality_control = false;
  std::string rescale_type;  ///< known_rescale_type
  std::optional<double> kvp;
  std::optional<double> tilt_tag_deg;

  int rows = 0, columns = 0, samples = 1, frame_count = 1;
  int bits_allocated = 0, bits_stored = 0, high_bit = 0;
  bool is_signed = false;
  std::string photometric;
  std::optional<std::uint16_t> padding, padding_limit;  ///< as stored, 16 bits

  Element pixels;                   ///< tag 0: none
  std::vector<Fragment> fragments;  ///< encapsulated: without the offset table, one list per frame in frame_fragments
  std::vector<std::array<std::size_t, 2>> frame_fragments;  ///< [from, to) in fragments
  std::vector<Frame> frames;                                ///< frame_count of them
  std::vector<TagFault> faults;                             ///< in the order of their severity; empty: usable as slices

  bool is_ct() const;
  bool is_localizer() const;
  bool has_geometry() const;  ///< any position or orientation at all
  std::uint64_t frame_bytes() const {
    return std::uint64_t(rows) * std::uint64_t(columns) * std::uint64_t(samples) * std::uint64_t(bits_allocated / 8);
  }
};

/// Reads and checks a file's header. Throws WalkFault where it is no DICOM file or broken before its pixel data; what
/// is wrong with its values is listed in faults.
FileHeader read_header(const Origin& origin);

/// Whether the pixel data that the header tells of can be read as it tells: their shape, that the file holds them, and
/// in a compressed file which fragments belong to which frame. `representation` is PixelRepresentation, -1 where the
/// file has none. Fills is_signed, fragments and frame_fragments; the first thing that is wrong is added to the
/// header's faults. Reads the fragments' lengths and the offset table, no pixels. (header_pixels.cpp)
void check_pixels(FileHeader& header, ByteSource& source, int representation);

}  // namespace trephine::dicom
