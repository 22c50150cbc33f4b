// SPDX-License-Identifier: GPL-3.0-or-later
// Which jobs make which arrays, and what sbatch is told of them. Nothing here asks Slurm.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "library/slurm_engine.h"

namespace trephine::library {
namespace {

constexpr int smallest_class_mb = 256, largest_default_array = 1000;
constexpr double memory_margin = 1.15;  // Slurm kills what takes more than it was granted
constexpr double grace_s = 180;         // our own limit is to be met first, and its reason told

std::vector<BatchClass> classes_of(const EngineParams& engine, const LibraryBuildParams& params) {
  std::vector<BatchClass> out;
  for (const EngineClassParams& c : engine.classes)
    out.push_back({static_cast<int>(c.memory_mb),
                   params.case_limit_s > 0 ? std::min(c.time_limit_s, params.case_limit_s) : c.time_limit_s,
                   c.partition});
  return out;
}

void classify(const std::vector<BatchClass>& classes, double case_limit_s, double estimate_mb, BatchJob& job) {
  const double need_mb = memory_margin * estimate_mb;
  if (classes.empty()) {
    job.time_limit_s = case_limit_s;
    job.memory_mb = smallest_class_mb;
    while (job.memory_mb < need_mb) job.memory_mb *= 2;
    return;
  }
  const BatchClass* chosen = &classes.back();
  for (auto it = classes.rbegin(); it != classes.rend(); ++it)
    if (it->memory_mb >= need_mb) chosen = &*it;
  job.memory_mb = chosen->memory_mb;
  job.partition = chosen->partition;
  job.time_limit_s = chosen->time_limit_s;
}

std::string minutes(double limit_s) { return std::to_string(static_cast<long>(std::ceil((limit_s + grace_s) / 60))); }

}  // namespace

Batch plan_batch(const std::vector<NinjaJob>& jobs, const EngineParams& engine, const LibraryBuildParams& params) {
  Batch batch;
  batch.partition = engine.partition;
  batch.account = engine.account;
  for (const config::SaidValue& option : engine.sbatch) batch.options.push_back(option.text);
  batch.max_array = engine.max_array_count > 0 ? static_cast<int>(engine.max_array_count) : largest_default_array;
  batch.at_once = static_cast<int>(engine.at_once_count);
  batch.max_tries = 1 + static_cast<int>(engine.resubmissions_count);
  batch.cache_limit_mb = params.cache_limit_mb;
  batch.sheet = params.sheet;
  batch.classes = classes_of(engine, params);
  std::map<std::string, int> waves;  // jobs stand after those that they wait for
  for (const NinjaJob& j : jobs) {
    BatchJob one;
    one.name = j.job.name;
    one.token = j.job.token;
    one.is_phantom = j.job.is_phantom;
    one.needs_phantom = !j.job.phantom.empty();
    for (const std::string& before : j.after)
      if (const auto found = waves.find(before); found != waves.end()) one.wave = std::max(one.wave, found->second + 1);
    waves[one.name] = one.wave;
    classify(batch.classes, params.case_limit_s, j.memory_mb, one);
    batch.jobs.push_back(std::move(one));
  }
  return batch;
}

std::vector<std::string> options_of_array(const Batch& batch, const BatchJob& first, std::size_t count,
                                          const std::vector<std::string>& after) {
  std::vector<std::string> out = {"--job-name=" + batch.slurm_name(),
                                  "--no-requeue",
                                  "--ntasks=1",
                                  "--cpus-per-task=1",
                                  "--mem=" + std::to_string(first.memory_mb) + "M",
                                  "--open-mode=append"};
  if (count > 0)
    out.push_back("--array=0-" + std::to_string(count - 1) +
                  (batch.at_once > 0 ? "%" + std::to_string(batch.at_once) : ""));
  if (first.time_limit_s > 0) out.push_back("--time=" + minutes(first.time_limit_s));
  const std::string& partition = first.partition.empty() ? batch.partition : first.partition;
  if (!partition.empty()) out.push_back("--partition=" + partition);
  if (!batch.account.empty()) out.push_back("--account=" + batch.account);
  std::string dependency;
  for (const std::string& id : after) dependency += (dependency.empty() ? "--dependency=afterany:" : ":") + id;
  if (!dependency.empty()) out.push_back(dependency);
  out.insert(out.end(), batch.options.begin(), batch.options.end());
  return out;
}

std::vector<BatchArray> part_into_arrays(const Batch& batch, const std::set<std::string>& names) {
  using Class = std::tuple<int, int, std::string, double>;  // wave, memory, partition, time
  std::map<Class, std::vector<std::string>> classes;
  for (const BatchJob& j : batch.jobs)
    if (names.count(j.name)) classes[{j.wave, j.memory_mb, j.partition, j.time_limit_s}].push_back(j.name);
  const auto most = static_cast<std::size_t>(std::max(batch.max_array, 1));
  std::vector<BatchArray> arrays;
  for (const auto& [its, all] : classes)
    for (std::size_t from = 0; from < all.size(); from += most) {
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(from);
      const auto end = all.begin() + static_cast<std::ptrdiff_t>(std::min(from + most, all.size()));
      arrays.push_back({"", std::get<0>(its), {begin, end}});
    }
  return arrays;
}

}  // namespace trephine::library
