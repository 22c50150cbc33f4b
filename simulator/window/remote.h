// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "base/vec3.h"

namespace trephine::window {

/// A line protocol on the loopback interface: whoever connects sends `token SECRET`, then a line at a time, and gets
/// one line back for each. Who sends something else first, such as another user of the machine or a page in a browser,
/// is disconnected without an answer. Nothing blocks; the window looks for lines between two pictures. At most 8 that
/// sent the secret may be connected at a time, and as many that did not yet, of whom the oldest leaves for a new one.
class Remote {
 public:
  /// Throws Error 74 where the port cannot be had. Port 0: any that is free.
  Remote(int port, std::string secret);
  ~Remote();
  Remote(const Remote&) = delete;
  Remote& operator=(const Remote&) = delete;

  int port() const { return port_; }
  void poll(const std::function<std::string(const std::string& line)>& answer);

 private:
  struct Client {
    int socket;
    bool is_known;
    std::string received;
  };
  bool serve(Client& client, const std::function<std::string(const std::string& line)>& answer);
  int count(bool known) const;
  const std::string secret_;
  int socket_ = -1, port_ = 0;
  std::vector<Client> clients_;
};

/// Where the user's head is, as a tracker sends it: a datagram of text with the secret and three numbers, mm to the
/// right of the middle of the window, up, and towards the user from where the camera stands. What is no such text is
/// ignored.
class HeadReceiver {
 public:
  /// Throws Error 74 where the port of the loopback interface cannot be had. Port 0: any that is free.
  HeadReceiver(int port, std::string secret);
  ~HeadReceiver();
  HeadReceiver(const HeadReceiver&) = delete;
  HeadReceiver& operator=(const HeadReceiver&) = delete;
  int port() const { return port_; }
  /// The newest place that came, if any did since the last call.
  void poll(Vec3& head_mm);

 private:
  const std::string secret_;
  int socket_ = -1, port_ = 0;
};

}  // namespace trephine::window
