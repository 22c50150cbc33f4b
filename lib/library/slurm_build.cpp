// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <chrono>
#include <iterator>
#include <thread>

#include "base/error.h"
#include "base/log.h"
#include "base/progress.h"
#include "cluster/slurm.h"
#include "library/slurm_engine.h"
#include "publish/case_lock.h"

namespace trephine::library {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double ask_every_s = 5, tick_s = 0.2, submission_patience_s = 600;

double seconds_since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

class SlurmBuild {
 public:
  SlurmBuild(const LibraryState& state, const EngineParams& engine, const LibraryBuildParams& params,
             const std::function<void(const JobEvent&)>& event)
      : state_(state), engine_(engine), params_(params), event_(event) {}

  // What an earlier submission still does is not submitted twice.
  void submit(const std::vector<NinjaJob>& jobs) {
    publish::share_library(state_.library(), engine_.lease_s);
    std::map<std::string, LibraryJob> under_way;
    for (const Batch& open : read_batches(state_, true)) {
      follow(open.id);
      std::map<std::string, LibraryJob> words;
      try {
        words = read_jobs(jobs_file(open));
      } catch (const Error&) {  // its submission was broken off before it had any
      }
      const auto ended = ended_tasks(open);
      for (const BatchJob& j : open.jobs)
        if (const auto found = words.find(j.name); found != words.end() && !is_final(open, j, ended))
          under_way[j.name] = found->second;
    }
    std::vector<NinjaJob> fresh;
    for (const NinjaJob& j : jobs) {
      const auto found = under_way.find(j.job.name);
      if (found == under_way.end())
        fresh.push_back(j);
      else if (found->second.settings_sha256 != j.job.settings_sha256 || found->second.identity != j.job.identity)
        throw Error(ExitCode::busy, state_.library().string(), j.job.token,
                    "the cluster still builds it with other settings: wait, or `library cancel` and build again");
      under_way_.insert(j.job.name);
    }
    if (fresh.empty()) return;
    Batch batch = new_batch(state_);
    Batch plan = plan_batch(fresh, engine_, params_);
    plan.id = batch.id;
    plan.folder = batch.folder;
    if (const long most = cluster::max_array_of_slurm(); most > 1 && plan.max_array > most)
      plan.max_array = static_cast<int>(most);
    std::vector<LibraryJob> words;
    std::set<std::string> names;
    for (const NinjaJob& j : fresh) {
      words.push_back(j.job);
      names.insert(j.job.name);
    }
    write_jobs(jobs_file(plan), words);
    write_batch(plan);
    try {
      submit_jobs(plan, names, submission_patience_s);
    } catch (const Error&) {
      if (plan.arrays.empty()) close_batch(plan);  // nothing of it was taken: the next build plans anew
      throw;
    }
    follow(plan.id);
  }

  void wait(const std::function<void()>& tick) {
    auto asked = Clock::now() - std::chrono::hours(1);
    while (!under_way_.empty()) {
      if (cancel_requested()) {
        log_line("the cluster goes on; `trephine library status` tells how far it is, `library cancel` ends it");
        throw Cancelled{};
      }
      if (seconds_since(asked) >= ask_every_s) {
        look();
        asked = Clock::now();
      }
      tick();
      std::this_thread::sleep_for(std::chrono::duration<double>(tick_s));
    }
  }

  // Tells which jobs ended meanwhile.
  void tell() {
    for (const std::string& id : followed_) {
      const auto batch = read_batch(batches_folder(state_) / id);
      if (!batch) continue;
      for (const BatchJob& j : batch->jobs) {
        if (told_.count(j.name) || !under_way_.count(j.name)) continue;
        if (const auto begun = read_task(batch->folder, task_begun, j.name); begun && begun_.insert(j.name).second)
          event_({j.name, false, {}});
        std::map<std::string, TaskRecord> ended;
        if (const auto r = read_task(batch->folder, task_ended, j.name)) ended[j.name] = *r;
        if (!is_final(*batch, j, ended) && !batch->cancelled) continue;
        if (begun_.insert(j.name).second) event_({j.name, false, {}});
        JobResult result{static_cast<int>(ExitCode::cancelled), "cancelled", 0, 0, 0};
        if (const auto r = ended.find(j.name); r != ended.end()) result = r->second.result;
        event_({j.name, true, result});
        told_.insert(j.name);
      }
    }
  }

  std::set<std::string> under_way() const {
    std::set<std::string> left;
    std::set_difference(under_way_.begin(), under_way_.end(), told_.begin(), told_.end(),
                        std::inserter(left, left.end()));
    return left;
  }

 private:
  void follow(const std::string& id) { followed_.push_back(id); }

  void look() {
    tell();
    bool all_done = true;
    for (const std::string& id : followed_) {
      const BatchStep step = advance_batch(state_, id, false);
      all_done = all_done && step == BatchStep::finished;
      if (step == BatchStep::not_known && !silent_)
        log_warning("Slurm's controller does not answer; it is asked again until it does");
      if (step == BatchStep::resubmitted) log_warning("what was lost was submitted again");
      silent_ = step == BatchStep::not_known;
    }
    if (!all_done) return;
    tell();
    under_way_.clear();
  }

  const LibraryState& state_;
  const EngineParams& engine_;
  const LibraryBuildParams& params_;
  const std::function<void(const JobEvent&)>& event_;
  std::vector<std::string> followed_;
  std::set<std::string> under_way_, told_, begun_;
  bool silent_ = false;
};

}  // namespace

std::set<std::string> build_with_slurm(const LibraryState& state, const EngineParams& engine,
                                       const LibraryBuildParams& params, const std::vector<NinjaJob>& jobs,
                                       const std::function<void(const JobEvent&)>& event,
                                       const std::function<void()>& tick) {
  SlurmBuild build(state, engine, params, event);
  build.submit(jobs);
  if (params.wait)
    build.wait(tick);
  else
    build.tell();
  return build.under_way();
}

}  // namespace trephine::library
