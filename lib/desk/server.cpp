// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/server.h"

#include <httplib.h>

#include <nlohmann/json.hpp>

#include "base/error.h"

namespace trephine::desk {
namespace {

constexpr std::size_t max_body_bytes = std::size_t{1} << 28;
constexpr int threads = 32;  // a browser keeps half a dozen connections open, and each has a thread

RequestHead head_of(const httplib::Request& request) {
  RequestHead head;
  head.method = request.method;
  head.target = request.target;
  for (const auto& [name, list] : {std::pair<const char*, std::vector<std::string>*>{"Host", &head.hosts},
                                   {"Origin", &head.origins},
                                   {"Sec-Fetch-Site", &head.sites},
                                   {"Content-Type", &head.content_types},
                                   {"Content-Encoding", &head.encodings}})
    for (std::size_t i = 0; i < request.get_header_value_count(name); ++i)
      list->push_back(request.get_header_value(name, i));
  return head;
}

/// What no page of anybody else may do with what is sent.
void add_headers(const Reply& reply, httplib::Response& out) {
  out.status = reply.status;
  out.set_header("Content-Security-Policy",
                 reply.policy.empty() ? "default-src 'none'; frame-ancestors 'self'" : reply.policy);
  out.set_header("X-Content-Type-Options", "nosniff");
  out.set_header("X-Frame-Options", "SAMEORIGIN");
  out.set_header("Referrer-Policy", "no-referrer");
  out.set_header("Cross-Origin-Resource-Policy", "same-origin");
  out.set_header("Cross-Origin-Opener-Policy", "same-origin");
  out.set_header("Cache-Control", "no-store");
}

Reply plain(int status) {
  Reply reply;
  reply.status = status;
  reply.content_type = "text/plain";
  reply.body = status == 404 ? "not found\n" : "refused\n";
  return reply;
}

}  // namespace

Reply reply_of_exception() {
  Reply reply;
  nlohmann::json json;
  try {
    throw;
  } catch (const Error& e) {
    reply.status = e.code() == ExitCode::no_input ? 404 : e.code() == ExitCode::busy ? 409 : 422;
    const auto* list = dynamic_cast<const ErrorList*>(&e);
    std::string text;
    for (const Error& one : list ? list->all() : std::vector<Error>{e})
      text += (text.empty() ? "" : "\n") + one.line("").substr(2);  // without a program's name
    json = {{"error", text}, {"code", static_cast<int>(e.code())}};
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

struct Server::State {
  httplib::Server http;
  std::unique_ptr<Gate> gate;
  Handler handler;
  int port = 0;

  void answer(const httplib::Request& in, httplib::Response& out) {
    Request request;
    Reply reply;
    if (const int status = gate->refuses(head_of(in), request.path); status != 0) {
      reply = plain(status);
    } else {
      request.method = in.method;
      request.body = in.body;
      for (const auto& [name, value] : in.params) request.query[name] = value;
      try {
        reply = handler(request);
      } catch (...) {
        reply = reply_of_exception();
      }
    }
    add_headers(reply, out);
    out.set_content(std::move(reply.body), reply.content_type);
  }
};

Server::Server(int port, Handler handler) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.handler = std::move(handler);
  s.http.new_task_queue = [] { return new httplib::ThreadPool(threads); };
  s.http.set_payload_max_length(max_body_bytes);
  s.http.set_keep_alive_max_count(1000000);
  s.http.set_tcp_nodelay(true);
  // Before a body is read, and before cpp-httplib looks for a handler by a regular expression.
  s.http.set_pre_routing_handler([&s](const httplib::Request& in, httplib::Response& out) {
    std::string path;
    if (in.method == "POST" && s.gate->refuses(head_of(in), path) == 0)
      return httplib::Server::HandlerResponse::Unhandled;
    s.answer(in, out);
    return httplib::Server::HandlerResponse::Handled;
  });
  s.http.Post("/.{0,4096}", [&s](const httplib::Request& in, httplib::Response& out) { s.answer(in, out); });
  s.http.set_exception_handler(
      [](const httplib::Request&, httplib::Response& out, std::exception_ptr) { add_headers(plain(500), out); });
  s.port = port > 0 ? (s.http.bind_to_port("127.0.0.1", port) ? port : -1) : s.http.bind_to_any_port("127.0.0.1");
  if (s.port <= 0)
    throw Error(ExitCode::cannot_create, "", "--port",
                port > 0 ? std::to_string(port) + ", cannot be listened on: another program has it"
                         : "no port of the loopback interface is free");
  s.gate = std::make_unique<Gate>(s.port);
}

Server::~Server() = default;
int Server::port() const { return state_->port; }
const Gate& Server::gate() const { return *state_->gate; }
void Server::run() { state_->http.listen_after_bind(); }
void Server::stop() { state_->http.stop(); }

}  // namespace trephine::desk
