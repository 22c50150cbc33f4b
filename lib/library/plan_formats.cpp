// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/plan_formats.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/error_text.h"
#include "base/joined.h"
#include "base/log.h"
#include "base/spawn.h"
#include "base/text.h"
#include "base/write_file.h"
#include "library/build_jobs.h"
#include "library/library_state.h"

namespace trephine::library {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

struct Planned {
  LibraryConfig config;
  LibraryPlan plan;
  BuildJobs jobs;
};

Planned planned(const LibraryBuildRequest& request, const LibraryState& state, std::vector<std::string> only,
                const Progress& progress) {
  Planned out;
  out.config = read_library_config(request.config, request.overrides);
  make_output_folder(request.library);
  state.make_folders();
  PlanOptions options;
  options.rehash = request.params.rehash;
  options.rebuild = request.params.rebuild;
  options.pictures = request.params.pictures;
  options.only = std::move(only);
  options.program_version = request.program_version;
  out.plan = make_plan(out.config, state, options, progress);
  out.jobs = make_build_jobs(out.plan, out.config, state, request.params);
  return out;
}

std::vector<std::string> words_of(const LibraryBuildRequest& request, const std::string& name) {
  std::vector<std::string> words = {own_program().string(), "library", "one",
                                    fs::absolute(request.config).lexically_normal().string()};
  words.push_back("--out=" + fs::absolute(request.library).lexically_normal().string());
  for (const std::string& s : request.overrides.set) words.push_back("--set=" + s);
  for (const std::string& p : request.overrides.phantom) words.push_back("--phantom=" + p);
  for (const fs::path& r : request.overrides.roots) words.push_back("--root=" + fs::absolute(r).string());
  if (!request.params.pictures) words.emplace_back("--no-pictures");
  if (request.params.rebuild) words.emplace_back("--rebuild");
  if (request.params.allow_external) words.emplace_back("--allow-external");
  words.push_back("--case-limit-s=" + to_text(request.params.case_limit_s));
  words.push_back("--cache-limit-mb=" + std::to_string(request.params.cache_limit_mb));
  words.push_back(name);
  return words;
}

// For the shell, in single quotes, with each $ doubled as both Ninja and make want it.
std::string shell_words(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) {
    out += out.empty() ? "'" : " '";
    for (const char c : word) out += c == '\'' ? "'\\''" : c == '$' ? std::string("$$") : std::string(1, c);
    out += "'";
  }
  return out;
}

std::string as_json(const std::vector<OnePlannedJob>& jobs) {
  Json all = Json::array();
  for (const OnePlannedJob& j : jobs)
    all.push_back({{"name", j.name},
                   {"after", j.after},
                   {"memory_mb", static_cast<long long>(j.memory_mb + 0.5)},
                   {"time_limit_s", j.time_limit_s},
                   {"reasons", j.reasons},
                   {"command", j.command}});
  return Json({{"format", "trephine-library-plan 1"}, {"jobs", all}})
             .dump(2, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

// No output of the rules is ever made: whatever is planned runs.
std::string as_ninja(const std::vector<OnePlannedJob>& jobs) {
  std::string text = "ninja_required_version = 1.8\nrule job\n  command = $words\n  description = $out\n\n";
  for (const OnePlannedJob& j : jobs)
    text += "build " + j.name + ": job" + (j.after.empty() ? "" : " || " + joined(j.after, " ")) +
            "\n  words = " + shell_words(j.command) + "\n";
  return text;
}

std::string as_make(const std::vector<OnePlannedJob>& jobs) {
  std::string names;
  for (const OnePlannedJob& j : jobs) names += " " + j.name;
  std::string text = "# make -k -j N -f FILE\n.PHONY: all" + names + "\nall:" + names + "\n";
  for (const OnePlannedJob& j : jobs) {
    text += "\n" + j.name + ":" + (j.after.empty() ? "" : " | " + joined(j.after, " "));
    text += "\n\t" + shell_words(j.command) + "\n";
  }
  return text;
}

}  // namespace

std::vector<OnePlannedJob> plan_of_library(const LibraryBuildRequest& request, const Progress& progress) {
  const LibraryState state(fs::absolute(request.library).lexically_normal());
  const Planned p = planned(request, state, request.only, progress);
  std::map<std::string, const std::vector<std::string>*> reasons;
  std::vector<OnePlannedJob> out;
  for (const PlannedCase& c : p.plan.cases) {
    if (!c.fault) {
      reasons["case." + c.token] = &c.reasons;
      continue;
    }
    if (c.token.empty()) throw Error(c.fault->code(), c.fault->file(), c.fault->field(), c.fault->what());
    // Its job says the same and fails, and all others are built.
    const std::string why = error_text(*c.fault);
    log_warning(c.token + ": " + why);
    const std::string name = "case." + c.token;
    out.push_back({name, {}, {why}, words_of(request, name), c.estimate.memory_mb, request.params.case_limit_s});
  }
  for (const PlannedPhantom& phantom : p.plan.phantoms) reasons["phantom." + phantom.name] = &phantom.reasons;
  for (const NinjaJob& j : p.jobs.jobs) {
    OnePlannedJob one;
    one.name = j.job.name;
    one.after = j.after;
    one.memory_mb = j.memory_mb;
    one.time_limit_s = j.job.time_limit_s;
    one.command = words_of(request, one.name);
    if (const auto found = reasons.find(one.name); found != reasons.end()) one.reasons = *found->second;
    out.push_back(std::move(one));
  }
  return out;
}

std::string plan_text(const std::vector<OnePlannedJob>& jobs, PlanFormat format) {
  switch (format) {
    case PlanFormat::ninja:
      return as_ninja(jobs);
    case PlanFormat::make:
      return as_make(jobs);
    default:
      return as_json(jobs);
  }
}

JobResult do_one_of_library(const LibraryBuildRequest& request, const std::string& name) {
  const LibraryState state(fs::absolute(request.library).lexically_normal());
  const std::string case_prefix = "case.", phantom_prefix = "phantom.";
  std::vector<std::string> only;
  if (name.rfind(case_prefix, 0) == 0) {
    only.push_back(name.substr(case_prefix.size()));
  } else {
    // A phantom is planned with the cases that need it.
    const LibraryConfig config = read_library_config(request.config, request.overrides);
    for (const LibraryCase& c : config.cases)
      if (c.phantom >= 0 && phantom_prefix + config.phantoms[static_cast<std::size_t>(c.phantom)].name == name)
        only.push_back(c.token);
    if (only.empty()) throw Error(ExitCode::usage, request.config.string(), name, "the library has no such job");
  }
  const Planned p = planned(request, state, only, Progress({}, &cancel_requested()));
  for (const PlannedCase& c : p.plan.cases)
    if (c.fault && case_prefix + c.token == name)
      throw Error(c.fault->code(), c.fault->file(), c.fault->field(), c.fault->what());
  for (const NinjaJob& j : p.jobs.jobs) {
    if (j.job.name != name) continue;
    const JobResult result = do_library_job(j.job);
    if (!j.job.is_phantom) write_result(state, j.job.token, result);
    return result;
  }
  return {};
}

}  // namespace trephine::library
