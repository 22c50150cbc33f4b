// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/notes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace trephine::window {
namespace {

constexpr double new_for_s = 10, fades_in_s = 30, least = 0.7;

}  // namespace

void Notes::add(double at_s, texts::Note note) {
  kept_.push_back({at_s, std::move(note)});
  if (kept_.size() <= max_kept) return;
  kept_.pop_front();
  ++first_;
}

std::deque<TimedNote> Notes::since(std::size_t& n) const {
  const std::size_t from = std::min(count(), std::max(n, first_));
  n = count();
  return {kept_.begin() + std::ptrdiff_t(from - first_), kept_.end()};
}

std::string clock_text(double seconds) {
  const auto s = std::int64_t(std::max(0.0, seconds));
  return s < 3600 ? fmt::format("{}:{:02}", s / 60, s % 60)
                  : fmt::format("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60);
}

std::string notes_line(const Notes& notes, std::size_t most, texts::Language language) {
  std::string line;
  const std::deque<TimedNote>& kept = notes.kept();
  for (std::size_t n = kept.size(); n-- > 0 && kept.size() - n <= most;)
    line += (line.empty() ? "" : " | ") + clock_text(kept[n].at_s) + " " + texts::text_of(kept[n].note, language);
  return line.empty() ? "none" : line;
}

double freshness(const TimedNote& note, double now_s) {
  const double old = (now_s - note.at_s - new_for_s) / fades_in_s;
  return 1 - (1 - least) * std::clamp(old, 0.0, 1.0);
}

}  // namespace trephine::window
