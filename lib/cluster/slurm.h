// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace trephine::cluster {

/// Slurm, by its own programs: sbatch, squeue, scancel, scontrol. Nothing that they are given holds a path of a series.

/// One task of a job array that waits or runs; a job that is no array has the index -1.
struct SlurmTask {
  std::string array;  ///< the number of the array's job
  int index = -1;
  std::string state, node;  ///< PENDING, RUNNING, COMPLETING, ...; the node is empty while it waits
  std::string reason{};     ///< why it waits, in Slurm's word: Resources, JobHeldUser; "": none was said
};

/// Whether the task still waits or runs; one that is COMPLETING has ended, though its node may not have said so yet.
bool is_alive(const SlurmTask& task);

/// What `sbatch --parsable` said: the job's number, also where warnings stand around it. Empty where there is none.
std::string parse_submitted(const std::string& said);
/// What `squeue --noheader --array --format=%F|%K|%T|%N|%r` said, the last ones left out or not; lines of another form
/// are left out.
std::vector<SlurmTask> parse_tasks(const std::string& said);
/// MaxArraySize in what `scontrol show config` said; 0 where it is not there.
long parse_max_array(const std::string& said);

/// Submits a script and returns the job's number. While the controller does not answer, it is asked again for
/// `patience_s`. Throws Error 70 where sbatch is missing or refuses, with its own words; Cancelled.
std::string submit_to_slurm(const std::vector<std::string>& options, const std::string& script, double patience_s);

/// The tasks of that name that wait or run, and those that ended as long as the controller remembers them (MinJobAge);
/// nothing where it does not answer. Throws Error 70 where squeue is missing.
std::optional<std::vector<SlurmTask>> tasks_of_slurm(const std::string& job_name);

/// The same of these arrays, as Slurm's accounting knows them, which forgets nothing; none where it keeps no accounts.
std::vector<SlurmTask> accounted_tasks(const std::vector<std::string>& arrays);
/// What `sacct --allocations --format=JobID,State,NodeList` said, with --parsable2; other lines are left out.
std::vector<SlurmTask> parse_accounts(const std::string& said);

/// Ends all tasks of that name. Throws Error 70 where scancel is missing or refuses.
void cancel_in_slurm(const std::string& job_name);

/// The cluster's MaxArraySize; 0 where it cannot be told.
long max_array_of_slurm();

}  // namespace trephine::cluster
