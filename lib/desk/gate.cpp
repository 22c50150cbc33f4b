// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/gate.h"

#include "base/text.h"

namespace trephine::desk {
namespace {

constexpr std::size_t max_target = 2048;

int digit(char c) {
  return c >= '0' && c <= '9'   ? c - '0'
         : c >= 'a' && c <= 'f' ? c - 'a' + 10
         : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                : -1;
}

std::string host_at(int port) { return "127.0.0.1:" + std::to_string(port); }

/// Whether it names the host as the address does, and none of what a browser says of itself stands there twice.
bool is_for(const RequestHead& head, int port) {
  return head.hosts.size() == 1 && head.hosts[0] == host_at(port) && head.origins.size() <= 1 &&
         head.sites.size() <= 1 && head.destinations.size() <= 1 && head.keys.size() <= 1;
}

bool says_other_than(const std::vector<std::string>& said, const std::string& wanted) {
  return !said.empty() && said[0] != wanted;
}

/// Whether the target is a plain path, which is then decoded.
bool path_of(const RequestHead& head, std::string& path) {
  if (head.target.size() > max_target || head.target.empty() || head.target[0] != '/') return false;
  const std::string rest = head.target.substr(1), encoded = rest.substr(0, rest.find('?'));
  path = percent_decoded(encoded);
  return path.empty() == encoded.empty() && (path.empty() || is_plain_path(path));
}

}  // namespace

std::string percent_decoded(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned char c = static_cast<unsigned char>(text[i]);
    if (c == '%') {
      const int high = i + 2 < text.size() ? digit(text[i + 1]) : -1, low = high < 0 ? -1 : digit(text[i + 2]);
      if (low < 0) return "";
      c = static_cast<unsigned char>(high << 4 | low);
      i += 2;
    }
    if (c < 0x20 || c == 0x7f) return "";
    out += static_cast<char>(c);
  }
  return out;
}

bool is_plain_path(const std::string& path) {
  if (path.find('\\') != std::string::npos) return false;
  for (const std::string& part : split_at(path, '/'))
    if (part.empty() || part.front() == '.') return false;
  return true;
}

std::string Gate::address() const { return "http://" + host_at(port_) + "/#" + token_; }

int Gate::refuses(const RequestHead& head, std::string& path) const {
  if (!is_for(head, port_)) return 403;
  if (says_other_than(head.origins, "http://" + host_at(port_))) return 403;
  const bool plain = path_of(head, path);
  if (plain && (path.empty() || path == "icon")) return head.method == "GET" ? 0 : 405;
  if (says_other_than(head.sites, "same-origin")) return 403;
  if (head.keys.empty() || !same_secret(head.keys[0], token_) || !plain) return 404;
  return refuses_asking(head);
}

int Gate::refuses_asking(const RequestHead& head) const {
  if (head.method == "GET") return 0;
  if (head.method != "POST") return 405;
  // A form of another page could be sent without its script knowing the answer: so these must say that they are ours.
  if (head.origins.empty()) return 403;
  const bool known = head.content_types.size() == 1 && (head.content_types[0] == "application/json" ||
                                                        head.content_types[0] == "application/octet-stream");
  return known && head.encodings.empty() ? 0 : 415;
}

int refuses_page(const RequestHead& head, int port, std::string& path) {
  if (!is_for(head, port) || !head.origins.empty()) return 403;
  // The desk lies at another port of this host. No page is opened but in its frame.
  if (says_other_than(head.sites, "same-site") || says_other_than(head.destinations, "iframe")) return 403;
  if (head.method != "GET") return 405;
  return path_of(head, path) ? 0 : 404;
}

}  // namespace trephine::desk
