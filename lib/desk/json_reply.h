// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "base/error.h"
#include "base/html_text.h"
#include "desk/message.h"

namespace trephine::desk {

using Json = nlohmann::ordered_json;

/// Every text of a case, a scan or a configuration that the desk shows comes this way.
inline Reply json_reply(const Json& json) {
  Reply reply;
  reply.body = html_json(json.dump(-1, ' ', false, Json::error_handler_t::replace));
  return reply;
}

inline Reply bytes_reply(std::string bytes, const char* type = "application/octet-stream") {
  Reply reply;
  reply.content_type = type;
  reply.body = std::move(bytes);
  return reply;
}

/// The body of a request; a page's are flat and small. Throws Json::exception, Error 64 where it nests deeply.
inline nlohmann::json json_of(const Request& request) {
  if (request.body.size() > (1u << 20)) throw Error(ExitCode::usage, "", "request", "is larger than 1 MiB");
  return nlohmann::json::parse(request.body, [](int depth, auto, auto&) {
    if (depth > 16) throw Error(ExitCode::usage, "", "request", "nests deeper than 16 levels");
    return true;
  });
}

/// A whole number of the query. Throws Error 64.
int number_of(const Request& request, const std::string& name);
double real_of(const Request& request, const std::string& name);

}  // namespace trephine::desk
