// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

using namespace trephine;

// A modest thread keeps its work to itself, whatever others do at the same time, and hears of what went wrong.
TEST(Parallel, OnOneThreadAllPiecesAreOfThatThread) {
  std::atomic<int> pieces{0}, elsewhere{0};
  const auto count = [&] {
    on_one_thread([&] {
      const std::thread::id own = std::this_thread::get_id();
      parallel_for(0, 1000, 1, [&](std::int64_t, std::int64_t) {
        ++pieces;
        elsewhere += std::this_thread::get_id() != own;
        volatile double x = 1;
        for (int n = 0; n < 20000; ++n) x = x * 1.0000001;
      });
    });
  };
  std::thread other(count);
  parallel_for(0, 1000, 1, [](std::int64_t, std::int64_t) { std::this_thread::yield(); });
  count();
  other.join();
  EXPECT_EQ(pieces, 2000);
  EXPECT_EQ(elsewhere, 0);
  EXPECT_THROW(
      on_one_thread([] { parallel_for(0, 10, 1, [](std::int64_t, std::int64_t) { throw std::runtime_error("no"); }); }),
      std::runtime_error);
}

// A tree of boxes was left half made, and walked without end, when another part of the same loop threw.
TEST(Parallel, AnExceptionBesideALoopDoesNotEndItBeforeItsEnd) {
  using namespace std::chrono_literals;
  std::atomic<bool> began{false}, thrown{false};
  std::atomic<int> ended_early{0};
  const auto waits_for = [](const std::atomic<bool>& flag) {
    for (int ms = 0; ms < 500 && !flag; ++ms) std::this_thread::sleep_for(1ms);
  };
  const auto throws = [&] {
    waits_for(began);
    thrown = true;
    throw std::runtime_error("beside");
  };
  const auto loops = [&] {
    std::atomic<int> pieces{0};
    parallel_for(0, 300, 1, [&](std::int64_t, std::int64_t) {
      began = true;
      if (!thrown) waits_for(thrown);
      std::this_thread::sleep_for(1ms);
      ++pieces;
    });
    ended_early += pieces != 300;
  };
  EXPECT_THROW(parallel_do({throws, loops}), std::runtime_error);
  EXPECT_EQ(ended_early, 0);
}
