// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace trephine {

/// A line protocol on the loopback interface: whoever connects sends a line and gets one line back. Nothing blocks;
/// the window looks for lines between two pictures. At most 8 at a time may be connected.
class Remote {
 public:
  /// Throws Error 74 where the port cannot be had. Port 0: any that is free.
  explicit Remote(int port);
  ~Remote();
  Remote(const Remote&) = delete;
  Remote& operator=(const Remote&) = delete;

  int port() const { return port_; }
  void poll(const std::function<std::string(const std::string& line)>& answer);

 private:
  struct Client {
    int socket;
    std::string received;
  };
  bool serve(Client& client, const std::function<std::string(const std::string& line)>& answer);
  int socket_ = -1, port_ = 0;
  std::vector<Client> clients_;
};

}  // namespace trephine
