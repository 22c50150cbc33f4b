// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/secret.h"

namespace trephine::desk {

/// What of a request is looked at before anything else of it is read. Lists, since a name may be sent twice.
struct RequestHead {
  std::string method, target;
  std::vector<std::string> hosts, origins, sites, destinations, keys, content_types, encodings;
};

/// Decides who may ask the desk. Another user of the machine does not know the token; a page of another origin that is
/// open in the same browser neither knows it nor passes as this origin; a name that was rebound to the loopback is not
/// the host that was asked for. The token stands behind the # of the address, which no browser sends: the desk's script
/// takes it out of the address and sends it in a header of its own, which no page of another origin can add.
class Gate {
 public:
  /// `port` is the server's. The token is a random secret.
  explicit Gate(int port) : Gate(port, random_secret()) {}
  /// For tests.
  Gate(int port, std::string token) : port_(port), token_(std::move(token)) {}

  std::string address() const;

  /// 0: it may pass, and `path` is that of the target, decoded. Else the status that it is refused with: 404 for
  /// whatever does not know the token, so that nothing can be learnt; 403 for another origin or host; 405 for a method
  /// that nothing has; 415 for a body that is neither JSON nor bytes. The page itself and its icon hold nothing of a
  /// library, and anybody may have them.
  int refuses(const RequestHead& head, std::string& path) const;

 private:
  int refuses_asking(const RequestHead& head) const;

  int port_;
  std::string token_;
};

/// Decides who may ask the server of pages: whoever names it as it is called, to fill a frame. Which page, if any, is
/// decided by the path (page_shelf.h). Returns what Gate::refuses returns.
int refuses_page(const RequestHead& head, int port, std::string& path);

/// Decodes %XX; empty where the text holds a control character, a NUL or half an escape.
std::string percent_decoded(const std::string& text);
/// Whether every part of the path is a name: no empty one, none that begins with a dot, no backslash.
bool is_plain_path(const std::string& path);

}  // namespace trephine::desk
