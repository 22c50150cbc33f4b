// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <cstddef>
#include <deque>
#include <string>

#include "texts/note.h"

namespace trephine::window {

/// What a window told its user, and when: seconds after its start.
struct TimedNote {
  double at_s = 0;
  texts::Note note;
};

/// The last notes of a window; those of a whole day would take its memory.
class Notes {
 public:
  static constexpr std::size_t max_kept = 100;
  void add(double at_s, texts::Note note);
  void add(texts::Note note) { add(now_s(), std::move(note)); }
  std::size_t count() const { return first_ + kept_.size(); }  ///< that there ever were
  /// Of those since note number `n` (from 0), the ones that are kept; moves `n` behind the last one.
  std::deque<TimedNote> since(std::size_t& n) const;
  const std::deque<TimedNote>& kept() const { return kept_; }
  double now_s() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count(); }

 private:
  std::deque<TimedNote> kept_;
  std::size_t first_ = 0;
  const std::chrono::steady_clock::time_point begun_ = std::chrono::steady_clock::now();
};

/// "1:05", "1:00:05".
std::string clock_text(double seconds);
/// The last of them in a line, the newest first: "0:12 text | 0:03 text"; "none" where there is none.
std::string notes_line(const Notes& notes, std::size_t most, texts::Language language);
/// How much of its colour a note has: all while it is new, and never so little that it cannot be read.
double freshness(const TimedNote& note, double now_s);

}  // namespace trephine::window
