// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <regex>
#include <thread>
#include <vector>

#include "base/error.h"
#include "base/log.h"
#include "base/text.h"
#include "cli/progress_display.h"

namespace trephine {
namespace {

// What a display writes, through a pipe that holds it all.
class Captured {
 public:
  Captured() { EXPECT_EQ(::pipe2(fd_, O_CLOEXEC | O_NONBLOCK), 0); }
  ~Captured() {
    ::close(fd_[0]);
    ::close(fd_[1]);
  }
  int fd() const { return fd_[1]; }
  std::string text() {
    char buffer[4096];
    for (ssize_t n; (n = ::read(fd_[0], buffer, sizeof buffer)) > 0;) text_.append(buffer, static_cast<std::size_t>(n));
    return text_;
  }
  /// Waits until what was written since the last call holds that, however busy the machine is.
  void until(const std::string& pattern) {
    const std::regex wanted(pattern);
    for (int n = 0; n < 60000; ++n) {
      if (std::regex_search(text().substr(seen_), wanted)) {
        seen_ = text_.size();
        return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ADD_FAILURE() << "never written: " << pattern << "\n" << text_;
  }

 private:
  std::size_t seen_ = 0;
  int fd_[2];
  std::string text_;
};

using Style = cli::ProgressDisplay::Style;

TEST(ProgressDisplay, PlainLines) {
  Captured out;
  {
    cli::ProgressDisplay d(false, out.fd());
    const Progress p = d.start("skull.decimate", nullptr);
    for (int i = 0; i <= 1000; ++i) p.report(i / 1000.0);
    log_warning("thin\x1b bone");
    d.finish("skull.decimate", "80,000 triangles");
    d.finish("brain.segment", "cached");
  }
  log_line("");  // goes to stderr again
  const std::regex lines("warning: thin\\? bone\nskull.decimate: [^,\n]+, 80,000 triangles\nbrain.segment: cached\n");
  EXPECT_TRUE(std::regex_match(out.text(), lines)) << out.text();
}

// What a line says of the whole, in percent; -1 where it says nothing.
int percent_of_all(const std::string& line) {
  const auto at = line.find(" % of all");
  if (at == std::string::npos) return -1;
  const auto before = line.find_last_not_of("0123456789", at - 1);
  return std::stoi(line.substr(before == std::string::npos ? 0 : before + 1));
}

TEST(ProgressDisplay, TheShareOfTheWholeGrowsWithThePlanAndNeverFalls) {
  Captured out;
  {
    cli::ProgressDisplay d(false, out.fd(), Style::terminal);
    d.plan({{"import", 1}, {"skull.decimate", 6}, {"brain.decimate", 3}});
    d.start("import", nullptr);
    d.finish("import");
    const Progress skull = d.start("skull.decimate", nullptr), brain = d.start("brain.decimate", nullptr);
    skull.report(0.5);
    out.until("40 % of all");
    skull.report(0.2);  // a stage that begins again
    out.until("40 % of all[^]*40 % of all");
    skull.report(1);
    out.until("70 % of all");
    d.finish("skull.decimate");
    out.until("70 % of all, about ");
    brain.report(0.9);
    out.until("97 % of all");
  }
  const std::string text = out.text();
  int last = 0, seen = 0;
  for (std::size_t at = 0, end; at < text.size(); at = end + 1) {
    end = std::min(text.find('\r', at), text.size());
    const int percent = percent_of_all(text.substr(at, end - at));
    if (percent < 0) continue;
    EXPECT_GE(percent, last) << text;
    last = percent;
    ++seen;
  }
  EXPECT_GE(seen, 6) << text;
  EXPECT_EQ(last, 97) << text;  // 1 + 6 + 0.9 * 3 of 10
  EXPECT_FALSE(std::regex_search(text, std::regex("skull.decimate 20 %"))) << text;
}

// The last time left that was told of the whole, in seconds; -1: none.
double last_left_s(const std::string& text) {
  const std::regex told("% of all, about (?:([0-9]+) min )?([0-9.]+) s left");
  double left = -1;
  for (std::sregex_iterator it(text.begin(), text.end(), told), end; it != end; ++it)
    left = ((*it)[1].matched ? 60 * std::stod((*it)[1]) : 0) + std::stod((*it)[2]);
  return left;
}

// A run that does without what was refused plans anew, and so does one that knows more of what is to come.
TEST(ProgressDisplay, AFurtherPlanIsOfWhatIsLeft) {
  Captured out;
  {
    cli::ProgressDisplay d(false, out.fd(), Style::terminal);
    d.plan({{"import", 6}, {"skull.decimate", 4}});
    d.start("import", nullptr);
    std::this_thread::sleep_for(std::chrono::milliseconds(2100));
    d.finish("import");
    d.start("skull.decimate", nullptr);
    out.until("60 % of all, about [0-9.]+ s left");
    d.plan({{"skull.decimate", 30}});  // in seconds of this machine, whatever was expected of what is done
    for (int n = 0; n < 6000 && last_left_s(out.text()) < 25; ++n)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_GE(last_left_s(out.text()), 25) << out.text();
    d.report("skull.decimate", 0.75);  // 22.5 s and those that have passed, of 30 and those
    out.until("(7[6-9]|[89][0-9]) % of all");
  }
  const std::string text = out.text();
  int last = 0;
  for (std::size_t at = 0, end; at < text.size(); at = end + 1) {
    end = std::min(text.find('\r', at), text.size());
    const int percent = percent_of_all(text.substr(at, end - at));
    if (percent < 0) continue;
    EXPECT_GE(percent, last) << text;
    last = percent;
  }
}

TEST(ProgressDisplay, QuietSaysNothing) {
  Captured out;
  cli::ProgressDisplay d(true, out.fd(), Style::terminal);
  d.start("a", nullptr).report(0.5);
  d.finish("a", "x");
  EXPECT_EQ(out.text(), "");
}

TEST(ProgressDisplay, TheTerminalsLineIsRepainted) {
  Captured out;
  {
    cli::ProgressDisplay d(false, out.fd(), Style::terminal);
    const Progress a = d.start("skull.decimate", nullptr), b = d.start("brain.segment", nullptr);
    a.report(0.4);
    b.report(0.6);
    out.until("\r\x1b\\[Kskull.decimate 40 %[^|]* \\| brain.segment 60 %");
    out.until("skull.decimate 40 % \\([^ ]+ %/s, [^|]* left\\)");  // once it has run for a second
    log_warning("w");
    d.finish("brain.segment", "done");
  }
  const std::string text = out.text();
  EXPECT_NE(text.find("\r\x1b[Kwarning: w\n"), std::string::npos) << text;
  EXPECT_TRUE(std::regex_search(text, std::regex("\r\x1b\\[Kbrain.segment: [0-9][^,\n]*, done\n"))) << text;
  EXPECT_EQ(text.substr(text.size() - 4), "\r\x1b[K");
  // No painted line is wider than the 79 columns of a terminal of unknown width.
  for (std::size_t at = 0; (at = text.find("\x1b[K", at)) != std::string::npos;) {
    at += 3;
    EXPECT_LE(std::min(text.size(), text.find_first_of("\r\n", at)) - at, 79u);
  }
}

TEST(ProgressDisplay, Cancels) {
  std::atomic<bool> cancel{true};
  cli::ProgressDisplay d(true);
  EXPECT_THROW(d.start("a", &cancel).report(0.1), Cancelled);
}

TEST(ProgressDisplay, FromManyThreads) {
  Captured out;
  {
    cli::ProgressDisplay d(false, out.fd(), Style::plain);
    std::vector<std::thread> threads;
    for (int t = 0; t < 8; ++t)
      threads.emplace_back([&d, t] {
        const std::string name = "stage" + std::to_string(t);
        const Progress p = d.start(name, nullptr);
        for (int i = 0; i <= 10000; ++i) p.report(i / 10000.0);
        log_line("from " + name);
        d.finish(name);
      });
    for (auto& t : threads) t.join();
  }
  const std::string text = out.text();
  // Two lines each, whole; what else a stage says is that it has gone on for five seconds.
  const std::regex line("(^|\n)(from stage[0-7]|stage[0-7]: [^\n]+)(?=\n)");
  EXPECT_EQ(std::distance(std::sregex_iterator(text.begin(), text.end(), line), std::sregex_iterator()), 16) << text;
}

TEST(ProgressDisplay, Durations) {
  EXPECT_EQ(cli::duration_text(0.04), "0 s");
  EXPECT_EQ(cli::duration_text(9.94), "9.9 s");
  EXPECT_EQ(cli::duration_text(9.96), "10 s");
  EXPECT_EQ(cli::duration_text(59.6), "1 min 00 s");
  EXPECT_EQ(cli::duration_text(65), "1 min 05 s");
  EXPECT_EQ(cli::duration_text(7380), "2 h 03 min");
  EXPECT_EQ(grouped_text(80000), "80,000");
  EXPECT_EQ(grouped_text(-1234567), "-1,234,567");
  EXPECT_EQ(grouped_text(-123), "-123");
  EXPECT_EQ(grouped_text(0), "0");
}

}  // namespace
}  // namespace trephine
