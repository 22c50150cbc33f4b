// SPDX-License-Identifier: GPL-3.0-or-later
// Heads of requests: what is none, or says in two ways where it ends, is refused.
#include <gtest/gtest.h>

#include <random>

#include "desk/http_head.h"

namespace trephine::desk {
namespace {

int status(const std::string& lines, const std::string& first = "POST /api/keep?a=1 HTTP/1.1") {
  HttpHead head;
  return parse_head(first + "\r\nHost: 127.0.0.1:1\r\n" + lines + "\r\n", head);
}

TEST(desk_head, WhatABrowserSends) {
  HttpHead head;
  ASSERT_EQ(parse_head("POST /api/keep?a=1 HTTP/1.1\r\nHost: h:1\r\ncontent-length: 7\r\nTrephine-Desk: abc\r\n"
                       "Range: bytes=0-1,2-3\r\nContent-Type: application/json\r\n\r\n",
                       head),
            0);
  EXPECT_EQ(head.asked.method, "POST");
  EXPECT_EQ(head.asked.target, "/api/keep?a=1");
  EXPECT_EQ(head.asked.hosts, std::vector<std::string>{"h:1"});
  EXPECT_EQ(head.asked.keys, std::vector<std::string>{"abc"});
  EXPECT_EQ(head.asked.content_types, std::vector<std::string>{"application/json"});
  EXPECT_EQ(head.body_bytes, 7u);
  EXPECT_TRUE(head.keep_alive);
  EXPECT_EQ(status("", "GET / HTTP/1.1"), 0);
}

TEST(desk_head, WhereItEndsIsSaidOnce) {
  EXPECT_EQ(status(""), 411);
  EXPECT_EQ(status("Content-Length: 7\r\nContent-Length: 7\r\n"), 400);
  EXPECT_EQ(status("Content-Length: 7\r\nContent-Length: 8\r\n"), 400);
  EXPECT_EQ(status("Content-Length: -1\r\n"), 400);
  EXPECT_EQ(status("Content-Length: 99999999999999999999\r\n"), 400);
  EXPECT_NE(status("Content-Length: 7\r\nTransfer-Encoding: chunked\r\n"), 0);
  EXPECT_EQ(status("Transfer-Encoding: chunked\r\n"), 411);
  EXPECT_EQ(status("Transfer-Encoding: x\r\n"), 411);
  EXPECT_EQ(status("Content-Length: 7\r\nExpect: 100-continue\r\n"), 417);
  EXPECT_EQ(status("Upgrade: websocket\r\n", "GET / HTTP/1.1"), 400);
}

TEST(desk_head, WhatIsNoHead) {
  for (const char* first : {"", "GET", "GET /", "GET / HTTP/2.0", "GET  / HTTP/1.1", "G ET / HTTP/1.1", "\x16\x03\x01"})
    EXPECT_EQ(status("", first), 400) << first;
  for (const char* line : {"no colon\r\n", "a b: c\r\n", ": c\r\n", "a: \x01\r\n"})
    EXPECT_EQ(status(line, "GET / HTTP/1.1"), 400) << line;
}

TEST(desk_head, AQueryIsDecoded) {
  const auto query = query_of("/api/x?a=1&b=two+words%20%26&c=&a=2&d");
  EXPECT_EQ(query, (std::map<std::string, std::string>{{"a", "2"}, {"b", "two words &"}, {"c", ""}}));
  EXPECT_TRUE(query_of("/api/x").empty());
}

// Whatever bytes come: it is parsed or refused.
TEST(desk_head, AnyBytes) {
  std::mt19937 random(1);
  const std::string good =
      "POST /api/keep?a=1 HTTP/1.1\r\nHost: h:1\r\nContent-Length: 7\r\nTrephine-Desk: abc\r\n\r\n";
  for (int i = 0; i < 100000; ++i) {
    std::string text = good;
    for (unsigned n = random() % 6; n-- > 0;) text[random() % text.size()] = static_cast<char>(random());
    HttpHead head;
    if (parse_head(text, head) == 0) {
      ASSERT_LE(head.asked.target.size(), text.size());
    }
  }
}

}  // namespace
}  // namespace trephine::desk
