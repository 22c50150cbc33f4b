// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace trephine::codecs {

/// How a transfer syntax stores the pixels of a frame.
enum class Encoding {
  native,
  jpeg,
  jpeg_ls,
  jpeg_2000,
  rle,
  unsupported,  ///< of the pixels: the header can be read
  unreadable,   ///< of the whole data set
};
struct TransferSyntax {
  const char* uid;
  const char* name;  ///< for messages
  Encoding encoding;
  bool explicit_vr = true;
  bool lossy = false;
};
/// Null where DICOM's list, as far as we know it, has no such UID.
const TransferSyntax* find_transfer_syntax(std::string_view uid);
const TransferSyntax& implicit_little_endian();
const TransferSyntax& explicit_little_endian();

/// What is wrong with a compressed frame's own header or end, or "": the size and number of components compared with
/// the file's, the end marker (the codec would fill up a truncated stream), RLE segments compared with the existing
/// bytes.
std::string check_codestream(Encoding encoding, std::string_view stream, int columns, int rows, int bits_allocated);

}  // namespace trephine::codecs
