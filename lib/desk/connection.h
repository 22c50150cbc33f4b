// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <string>

#include "base/file_descriptor.h"
#include "desk/http_head.h"
#include "desk/server.h"

namespace trephine::desk {

/// One connection of a Server, which no call of it waits for. It is the server's thread's alone, but while it is at
/// `answering`: then request() is also that of the thread that answers.
class Connection {
 public:
  using Clock = std::chrono::steady_clock;
  /// `head`: waits for a head, or the rest of one. `draining`: all was sent; what still comes is thrown away, for a
  /// connection that is closed over unread bytes takes back what was sent last.
  enum class State { head, body, answering, writing, draining, over };

  explicit Connection(FileDescriptor socket) : socket_(std::move(socket)) { wait_for_head(); }

  int socket() const { return socket_.get(); }
  State state() const { return state_; }
  /// Since when it is at its state, and when that ends by itself.
  Clock::time_point since() const { return since_; }
  Clock::time_point until() const { return until_; }
  const Request& request() const { return request_; }

  /// Takes what has come. Afterwards it may be at `answering`: then request() is to be answered.
  void read(const Server::Door& door);
  /// Sends what can be sent, as read() does of what waits.
  void write(const Server::Door& door);
  /// The answer to request().
  void answer(const Reply& reply, const Server::Door& door);
  void close() { state_ = State::over; }

 private:
  void become(State state, int seconds);
  void wait_for_head();
  void look_for_head(const Server::Door& door, std::size_t from);
  int begin(const Server::Door& door, std::string_view head);
  void refuse(int status);
  void send(const Reply& reply, bool keep_alive);
  std::size_t receive(char* to, std::size_t most);

  FileDescriptor socket_;
  State state_ = State::head;
  Clock::time_point since_, until_;
  std::string in_, out_;
  std::string_view lasting_;
  std::size_t sent_ = 0, drained_ = 0;
  HttpHead head_;
  Request request_;
};

}  // namespace trephine::desk
