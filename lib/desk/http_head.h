// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "desk/gate.h"
#include "desk/message.h"

namespace trephine::desk {

/// The head of a request of HTTP/1.1.
struct HttpHead {
  RequestHead asked;
  std::uint64_t body_bytes = 0;
  bool keep_alive = false;
};

/// Parses a head, up to and with its empty line. Returns 0, or the status with which it is refused: 400 where it is
/// none, 411 for a body whose length is not said before it (chunked), 417 for one that waits to be asked for. Parts of
/// an answer (Range) are never given, so nothing of that is read.
int parse_head(std::string_view text, HttpHead& head);

/// What a target says behind its question mark: the last of each name.
std::map<std::string, std::string> query_of(const std::string& target);

/// The answer but for its `lasting` bytes, with what no page of anybody else may do with it.
std::string answer_text(const Reply& reply, bool keep_alive);

}  // namespace trephine::desk
