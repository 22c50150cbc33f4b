// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/progress.h"

namespace trephine::cli {

/// Shows how far several concurrent stages are. On a terminal it repaints one line with each running stage's share,
/// rate and time left, and writes a line that stays for each finished stage. Elsewhere it writes plain lines, at most
/// one every few seconds for each stage and at least one every ten seconds. A stage's share never falls. With `quiet`
/// it shows nothing. Whatever it shows, a program that another one started for its status (json/job_status.h) writes it
/// there about once a second. While a display exists, log_line goes through it, so that a warning does not break its
/// line. It is thread safe, and restores the terminal's line and the log when it is destroyed.
class ProgressDisplay {
 public:
  enum class Style { automatic, terminal, plain };
  /// Writes to the descriptor (stderr), which must stay open. Style::automatic asks isatty.
  explicit ProgressDisplay(bool quiet, int fd = 2, Style style = Style::automatic);
  ~ProgressDisplay();
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  /// What will run, with expected seconds that are right relative to each other. From then on the share of the whole is
  /// shown, which never falls, with the time left, by how long what has ended took. A further plan is of all that has
  /// not ended then: more is known of how long it takes, or something else is to be done.
  void plan(const std::vector<std::pair<std::string, double>>& expected_s);
  /// Begins a stage. The returned object reports to this display, which must outlive it.
  Progress start(const std::string& stage, const std::atomic<bool>* cancel = &cancel_requested());
  /// For code that has no Progress object. A stage that was not started is ignored.
  void report(const std::string& stage, double fraction);
  /// Ends a stage and shows "skull.decimate: 12.3 s, 80,000 triangles", where the note is the part after the time. A
  /// stage that was not started ("cached") shows no time. No line is written for a stage without a note that took less
  /// than `min_line_s`; a log in JSON has them all.
  void finish(const std::string& stage, const std::string& note = "", double min_line_s = 0);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A duration as text: "8 s", "1 min 05 s", "2 h 03 min".
std::string duration_text(double seconds);

}  // namespace trephine::cli
