// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What GDCM does, in dicom_codecs.so, which is loaded by the first call: its dictionary takes 15 ms.
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace trephine::codecs {

/// One frame of 16 or 8 bits, monochrome, in one of DICOM's transfer syntaxes.
struct CodedFrame {
  std::string syntax_uid;
  int columns = 0, rows = 0, bits_allocated = 0, bits_stored = 0;
  bool is_signed = false;
};

/// An element of a file with its value as bytes of even length, or with the items of a sequence (VR SQ).
struct FileElement {
  std::uint16_t group = 0, element = 0;
  std::string vr;  ///< two letters
  std::string value;
  std::vector<std::vector<FileElement>> items{};
};

/// Functions that return false say why in `fault`.
struct Codecs {
  /// Decodes a frame. To be called in a bounded child only, on a stream that was checked: GDCM can crash on others.
  bool (*decode)(const CodedFrame* frame, std::string_view stream, std::vector<char>* pixels, std::string* fault);
  /// A DICOM file of these elements and this frame, whose pixels are little endian, in the frame's transfer syntax.
  bool (*write)(const std::vector<FileElement>* elements, const CodedFrame* frame, const std::vector<char>* pixels,
                std::string* file, std::string* fault);
  /// A DICOM file of these elements as they are, pixels among them, in an uncompressed little endian transfer syntax.
  bool (*write_object)(const std::vector<FileElement>* elements, const std::string* syntax_uid, std::string* file,
                       std::string* fault);
};
/// Throws Error 70 where the library is missing.
const Codecs& codecs();

}  // namespace trephine::codecs
