// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/coarse_worker.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <utility>

#include "base/error.h"
#include "base/parallel.h"

namespace trephine::render {
namespace {

constexpr int nice_by = 5;

// A coarser surface in place of the whole one, where that is worth it.
void make_instead(const scene::SceneSurface& whole, double within_mm, const Progress& progress, CoarseMade& made) {
  const scene::SceneSurface less = coarse_surface(whole, within_mm, progress);
  if (!is_worth_it(less.indices.size(), whole.indices.size())) return;
  on_one_thread([&] { made.facts = coarse_facts(whole, less, progress); });
  made.instead = std::make_shared<const SurfaceParts>(parts_of(less));
}

}  // namespace

struct CoarseWorker::Job {
  Job(double mm, std::size_t max_bytes, std::vector<CoarseAsk> all)
      : within_mm(mm), room(max_bytes), asks(std::move(all)) {}
  const double within_mm;
  std::size_t room;
  const std::vector<CoarseAsk> asks;
  std::atomic<bool> cancelled{false};
  // Guarded by the worker's mutex:
  std::deque<CoarseMade> made;
  std::exception_ptr fault;
  bool done = false;
};

CoarseWorker::CoarseWorker() = default;

CoarseWorker::~CoarseWorker() {
  cancel();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  asked_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void CoarseWorker::begin(double within_mm, std::size_t max_bytes, std::vector<CoarseAsk> asks) {
  cancel();
  if (asks.empty()) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    job_ = next_ = std::make_shared<Job>(within_mm, max_bytes, std::move(asks));
  }
  if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
  asked_.notify_one();
}

void CoarseWorker::cancel() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (job_) job_->cancelled = true;
  job_.reset();
  next_.reset();
}

std::optional<CoarseMade> CoarseWorker::take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!job_) return std::nullopt;
  std::optional<CoarseMade> out;
  if (!job_->made.empty()) {
    out = std::move(job_->made.front());
    job_->made.pop_front();
  } else if (job_->fault) {
    std::rethrow_exception(std::exchange(job_, nullptr)->fault);
  }
  if (job_->done && job_->made.empty() && !job_->fault) job_.reset();
  return out;
}

bool CoarseWorker::busy() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return job_ != nullptr;
}

void CoarseWorker::wait() {
  std::unique_lock<std::mutex> lock(mutex_);
  done_.wait(lock, [&] { return !job_ || job_->done; });
}

void CoarseWorker::run() {
  // A system that does not grant it makes triangles all the same.
  setpriority(PRIO_PROCESS, id_t(syscall(SYS_gettid)), nice_by);
  for (;;) {
    std::shared_ptr<Job> job;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      asked_.wait(lock, [&] { return stop_ || next_; });
      if (stop_) return;
      job = std::exchange(next_, nullptr);
    }
    std::exception_ptr fault;
    try {
      make(*job);
    } catch (const Cancelled&) {
    } catch (...) {
      fault = std::current_exception();
    }
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      job->fault = fault;
      job->done = true;
    }
    done_.notify_all();
  }
}

void CoarseWorker::make(Job& job) {
  const Progress progress({}, &job.cancelled);
  for (const CoarseAsk& ask : job.asks) {
    CoarseMade made;
    made.surface = ask.surface;
    made.whole = ask.whole;
    if (ask.whole) made.beside = coarse_parts(*ask.whole, job.within_mm, job.room, progress);
    if (made.beside) {
      made.facts = made.beside->facts;
      job.room -= made.facts.bytes;
    } else if (ask.instead) {
      make_instead(*ask.instead, job.within_mm, progress, made);
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    job.made.push_back(std::move(made));
  }
}

}  // namespace trephine::render
