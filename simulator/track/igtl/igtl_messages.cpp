// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/igtl/igtl_messages.h"

#include <openigtlink/igtl_header.h>
#include <openigtlink/igtl_tdata.h>
#include <openigtlink/igtl_transform.h>
#include <openigtlink/igtl_util.h>

#include <algorithm>
#include <cstring>

#include "base/shared_library.h"

#define GIVEN extern "C" __attribute__((visibility("default")))

namespace trephine::track {
namespace {

constexpr std::uint64_t status_bytes = 30;  // code, subcode and name of an error; its text follows

// A text of the protocol need not end.
template <std::size_t N>
void copy_text(const char* text, std::size_t most, char (&out)[N]) {
  std::memset(out, 0, N);
  std::memcpy(out, text, std::min(most, N - 1));
}

bool right_crc(const IgtlHeader& header, const std::uint8_t* body) {
  return crc64(const_cast<unsigned char*>(body), header.body_bytes, crc64(nullptr, 0, 0)) == header.crc;
}

}  // namespace
}  // namespace trephine::track

using namespace trephine::track;

GIVEN int trephine_igtl_version() { return trephine::own_library_version; }

GIVEN void trephine_igtl_header(const std::uint8_t* bytes, IgtlHeader* out) {
  igtl_header h;
  static_assert(sizeof h == igtl_header_bytes);
  std::memcpy(&h, bytes, sizeof h);
  igtl_header_convert_byte_order(&h);
  out->version = h.version;
  copy_text(h.name, sizeof h.name, out->type);
  copy_text(h.device_name, sizeof h.device_name, out->name);
  const std::uint64_t stamp = h.timestamp;
  out->stamp_s = double(stamp >> 32) + double(stamp & 0xFFFFFFFFu) / 4294967296.0;
  out->body_bytes = h.body_size;
  out->crc = h.crc;
}

GIVEN void trephine_igtl_content(const IgtlHeader* header, const std::uint8_t* body, IgtlContent* out) {
  out->fault = IgtlFault::none;
  out->count = 0;
  out->status = 1;
  const bool is_transform = std::strcmp(header->type, "TRANSFORM") == 0,
             is_tdata = std::strcmp(header->type, "TDATA") == 0, is_status = std::strcmp(header->type, "STATUS") == 0;
  if (!is_transform && !is_tdata && !is_status) return;
  const std::uint64_t bytes = header->body_bytes;
  if ((is_transform && bytes != IGTL_TRANSFORM_SIZE) || (is_status && bytes < status_bytes) ||
      (is_tdata && (bytes % IGTL_TDATA_ELEMENT_SIZE != 0 || bytes > IGTL_TDATA_ELEMENT_SIZE * igtl_most_bodies))) {
    out->fault = IgtlFault::size;
    return;
  }
  if (!right_crc(*header, body)) {
    out->fault = IgtlFault::crc;
    return;
  }
  if (is_transform) {
    IgtlBody& b = out->bodies[out->count++];
    std::memcpy(b.name, header->name, sizeof b.name);
    b.turns = true;
    std::memcpy(b.columns, body, IGTL_TRANSFORM_SIZE);
    igtl_transform_convert_byte_order(b.columns);
  }
  for (std::uint64_t at = 0; is_tdata && at < bytes; at += IGTL_TDATA_ELEMENT_SIZE) {
    igtl_tdata_element e;
    static_assert(sizeof e == IGTL_TDATA_ELEMENT_SIZE);
    std::memcpy(&e, body + at, sizeof e);
    igtl_tdata_convert_byte_order(&e, 1);
    IgtlBody& b = out->bodies[out->count++];
    copy_text(e.name, sizeof e.name, b.name);
    b.turns = e.type == IGTL_TDATA_TYPE_TRACKER || e.type == IGTL_TDATA_TYPE_6D;
    std::memcpy(b.columns, reinterpret_cast<const char*>(&e) + offsetof(igtl_tdata_element, transform),
                sizeof b.columns);
  }
  if (is_status) out->status = body[0] << 8 | body[1];  // the one type of which Debian has no header in C
}

GIVEN void trephine_igtl_ask(std::uint8_t* out) {
  igtl_header h{};
  igtl_stt_tdata ask{};
  igtl_stt_tdata_convert_byte_order(&ask);
  h.version = 1;
  std::memcpy(h.name, "STT_TDATA", 9);
  h.body_size = sizeof ask;
  h.crc = crc64(reinterpret_cast<unsigned char*>(&ask), sizeof ask, crc64(nullptr, 0, 0));
  igtl_header_convert_byte_order(&h);
  static_assert(sizeof h + sizeof ask == igtl_ask_bytes);
  std::memcpy(out, &h, sizeof h);
  std::memcpy(out + sizeof h, &ask, sizeof ask);
}
