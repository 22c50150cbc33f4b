// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "library/job.h"
#include "library/library_state.h"

namespace trephine::library {

/// What a library build has handed to Slurm, in LIBRARY/.library/slurm/BATCH/ (mode 0700), so that whoever submitted it
/// may leave:
///   batch.json           what follows here; holds names of jobs and figures only
///   cancelled            is there where a person ended it
///   jobs.jsonl           every job with its words, and with them the paths of series: mode 0600, removed at the end
///   tasks-K.jsonl        the jobs of one array, a line each, likewise
///   begun/, ended/       a record of each job's last try, by its name, written by the node
///   array-K.log          what Slurm itself said of the tasks

struct BatchJob {
  std::string name;
  int wave = 0;  ///< it begins when all jobs of the waves before have ended
  int memory_mb = 0;
  double time_limit_s = 0;  ///< 0: none
  std::string partition;
  int tries = 0;  ///< how often it was submitted
  bool is_phantom = false, needs_phantom = false;
  std::string token;
};

/// One array: its number in Slurm (empty while it is submitted) and the names of its jobs by their index.
struct BatchArray {
  std::string slurm;
  int wave = 0;
  std::vector<std::string> names;
};

/// What Slurm grants to a job.
struct BatchClass {
  int memory_mb = 0;
  double time_limit_s = 0;  ///< 0: none
  std::string partition;
};

struct Batch {
  std::string id;
  std::filesystem::path folder;
  std::vector<BatchJob> jobs;
  std::vector<BatchArray> arrays;
  std::vector<BatchClass> classes;  ///< by memory, rising; none: any power of two of 256 MB
  std::string finish;               ///< the number of the job that ends the batch
  std::string partition, account;
  std::vector<std::string> options;
  int max_array = 1000, at_once = 0, max_tries = 1;
  std::int64_t cache_limit_mb = 0;
  bool sheet = true;
  bool finished = false, cancelled = false;

  std::string slurm_name() const { return "trephine-" + id; }
  bool is_open() const { return !finished && !cancelled; }
};

/// How a job's last try ended, or that it began.
struct TaskRecord {
  int attempt = 0;
  std::string node;
  double begin_s = 0, end_s = 0;  ///< seconds since the epoch by the node's clock; end_s 0: it has not ended
  JobResult result;
};

std::filesystem::path batches_folder(const LibraryState& state);
/// The batches that are there, the oldest first; with `open` only those that are neither finished nor cancelled.
/// Damaged ones are left out.
std::vector<Batch> read_batches(const LibraryState& state, bool open);
std::optional<Batch> read_batch(const std::filesystem::path& folder);
/// Makes a folder with a new name for it. Throws Error 73.
Batch new_batch(const LibraryState& state);
/// All but `cancelled`. Throws Error 73 and 74.
void write_batch(const Batch& batch);
/// Says beside it that the batch is cancelled, in a file of its own: whoever read the batch before, as its last job may
/// have, and writes it again, takes nothing of that back. Throws Error 73 and 74.
void mark_cancelled(const Batch& batch);
/// The file whose time is when the batch was changed last.
std::filesystem::path changed_last(const Batch& batch);

void write_jobs(const std::filesystem::path& file, const std::vector<LibraryJob>& jobs);
std::map<std::string, LibraryJob> read_jobs(const std::filesystem::path& file);
/// The job in line `index` (from 0). Throws Error 64 where there is none, 66 and 65.
LibraryJob read_job(const std::filesystem::path& file, int index);
std::filesystem::path jobs_file(const Batch& batch);
std::filesystem::path tasks_file(const std::filesystem::path& batch_folder, int array);

/// Removes what holds paths of series.
void remove_words(const Batch& batch);

std::optional<TaskRecord> read_task(const std::filesystem::path& batch_folder, const char* which,
                                    const std::string& name);
void write_task(const std::filesystem::path& batch_folder, const char* which, const std::string& name,
                const TaskRecord& record);
constexpr const char *task_begun = "begun", *task_ended = "ended";

/// The job in the next class that grants more of what it lacked; nothing where there is no such class.
std::optional<BatchJob> with_more(const Batch& batch, const BatchJob& job, Lack lack);

/// Whether the same job may end otherwise when it is tried again, in a larger class where it lacked something: it did
/// not fail by its data or configuration.
bool may_pass_next_time(const Batch& batch, const BatchJob& job, const JobResult& result);

}  // namespace trephine::library
