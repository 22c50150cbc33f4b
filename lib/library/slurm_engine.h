// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <set>
#include <string>
#include <vector>

#include "cluster/slurm.h"
#include "library/batch.h"
#include "library/build.h"
#include "library/ninja.h"

namespace trephine::library {

/// A library build by Slurm (docs/how-to/cluster.md). Stale cases become job arrays: first those that others wait for
/// (phantoms; of one patient's cases the first), parted by classes of memory and time, in chunks that the cluster
/// accepts. A task is one `trephine run` in the node's own temporary folder, whose case is then published in the
/// library. A last job submits again what was lost, with more memory or time where it was ended for want of it,
/// verifies every byte, and makes the index.

/// The batch that does these jobs, with its jobs' waves and classes; nothing is written and nothing submitted. A job
/// without a class that is large enough gets the largest.
Batch plan_batch(const std::vector<NinjaJob>& jobs, const EngineParams& engine, const LibraryBuildParams& params);

/// The options of sbatch for an array of jobs of one class, or for a single job (count 0), without its script.
std::vector<std::string> options_of_array(const Batch& batch, const BatchJob& first, std::size_t count,
                                          const std::vector<std::string>& after);

/// Parts names into arrays: of one wave and class each, at most max_array long, in the order of the batch.
std::vector<BatchArray> part_into_arrays(const Batch& batch, const std::set<std::string>& names);

/// Submits these jobs of the batch and a last job after them; batch.json is written after each step, so that a
/// submission that is broken off is continued by advance_batch. Where sbatch refuses an array after it took others, or
/// the last job, advance_batch goes on with the rest. Throws Error 70, 73, 74; Cancelled.
void submit_jobs(Batch& batch, const std::set<std::string>& names, double patience_s);

/// Nothing of the batch is submitted any more, and what it did not build is stale.
void close_batch(const Batch& batch);

enum class BatchStep {
  under_way,    ///< tasks wait or run, or another process works on the batch
  not_known,    ///< Slurm's controller does not answer
  resubmitted,  ///< nothing ran any more and something was lost: it was submitted again
  finished,     ///< everything is there, or failed for good; verified, and the index made
};
/// Brings a batch on: looks whether its tasks still run; then submits again what has neither a result nor a case that
/// is built (its node died, or the disk was full), as often as the batch allows; or ends it. `as_last_job`: the caller
/// is the batch's last job, which Slurm therefore still lists. Throws Error 70, 73, 74.
BatchStep advance_batch(const LibraryState& state, const std::string& id, bool as_last_job);

/// How each job of the batch stands: its last try's record, or nothing. A job whose record is final is done.
std::map<std::string, TaskRecord> ended_tasks(const Batch& batch);
bool is_final(const Batch& batch, const BatchJob& job, const std::map<std::string, TaskRecord>& ended);
/// What the last try of a job lacked, by its name, as Slurm's states of the tasks say; others are left out.
std::map<std::string, Lack> lacks_of(const Batch& batch, const std::vector<cluster::SlurmTask>& tasks);
/// What Slurm ended the task for want of.
Lack lack_of(const cluster::SlurmTask& task);

/// What a task of an array runs: the job of this index (SLURM_ARRAY_TASK_ID). Returns the job's exit code. Throws Error
/// 64 where it was not started by Slurm.
int run_slurm_task(const std::filesystem::path& batch_folder, int array);

/// What the batch's last job runs: advance_batch, for some minutes also while Slurm does not answer.
int run_last_slurm_job(const std::filesystem::path& batch_folder);

/// Ends all open batches: their tasks are killed, and cases that are published stay as they are. Returns how many
/// batches there were. Throws Error 70.
int cancel_batches(const LibraryState& state);

/// What Build hands to Slurm: submits what is not under way already, and, unless params.wait is off, stays until all is
/// done. Calls `event` for every job that ended for good. Returns the names of the jobs that are still under way.
/// Throws Error 75 where a case is under way with other settings; 70, 73, 74; Cancelled, and what was submitted goes
/// on.
std::set<std::string> build_with_slurm(const LibraryState& state, const EngineParams& engine,
                                       const LibraryBuildParams& params, const std::vector<NinjaJob>& jobs,
                                       const std::function<void(const JobEvent&)>& event,
                                       const std::function<void()>& tick);

}  // namespace trephine::library
