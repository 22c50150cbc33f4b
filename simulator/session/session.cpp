// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/session.h"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <future>

#include "base/error.h"

namespace trephine {
namespace {

// So many frames of a session without a clock are kept until its end: what does not sleep would outrun any disk.
constexpr double most_kept_ticks = 2e7;

double thread_cpu_s() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

std::unique_ptr<RecordingWriter> recording_of(const SessionOptions& options, const RecordingHeader& header) {
  return options.record.empty() ? nullptr : std::make_unique<RecordingWriter>(options.record, header);
}

std::uint64_t ticks_of(const SessionOptions& options) {
  const double ticks = std::max(1.0, std::round(options.seconds * options.servo.rate_hz));
  if (!options.servo.paced && ticks > most_kept_ticks)
    throw Error(ExitCode::usage, "", "--seconds", "is too long without --paced");
  return std::uint64_t(ticks);
}

}  // namespace

double SessionResult::cpu_us_a_tick() const {
  return statistics.ticks > 0 ? 1e6 * cpu_s / double(statistics.ticks) : 0;
}

Session::Session(const SessionOptions& options, const std::atomic<bool>& stop,
                 const std::function<void(const std::string&)>& say)
    : options_(options),
      stop_(stop),
      felt_(options.case_folder, options.shape),
      contact_(felt_.loaded.haptic, options.contact),
      device_(make_device(options.device, {contact_, touchable_of(felt_.feels), options.servo.paced,
                                           options.servo.realtime, say, Progress({}, &stop)})),
      header_(header_of(options)),
      proxy_(contact_, felt_.feels, options.force, options.shaft, make_tool(header_.tool)),
      recording_(recording_of(options, header_)),
      ticks_(ticks_of(options)),
      queue_(queue_size()),
      servo_(proxy_, *device_, options.servo, recording_ ? &queue_ : nullptr) {}

Session::~Session() {
  if (thread_.joinable()) thread_.join();
}

RecordingHeader Session::header_of(const SessionOptions& options) const {
  RecordingHeader header = felt_.header();
  header.device = options.device.name;
  header.rate_hz = options.servo.rate_hz;
  header.contact = options.contact;
  header.force = options.force;
  header.shaft = options.shaft;
  header.tool = own_tool(options.tool);
  return header;
}

std::size_t Session::queue_size() const {
  if (!recording_) return 64;
  return options_.servo.paced ? std::size_t(1) << 16 : std::size_t(ticks_);
}

int Session::tool_points() const { return proxy_.tool_body() ? proxy_.tool_body()->count() : 0; }

void Session::run() {
  const double before_s = thread_cpu_s();
  servo_.run(ticks_, stop_);
  cpu_s_ = thread_cpu_s() - before_s;
  done_ = true;
}

const RealtimeGrant& Session::start() {
  std::promise<RealtimeGrant> promise;
  std::future<RealtimeGrant> granted = promise.get_future();
  const bool realtime = options_.servo.paced && options_.servo.realtime;
  thread_ = std::thread([this, realtime, promise = std::move(promise)]() mutable {
    promise.set_value(realtime ? claim_realtime() : RealtimeGrant{});
    run();
  });
  grant_ = granted.get();
  return grant_;
}

void Session::drain() {
  frames_.clear();
  queue_.drain(frames_);
  recording_->add(frames_);
}

void Session::write_frames() {
  if (recording_ && options_.servo.paced) drain();
}

SessionResult Session::finish() {
  if (thread_.joinable()) thread_.join();
  if (recording_) {
    drain();
    recording_->finish();
  }
  return {header_, grant_, servo_.statistics(), device_->counts(), queue_.dropped(), cpu_s_};
}

}  // namespace trephine
