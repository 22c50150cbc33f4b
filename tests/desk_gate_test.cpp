// SPDX-License-Identifier: GPL-3.0-or-later
// Who may ask the desk: requests of other origins, hosts and users are refused before anything of them is read.
#include <gtest/gtest.h>

#include <random>

#include "desk/gate.h"

namespace trephine::desk {
namespace {

const std::string token(32, 'a');
const Gate gate(4711, token);

RequestHead good(const std::string& target = "/" + token + "/api/library") {
  return {"GET", target, {"127.0.0.1:4711"}, {}, {}, {}, {}};
}
int status(const RequestHead& head) {
  std::string path;
  return gate.refuses(head, path);
}

TEST(desk_gate, WhoKnowsTheTokenPasses) {
  std::string path;
  EXPECT_EQ(gate.refuses(good(), path), 0);
  EXPECT_EQ(path, "api/library");
  EXPECT_EQ(gate.refuses(good("/" + token + "/?x=/../.."), path), 0);
  EXPECT_EQ(path, "");
  RequestHead post = good();
  post.method = "POST";
  post.origins = {"http://127.0.0.1:4711"};
  post.content_types = {"application/json"};
  EXPECT_EQ(status(post), 0);
  EXPECT_EQ(Gate(1).token().size(), 32u);
  EXPECT_NE(Gate(1).token(), Gate(1).token());
}

TEST(desk_gate, OthersAreRefused) {
  const auto with = [](auto change) {
    RequestHead head = good();
    change(head);
    return status(head);
  };
  EXPECT_EQ(with([](auto& h) { h.hosts = {"evil.example:4711"}; }), 403);  // a name that was rebound to the loopback
  EXPECT_EQ(with([](auto& h) { h.hosts = {"127.0.0.1"}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.hosts = {}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.hosts = {"127.0.0.1:4711", "evil.example"}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.origins = {"http://evil.example"}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.origins = {"null"}; }), 403);  // a page in a sandbox, such as a case's
  EXPECT_EQ(with([](auto& h) { h.origins = {"http://localhost:4711"}; }), 403);  // another origin than the host's
  EXPECT_EQ(with([](auto& h) { h.sites = {"cross-site"}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.sites = {"same-site"}; }), 403);  // another port of this machine
  EXPECT_EQ(with([](auto& h) { h.target = "/" + std::string(32, 'b') + "/"; }), 404);
  EXPECT_EQ(with([](auto& h) { h.target = "/" + token; }), 404);
  EXPECT_EQ(with([](auto& h) { h.target = "/" + token + "x/"; }), 404);
  EXPECT_EQ(with([](auto& h) { h.target = "http://127.0.0.1:4711/" + token + "/"; }), 404);
  for (const char* method : {"PUT", "DELETE", "OPTIONS", "HEAD", "get", ""})
    EXPECT_EQ(with([&](auto& h) { h.method = method; }), 405) << method;
  EXPECT_EQ(with([](auto& h) { h.method = "POST"; }), 403);  // without an origin: a form of another page
  const auto post = [&](const std::vector<std::string>& types, const std::vector<std::string>& encodings) {
    return with([&](auto& h) {
      h.method = "POST";
      h.origins = {"http://127.0.0.1:4711"};
      h.content_types = types;
      h.encodings = encodings;
    });
  };
  EXPECT_EQ(post({}, {}), 415);
  EXPECT_EQ(post({"text/plain"}, {}), 415);
  EXPECT_EQ(post({"multipart/form-data; boundary=x"}, {}), 415);
  EXPECT_EQ(post({"application/json"}, {"gzip"}), 415);  // it would be unpacked before its size is known
}

TEST(desk_gate, NoPathLeavesItsPlace) {
  for (const char* path :
       {"case/a/../../b", "case//a", "../x", "case/.ssh/x", "case/a/%2e%2e/b", "case/a/..%2f..", "case/a\\..\\b",
        "case/%00", "case/%0a", "case/%", "case/%4", "case/%zz", "/etc/passwd", "case/a/", "%2e%2e/x"})
    EXPECT_EQ(status(good("/" + token + "/" + path)), 404) << path;
}

// Whatever bytes a target has: what passes is a plain path.
TEST(desk_gate, WhatPassesIsPlain) {
  std::mt19937 random(1);
  const std::string letters = "abc./%2e%2f\\0:?#&= \x01\xff..//case";
  int passed = 0;
  for (int i = 0; i < 200000; ++i) {
    std::string target = "/" + token + "/";
    for (unsigned n = random() % 24; n-- > 0;) target += letters[random() % letters.size()];
    std::string path;
    if (gate.refuses(good(target), path) != 0) continue;
    ++passed;
    ASSERT_TRUE(path.empty() || is_plain_path(path)) << target;
    for (const char c : path) ASSERT_TRUE(static_cast<unsigned char>(c) >= 0x20) << target;
    ASSERT_EQ(("/" + path + "/").find("/."), std::string::npos) << target;
    ASSERT_EQ(("/" + path).find("//"), std::string::npos) << target;
  }
  EXPECT_GT(passed, 1000);
}

}  // namespace
}  // namespace trephine::desk
