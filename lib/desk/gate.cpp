// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/gate.h"

#include <sys/random.h>

#include <array>

#include "base/error.h"
#include "base/hex.h"
#include "base/text.h"

namespace trephine::desk {
namespace {

constexpr std::size_t max_target = 2048;

std::string random_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw Error(ExitCode::internal, "", "token", "the system gives no random bytes");
  return hex_text(bytes.data(), bytes.size());
}

/// In a time that does not depend on where they differ.
bool same_secret(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  unsigned char differ = 0;
  for (std::size_t i = 0; i < a.size(); ++i) differ = static_cast<unsigned char>(differ | (a[i] ^ b[i]));
  return differ == 0;
}

int digit(char c) {
  return c >= '0' && c <= '9'   ? c - '0'
         : c >= 'a' && c <= 'f' ? c - 'a' + 10
         : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                : -1;
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

Gate::Gate(int port) : port_(port), token_(random_token()) {}

std::string Gate::address() const { return "http://127.0.0.1:" + std::to_string(port_) + "/" + token_ + "/"; }

int Gate::refuses(const RequestHead& head, std::string& path) const {
  const std::string port = ":" + std::to_string(port_);
  if (head.hosts.size() != 1 || (head.hosts[0] != "127.0.0.1" + port && head.hosts[0] != "localhost" + port))
    return 403;
  if (head.origins.size() > 1 || head.sites.size() > 1) return 403;
  if (!head.origins.empty() && head.origins[0] != "http://" + head.hosts[0]) return 403;
  if (!head.sites.empty() && head.sites[0] != "same-origin" && head.sites[0] != "none") return 403;
  if (head.target.size() > max_target || head.target.size() < token_.size() + 2 || head.target[0] != '/') return 404;
  if (!same_secret(head.target.substr(1, token_.size()), token_) || head.target[token_.size() + 1] != '/') return 404;
  if (head.method != "GET" && head.method != "POST") return 405;
  const std::string rest = head.target.substr(token_.size() + 2), encoded = rest.substr(0, rest.find('?'));
  path = percent_decoded(encoded);
  if (path.empty() != encoded.empty() || (!path.empty() && !is_plain_path(path))) return 404;
  if (head.method == "POST") {
    // A form of another page could be sent without its script knowing the answer: so these must say that they are ours.
    if (head.origins.empty()) return 403;
    if (!head.encodings.empty() || head.content_types.size() != 1 ||
        (head.content_types[0] != "application/json" && head.content_types[0] != "application/octet-stream"))
      return 415;
  }
  return 0;
}

}  // namespace trephine::desk
