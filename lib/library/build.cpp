// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/build.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/log.h"
#include "base/parallel.h"
#include "base/text.h"
#include "base/write_file.h"
#include "library/build_jobs.h"
#include "library/catalogue.h"
#include "library/ninja.h"
#include "library/sheet.h"
#include "library/slurm_engine.h"
#include "library/timeline.h"
#include "publish/case_lock.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t max_reasons = 3;

std::string rounded(double v) { return to_text(std::round(v * 10) / 10); }

// What the kernel says is free, and the group's limit where the build runs in one.
double free_memory_mb() {
  double mb = 1024;
  std::ifstream info("/proc/meminfo");
  std::string key, rest;
  for (double kb; info >> key >> kb && std::getline(info, rest);)
    if (key == "MemAvailable:") mb = kb / 1024;
  std::ifstream limit("/sys/fs/cgroup/memory.max"), used("/sys/fs/cgroup/memory.current");
  double most = 0, now = 0;
  if (limit >> most && used >> now) mb = std::min(mb, (most - now) / (1 << 20));
  return std::max(mb, 256.0);
}

class Build {
 public:
  Build(const LibraryBuildRequest& request, LibraryObserver& observer)
      : request_(request), observer_(observer), state_(fs::absolute(request.library).lexically_normal()) {}

  LibraryBuildResult run() {
    config_ = read_library_config(request_.config, request_.overrides);
    const bool dry = request_.params.dry_run || !request_.why.empty();
    if (dry) {
      plan(false);
      request_.why.empty() ? tell_plan() : tell_why();
      return result_;
    }
    make_output_folder(request_.library);
    state_.make_folders();
    const auto lock = take_lock();
    require_no_cluster();
    remove_leftovers();
    plan(true);
    check_disk();
    const BuildJobs jobs = make_build_jobs(plan_, config_, state_, request_.params);
    weights_ = jobs.weights;
    if (!jobs.jobs.empty()) engine() == Engine::slurm ? work_on_cluster(jobs.jobs) : work(jobs.jobs);
    collect();
    const bool is_made = engine() == Engine::slurm && !jobs.jobs.empty();  // by the batch's last job
    if (request_.params.sheet && !is_made && (result_.built > 0 || !has_sheet(state_.library()))) make_sheet_or_warn();
    std::vector<TimelineItem> times;
    for (const auto& [name, item] : timeline_) times.push_back(item);
    keep_timeline(state_, times);
    tell_result();
    return result_;
  }

 private:
  std::unique_ptr<publish::CaseLock> take_lock() const {
    try {
      return std::make_unique<publish::CaseLock>(state_.folder());
    } catch (const Error& e) {
      if (e.code() != ExitCode::busy) throw;
      throw Error(ExitCode::busy, request_.library.string(), "",
                  "another build works on this library, try again when it is done");
    }
  }

  // Of a build that was killed: of cases that were published meanwhile, too, for which no run is started.
  void remove_leftovers() const {
    const auto tidy = [](const fs::path& folder, std::initializer_list<const char*> below) {
      for (const char* name : below) remove_stale_temporaries(folder / name);
    };
    tidy(state_.library(), {"", library_cache_name});
    tidy(state_.folder(), {"", "cases", "settings", "phantoms", "logs"});
    std::error_code error, ignored;
    // Of jobs that were killed; one that still runs, on a cluster, writes its own again.
    for (fs::directory_iterator it(state_.folder() / "logs", error), end; !error && it != end; it.increment(error))
      if (it->path().extension() == LibraryState::status_suffix) fs::remove(it->path(), ignored);
    for (fs::directory_iterator it(state_.library(), error), end; !error && it != end; it.increment(error))
      if (it->path().filename().string().front() != '.') tidy(it->path(), {"", "meshes", "report"});
  }

  void plan(bool write) {
    PlanOptions options;
    options.rehash = request_.params.rehash;
    options.rebuild = request_.params.rebuild;
    options.pictures = request_.params.pictures;
    options.only = request_.only;
    for (const std::string& token : request_.why) options.only.push_back(token);
    options.program_version = request_.program_version;
    options.write = write;
    const Progress progress([this](double f) { observer_.planning(f); }, &cancel_requested());
    plan_ = make_plan(config_, state_, options, progress);
    if (plan_.repeated > 0)
      log_warning(std::to_string(plan_.repeated) + " series were found that are there under another name: left out");
  }

  double needed_disk_mb() const {
    double mb = 0, cache_mb = 0;
    for (const PlannedPhantom& p : plan_.phantoms)
      if (p.needed && !p.reasons.empty()) mb += p.estimate.disk_mb;
    for (const PlannedCase& c : plan_.cases)
      if (!c.reasons.empty()) {
        mb += c.estimate.disk_mb;
        cache_mb += c.estimate.cache_mb;
      }
    return mb + std::min(cache_mb, static_cast<double>(request_.params.cache_limit_mb));
  }

  void check_disk() const {
    if (request_.params.check_disk) publish::require_disk(state_.library(), needed_disk_mb());
  }

  void work(const std::vector<NinjaJob>& jobs) {
    std::vector<double> memory;
    for (const NinjaJob& j : jobs) memory.push_back(j.memory_mb);
    const double budget_mb =
        request_.params.memory_mb > 0 ? static_cast<double>(request_.params.memory_mb) : 0.85 * free_memory_mb();
    const int wanted = request_.params.jobs > 0 ? request_.params.jobs : thread_count();
    const MemoryPools pools = make_pools(memory, budget_mb, wanted);
    at_once_ = pools.jobs;
    const double largest = *std::max_element(memory.begin(), memory.end());
    if (largest > budget_mb)
      log_warning("a case needs " + rounded(largest) + " MB by estimate, more than the " + rounded(budget_mb) +
                  " MB that there are: tried alone");
    start_ = Clock::now();
    observer_.began(static_cast<int>(jobs.size()));
    NinjaOptions options;
    options.folder = state_.folder();
    options.keep_going = request_.params.keep_going;
    run_ninja(
        jobs, pools, options, [this](const JobEvent& e) { take(e); }, [this] { tick(); });
  }

  Engine engine() const {
    return request_.params.engine == Engine::as_configured ? config_.engine.name : request_.params.engine;
  }

  void work_on_cluster(const std::vector<NinjaJob>& jobs) {
    start_ = Clock::now();
    observer_.began(static_cast<int>(jobs.size()));
    under_way_ = build_with_slurm(
        state_, config_.engine, request_.params, jobs, [this](const JobEvent& e) { take(e); }, [this] { tick(); });
  }

  // Two engines would build the same cases twice.
  void require_no_cluster() const {
    if (engine() == Engine::slurm || read_batches(state_, true).empty()) return;
    throw Error(
        ExitCode::busy, request_.library.string(), "",
        "a cluster works on this library: `trephine library status` tells how far it is, `library cancel` ends it");
  }

  void take(const JobEvent& e) {
    const double now_s = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    if (engine() != Engine::slurm) {  // whose nodes tell it themselves
      TimelineItem& i = timeline_[e.name];
      i = {e.name, "", e.is_end ? i.begin_s : now_s, now_s, e.result.cpu_s, e.result.code};
    }
    if (!e.is_end) {
      running_.push_back(e.name);
      observer_.started(e.name);
      return;
    }
    running_.erase(std::remove(running_.begin(), running_.end(), e.name), running_.end());
    results_[e.name] = e.result;
    done_weight_ += weights_[e.name];
    last_end_ = Clock::now();
    ++(e.result.code == 0 ? done_ : failed_);
    if (engine() != Engine::slurm && e.name.rfind("case.", 0) == 0 &&
        e.result.code != static_cast<int>(ExitCode::cancelled))
      record(e.name.substr(5), e.result);
    observer_.finished(e.name, e.result);
  }

  // A full disk is no reason to leave out the summary.
  void record(const std::string& token, const JobResult& result) {
    try {
      write_result(state_, token, result);
    } catch (const Error& error) {
      if (!told_full_) log_warning(std::string("results cannot be recorded: ") + error.what());
      told_full_ = true;
    }
  }

  // As fast as the jobs so far, from the last that ended on; -1: not known.
  double seconds_left() const {
    if (done_weight_ <= 0) return -1;
    double all = 0;
    for (const auto& [name, weight] : weights_) all += weight;
    const double took = std::chrono::duration<double>(last_end_ - start_).count();
    const double since = std::chrono::duration<double>(Clock::now() - last_end_).count();
    const double left = took * (all - done_weight_) / done_weight_ - since;
    return left > 0 ? left : -1;
  }

  void tick() {
    Named<json::JobStatus> running;
    for (const std::string& name : running_)
      running.emplace_back(name, json::read_job_status(state_.status_file(name)).value_or(json::JobStatus{}));
    observer_.working(running, done_, failed_, seconds_left());
  }

  void collect() {
    result_.cases = static_cast<int>(plan_.cases.size());
    for (const PlannedCase& c : plan_.cases) {
      if (c.fault) {
        fail(c.token, {static_cast<int>(c.fault->code()), text_of(*c.fault), 0, 0, 0});
        if (!c.entry.token.empty()) record(c.token, failures_.back().second);
      } else if (c.reasons.empty()) {
        ++result_.fresh;
        // What was wrong with it was put right without a build: its series is again what it was built of.
        if (const auto last = read_result(state_, c.token); last && last->code != 0) record(c.token, {});
      } else if (under_way_.count("case." + c.token)) {
        ++result_.under_way;
      } else if (const auto found = results_.find("case." + c.token); found == results_.end()) {
        fail(c.token, {static_cast<int>(ExitCode::busy), "not begun: the build stopped before", 0, 0, 0});
      } else if (found->second.code != 0) {
        fail(c.token, found->second);
      } else {
        ++result_.built;
      }
    }
    result_.failed = static_cast<int>(failures_.size());
    // What was not begun has no fault of its own.
    for (const auto& [token, r] : failures_)
      if (result_.code == 0 && r.code != static_cast<int>(ExitCode::busy)) result_.code = r.code;
    if (result_.code == 0 && !failures_.empty()) result_.code = failures_.front().second.code;
  }
  static std::string text_of(const Error& e) {
    std::string text;
    for (const std::string& part : {e.file(), e.field()})
      if (!part.empty()) text += part + ": ";
    return printable(text + e.what());
  }
  void fail(const std::string& token, const JobResult& r) { failures_.emplace_back(token, r); }

  void make_sheet_or_warn() const {
    try {
      make_sheet(state_.library());
    } catch (const Error& e) {
      log_warning(std::string("the contact sheet could not be made: ") + e.what());
    }
  }

  // What the cases that were built do without, or have something simple in place of.
  Named<std::string> concessions() const {
    Named<std::string> lines;
    for (const auto& [name, result] : results_)
      if (const std::string token = name.substr(name.find('.') + 1); result.code == 0 && name == "case." + token)
        lines.emplace_back(token, concessions_text(read_row(state_.library(), token)));
    lines.erase(std::remove_if(lines.begin(), lines.end(), [](const auto& l) { return l.second.empty(); }),
                lines.end());
    return lines;
  }

  void tell_result() {
    result_.table = std::to_string(result_.cases) + (result_.cases == 1 ? " case: " : " cases: ") +
                    std::to_string(result_.built) + " built, " + std::to_string(result_.fresh) + " as they were, " +
                    std::to_string(result_.failed) + " failed";
    if (result_.under_way > 0) result_.table += ", " + std::to_string(result_.under_way) + " on the cluster";
    result_.table += "\n";
    Named<std::string> lines = concessions();
    for (const auto& [token, r] : failures_) lines.emplace_back(token, std::to_string(r.code) + "  " + r.reason);
    std::size_t width = 0;
    for (const auto& [token, line] : lines) width = std::max(width, token.size());
    for (const auto& [token, line] : lines)
      result_.table += token + std::string(width + 2 - token.size(), ' ') + line + "\n";
    nlohmann::ordered_json json = counts();
    json["built"] = result_.built;
    json["failed"] = result_.failed;
    json["under_way"] = result_.under_way;
    json["wall_s"] = std::chrono::duration<double>(Clock::now() - begin_).count();
    json["jobs_at_once"] = at_once_;
    json["jobs"] = nlohmann::ordered_json::object();
    for (const auto& [name, r] : results_)
      json["jobs"][name] = {{"code", r.code}, {"seconds", r.seconds}, {"cpu_s", r.cpu_s}, {"memory_mb", r.memory_mb}};
    json["failures"] = nlohmann::ordered_json::object();
    for (const auto& [token, r] : failures_) json["failures"][token] = {{"code", r.code}, {"reason", r.reason}};
    result_.json = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  }
  nlohmann::ordered_json counts() const {
    nlohmann::ordered_json json = {{"cases", result_.cases}, {"fresh", result_.fresh}};
    json["stale"] = nlohmann::ordered_json::object();
    for (const PlannedCase& c : plan_.cases)
      if (!c.reasons.empty()) json["stale"][c.token] = c.reasons;
    return json;
  }

  void tell_plan() {
    std::string lines;
    int stale = 0;
    result_.cases = static_cast<int>(plan_.cases.size());
    for (const PlannedCase& c : plan_.cases) {
      if (c.fault) {
        lines += c.token + ": cannot be built: " + text_of(*c.fault) + "\n";
        ++result_.failed;
        if (result_.code == 0) result_.code = static_cast<int>(c.fault->code());
        continue;
      }
      result_.fresh += c.reasons.empty();
      stale += !c.reasons.empty();
      for (std::size_t i = 0; i < std::min(max_reasons, c.reasons.size()); ++i)
        lines += (i == 0 ? c.token + ": " : std::string(c.token.size() + 2, ' ')) + c.reasons[i] + "\n";
      if (c.reasons.size() > max_reasons)
        lines += std::string(c.token.size() + 2, ' ') + "and " + std::to_string(c.reasons.size() - max_reasons) +
                 " more; --why " + c.token + " tells them\n";
    }
    result_.table = std::to_string(stale) + " of " + std::to_string(result_.cases) + " cases would be built, " +
                    std::to_string(result_.failed) + " cannot be";
    if (stale > 0) result_.table += "; " + publish::megabytes_text(needed_disk_mb()) + " of disk by estimate";
    result_.table += "\n" + lines;
    result_.json = counts().dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  }

  void tell_why() {
    for (const PlannedCase& c : plan_.cases) {
      result_.table += c.token + ":";
      if (c.fault) {
        result_.table += " cannot be built: " + text_of(*c.fault) + "\n";
      } else if (c.reasons.empty()) {
        result_.table += " is up to date\n";
      } else {
        result_.table += " would be built\n";
        for (const std::string& r : c.reasons) result_.table += "  " + r + "\n";
      }
      if (const auto last = read_result(state_, c.token); last && last->code != 0)
        result_.table += "  its last build failed with " + std::to_string(last->code) + ": " + last->reason + "\n";
    }
    result_.json = counts().dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  }

  const LibraryBuildRequest& request_;
  LibraryObserver& observer_;
  const LibraryState state_;
  LibraryConfig config_;
  LibraryPlan plan_;
  LibraryBuildResult result_;
  const Clock::time_point begin_ = Clock::now();
  Clock::time_point start_, last_end_;
  std::vector<std::string> running_;
  std::set<std::string> under_way_;  // names of jobs that the cluster still has
  std::map<std::string, TimelineItem> timeline_;
  std::map<std::string, JobResult> results_;
  std::map<std::string, double> weights_;
  std::vector<std::pair<std::string, JobResult>> failures_;
  double done_weight_ = 0;
  int done_ = 0, failed_ = 0, at_once_ = 0;
  bool told_full_ = false;
};

}  // namespace

LibraryBuildResult build_library(const LibraryBuildRequest& request, LibraryObserver& observer) {
  return Build(request, observer).run();
}

}  // namespace trephine::library
