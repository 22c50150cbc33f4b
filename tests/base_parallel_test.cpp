// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
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
