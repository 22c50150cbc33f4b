// SPDX-License-Identifier: GPL-3.0-or-later
// Who may ask the desk: requests of other origins, hosts and users are refused before anything of them is read.
#include <gtest/gtest.h>

#include <random>

#include "desk/gate.h"

namespace trephine::desk {
namespace {

const std::string token(32, 'a');
const Gate gate(4711, token);

RequestHead good(const std::string& target = "/api/library") {
  return {"GET", target, {"127.0.0.1:4711"}, {}, {}, {}, {token}, {}, {}};
}
int status(const RequestHead& head) {
  std::string path;
  return gate.refuses(head, path);
}

TEST(desk_gate, WhoKnowsTheTokenPasses) {
  std::string path;
  EXPECT_EQ(gate.refuses(good(), path), 0);
  EXPECT_EQ(path, "api/library");
  EXPECT_EQ(gate.refuses(good("/api/open?x=/../.."), path), 0);
  EXPECT_EQ(path, "api/open");
  RequestHead post = good();
  post.method = "POST";
  post.origins = {"http://127.0.0.1:4711"};
  post.content_types = {"application/json"};
  EXPECT_EQ(status(post), 0);
  EXPECT_EQ(random_secret().size(), 32u);
  EXPECT_NE(random_secret(), random_secret());
  EXPECT_EQ(gate.address(), "http://127.0.0.1:4711/#" + token);  // what stands behind # is never sent
}

TEST(desk_gate, OthersAreRefused) {
  const auto with = [](auto change) {
    RequestHead head = good();
    change(head);
    return status(head);
  };
  EXPECT_EQ(with([](auto& h) { h.hosts = {"evil.example:4711"}; }), 403);  // a name that was rebound to the loopback
  EXPECT_EQ(with([](auto& h) { h.hosts = {"127.0.0.1"}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.hosts = {"localhost:4711"}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.hosts = {}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.hosts = {"127.0.0.1:4711", "evil.example"}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.origins = {"http://evil.example"}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.origins = {"null"}; }), 403);  // a page in a sandbox, such as a case's
  EXPECT_EQ(with([](auto& h) { h.origins = {"http://localhost:4711"}; }), 403);  // another origin than the host's
  EXPECT_EQ(with([](auto& h) { h.sites = {"cross-site"}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.sites = {"same-site"}; }), 403);  // another port of this machine
  EXPECT_EQ(with([](auto& h) { h.sites = {"none"}; }), 403);       // an address that was typed
  EXPECT_EQ(with([](auto& h) { h.keys = {}; }), 404);
  EXPECT_EQ(with([](auto& h) { h.keys = {std::string(32, 'b')}; }), 404);
  EXPECT_EQ(with([](auto& h) { h.keys = {token.substr(1)}; }), 404);
  EXPECT_EQ(with([](auto& h) { h.keys = {token, token}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.target = "http://127.0.0.1:4711/api/library"; }), 404);
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

// The page that takes the secret out of its address has none yet when it is asked for.
TEST(desk_gate, TheEmptyPageIsForAnybody) {
  for (const char* target : {"/", "/?x", "/icon"}) {
    RequestHead head = good(target);
    head.keys = {};
    head.sites = {"cross-site"};  // from the file that opens the browser
    EXPECT_EQ(status(head), 0) << target;
    head.method = "POST";
    EXPECT_EQ(status(head), 405) << target;
    head.hosts = {"evil.example:4711"};
    EXPECT_EQ(status(head), 403) << target;
  }
}

TEST(desk_gate, APageIsForAFrameOfTheDesk) {
  const auto with = [](auto change) {
    RequestHead head{"GET", "/abc", {"127.0.0.1:4712"}, {}, {"same-site"}, {"iframe"}, {}, {}, {}};
    change(head);
    std::string path;
    return refuses_page(head, 4712, path);
  };
  EXPECT_EQ(with([](auto&) {}), 0);
  EXPECT_EQ(with([](auto& h) { h.sites = h.destinations = {}; }), 0);  // a browser that does not say
  EXPECT_EQ(with([](auto& h) { h.hosts = {"127.0.0.1:4711"}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.hosts = {"localhost:4712"}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.origins = {"null"}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.sites = {"cross-site"}; }), 403);
  EXPECT_EQ(with([](auto& h) { h.destinations = {"document"}; }), 403);  // opened by itself
  EXPECT_EQ(with([](auto& h) { h.destinations = {"empty"}; }), 403);     // fetched by a script
  EXPECT_EQ(with([](auto& h) { h.method = "POST"; }), 405);
  EXPECT_EQ(with([](auto& h) { h.target = "/../abc"; }), 404);
}

TEST(desk_gate, NoPathLeavesItsPlace) {
  for (const char* path :
       {"case/a/../../b", "case//a", "../x", "case/.ssh/x", "case/a/%2e%2e/b", "case/a/..%2f..", "case/a\\..\\b",
        "case/%00", "case/%0a", "case/%", "case/%4", "case/%zz", "/etc/passwd", "case/a/", "%2e%2e/x"})
    EXPECT_EQ(status(good(std::string("/") + path)), 404) << path;
}

// Whatever bytes a target has: what passes is a plain path.
TEST(desk_gate, WhatPassesIsPlain) {
  std::mt19937 random(1);
  const std::string letters = "abc./%2e%2f\\0:?#&= \x01\xff..//case";
  int passed = 0;
  for (int i = 0; i < 200000; ++i) {
    std::string target = "/";
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
