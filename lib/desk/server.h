// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "desk/gate.h"
#include "desk/message.h"

namespace trephine::desk {

/// An HTTP server on the loopback interface, behind a gate. It is the one place that knows cpp-httplib.
class Server {
 public:
  using Handler = std::function<Reply(const Request&)>;

  /// Binds to 127.0.0.1; port 0 takes a free one. Throws Error 73 where that fails. `handler` is called from several
  /// threads; what it throws becomes an answer.
  Server(int port, Handler handler);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;
  const Gate& gate() const;
  /// Answers until stop() is called from another thread.
  void run();
  void stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The answer to an exception that is being handled: Errors as {"error": line, "code": exit code}.
Reply reply_of_exception();

}  // namespace trephine::desk
