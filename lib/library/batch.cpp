// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/batch.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "base/error.h"
#include "base/exit_code.h"
#include "base/write_file.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t max_bytes = std::uint64_t{1} << 28;
constexpr const char* state_file = "batch.json";
constexpr const char* cancelled_file = "cancelled";

// Sorted by name they are sorted by age, as far as the clocks of the hosts that submit agree.
std::string new_id() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  std::random_device source;
  char text[32];
  std::snprintf(text, sizeof text, "%012llx%04x",
                static_cast<unsigned long long>(std::chrono::duration_cast<std::chrono::milliseconds>(now).count()),
                static_cast<unsigned>(source()) & 0xffffu);
  return text;
}

}  // namespace

// What the files hold: each struct's fields, by their names.
NLOHMANN_JSON_SERIALIZE_ENUM(Lack, {{Lack::nothing, ""}, {Lack::memory, "memory"}, {Lack::time, "time"}})
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(JobResult, code, reason, seconds, memory_mb, cpu_s, lack, signal)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TaskRecord, attempt, node, begin_s, end_s, result)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BatchJob, name, token, wave, memory_mb, time_limit_s, partition, tries, is_phantom,
                                   needs_phantom)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BatchArray, slurm, wave, names)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BatchClass, memory_mb, time_limit_s, partition)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Batch, finish, partition, account, options, max_array, at_once, max_tries,
                                   cache_limit_mb, sheet, finished, classes, arrays, jobs)

namespace {

template <class T>
std::optional<T> read_object(const fs::path& file) {
  try {
    const std::vector<char> bytes = read_file(file, max_bytes);
    return nlohmann::json::parse(bytes.begin(), bytes.end()).get<T>();
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    return {};
  }
}

template <class T>
void write_object(const fs::path& file, const T& object) {
  write_file(file, nlohmann::json(object).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

// Only its owner may read it: it lies in a folder that only he may enter, too.
void make_private(const fs::path& file) {
  std::error_code ignored;
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write, ignored);
}

fs::path record_file(const fs::path& folder, const char* which, const std::string& name) {
  return folder / which / (name + ".json");
}

}  // namespace

fs::path batches_folder(const LibraryState& state) { return state.folder() / "slurm"; }
fs::path jobs_file(const Batch& batch) { return batch.folder / "jobs.jsonl"; }
fs::path tasks_file(const fs::path& folder, int array) {
  return folder / ("tasks-" + std::to_string(array) + ".jsonl");
}

std::optional<Batch> read_batch(const fs::path& folder) {
  std::optional<Batch> b = read_object<Batch>(folder / state_file);
  if (!b) return {};
  b->folder = folder;
  b->id = folder.filename().string();
  b->cancelled = fs::exists(folder / cancelled_file);
  return b;
}

std::vector<Batch> read_batches(const LibraryState& state, bool open) {
  std::vector<fs::path> folders;
  std::error_code error;
  for (fs::directory_iterator it(batches_folder(state), error), end; !error && it != end; it.increment(error))
    folders.push_back(it->path());
  std::sort(folders.begin(), folders.end());
  std::vector<Batch> all;
  for (const fs::path& folder : folders)
    if (auto batch = read_batch(folder); batch && (!open || batch->is_open())) all.push_back(std::move(*batch));
  return all;
}

Batch new_batch(const LibraryState& state) {
  Batch b;
  b.id = new_id();
  b.folder = batches_folder(state) / b.id;
  for (const fs::path& folder : {batches_folder(state), b.folder, b.folder / task_begun, b.folder / task_ended}) {
    make_output_folder(folder);
    std::error_code ignored;
    fs::permissions(folder, fs::perms::owner_all, ignored);
  }
  return b;
}

void write_batch(const Batch& b) { write_object(b.folder / state_file, b); }

void mark_cancelled(const Batch& b) { write_file(b.folder / cancelled_file, ""); }

fs::path changed_last(const Batch& b) { return b.folder / (b.cancelled ? cancelled_file : state_file); }

void write_jobs(const fs::path& file, const std::vector<LibraryJob>& jobs) {
  std::string text;
  for (const LibraryJob& job : jobs) text += job_line(job);
  write_file(file, text);
  make_private(file);
}

std::map<std::string, LibraryJob> read_jobs(const fs::path& file) {
  std::map<std::string, LibraryJob> all;
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Error(ExitCode::no_input, file.string(), "", "the words of the batch's jobs are gone");
  for (std::string line; std::getline(in, line);) {
    LibraryJob job = parse_job_line(line);
    all[job.name] = std::move(job);
  }
  return all;
}

LibraryJob read_job(const fs::path& file, int index) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Error(ExitCode::no_input, file.string(), "", "the words of the array's jobs are gone");
  std::string line;
  for (int i = 0; i <= index; ++i)
    if (!std::getline(in, line)) throw Error(ExitCode::usage, file.string(), std::to_string(index), "no such job");
  return parse_job_line(line);
}

void remove_words(const Batch& batch) {
  std::error_code ignored;
  fs::remove(jobs_file(batch), ignored);
  for (std::size_t k = 0; k < batch.arrays.size(); ++k)
    fs::remove(tasks_file(batch.folder, static_cast<int>(k)), ignored);
}

std::optional<TaskRecord> read_task(const fs::path& folder, const char* which, const std::string& name) {
  std::error_code ignored;
  if (!fs::exists(record_file(folder, which, name), ignored)) return {};
  return read_object<TaskRecord>(record_file(folder, which, name));
}

void write_task(const fs::path& folder, const char* which, const std::string& name, const TaskRecord& r) {
  write_object(record_file(folder, which, name), r);
}

std::optional<BatchJob> with_more(const Batch& batch, const BatchJob& job, Lack lack) {
  constexpr int max_mb = 1 << 30;
  BatchJob more = job;
  if (batch.classes.empty() && lack == Lack::memory && job.memory_mb < max_mb) {
    more.memory_mb *= 2;
    return more;
  }
  const auto grants_more = [&](const BatchClass& c) {
    return lack == Lack::memory
               ? c.memory_mb > job.memory_mb
               : lack == Lack::time && c.memory_mb >= job.memory_mb && c.time_limit_s > job.time_limit_s;
  };
  // One with more memory and less time would end the next try by its limit; it is better than none.
  const BatchClass* chosen = nullptr;
  for (const BatchClass& c : batch.classes)
    if (grants_more(c) &&
        (!chosen || (chosen->time_limit_s < job.time_limit_s && c.time_limit_s > chosen->time_limit_s)))
      chosen = &c;
  if (!chosen) return {};
  more.memory_mb = chosen->memory_mb;
  more.time_limit_s = chosen->time_limit_s;
  more.partition = chosen->partition;
  return more;
}

bool may_pass_next_time(const Batch& batch, const BatchJob& job, const JobResult& result) {
  if (result.lack != Lack::nothing) return with_more(batch, job, result.lack).has_value();
  switch (static_cast<ExitCode>(result.code)) {
    case ExitCode::internal:  // our own faults, and a time that is up, come again
      return result.signal != 0;
    case ExitCode::cannot_create:  // a disk that is full or away
    case ExitCode::io:
    case ExitCode::busy:
    case ExitCode::cancelled:
      return true;
    case ExitCode::no_input:
      return job.needs_phantom;  // which is tried again, too
    default:
      return false;
  }
}

}  // namespace trephine::library
