// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "base/file_descriptor.h"
#include "desk/gate.h"
#include "desk/message.h"

namespace trephine::desk {

/// A port of 127.0.0.1 that is listened on.
struct Listening {
  FileDescriptor socket;
  int port = 0;
};
/// The port and the one after it; 0: any two that are free. Throws Error 73 where that fails.
std::pair<Listening, Listening> listen_on_two(int port);

/// A server of HTTP/1.1 on the loopback interface. One thread moves all bytes and waits for nobody; what passes the
/// door is answered by a few others. So who sends slowly, never ends, or does not read costs a place among 256
/// connections and at most 16 KiB of a head; where the places are all taken, the one that has waited longest goes, and
/// of those that passed the door none while there are others. Before the door passes it, nothing is read of a request
/// but its head. A body is read where its length was said before it and is at most 256 MiB; after every refusal the
/// connection ends.
class Server {
 public:
  /// 0 where a request may pass, and its path; else the status that it is refused with.
  using Door = std::function<int(const RequestHead&, std::string& path)>;
  using Handler = std::function<Reply(const Request&)>;

  /// `handler` is called from `threads` threads; what it throws becomes an answer.
  Server(Listening at, Door door, Handler handler, int threads);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Answers until stop() is called from another thread.
  void run();
  void stop();

 private:
  class State;
  std::unique_ptr<State> state_;
};

/// The answer to an exception that is being handled: Errors as {"error": line, "code": exit code}.
Reply reply_of_exception();

}  // namespace trephine::desk
