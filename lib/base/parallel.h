// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

namespace trephine {

/// Limits the threads of our own loops and of everything else that runs on TBB (VTK's SMP filters among them) for the
/// rest of the process; 0 means one thread per core. Modules that use a library with its own thread pool read
/// thread_count().
void set_thread_count(int count);
int thread_count();

/// Calls body(from, to) for pieces of [begin, end) of at most `grain` items, on up to thread_count() threads. The
/// pieces are the same whatever the thread count, so a body that writes only its own items, or one result per piece, is
/// deterministic. An exception of one piece is thrown again after all running pieces have ended.
void parallel_for(std::int64_t begin, std::int64_t end, std::int64_t grain,
                  const std::function<void(std::int64_t from, std::int64_t to)>& body);

/// Runs that in this thread; what of it would run in parallel runs here as well, one piece after the other. For a
/// thread that gives way to others, which the threads of a pool would not.
void on_one_thread(const std::function<void()>& body);

/// Runs the tasks in parallel, in no particular order. Exceptions are handled as in parallel_for.
inline void parallel_do(const std::vector<std::function<void()>>& tasks) {
  parallel_for(0, static_cast<std::int64_t>(tasks.size()), 1, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t i = from; i < to; ++i) tasks[static_cast<std::size_t>(i)]();
  });
}

}  // namespace trephine
