// SPDX-License-Identifier: GPL-3.0-or-later
#include "library_display.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdio>
#include <mutex>

#include "base/log.h"
#include "base/text.h"
#include "cli/progress_display.h"

namespace trephine::tools {

struct LibraryDisplay::State {
  bool quiet = false, terminal = false, painted = false, json = false;
  int jobs = 0, percent = -1;
  std::mutex mutex;
  LogSink log_before;

  // The functions below are called with the mutex held.
  void paint(const std::string& text) {
    if (!terminal) return;
    winsize size{};
    const bool known = ::ioctl(2, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
    const std::string clipped = printable(text).substr(0, known ? size.ws_col - 1u : 79u);
    std::fprintf(stderr, "\r\x1b[K%s", clipped.c_str());
    std::fflush(stderr);
    painted = true;
  }
  void line(const std::string& text) {
    if (json) return log_line(text);
    std::fprintf(stderr, "%s%s\n", painted ? "\r\x1b[K" : "", printable(text).c_str());
    painted = false;
  }
};

LibraryDisplay::LibraryDisplay(bool said_quiet) : state_(std::make_unique<State>()) {
  const bool quiet = said_quiet || !log_tells(LogLevel::info);  // all that it says itself is of that level
  State& s = *state_;
  s.quiet = quiet;
  s.json = log_is_json();
  s.terminal = !quiet && !s.json && ::isatty(2) == 1;
  if (quiet) return;
  s.log_before = set_log_sink([&s](const std::string& text) {
    const std::lock_guard<std::mutex> lock(s.mutex);
    s.line(text);
  });
}

LibraryDisplay::~LibraryDisplay() {
  if (state_->quiet) return;
  set_log_sink(state_->log_before);
  if (state_->painted) std::fputs("\r\x1b[K", stderr);
}

void LibraryDisplay::planning(double fraction) {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  const int percent = static_cast<int>(fraction * 100);
  if (percent == state_->percent) return;
  state_->percent = percent;
  state_->paint("looking at the series: " + std::to_string(percent) + " %");
}

void LibraryDisplay::began(int jobs) {
  state_->jobs = jobs;
  const std::lock_guard<std::mutex> lock(state_->mutex);
  if (!state_->quiet) state_->line(std::to_string(jobs) + (jobs == 1 ? " job to do" : " jobs to do"));
}

void LibraryDisplay::started(const std::string&) {}

void LibraryDisplay::working(const Named<json::JobStatus>& running, int done, int failed, double seconds_left) {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  std::string text = std::to_string(done) + " of " + std::to_string(state_->jobs) + " done";
  if (failed > 0) text += ", " + std::to_string(failed) + " failed";
  if (seconds_left >= 0) text += ", " + cli::duration_text(seconds_left) + " left";
  for (const auto& [job, status] : running) {
    text += " | " + job.substr(job.find('.') + 1);
    if (!status.stages.empty()) text += " " + status.stages.back().name;
    if (status.fraction >= 0) text += ", " + std::to_string(static_cast<int>(100 * status.fraction)) + " % of the case";
  }
  state_->paint(text);
}

void LibraryDisplay::finished(const std::string& job, const library::JobResult& result) {
  if (state_->quiet) return;
  const std::lock_guard<std::mutex> lock(state_->mutex);
  const std::string name = job.rfind("case.", 0) == 0 ? job.substr(5) : "phantom " + job.substr(job.find('.') + 1);
  std::string text =
      name + ": " + cli::duration_text(result.seconds) + ", " + to_text(static_cast<int>(result.memory_mb)) + " MB";
  if (result.code != 0) text = name + ": failed with " + std::to_string(result.code) + ": " + result.reason;
  state_->line(text);
}

}  // namespace trephine::tools
