// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/progress.h"

#include <csignal>

#include "base/error.h"

namespace trephine {
namespace {

std::atomic<bool> g_cancel{false};

extern "C" void on_signal(int number) {
  if (g_cancel.exchange(true)) {
    std::signal(number, SIG_DFL);
    std::raise(number);
  }
}

}  // namespace

void Progress::report(double fraction) const {
  check();
  if (sink_) sink_(fraction);
}

void Progress::check() const {
  if (cancelled()) throw Cancelled{};
}

Progress Progress::part(double from, double to) const {
  if (!sink_) return Progress({}, cancel_);
  return Progress([sink = sink_, from, to](double f) { sink(from + (to - from) * f); }, cancel_);
}

const std::atomic<bool>& cancel_requested() { return g_cancel; }

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  // A limit on file sizes is an error of the write that meets it, be it only of a message.
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace trephine
