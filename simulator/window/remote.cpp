// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/remote.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "base/error.h"
#include "base/secret.h"

namespace trephine::window {
namespace {

constexpr int max_clients = 8, max_waiting = 64;  // connected, of each kind; not yet taken up
constexpr std::size_t longest_line = 1024;
constexpr double max_head_mm = 2000;

// A socket of the loopback interface, and the port that it got.
int socket_at(int kind, const char* flag, int& port) {
  const auto refuse = [&](const char* what) {
    throw Error(ExitCode::io, "", flag, std::to_string(port) + ": " + what + ": " + std::strerror(errno));
  };
  const int s = ::socket(AF_INET, kind | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (s < 0) refuse("no socket");
  const int yes = 1;
  if (kind == SOCK_STREAM) ::setsockopt(s, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(std::uint16_t(port));
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::bind(s, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0 ||
      (kind == SOCK_STREAM && ::listen(s, max_waiting) != 0)) {
    const int fault = errno;
    ::close(s);
    errno = fault;
    refuse("the port cannot be used");
  }
  socklen_t size = sizeof at;
  ::getsockname(s, reinterpret_cast<sockaddr*>(&at), &size);
  port = ntohs(at.sin_port);
  return s;
}

}  // namespace

Remote::Remote(int port, std::string secret) : secret_(std::move(secret)), port_(port) {
  socket_ = socket_at(SOCK_STREAM, "--remote", port_);
}

Remote::~Remote() {
  for (const Client& c : clients_) ::close(c.socket);
  ::close(socket_);
}

bool Remote::serve(Client& c, const std::function<std::string(const std::string& line)>& answer) {
  char bytes[512];
  bool ended = false;
  for (;;) {
    const ssize_t n = ::recv(c.socket, bytes, sizeof bytes, 0);
    if (n == 0) {  // what it sent before it closed is still done
      ended = true;
      break;
    }
    if (n < 0) {
      if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) return false;
      break;
    }
    c.received.append(bytes, std::size_t(n));
    if (c.received.size() > 64 * longest_line) return false;  // it sends faster than it is answered
  }
  for (std::size_t end; (end = c.received.find('\n')) != std::string::npos;) {
    std::string line = c.received.substr(0, end);
    c.received.erase(0, end + 1);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (!c.is_known && (!same_secret(line, "token " + secret_) || count(true) == max_clients)) return false;
    const std::string said = (std::exchange(c.is_known, true) ? answer(line) : "ok") + "\n";
    // An answer is short; a client that does not read it is disconnected.
    if (::send(c.socket, said.data(), said.size(), MSG_NOSIGNAL) != ssize_t(said.size())) return false;
  }
  return !ended && c.received.size() <= longest_line;
}

int Remote::count(bool known) const {
  return int(std::count_if(clients_.begin(), clients_.end(), [&](const Client& c) { return c.is_known == known; }));
}

void Remote::poll(const std::function<std::string(const std::string& line)>& answer) {
  const auto stays = [&](Client& c) {
    if (serve(c, answer)) return true;
    ::close(c.socket);
    return false;
  };
  clients_.erase(std::remove_if(clients_.begin(), clients_.end(), [&](Client& c) { return !stays(c); }),
                 clients_.end());
  // Who sent its line already is heard before anybody leaves for a new one.
  for (int s, n = 0; n < max_waiting && (s = ::accept4(socket_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC)) >= 0;
       ++n) {
    Client one{s, false, ""};
    if (!stays(one)) continue;
    if (!one.is_known && count(false) == max_clients) {
      const auto oldest = std::find_if(clients_.begin(), clients_.end(), [](const Client& c) { return !c.is_known; });
      ::close(oldest->socket);
      clients_.erase(oldest);
    }
    clients_.push_back(std::move(one));
  }
}

HeadReceiver::HeadReceiver(int port, std::string secret) : secret_(std::move(secret)), port_(port) {
  socket_ = socket_at(SOCK_DGRAM, "--head-port", port_);
}
HeadReceiver::~HeadReceiver() { ::close(socket_); }

void HeadReceiver::poll(Vec3& head_mm) {
  char bytes[257];
  // A sender that is faster than the pictures must not stop them.
  ssize_t n = 0;
  for (int k = 0; k < 256 && (n = ::recv(socket_, bytes, sizeof bytes - 1, 0)) >= 0; ++k) {
    bytes[n] = 0;
    Vec3 p;
    const char* numbers = std::strchr(bytes, ' ');
    if (!numbers || !same_secret({bytes, std::size_t(numbers - bytes)}, secret_)) continue;
    if (std::sscanf(numbers, "%lf %lf %lf", &p.x, &p.y, &p.z) == 3 && is_finite(p) && norm(p) < max_head_mm)
      head_mm = p;
  }
}

}  // namespace trephine::window
