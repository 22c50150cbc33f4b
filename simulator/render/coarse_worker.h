// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "render/surface_parts.h"

namespace trephine::render {

/// What coarser triangles are to be made of.
struct CoarseAsk {
  int surface = 0;
  std::shared_ptr<const SurfaceParts> whole;  ///< they are to stand beside these; null: they cannot
  /// Where there are none beside them, a coarser surface is to stand in place of this one; null: none is. It must stay
  /// as it is until the worker has ended, or takes another order.
  const scene::SceneSurface* instead = nullptr;
};

/// What was made. Neither `beside` nor `instead`: the surface stays whole.
struct CoarseMade {
  int surface = 0;
  std::shared_ptr<const SurfaceParts> whole;  ///< of the CoarseAsk: what `beside` belongs to
  std::optional<CoarseParts> beside;
  std::shared_ptr<const SurfaceParts> instead;
  CoarseFacts facts;  ///< of `beside` or `instead`, whichever was made
};

/// Makes coarser triangles, and measures them, for somebody who may not wait, such as a window: in one thread, which
/// gives way to all others (nice 5). What it makes depends on nothing but what it is asked for.
///
/// Calls come from one thread and return at once, but for wait() and the destructor. The destructor waits until the
/// thread has ended: for some milliseconds of what it is at.
class CoarseWorker {
 public:
  CoarseWorker();
  ~CoarseWorker();
  CoarseWorker(const CoarseWorker&) = delete;
  CoarseWorker& operator=(const CoarseWorker&) = delete;

  /// Begins to make them all, one after the other; together they take at most so many bytes beside the whole ones.
  /// What was asked for before is dropped.
  void begin(double within_mm, std::size_t max_bytes, std::vector<CoarseAsk> asks);
  void cancel();
  /// The next that was made, in the order in which they were asked for. Throws what making it threw, such as bad_alloc;
  /// the rest is then dropped.
  std::optional<CoarseMade> take();
  /// Whether there is something to be taken, now or later.
  bool busy() const;
  /// Until all that was asked for can be taken.
  void wait();

 private:
  struct Job;
  void run();
  void make(Job& job);

  mutable std::mutex mutex_;  // guards what follows, and is never held while triangles are made
  std::condition_variable asked_, done_;
  std::shared_ptr<Job> job_, next_;  // the one whose results are wanted; the same, where the thread has not begun it
  bool stop_ = false;
  std::thread thread_;  // begins with the first order
};

}  // namespace trephine::render
