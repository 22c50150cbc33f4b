// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <atomic>
#include <functional>
#include <string>

namespace trephine {

/// A long function reports through this object how far it is, and learns from it that it should stop. It is cheap
/// enough for inner loops (every row or slice, not every voxel) and safe from several threads. A default-constructed
/// object reports nowhere and is never cancelled.
class Progress {
 public:
  using Sink = std::function<void(double fraction)>;
  Progress() = default;
  /// `cancel` may be null; it must outlive this object.
  Progress(Sink sink, const std::atomic<bool>* cancel) : sink_(std::move(sink)), cancel_(cancel) {}

  /// Reports that `fraction` (0 to 1) of the work is done. Throws Cancelled once the user has asked to stop.
  void report(double fraction) const;
  /// Throws Cancelled once the user has asked to stop.
  void check() const;
  bool cancelled() const { return cancel_ && cancel_->load(std::memory_order_relaxed); }
  /// The part [from, to] of this progress, for a step of a longer function.
  Progress part(double from, double to) const;
  /// Ends when this one does and reports nowhere: for a piece of work of which another part of the function keeps
  /// count.
  Progress silent() const { return Progress({}, cancel_); }

 private:
  Sink sink_;
  const std::atomic<bool>* cancel_ = nullptr;
};

/// Set by SIGINT and SIGTERM after install_signal_handlers(); a second signal ends the process at once.
const std::atomic<bool>& cancel_requested();
void install_signal_handlers();

}  // namespace trephine
