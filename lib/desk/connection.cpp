// SPDX-License-Identifier: GPL-3.0-or-later
#include "desk/connection.h"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace trephine::desk {
namespace {

constexpr std::size_t max_head_bytes = 16 << 10, max_body_bytes = std::size_t{1} << 28, max_drained_bytes = 1 << 20;
// How long a connection may be without a request, with a part of a head in all, without a byte of a body or of what is
// sent, and closed on our side alone.
constexpr int idle_s = 60, head_s = 10, stalled_s = 30, draining_s = 2;

Reply plain(int status) {
  Reply reply;
  reply.status = status;
  reply.content_type = "text/plain";
  reply.body = status == 404 ? "not found\n" : "refused\n";
  return reply;
}

}  // namespace

void Connection::become(State state, int seconds) {
  state_ = state;
  since_ = Clock::now();
  until_ = since_ + std::chrono::seconds(seconds);
}

void Connection::wait_for_head() { become(State::head, in_.empty() ? idle_s : head_s); }

// Bytes that have come, 0 where there are none now. At their end, or where it fails, the connection is over.
std::size_t Connection::receive(char* to, std::size_t most) {
  const ssize_t got = ::recv(socket_.get(), to, most, MSG_DONTWAIT);
  if (got > 0) return static_cast<std::size_t>(got);
  if (got == 0 || (errno != EAGAIN && errno != EINTR)) close();
  return 0;
}

void Connection::read(const Server::Door& door) {
  std::array<char, 1 << 16> piece;
  std::size_t most = piece.size();
  if (state_ == State::head) most = max_head_bytes - in_.size();
  if (state_ == State::body) most = std::min<std::size_t>(most, head_.body_bytes - request_.body.size());
  const std::size_t got = receive(piece.data(), most);
  if (got == 0) return;
  if (state_ == State::head) {
    if (in_.empty()) until_ = Clock::now() + std::chrono::seconds(head_s);
    const std::size_t before = in_.size();
    in_.append(piece.data(), got);
    look_for_head(door, before < 3 ? 0 : before - 3);
  } else if (state_ == State::body) {
    request_.body.append(piece.data(), got);
    become(request_.body.size() == head_.body_bytes ? State::answering : State::body, stalled_s);
  } else if (state_ == State::draining && (drained_ += got) > max_drained_bytes) {
    close();
  }
}

void Connection::look_for_head(const Server::Door& door, std::size_t from) {
  const std::size_t end = in_.find("\r\n\r\n", from);
  if (end == std::string::npos) {
    if (in_.size() >= max_head_bytes) refuse(431);
    return;
  }
  const std::size_t head_bytes = end + 4;
  if (const int status = begin(door, std::string_view(in_).substr(0, head_bytes)); status != 0) return refuse(status);
  const std::size_t here = std::min<std::size_t>(in_.size() - head_bytes, head_.body_bytes);
  request_.body.assign(in_, head_bytes, here);
  in_.erase(0, head_bytes + here);
  become(here == head_.body_bytes ? State::answering : State::body, stalled_s);
}

// What a request is that may pass; else the status that it is refused with.
int Connection::begin(const Server::Door& door, std::string_view head) {
  head_ = {};
  request_ = {};
  const int framing = parse_head(head, head_);
  if (framing == 400) return framing;
  // Who may not ask learns nothing, and so not what his body should have been.
  if (const int status = door(head_.asked, request_.path); status != 0) return status;
  if (framing != 0) return framing;
  if (head_.asked.method != "POST" && head_.body_bytes > 0) return 400;
  if (head_.body_bytes > max_body_bytes) return 413;
  request_.method = head_.asked.method;
  request_.query = query_of(head_.asked.target);
  return 0;
}

// What follows a refused head may be anything: nothing more of it is read as a request.
void Connection::refuse(int status) { send(plain(status), false); }

void Connection::answer(const Reply& reply, const Server::Door& door) {
  send(reply, head_.keep_alive);
  request_ = {};
  write(door);
}

void Connection::send(const Reply& reply, bool keep_alive) {
  head_.keep_alive = keep_alive;
  if (!keep_alive) in_.clear();
  out_ = answer_text(reply, keep_alive);
  lasting_ = reply.lasting;
  sent_ = 0;
  become(State::writing, stalled_s);
}

void Connection::write(const Server::Door& door) {
  const std::string_view left =
      sent_ < out_.size() ? std::string_view(out_).substr(sent_) : lasting_.substr(sent_ - out_.size());
  const ssize_t sent = ::send(socket_.get(), left.data(), left.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (sent < 0) {
    if (errno != EAGAIN && errno != EINTR) close();
    return;
  }
  sent_ += static_cast<std::size_t>(sent);
  until_ = Clock::now() + std::chrono::seconds(stalled_s);
  if (sent_ < out_.size() + lasting_.size()) return;
  out_ = std::string();
  if (!head_.keep_alive) {
    ::shutdown(socket_.get(), SHUT_WR);
    return become(State::draining, draining_s);
  }
  wait_for_head();
  if (!in_.empty()) look_for_head(door, 0);
}

}  // namespace trephine::desk
