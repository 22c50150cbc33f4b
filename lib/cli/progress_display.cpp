// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/progress_display.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <map>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "base/log.h"
#include "base/text.h"
#include "cli/job_status.h"

namespace trephine::cli {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double repaint_s = 0.2, plain_line_s = 5, longest_silence_s = 10, status_s = 1;

double seconds_between(Clock::time_point a, Clock::time_point b) {
  return std::chrono::duration<double>(b - a).count();
}

// At most `columns` characters (UTF-8) of the text.
std::string clipped(const std::string& text, std::size_t columns) {
  std::size_t i = 0, n = 0;
  for (; i < text.size(); ++i)
    if ((static_cast<unsigned char>(text[i]) & 0xc0) != 0x80 && ++n > columns) break;
  return text.substr(0, i);
}

}  // namespace

std::string duration_text(double seconds) {
  if (!(seconds >= 0)) seconds = 0;
  if (seconds < 9.95) return to_text(std::round(seconds * 10) / 10) + " s";
  const auto s = static_cast<long long>(std::llround(std::min(seconds, 1e9)));
  const auto two = [](long long v) { return (v < 10 ? "0" : "") + std::to_string(v); };
  if (s < 60) return std::to_string(s) + " s";
  if (s < 3600) return std::to_string(s / 60) + " min " + two(s % 60) + " s";
  return std::to_string(s / 3600) + " h " + two(s / 60 % 60) + " min";
}

struct ProgressDisplay::State {
  struct Stage {
    std::string name;
    Clock::time_point started, said;
    double fraction = 0;
  };

  bool quiet = false, terminal = false, json = false;
  int fd = 2;
  std::mutex mutex;
  std::vector<Stage> running;
  std::map<std::string, double> expected_s;  ///< of what is planned
  bool planned = false;
  double done_s = 0, all_s = 0;    ///< of the expected seconds: of what has ended, and with what is planned
  double shown_fraction = 0;       ///< of the whole
  Clock::time_point began, spoke;  ///< when the plan was told; when the last line was written
  bool painted = false, ending = false;
  Clock::time_point reported;  ///< when the status was written last
  std::condition_variable end;
  std::thread painter;
  LogSink log_before;

  Stage* find(const std::string& name) {
    for (Stage& s : running)
      if (s.name == name) return &s;
    return nullptr;
  }

  // The functions below are called with the mutex held.
  void write(const std::string& text) {
    std::size_t done = 0;
    while (done < text.size()) {
      const ssize_t n = ::write(fd, text.data() + done, text.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return;  // that nobody can see the progress is no reason to stop
      done += static_cast<std::size_t>(n);
    }
  }
  static std::string stage_text(const Stage& s, Clock::time_point now) {
    const double f = s.fraction, elapsed = seconds_between(s.started, now);
    std::string text = s.name + " " + std::to_string(static_cast<int>(f * 100)) + " %";
    if (f > 0.01 && f < 1 && elapsed > 1)
      text += " (" + to_text(std::round(1000 * f / elapsed) / 10) + " %/s, " + duration_text(elapsed * (1 - f) / f) +
              " left)";
    return text;
  }
  /// How many of the planned seconds are done.
  double sum_s() const {
    double sum = done_s;
    for (const Stage& s : running)
      if (const auto e = expected_s.find(s.name); e != expected_s.end()) sum += e->second * s.fraction;
    return sum;
  }
  /// The share that is shown never falls, though a further plan may hold more than the one before it; the time left
  /// follows the plan. Below 0 where nothing is planned.
  double whole_fraction() {
    if (!(all_s > 0)) return -1;
    shown_fraction = std::max(shown_fraction, std::min(sum_s() / all_s, 0.99));
    return shown_fraction;
  }
  // Empty where nothing is planned.
  std::string whole_text(Clock::time_point now) {
    const double fraction = whole_fraction(), sum = sum_s();
    if (fraction < 0) return "";
    const double elapsed = seconds_between(began, now), left_s = std::max(all_s - sum, 0.01 * all_s);
    std::string text = std::to_string(static_cast<int>(fraction * 100)) + " % of all";
    // A stage that is slow to begin with says little of the others, so some seconds count as foreseen.
    const double held_s = std::max(10.0, 0.25 * all_s);
    if (sum > 0.05 * all_s && elapsed > 2)
      text += ", about " + duration_text(left_s * (elapsed + held_s) / (sum + held_s)) + " left";
    return text;
  }
  trephine::json::JobStatus status() {
    trephine::json::JobStatus out;
    out.fraction = whole_fraction();
    for (const Stage& s : running) out.stages.push_back({s.name, s.fraction});
    return out;
  }
  std::string running_text(Clock::time_point now) {
    std::string text = whole_text(now);
    for (const Stage& s : running) text += (text.empty() ? "" : " | ") + stage_text(s, now);
    return text;
  }
  void paint() {
    if (!terminal || running.empty()) return;
    winsize size{};
    const bool known = ::ioctl(fd, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
    const std::string text = running_text(Clock::now());
    write("\r\x1b[K" + clipped(printable(text), known ? size.ws_col - 1u : 79u));
    painted = true;
  }
  void clear() {
    if (painted) write("\r\x1b[K");
    painted = false;
  }
  // Writes a line that stays.
  void line(const std::string& text) {
    if (json) {
      spoke = Clock::now();
      return log_line(text);
    }
    clear();
    write(printable(text) + "\n");
    spoke = Clock::now();
    paint();
  }
};

ProgressDisplay::ProgressDisplay(bool said_quiet, int fd, Style style) : state_(std::make_unique<State>()) {
  const bool quiet = said_quiet || !log_tells(LogLevel::info);  // all that it says itself is of that level
  State& s = *state_;
  s.quiet = quiet;
  s.fd = fd;
  s.json = log_is_json();
  s.terminal = !quiet && !s.json && (style == Style::terminal || (style == Style::automatic && ::isatty(fd) == 1));
  if (quiet && !has_job_status()) return;
  if (!quiet)
    s.log_before = set_log_sink([&s](const std::string& text) {
      const std::lock_guard<std::mutex> lock(s.mutex);
      s.line(text);
    });
  s.spoke = Clock::now();
  s.painter = std::thread([&s] {
    std::unique_lock<std::mutex> lock(s.mutex);
    while (!s.end.wait_for(lock, std::chrono::duration<double>(repaint_s), [&s] { return s.ending; })) {
      const auto now = Clock::now();
      if (s.terminal)
        s.paint();
      else if (!s.quiet && !s.running.empty() && seconds_between(s.spoke, now) >= longest_silence_s)
        s.line(s.running_text(now));
      if (!has_job_status() || seconds_between(s.reported, now) < status_s) continue;
      s.reported = now;
      const auto status = s.status();
      lock.unlock();  // a slow disk holds up no stage
      write_job_status(status);
      lock.lock();
    }
  });
}

ProgressDisplay::~ProgressDisplay() {
  State& s = *state_;
  if (!s.painter.joinable()) return;
  if (!s.quiet) set_log_sink(s.log_before);
  {
    const std::lock_guard<std::mutex> lock(s.mutex);
    s.ending = true;
    s.clear();
  }
  s.end.notify_all();
  s.painter.join();
  write_job_status(s.status());
}

void ProgressDisplay::plan(const std::vector<std::pair<std::string, double>>& expected_s) {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  State& s = *state_;
  // What the plan says is in seconds of this machine, so what has been done counts as what it took.
  s.expected_s = {expected_s.begin(), expected_s.end()};
  s.done_s = s.planned ? seconds_between(s.began, Clock::now()) : 0;
  for (const State::Stage& r : s.running)
    if (const auto e = s.expected_s.find(r.name); e != s.expected_s.end()) s.done_s -= e->second * r.fraction;
  s.done_s = std::max(s.done_s, 0.0);
  s.all_s = s.done_s;
  for (const auto& [name, seconds] : s.expected_s) s.all_s += seconds;
  if (!std::exchange(s.planned, true)) s.began = Clock::now();
}

Progress ProgressDisplay::start(const std::string& stage, const std::atomic<bool>* cancel) {
  {
    const std::lock_guard<std::mutex> lock(state_->mutex);
    const auto now = Clock::now();
    state_->running.push_back({stage, now, now, 0});
    state_->paint();
  }
  return Progress([this, stage](double fraction) { report(stage, fraction); }, cancel);
}

void ProgressDisplay::report(const std::string& stage, double fraction) {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  State::Stage* s = state_->find(stage);
  if (!s || !(fraction >= 0)) return;
  s->fraction = std::max(s->fraction, std::min(fraction, 1.0));
  if (state_->quiet || state_->terminal) return;  // the painter shows it
  const auto now = Clock::now();
  if (seconds_between(s->said, now) < plain_line_s) return;
  s->said = now;
  const std::string whole = state_->whole_text(now);
  state_->line((whole.empty() ? "" : whole + " | ") + State::stage_text(*s, now));
}

void ProgressDisplay::finish(const std::string& stage, const std::string& note, double min_line_s) {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  std::string text = stage + ":";
  double seconds = 0;
  if (const State::Stage* s = state_->find(stage)) {
    seconds = seconds_between(s->started, Clock::now());
    text += " " + duration_text(seconds);
    if (!note.empty()) text += ",";
    state_->running.erase(state_->running.begin() + (s - state_->running.data()));
  }
  if (!note.empty()) text += " " + note;
  if (const auto e = state_->expected_s.find(stage); e != state_->expected_s.end()) state_->done_s += e->second;
  const bool short_one = note.empty() && seconds < min_line_s && !state_->json;
  if (!state_->quiet && !short_one) state_->line(text);
}

}  // namespace trephine::cli
