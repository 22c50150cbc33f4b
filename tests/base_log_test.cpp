// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/log.h"

namespace trephine {
namespace {

class Log : public testing::Test {
 protected:
  void TearDown() override { set_log_form({}); }
  static std::string said(const LogForm& form) {
    set_log_form(form);
    testing::internal::CaptureStderr();
    log_line("a line");
    log_warning("a \"warning\" \\ with \x1b and \xff\xc3\xa4");
    log_error("an error");
    return testing::internal::GetCapturedStderr();
  }
};

TEST_F(Log, WritesLinesOfTheLevelAndBelow) {
  EXPECT_EQ(said({}), "a line\nwarning: a \"warning\" \\ with ? and \xff\xc3\xa4\nan error\n");
  EXPECT_EQ(said({LogLevel::error, false, ""}), "an error\n");
  EXPECT_EQ(said({LogLevel::warning, false, ""}).find("a line"), std::string::npos);
}

TEST_F(Log, WritesOneObjectALine) {
  const std::string text = said({LogLevel::warning, true, "trephine run"});
  const std::string head = "{\"time\":\"", first = "\",\"level\":\"warning\",\"program\":\"trephine run\",\"text\":";
  ASSERT_EQ(text.rfind(head, 0), 0u) << text;
  const std::size_t time = std::string("2026-01-31T12:00:00.123Z").size();
  EXPECT_EQ(text.substr(head.size() + time, first.size()), first);
  EXPECT_NE(text.find("\"a \\\"warning\\\" \\\\ with ? and ?\xc3\xa4\"}\n{"), std::string::npos) << text;
  EXPECT_EQ(text.substr(text.size() - 12), "\"an error\"}\n");
}

}  // namespace
}  // namespace trephine
