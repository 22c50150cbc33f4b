// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/build_jobs.h"

#include <algorithm>
#include <set>
#include <utility>

#include "base/joined.h"
#include "base/text.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

class JobMaker {
 public:
  JobMaker(const LibraryPlan& plan, const LibraryConfig& config, const LibraryState& state,
           const LibraryBuildParams& params)
      : plan_(plan), config_(config), state_(state), params_(params) {}

  BuildJobs make() {
    // Ninja takes what is ready in this order: each phantom stands before its cases, so that the first cases are there
    // soon.
    std::set<int> made;
    // Cases of one series share stages: all others take them from the cache when they come after the first.
    std::map<fs::path, std::string> first;
    for (const PlannedCase& c : plan_.cases) {
      if (c.fault || c.reasons.empty()) continue;
      const int phantom = c.entry.phantom;
      if (phantom >= 0 && !plan_.phantoms[static_cast<std::size_t>(phantom)].reasons.empty() &&
          made.insert(phantom).second)
        made_.jobs.push_back(phantom_job(static_cast<std::size_t>(phantom)));
      NinjaJob job = case_job(c);
      if (const auto [of_series, is_first] = first.emplace(c.series, job.job.name); !is_first)
        job.after.push_back(of_series->second);
      made_.weights[job.job.name] = static_cast<double>(c.voxels) + 1e6;
      made_.jobs.push_back(std::move(job));
    }
    return std::move(made_);
  }

 private:
  NinjaJob phantom_job(std::size_t index) {
    const PlannedPhantom& p = plan_.phantoms[index];
    const phantom::PhantomParams& params = config_.phantoms[index].params;
    NinjaJob out;
    out.memory_mb = p.estimate.memory_mb;
    LibraryJob& job = out.job;
    job.name = "phantom." + p.name;
    job.token = p.name;
    job.is_phantom = true;
    job.identity = p.identity;
    job.arguments = {"phantom", state_.phantom_folder(p.name).string(), "--threads=1"};
    add_flags(params.body, job.arguments);
    add_flags(params.head, job.arguments);
    add_flags(params.head.hard, job.arguments);
    add_flags(params.scan, job.arguments);
    add_flags(params.series, job.arguments);
    add_flags(params.truth, job.arguments);
    set_common(job);
    made_.weights[job.name] = 1e6;
    return out;
  }

  template <class P>
  static void add_flags(const P& params, std::vector<std::string>& out) {
    for (const Parameter& p : parameters_of<P>().parameters) {
      std::string name = p.name;
      std::replace(name.begin(), name.end(), '_', '-');
      const ParameterValue value = p.get(&params);
      if (const bool* flag = std::get_if<bool>(&value)) {
        out.push_back((*flag ? "--" : "--no-") + name);
      } else if (const auto* numbers = std::get_if<std::vector<double>>(&value)) {
        const std::string text = joined(*numbers, ",", [](const double n) { return to_text(n); });
        out.push_back("--" + name + "=" + text);
      } else if (const auto* text = std::get_if<std::string>(&value)) {
        out.push_back("--" + name + "=" + *text);
      } else {
        out.push_back("--" + name + "=" + to_text(value));
      }
    }
  }

  NinjaJob case_job(const PlannedCase& c) {
    NinjaJob out;
    out.memory_mb = c.estimate.memory_mb;
    LibraryJob& job = out.job;
    job.name = "case." + c.token;
    job.token = c.token;
    job.settings_sha256 = c.inputs.settings_sha256;
    job.series = c.series;
    job.time_limit_s = params_.case_limit_s;
    job.arguments = {"run",
                     c.entry.config.string(),
                     "--series",
                     c.series.string(),
                     "--out",
                     state_.library().string(),
                     "--case",
                     c.token,
                     "--threads=1",
                     "--no-sheet",
                     "--cache",
                     (state_.library() / library_cache_name).string(),
                     "--cache-limit-mb=" + std::to_string(params_.cache_limit_mb)};
    if (!params_.pictures) job.arguments.insert(job.arguments.end(), {"--no-pictures", "--no-page"});
    if (params_.allow_external) job.arguments.emplace_back("--allow-external");
    if (!params_.check_disk) job.arguments.emplace_back("--no-check-disk");
    for (const std::string& s : c.entry.set) job.arguments.push_back("--set=" + s);
    if (!c.entry.landmarks.empty()) job.arguments.push_back("--landmarks=" + c.entry.landmarks.string());
    for (const fs::path& root : config_.roots) job.arguments.push_back("--root=" + fs::absolute(root).string());
    if (c.entry.phantom >= 0) {
      const PlannedPhantom& p = plan_.phantoms[static_cast<std::size_t>(c.entry.phantom)];
      job.phantom = p.name;
      job.identity = p.identity;
      if (!p.reasons.empty()) out.after.push_back("phantom." + p.name);
    }
    set_common(job);
    return out;
  }
  void set_common(LibraryJob& job) const {
    job.library = state_.library();
    job.keep_going = params_.keep_going;
  }

  const LibraryPlan& plan_;
  const LibraryConfig& config_;
  const LibraryState& state_;
  const LibraryBuildParams& params_;
  BuildJobs made_;
};

}  // namespace

BuildJobs make_build_jobs(const LibraryPlan& plan, const LibraryConfig& config, const LibraryState& state,
                          const LibraryBuildParams& params) {
  return JobMaker(plan, config, state, params).make();
}

}  // namespace trephine::library
