// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/server.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <list>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/error_text.h"
#include "base/joined.h"
#include "base/progress.h"
#include "desk/connection.h"

namespace trephine::desk {
namespace {

constexpr std::size_t most_connections = 256;
constexpr int backlog = 128, accepted_at_once = 16, look_again_ms = 500;

Listening listen_on(int port) {
  Listening out;
  out.socket = FileDescriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;
  ::setsockopt(out.socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  socklen_t size = sizeof address;
  auto* const at = reinterpret_cast<sockaddr*>(&address);
  if (::bind(out.socket.get(), at, size) != 0 || ::listen(out.socket.get(), backlog) != 0 ||
      ::getsockname(out.socket.get(), at, &size) != 0)
    return {};
  out.port = ntohs(address.sin_port);
  return out;
}

}  // namespace

std::pair<Listening, Listening> listen_on_two(int port) {
  for (int tries = port > 0 ? 1 : 100; tries > 0; --tries) {
    Listening first = listen_on(port);
    if (first.port == 0 || first.port == 65535) continue;
    Listening second = listen_on(first.port + 1);
    if (second.port > 0) return {std::move(first), std::move(second)};
  }
  throw Error(ExitCode::cannot_create, "", "--port",
              port > 0 ? std::to_string(port) + " and the one after it cannot be listened on: another program has one"
                       : "no two ports of the loopback interface are free");
}

Reply reply_of_exception() {
  Reply reply;
  nlohmann::json json;
  try {
    throw;
  } catch (const Error& e) {
    reply.status = e.code() == ExitCode::no_input ? 404 : e.code() == ExitCode::busy ? 409 : 422;
    const auto* list = dynamic_cast<const ErrorList*>(&e);
    const auto text = [](const Error& one) { return error_text(one); };
    json = {{"error", list ? joined(list->all(), "\n", text) : error_text(e)}, {"code", static_cast<int>(e.code())}};
  } catch (const Cancelled&) {
    reply.status = 503;
    json = {{"error", "stopped"}, {"code", static_cast<int>(ExitCode::cancelled)}};
  } catch (const std::bad_alloc&) {
    reply.status = 503;
    json = {{"error", "not enough memory"}, {"code", static_cast<int>(ExitCode::internal)}};
  } catch (const std::exception&) {
    reply.status = 400;  // JSON that is none, or of another shape; what it says may hold anything
    json = {{"error", "the request is not understood"}, {"code", static_cast<int>(ExitCode::usage)}};
  }
  reply.body = json.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  return reply;
}

class Server::State {
 public:
  State(Listening at, Door door, Handler handler, int threads)
      : listening_(std::move(at)),
        door_(std::move(door)),
        handler_(std::move(handler)),
        wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
        threads_(threads) {}

  void run() {
    std::vector<std::thread> threads;
    for (int i = 0; i < threads_; ++i) threads.emplace_back([this] { answer_requests(); });
    while (!stopping_) {
      wait();
      send_answers();
      serve();
      admit();
      connections_.remove_if([](const Connection& c) { return c.state() == Connection::State::over; });
    }
    asked_.notify_all();
    for (std::thread& t : threads) t.join();
    connections_.clear();
  }

  void stop() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stopping_ = true;
    }
    asked_.notify_all();
    wake();
  }

 private:
  using At = Connection::State;

  void wake() const { ::eventfd_write(wake_.get(), 1); }

  // Until something can be done. What is being answered is not looked at: whoever asked may be gone, and is told so.
  void wait() {
    polled_ = {{wake_.get(), POLLIN, 0}, {listening_.socket.get(), POLLIN, 0}};
    for (const Connection& c : connections_) {
      const bool idle = c.state() == At::answering;
      polled_.push_back({idle ? -1 : c.socket(), static_cast<short>(c.state() == At::writing ? POLLOUT : POLLIN), 0});
    }
    if (::poll(polled_.data(), polled_.size(), look_again_ms) <= 0)
      for (pollfd& p : polled_) p.revents = 0;
    eventfd_t ignored = 0;
    ::eventfd_read(wake_.get(), &ignored);
  }

  void send_answers() {
    std::vector<std::pair<Connection*, Reply>> answers;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      answers.swap(answered_);
    }
    for (auto& [connection, reply] : answers) {
      connection->answer(reply, door_);
      if (connection->state() == At::answering) hand_on(*connection);
    }
  }

  // In the order in which wait() has listed them.
  void serve() {
    const auto now = Connection::Clock::now();
    std::size_t at = 2;
    for (Connection& c : connections_) {
      const bool ready = polled_[at++].revents != 0;
      if (c.state() == At::answering) continue;
      if (ready) c.state() == At::writing ? c.write(door_) : c.read(door_);
      if (c.state() == At::answering)
        hand_on(c);
      else if (now > c.until())
        c.close();
    }
  }

  void admit() {
    if (polled_[1].revents == 0) return;
    for (int i = 0; i < accepted_at_once; ++i) {
      FileDescriptor socket(::accept4(listening_.socket.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
      if (!socket.valid()) return;
      if (connections_.size() >= most_connections && !make_room()) return;
      const int yes = 1;
      ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
      connections_.emplace_back(std::move(socket));
    }
  }

  // The one goes that has waited longest, of those that passed the door only where there is no other; what is being
  // answered stays.
  bool make_room() {
    const auto goes_before = [](const Connection& a, const Connection& b) {
      const bool a_passed = a.state() == At::body, b_passed = b.state() == At::body;
      return a_passed != b_passed ? b_passed : a.since() < b.since();
    };
    auto oldest = connections_.end();
    for (auto c = connections_.begin(); c != connections_.end(); ++c)
      if (c->state() != At::answering && (oldest == connections_.end() || goes_before(*c, *oldest))) oldest = c;
    if (oldest == connections_.end()) return false;
    connections_.erase(oldest);
    return true;
  }

  void hand_on(Connection& connection) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      requests_.push_back(&connection);
    }
    asked_.notify_one();
  }

  void answer_requests() {
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
      asked_.wait(lock, [this] { return stopping_ || !requests_.empty(); });
      if (stopping_) return;
      Connection* const connection = requests_.front();
      requests_.pop_front();
      lock.unlock();
      Reply reply;
      try {
        reply = handler_(connection->request());
      } catch (...) {
        reply = reply_of_exception();
      }
      lock.lock();
      answered_.emplace_back(connection, std::move(reply));
      wake();
    }
  }

  const Listening listening_;
  const Door door_;
  const Handler handler_;
  const FileDescriptor wake_;
  const int threads_;
  std::list<Connection> connections_;
  std::vector<pollfd> polled_;
  std::mutex mutex_;
  std::condition_variable asked_;
  std::atomic<bool> stopping_{false};
  std::deque<Connection*> requests_;
  std::vector<std::pair<Connection*, Reply>> answered_;
};

Server::Server(Listening at, Door door, Handler handler, int threads)
    : state_(std::make_unique<State>(std::move(at), std::move(door), std::move(handler), threads)) {}
Server::~Server() = default;
void Server::run() { state_->run(); }
void Server::stop() { state_->stop(); }

}  // namespace trephine::desk
