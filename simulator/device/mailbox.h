// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <atomic>

namespace trephine::device {

/// The newest value that one thread writes, for one other thread. Three slots change hands, so that neither thread ever
/// waits, allocates or makes a system call, and no value is read half written.
template <class T>
class Mailbox {
 public:
  void write(const T& value) {
    slots_[back_] = value;
    back_ = middle_.exchange(back_ | fresh, std::memory_order_acq_rel) & 3;
  }
  /// Returns false where nothing was written since the last read; `out` is then unchanged.
  bool read(T& out) {
    if (!(middle_.load(std::memory_order_relaxed) & fresh)) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & 3;
    out = slots_[front_];
    return true;
  }

 private:
  static constexpr unsigned fresh = 4;
  std::array<T, 3> slots_{};
  std::atomic<unsigned> middle_{1};
  unsigned back_ = 0, front_ = 2;  // the writer's, the reader's
};

}  // namespace trephine::device
