// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/slurm_engine.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "base/error.h"
#include "base/lease.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/spawn.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cluster/slurm.h"
#include "library/build_jobs.h"
#include "library/keeping.h"
#include "library/sheet.h"
#include "library/timeline.h"
#include "pipeline/stage_cache.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

constexpr int last_job_memory_mb = 1024;
constexpr double last_job_patience_s = 600, last_job_pause_s = 3;

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// sbatch reads a script; it holds the program, the batch's folder and a number.
fs::path write_script(const Batch& batch, const std::string& name, const std::string& words) {
  const fs::path file = batch.folder / (name + ".sh");
  write_file(file, "#!/bin/sh\nexec " + quoted(own_program().string()) + " library " + words + "\n");
  return file;
}

double now_s() { return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count(); }

std::string node_name() {
  if (const char* said = std::getenv("SLURMD_NODENAME")) return said;
  char name[256] = "";
  return ::gethostname(name, sizeof name - 1) == 0 ? name : "";
}

BatchJob& job_named(Batch& batch, const std::string& name) {
  const auto found =
      std::find_if(batch.jobs.begin(), batch.jobs.end(), [&](const BatchJob& j) { return j.name == name; });
  if (found == batch.jobs.end()) throw Error(ExitCode::internal, batch.folder.string(), name, "no such job");
  return *found;
}

// Ends a batch of which nothing runs any more.
class Ending {
 public:
  Ending(const LibraryState& state, Batch& batch, const std::vector<cluster::SlurmTask>& tasks)
      : state_(state), batch_(batch), ended_(ended_tasks(batch)) {
    std::vector<std::string> arrays;
    for (const BatchArray& a : batch.arrays) arrays.push_back(a.slurm);
    if (ended_.size() < batch.jobs.size()) lacks_ = lacks_of(batch, cluster::accounted_tasks(arrays));
    for (const auto& [name, lack] : lacks_of(batch, tasks)) lacks_[name] = lack;
  }

  // What must be submitted again; the others' records are final afterwards.
  std::set<std::string> lost() {
    std::set<std::string> names;
    const auto jobs = read_jobs(jobs_file(batch_));
    for (BatchJob& j : batch_.jobs) {
      if (is_final(batch_, j, ended_)) continue;
      const auto job = jobs.find(j.name);
      // The node died after it had published, or could not write its record.
      if (job != jobs.end() && is_done_already(job->second)) {
        conclude(j, {});
        continue;
      }
      const Lack lack = lack_of_last_try(j);
      const auto more = lack == Lack::nothing ? std::optional<BatchJob>(j) : with_more(batch_, j, lack);
      if (job == jobs.end() || !more || j.tries >= batch_.max_tries) {
        conclude(j, last_result(j, lack));
        continue;
      }
      if (lack != Lack::nothing)
        log_line(j.name + ": " + wanted(j, lack) + "; again with " + to_text(more->memory_mb) + " MB" +
                 (more->time_limit_s > 0 ? ", " + to_text(more->time_limit_s) + " s" : ""));
      j = *more;
      names.insert(j.name);
    }
    return names;
  }

  // Reads every byte of what was built. What is damaged must be submitted again, or failed.
  std::set<std::string> damaged() {
    std::set<std::string> names;
    std::vector<std::string> tokens;
    std::map<std::string, const BatchJob*> by_token;
    for (const BatchJob& j : batch_.jobs)
      if (const auto r = ended_.find(j.name); !j.is_phantom && r != ended_.end() && r->second.result.code == 0) {
        tokens.push_back(j.token);
        by_token[j.token] = &j;
      }
    if (tokens.empty()) return names;
    const VerifyResult verified = verify_library(state_.library(), tokens, false, Progress({}, &cancel_requested()));
    for (const auto& [token, fault] : verified.faults) {
      const BatchJob& j = *by_token.at(token);
      std::error_code ignored;
      fs::remove(state_.case_file(token, "built"), ignored);
      const JobResult result{static_cast<int>(ExitCode::bad_input), "damaged after it was published: " + fault, 0, 0,
                             0};
      if (j.tries < batch_.max_tries) {
        fs::remove(batch_.folder / task_ended / (j.name + ".json"), ignored);
        names.insert(j.name);
      } else {
        conclude(j, result);
      }
    }
    return names;
  }

  void end() {
    if (batch_.sheet) try {
        make_sheet(state_.library());
      } catch (const Error& e) {
        log_warning(std::string("the contact sheet could not be made: ") + e.what());
      }
    pipeline::StageCache(state_.library() / library_cache_name)
        .shrink_to(static_cast<std::uint64_t>(batch_.cache_limit_mb) * 1'000'000);
    keep_timeline(state_, timeline_of(batch_));
    batch_.finished = true;
    write_batch(batch_);
    remove_words(batch_);
  }

 private:
  // The record of the last try, where there is one.
  const TaskRecord* record_of_last_try(const BatchJob& j) const {
    const auto found = ended_.find(j.name);
    return found == ended_.end() || found->second.attempt < j.tries ? nullptr : &found->second;
  }
  Lack lack_of_last_try(const BatchJob& j) const {
    const TaskRecord* record = record_of_last_try(j);
    if (record && record->result.lack != Lack::nothing) return record->result.lack;
    const auto said = lacks_.find(j.name);
    return said == lacks_.end() ? Lack::nothing : said->second;
  }
  static std::string wanted(const BatchJob& j, Lack lack) {
    return lack == Lack::memory ? "took more than the " + to_text(j.memory_mb) + " MB that Slurm grants it"
                                : "took more than the " + to_text(j.time_limit_s) + " s that Slurm grants it";
  }
  JobResult last_result(const BatchJob& j, Lack lack) const {
    const TaskRecord* record = record_of_last_try(j);
    JobResult result = record ? record->result : JobResult{};
    const std::string tries = to_text(j.tries) + (j.tries == 1 ? " try" : " tries");
    if (lack != Lack::nothing)
      result.reason = wanted(j, lack) + ", in " + tries +
                      (j.tries >= batch_.max_tries ? "" : "; no class of the engine grants more");
    else if (!record)
      result.reason = "lost in " + tries + ": its node died, or Slurm ended it (array-*.log)";
    if (lack != Lack::nothing || !record) result.code = static_cast<int>(ExitCode::internal);
    result.lack = lack;
    return result;
  }

  void conclude(const BatchJob& j, const JobResult& result) {
    TaskRecord record;
    if (const auto before = ended_.find(j.name); before != ended_.end()) record = before->second;
    record.attempt = batch_.max_tries;  // final, whatever its code
    record.result = result;
    if (record.end_s <= 0) record.end_s = now_s();
    write_task(batch_.folder, task_ended, j.name, record);
    if (!j.is_phantom) write_result(state_, j.token, result);
    ended_[j.name] = record;
  }

  const LibraryState& state_;
  Batch& batch_;
  std::map<std::string, TaskRecord> ended_;
  std::map<std::string, Lack> lacks_;
};

}  // namespace

std::map<std::string, TaskRecord> ended_tasks(const Batch& batch) {
  std::map<std::string, TaskRecord> all;
  for (const BatchJob& j : batch.jobs)
    if (const auto r = read_task(batch.folder, task_ended, j.name)) all[j.name] = *r;
  return all;
}

bool is_final(const Batch& batch, const BatchJob& job, const std::map<std::string, TaskRecord>& ended) {
  const auto found = ended.find(job.name);
  if (found == ended.end()) return false;
  const TaskRecord& r = found->second;
  return r.result.code == 0 || !may_pass_next_time(batch, job, r.result) || r.attempt >= batch.max_tries;
}

Lack lack_of(const cluster::SlurmTask& task) {
  if (task.state.rfind("OUT_OF_ME", 0) == 0) return Lack::memory;
  return task.state == "TIMEOUT" ? Lack::time : Lack::nothing;
}

std::map<std::string, Lack> lacks_of(const Batch& batch, const std::vector<cluster::SlurmTask>& tasks) {
  std::map<std::string, Lack> lacks;
  for (const BatchArray& a : batch.arrays) {  // in the order of the tries: the last one counts
    for (const std::string& name : a.names) lacks.erase(name);
    for (const cluster::SlurmTask& t : tasks)
      if (t.array == a.slurm && t.index >= 0 && static_cast<std::size_t>(t.index) < a.names.size())
        if (const Lack lack = lack_of(t); lack != Lack::nothing)
          lacks[a.names[static_cast<std::size_t>(t.index)]] = lack;
  }
  return lacks;
}

void close_batch(const Batch& batch) {
  mark_cancelled(batch);
  remove_words(read_batch(batch.folder).value_or(batch));
}

void submit_jobs(Batch& batch, const std::set<std::string>& names, double patience_s) {
  const auto jobs = read_jobs(jobs_file(batch));
  std::map<int, std::vector<std::string>> numbers;  // of the arrays, by wave
  std::vector<std::string> all;
  for (BatchArray& array : part_into_arrays(batch, names)) {
    const int k = static_cast<int>(batch.arrays.size());
    std::vector<LibraryJob> tasks;
    for (const std::string& name : array.names) {
      tasks.push_back(jobs.at(name));
      BatchJob& job = job_named(batch, name);
      ++job.tries;
      tasks.back().time_limit_s = job.time_limit_s;
    }
    write_jobs(tasks_file(batch.folder, k), tasks);
    const fs::path script = write_script(batch, "array-" + std::to_string(k),
                                         "task " + quoted(batch.folder.string()) + " " + std::to_string(k));
    std::vector<std::string> before;
    for (const auto& [wave, of_wave] : numbers)
      if (wave < array.wave) before.insert(before.end(), of_wave.begin(), of_wave.end());
    std::vector<std::string> options =
        options_of_array(batch, job_named(batch, array.names.front()), array.names.size(), before);
    options.push_back("--chdir=" + batch.folder.string());
    options.push_back("--output=" + (batch.folder / ("array-" + std::to_string(k) + ".log")).string());
    batch.arrays.push_back(array);
    write_batch(batch);  // the tries count before they are made: a submission that is broken off is one
    try {
      batch.arrays.back().slurm = cluster::submit_to_slurm(options, script.string(), patience_s);
    } catch (const Error& e) {
      for (const std::string& name : array.names) --job_named(batch, name).tries;
      batch.arrays.pop_back();
      write_batch(batch);
      if (all.empty()) throw;
      log_warning(std::string("sbatch ") + e.what() + "; the rest is submitted when those before have ended");
      break;
    }
    write_batch(batch);
    numbers[array.wave].push_back(batch.arrays.back().slurm);
    all.push_back(batch.arrays.back().slurm);
  }
  BatchJob last;
  last.memory_mb = last_job_memory_mb;
  std::vector<std::string> options = options_of_array(batch, last, 0, all);
  options.push_back("--chdir=" + batch.folder.string());
  options.push_back("--output=" + (batch.folder / "last.log").string());
  const fs::path script = write_script(batch, "last", "finish " + quoted(batch.folder.string()));
  try {
    batch.finish = cluster::submit_to_slurm(options, script.string(), patience_s);
  } catch (const Error& e) {
    log_warning(
        std::string("sbatch ") + e.what() +
        "; no job of Slurm's ends this build: leave it running, or `library build` again when the jobs have ended");
  }
  write_batch(batch);
}

BatchStep advance_batch(const LibraryState& state, const std::string& id, bool as_last_job) {
  const fs::path folder = batches_folder(state) / id;
  std::optional<Lease> lease;
  try {
    lease.emplace(folder);
  } catch (const Error& e) {
    if (e.code() == ExitCode::busy) return BatchStep::under_way;
    throw;
  }
  std::optional<Batch> batch = read_batch(folder);
  if (!batch) throw Error(ExitCode::io, folder.string(), "batch.json", "is missing or damaged: `library build` again");
  if (!batch->is_open()) return BatchStep::finished;
  const auto tasks = cluster::tasks_of_slurm(batch->slurm_name());
  if (!tasks) return BatchStep::not_known;
  const bool waits = std::any_of(tasks->begin(), tasks->end(), [&](const cluster::SlurmTask& t) {
    return cluster::is_alive(t) && (!as_last_job || t.array != batch->finish);
  });
  if (waits) return BatchStep::under_way;
  Ending ending(state, *batch, *tasks);
  std::set<std::string> again = ending.lost();
  if (again.empty()) again = ending.damaged();
  if (again.empty()) {
    ending.end();
    return BatchStep::finished;
  }
  try {
    submit_jobs(*batch, again, last_job_patience_s);
  } catch (const Error& e) {
    // What is left of it is stale, and the next build submits it with the options of then.
    close_batch(*batch);
    throw Error(e.code(), e.file(), e.field(), std::string(e.what()) + "; `library build` again submits what is left");
  }
  return BatchStep::resubmitted;
}

int run_last_slurm_job(const fs::path& folder) {
  const fs::path plain = folder.has_filename() ? folder : folder.parent_path();
  const LibraryState state(plain.parent_path().parent_path().parent_path());
  const auto start = std::chrono::steady_clock::now();
  BatchStep step = BatchStep::not_known;
  do {
    if (step != BatchStep::not_known || std::chrono::steady_clock::now() - start > std::chrono::seconds(1))
      std::this_thread::sleep_for(std::chrono::duration<double>(last_job_pause_s));
    if (cancel_requested()) throw Cancelled{};
    step = advance_batch(state, plain.filename().string(), true);
  } while ((step == BatchStep::under_way || step == BatchStep::not_known) &&
           std::chrono::steady_clock::now() - start < std::chrono::duration<double>(last_job_patience_s));
  return step == BatchStep::finished || step == BatchStep::resubmitted ? 0 : static_cast<int>(ExitCode::busy);
}

int run_slurm_task(const fs::path& folder, int array) {
  const char* said = std::getenv("SLURM_ARRAY_TASK_ID");
  const auto index = said ? parse_integer(said) : std::nullopt;
  if (!index || *index < 0 || *index > 10'000'000)
    throw Error(ExitCode::usage, "", "library task", "is started by Slurm only, for `library build --engine slurm`");
  LibraryJob job = read_job(tasks_file(folder, array), static_cast<int>(*index));
  job.on_node = true;
  job.keep_going = false;
  TaskRecord record;
  record.attempt = 1;
  if (const auto batch = read_batch(folder))
    for (const BatchJob& j : batch->jobs)
      if (j.name == job.name) record.attempt = std::max(j.tries, 1);
  record.node = node_name();
  record.begin_s = now_s();
  write_task(folder, task_begun, job.name, record);
  record.result = do_library_job(job);
  record.end_s = now_s();
  if (!job.is_phantom) write_result(LibraryState(job.library), job.token, record.result);
  write_task(folder, task_ended, job.name, record);
  return record.result.code;
}

int cancel_batches(const LibraryState& state) {
  int count = 0;
  for (const Batch& open : read_batches(state, true)) {
    cluster::cancel_in_slurm(open.slurm_name());
    // The last job may have submitted more a moment ago: it looks again before it does.
    close_batch(open);
    cluster::cancel_in_slurm(open.slurm_name());
    ++count;
  }
  return count;
}

}  // namespace trephine::library
