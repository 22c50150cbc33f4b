// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/time_limit.h"

#include <algorithm>

namespace trephine {

TimeLimit::TimeLimit(double limit_s, const Progress& outer)
    : outer_(outer),
      end_(std::chrono::steady_clock::now() +
           std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(limit_s))) {
  watch_ = std::thread([this] {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!done_) {
      if (std::chrono::steady_clock::now() >= end_) over_ = true;
      if (over_ || outer_.cancelled()) stop_ = true;
      wake_.wait_for(lock, std::chrono::milliseconds(20));
    }
  });
}

TimeLimit::~TimeLimit() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    done_ = true;
  }
  wake_.notify_all();
  watch_.join();
}

Progress TimeLimit::progress() const {
  return Progress([this](double fraction) { outer_.report(fraction); }, &stop_);
}

double TimeLimit::left_s() const {
  return std::max(0.0, std::chrono::duration<double>(end_ - std::chrono::steady_clock::now()).count());
}

}  // namespace trephine
