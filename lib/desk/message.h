// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <string_view>

namespace trephine::desk {

/// A request that passed the gate, and the answer; neither knows the library that carries them.
struct Request {
  std::string method;                        ///< GET or POST
  std::string path;                          ///< "api/library"; no ".." and no empty part
  std::map<std::string, std::string> query;  ///< the last of each name
  std::string body;

  std::string value(const std::string& name) const {
    const auto found = query.find(name);
    return found == query.end() ? "" : found->second;
  }
};

struct Reply {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
  std::string_view lasting;  ///< sent behind `body`: what lasts as long as the program, and is never copied
  std::string policy;        ///< content security policy; empty: what is sent may load, run and show nothing
};

}  // namespace trephine::desk
