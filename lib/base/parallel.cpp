// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#ifndef TREPHINE_HEADLESS
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#endif

#include <algorithm>
#include <memory>
#include <thread>

namespace trephine {
namespace {

#ifndef TREPHINE_HEADLESS
// This object is never destroyed. Without the limit TBB starts threads at the end of the process, and where memory is
// too short for them it ends the process by an exception.
std::unique_ptr<tbb::global_control>& g_limit = *new std::unique_ptr<tbb::global_control>;
#endif
int g_count = 0;

int cores() { return std::max(1u, std::thread::hardware_concurrency()); }

}  // namespace

void set_thread_count(int count) {
  g_count = count > 0 ? count : cores();
#ifndef TREPHINE_HEADLESS
  g_limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, g_count);
#endif
}

int thread_count() { return g_count > 0 ? g_count : cores(); }

void parallel_for(std::int64_t begin, std::int64_t end, std::int64_t grain,
                  const std::function<void(std::int64_t, std::int64_t)>& body) {
  if (end <= begin) return;
  grain = std::max<std::int64_t>(1, grain);
  const std::int64_t pieces = (end - begin + grain - 1) / grain;
  const auto piece = [&](std::int64_t i) {
    const std::int64_t from = begin + i * grain;
    body(from, std::min(end, from + grain));
  };
#ifdef TREPHINE_HEADLESS  // one after the other: the parallel parts run when a case is loaded
  for (std::int64_t i = 0; i < pieces; ++i) piece(i);
#else
  // In the context of a loop around it, an exception of that loop's other pieces would end this one before its end, and
  // without a word: what follows would go on with what is half made.
  tbb::task_group_context own(tbb::task_group_context::isolated);
  tbb::parallel_for(std::int64_t{0}, pieces, piece, own);
#endif
}

void on_one_thread(const std::function<void()>& body) {
#ifdef TREPHINE_HEADLESS
  body();
#else
  tbb::task_arena(1).execute(body);
#endif
}

}  // namespace trephine
