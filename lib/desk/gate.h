// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

namespace trephine::desk {

/// What of a request is looked at before anything else of it is read. Lists, since a name may be sent twice.
struct RequestHead {
  std::string method, target;
  std::vector<std::string> hosts, origins, sites, content_types, encodings;
};

/// Decides who may ask. Another user of the machine does not know the token; a page of another origin that is open in
/// the same browser neither knows it nor passes as this origin; a name that was rebound to the loopback is not the host
/// that was asked for.
class Gate {
 public:
  /// `port` is the server's. The token is made of the system's entropy: 32 hexadecimal digits.
  explicit Gate(int port);
  /// For tests.
  Gate(int port, std::string token) : port_(port), token_(std::move(token)) {}

  const std::string& token() const { return token_; }
  std::string address() const;

  /// 0: it may pass, and `path` is what follows the token, decoded. Else the status that it is refused with: 404 for
  /// whatever does not know the token, so that nothing can be learnt; 403 for another origin or host; 405 for a method
  /// that nothing has; 415 for a body that is neither JSON nor bytes.
  int refuses(const RequestHead& head, std::string& path) const;

 private:
  int port_;
  std::string token_;
};

/// Decodes %XX; empty where the text holds a control character, a NUL or half an escape.
std::string percent_decoded(const std::string& text);
/// Whether every part of the path is a name: no empty one, none that begins with a dot, no backslash.
bool is_plain_path(const std::string& path);

}  // namespace trephine::desk
