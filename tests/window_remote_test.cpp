// SPDX-License-Identifier: GPL-3.0-or-later
// Who may work a session from outside: whoever knows its token, and no other user of the machine.
#include "window/remote.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

using namespace trephine;
using namespace std::chrono_literals;

namespace {

const std::string secret(32, 'a');

class Peer {
 public:
  Peer(int kind, int port) : socket_(::socket(AF_INET, kind, 0)) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(std::uint16_t(port));
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
  }
  ~Peer() { ::close(socket_); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;
  void send(const std::string& text) const { ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL); }
  /// What is there; "closed" where the other side ended it.
  std::string got() const {
    char bytes[512];
    const ssize_t n = ::recv(socket_, bytes, sizeof bytes, MSG_DONTWAIT);
    return n > 0 ? std::string(bytes, std::size_t(n)) : n == 0 || errno == ECONNRESET ? "closed" : "";
  }

 private:
  int socket_;
};

class RemoteTest : public testing::Test {
 protected:
  void poll() {
    for (int n = 0; n < 4; ++n) {
      std::this_thread::sleep_for(5ms);
      remote.poll([&](const std::string& line) {
        done.push_back(line);
        return "did " + line;
      });
    }
  }
  window::Remote remote{0, secret};
  std::vector<std::string> done;
};

TEST_F(RemoteTest, DoesWhatIsSaidBehindTheToken) {
  const Peer owner(SOCK_STREAM, remote.port());
  owner.send("token " + secret + "\r\nundo\n");
  poll();
  EXPECT_EQ(owner.got(), "ok\ndid undo\n");
  owner.send("quit\n");
  poll();
  EXPECT_EQ(owner.got(), "did quit\n");
}

TEST_F(RemoteTest, DoesNothingForOthers) {
  for (const std::string& first :
       std::vector<std::string>{"quit\n", "token " + std::string(32, 'b') + "\nquit\n",
                                "token " + secret.substr(1) + "\nquit\n", "token\nquit\n", "\nquit\n",
                                "GET / HTTP/1.1\r\nX: \r\ntoken " + secret + "\r\nquit\r\n", std::string(5000, 'x')}) {
    const Peer other(SOCK_STREAM, remote.port());
    other.send(first);
    poll();
    EXPECT_EQ(other.got(), "closed") << first;
  }
  EXPECT_TRUE(done.empty());
}

TEST_F(RemoteTest, OthersTakeNobodysPlace) {
  const Peer owner(SOCK_STREAM, remote.port());
  owner.send("token " + secret + "\n");
  poll();
  std::vector<std::unique_ptr<Peer>> silent;
  for (int n = 0; n < 40; ++n) silent.push_back(std::make_unique<Peer>(SOCK_STREAM, remote.port()));
  const Peer second(SOCK_STREAM, remote.port());
  second.send("token " + secret + "\n");
  poll();
  EXPECT_EQ(second.got(), "ok\n");
  EXPECT_EQ(owner.got(), "ok\n");
  owner.send("undo\n");
  poll();
  EXPECT_EQ(owner.got(), "did undo\n");
}

TEST(HeadReceiverTest, TakesPlacesWithTheToken) {
  window::HeadReceiver head(0, secret);
  const Peer tracker(SOCK_DGRAM, head.port());
  Vec3 at{1, 2, 3};
  for (const std::string& text :
       std::vector<std::string>{"10 20 30", std::string(32, 'b') + " 10 20 30", secret, secret + " 10 20",
                                secret + "10 20 30", secret + " 10 20 nan", " 10 20 30", ""}) {
    tracker.send(text);
    std::this_thread::sleep_for(5ms);
    head.poll(at);
    EXPECT_EQ(at, (Vec3{1, 2, 3})) << text;
  }
  tracker.send(secret + " 10 -20 30.5\n");
  std::this_thread::sleep_for(5ms);
  head.poll(at);
  EXPECT_EQ(at, (Vec3{10, -20, 30.5}));
}

}  // namespace
