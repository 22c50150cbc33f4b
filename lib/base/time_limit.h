// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/progress.h"

namespace trephine {

/// A limit on the wall clock time of everything that happens under its progress: once it is over, or once the outer
/// progress is cancelled, the code that checks it stops (Cancelled). within_time makes an Error of the former.
class TimeLimit {
 public:
  TimeLimit(double limit_s, const Progress& outer);
  ~TimeLimit();
  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;

  /// Reports to the outer progress; valid as long as this object.
  Progress progress() const;
  bool over() const { return over_; }
  /// 0 once it is over.
  double left_s() const;

 private:
  const Progress outer_;
  const std::chrono::steady_clock::time_point end_;
  std::atomic<bool> stop_{false}, over_{false};
  bool done_ = false;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::thread watch_;
};

/// Runs work(limit) and returns what it does. Throws Error 70, field "total_limit_s", where it takes longer.
template <class F>
auto within_time(double limit_s, const Progress& outer, F&& work) {
  TimeLimit limit(limit_s, outer);
  try {
    return std::forward<F>(work)(limit);
  } catch (const Cancelled&) {
    if (!limit.over()) throw;
  }
  throw Error(ExitCode::internal, "", "total_limit_s", "the limit of time is over");
}

}  // namespace trephine
