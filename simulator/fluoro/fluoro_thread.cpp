// SPDX-License-Identifier: GPL-3.0-or-later
#include "fluoro/fluoro_thread.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <functional>

#include "base/error.h"
#include "base/parallel.h"

namespace trephine::fluoro {
namespace {

constexpr int band_rows = 8;  // between two looks at what is asked for
constexpr int max_threads = 8, nice_by = 5;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

FluoroThread::FluoroThread(const grid::Grid<std::int16_t>& ct, int size) : ct_(ct), size_(size) {
  require_ct(ct);
  thread_ = std::thread([this] { run(); });
}

FluoroThread::~FluoroThread() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  asked_.notify_one();
  thread_.join();
}

void FluoroThread::move(const CArmParams& arm) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (moved_.number > 0 && same_arm(moved_.arm, arm)) return;
  moved_ = {arm, {}, moved_.number + 1, now_s()};
  asked_.notify_one();
}

void FluoroThread::show(const CArmParams& arm, const std::vector<MetalRod>& metal) {
  const std::lock_guard<std::mutex> lock(mutex_);
  shown_ = {arm, metal, shown_.number + 1, now_s()};
  asked_.notify_one();
}

std::optional<MadeFluoro> FluoroThread::take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (fault_) std::rethrow_exception(std::exchange(fault_, nullptr));
  return std::exchange(made_, std::nullopt);
}

void FluoroThread::run() {
  // Threads that this one starts are as modest. A system that does not grant it makes pictures all the same.
  setpriority(PRIO_PROCESS, id_t(syscall(SYS_gettid)), nice_by);
  try {
    const FluoroVolume volume(ct_);
    serve(volume);
  } catch (...) {
    const std::lock_guard<std::mutex> lock(mutex_);
    fault_ = std::current_exception();
  }
}

void FluoroThread::serve(const FluoroVolume& volume) {
  for (;;) {
    Ask ask;
    bool prepares = false;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      asked_.wait(lock, [&] { return stop_ || shown_.number != served_ || moved_.number != ahead_; });
      if (stop_) return;
      prepares = shown_.number == served_;  // what is to be seen comes first
      ask = prepares ? moved_ : shown_;
    }
    (prepares ? ahead_ : served_) = ask.number;
    make(volume, ask, prepares);
  }
}

void FluoroThread::make(const FluoroVolume& volume, const Ask& ask, bool prepares) {
  if (const KeptFluoro* kept = memory_.find(ask.arm, size_)) {
    publish(*kept);
    return;
  }
  const KeptFluoro* coarse = patient(volume, ask, prepares, size_ / 2, nullptr);
  if (!coarse) return;
  publish(*coarse, prepares ? nullptr : &ask);
  const KeptFluoro* whole = patient(volume, ask, prepares, size_, coarse);
  if (!whole) return;
  published_ = 0;  // it shows better what the other one showed
  publish(*whole);
}

// Whether it is still what is wanted next. Half a picture that was asked for is made even where the arm has gone on:
// while it turns, each call asks for another place, and there would be no picture until it stands still.
bool FluoroThread::goes_on(const Ask& ask, bool prepares, bool coarse) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (stop_) return false;
  if (coarse && !prepares) return true;
  if (shown_.number != served_ && !same_arm(shown_.arm, ask.arm)) return false;
  return !prepares || moved_.number == ask.number;
}

// The integrals at that size, or null where they are not wanted any more.
const KeptFluoro* FluoroThread::patient(const FluoroVolume& volume, const Ask& ask, bool prepares, int size,
                                        const KeptFluoro* coarse) {
  if (const KeptFluoro* kept = memory_.find(ask.arm, size)) return kept;
  KeptFluoro k{ask.arm, {}, 1};
  k.integrals.size = size;
  if (!integrate(volume, ask, prepares, coarse, k.integrals)) return nullptr;
  k.bright = bright_of(k.integrals);
  return &memory_.keep(std::move(k));
}

// Rows in bands, by this thread and others; between two bands this one looks for what is asked for.
bool FluoroThread::integrate(const FluoroVolume& volume, const Ask& ask, bool prepares, const KeptFluoro* coarse,
                             FluoroIntegrals& out) {
  const int size = out.size;
  out.integral.resize(std::size_t(size) * std::size_t(size));
  const CArm arm(ask.arm, size);
  std::atomic<int> next{0};
  std::atomic<bool> stop{false};
  const auto band = [&] {
    const int row = next.fetch_add(band_rows);
    if (row < size) volume.integrate(arm, row, std::min(size, row + band_rows), out);
    return row < size;
  };
  struct Others {
    std::vector<std::thread> threads;
    std::atomic<bool>& stop;
    bool done = false;
    ~Others() {
      if (!done) stop = true;
      for (std::thread& t : threads) t.join();
    }
  };
  {
    Others others{{}, stop};
    try {
      for (int n = 1; n < std::min(thread_count(), max_threads); ++n)
        others.threads.emplace_back([&] {
          while (!stop && band()) {
          }
        });
    } catch (const std::system_error&) {  // fewer threads are slower, and nothing else
    }
    while (band()) {
      if (!goes_on(ask, prepares, !coarse)) return false;
      if (coarse) publish(*coarse);
    }
    others.done = true;
  }
  return true;
}

// The patient with the metal as it was last shown, if that was at this place of the arm; or, where the arm has gone on,
// as it was `asked` for. Nothing where that has such a picture already.
void FluoroThread::publish(const KeptFluoro& patient, const Ask* asked) {
  Ask ask;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ask = shown_;
  }
  if (!same_arm(patient.arm, ask.arm)) {
    if (!asked || asked->number < published_) return;
    ask = *asked;
  }
  if (ask.number == published_) return;  // 0 is what nobody asked for
  MadeFluoro made;
  made.picture = picture_of(patient.integrals, patient.bright, CArm(patient.arm, patient.integrals.size), ask.metal);
  made.arm = ask.arm;
  made.metal = ask.metal;
  made.waited_s = now_s() - ask.asked_s;
  published_ = served_ = ask.number;
  const std::lock_guard<std::mutex> lock(mutex_);
  made_ = std::move(made);
}

}  // namespace trephine::fluoro
