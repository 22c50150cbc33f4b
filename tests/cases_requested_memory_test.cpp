// SPDX-License-Identifier: GPL-3.0-or-later
#include "cases_requested_memory.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

namespace {
std::atomic<std::uint64_t> bytes{0};
}

std::uint64_t requested_bytes() { return bytes; }

__attribute__((noinline)) void* operator new(std::size_t size) {
  bytes.fetch_add(size, std::memory_order_relaxed);
  if (void* p = std::malloc(size ? size : 1)) return p;
  throw std::bad_alloc();
}
__attribute__((noinline)) void operator delete(void* p) noexcept { std::free(p); }
__attribute__((noinline)) void operator delete(void* p, std::size_t) noexcept { std::free(p); }

// The tests of hostile sizes would pass if nobody counted.
TEST(RequestedMemory, IsCounted) {
  const std::uint64_t before = requested_bytes();
  const std::vector<char> v(12345);
  EXPECT_GE(requested_bytes() - before, v.size());
  EXPECT_LT(requested_bytes() - before, v.size() + 1000);
}
