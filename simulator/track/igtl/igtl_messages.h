// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>

// The border to igtl_messages.so, which alone is linked with libopenigtlink: messages of the OpenIGTLink protocol,
// versions 1 and 2, taken apart. Plain data, for it is passed between libraries.

namespace trephine::track {

constexpr std::size_t igtl_header_bytes = 58, igtl_type_bytes = 13, igtl_name_bytes = 21;
constexpr int igtl_most_bodies = 64;             ///< of one TDATA
constexpr std::size_t igtl_ask_bytes = 58 + 36;  ///< of STT_TDATA

/// Texts end with 0.
struct IgtlHeader {
  int version;
  char type[igtl_type_bytes], name[igtl_name_bytes];
  double stamp_s;  ///< of the sender's clock; 0: none was given
  std::uint64_t body_bytes, crc;
};

enum class IgtlFault : int { none, crc, size };
struct IgtlBody {
  char name[igtl_name_bytes];
  bool turns;         ///< false: the sender knows its place alone, or its axis alone
  float columns[12];  ///< of the matrix: three directions, and the place, mm
};
struct IgtlContent {
  IgtlFault fault;
  int count;  ///< of bodies: a TRANSFORM's or TDATA's
  IgtlBody bodies[igtl_most_bodies];
  int status;  ///< a STATUS message's code; 1: all is well
};

struct IgtlFunctions {
  void (*header)(const std::uint8_t* bytes, IgtlHeader* out);
  /// The body of a message whose header says so many bytes; of a type that we do not read it is empty.
  void (*content)(const IgtlHeader* header, const std::uint8_t* body, IgtlContent* out);
  /// A message STT_TDATA, which asks for poses as fast as they come.
  void (*ask)(std::uint8_t* out);
};

}  // namespace trephine::track
