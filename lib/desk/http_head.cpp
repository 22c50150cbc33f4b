// SPDX-License-Identifier: GPL-3.0-or-later
// The one place that knows Boost.Beast, of which the parser is taken and nothing else.
#include "desk/http_head.h"

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/status.hpp>
#include <limits>

#include "base/text.h"

namespace trephine::desk {
namespace {
namespace http = boost::beast::http;

std::vector<std::string> values_of(const http::fields& fields, const char* name) {
  std::vector<std::string> out;
  const auto range = fields.equal_range(name);
  for (auto it = range.first; it != range.second; ++it) out.emplace_back(it->value());
  return out;
}

std::string decoded(std::string text) {
  for (char& c : text)
    if (c == '+') c = ' ';
  return percent_decoded(text);
}

}  // namespace

int parse_head(std::string_view text, HttpHead& head) {
  // A value that goes on in the next line (obs-fold): parsers differ in what it means, Beast reads a folded length as
  // none. RFC 9112, section 5.2, has a server refuse it.
  if (text.find("\r\n ") != std::string_view::npos || text.find("\r\n\t") != std::string_view::npos) return 400;
  http::request_parser<http::empty_body> parser;
  parser.header_limit(static_cast<std::uint32_t>(text.size()));
  parser.body_limit(std::numeric_limits<std::uint64_t>::max());  // that is the server's to say
  boost::beast::error_code fault;
  const std::size_t read = parser.put(boost::asio::const_buffer(text.data(), text.size()), fault);
  if (fault || read != text.size() || !parser.is_header_done()) return 400;
  const auto& said = parser.get();
  head.asked.method = std::string(said.method_string());
  head.asked.target = std::string(said.target());
  for (const auto& [name, list] : {std::pair<const char*, std::vector<std::string>*>{"Host", &head.asked.hosts},
                                   {"Origin", &head.asked.origins},
                                   {"Sec-Fetch-Site", &head.asked.sites},
                                   {"Sec-Fetch-Dest", &head.asked.destinations},
                                   {"Trephine-Desk", &head.asked.keys},
                                   {"Content-Type", &head.asked.content_types},
                                   {"Content-Encoding", &head.asked.encodings}})
    *list = values_of(said, name);
  head.keep_alive = parser.keep_alive();
  if (said.count("Upgrade") > 0 || said.count("Content-Length") > 1) return 400;
  if (said.count("Transfer-Encoding") > 0) return 411;
  if (said.count("Expect") > 0) return 417;
  if (!parser.content_length() && head.asked.method == "POST") return 411;
  head.body_bytes = parser.content_length().value_or(0);
  return 0;
}

std::map<std::string, std::string> query_of(const std::string& target) {
  std::map<std::string, std::string> out;
  const std::size_t mark = target.find('?');
  if (mark == std::string::npos) return out;
  for (const std::string& part : split_at(target.substr(mark + 1), '&')) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos) continue;
    out[decoded(part.substr(0, equals))] = decoded(part.substr(equals + 1));
  }
  return out;
}

std::string answer_text(const Reply& reply, bool keep_alive) {
  const std::string policy =
      reply.policy.empty() ? "sandbox; default-src 'none'; frame-ancestors 'none'" : reply.policy;
  std::string out = "HTTP/1.1 " + std::to_string(reply.status) + " " +
                    std::string(http::obsolete_reason(http::int_to_status(static_cast<unsigned>(reply.status))));
  out += "\r\nContent-Type: " + reply.content_type +
         "\r\nContent-Length: " + std::to_string(reply.body.size() + reply.lasting.size()) +
         "\r\nContent-Security-Policy: " + policy +
         "\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer"
         "\r\nCross-Origin-Resource-Policy: same-origin\r\nCross-Origin-Opener-Policy: same-origin"
         "\r\nX-DNS-Prefetch-Control: off\r\nCache-Control: no-store\r\nConnection: ";
  out += keep_alive ? "keep-alive\r\n\r\n" : "close\r\n\r\n";
  return out + reply.body;
}

}  // namespace trephine::desk
