// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/metrics.h"

#include "base/joined.h"
#include "base/text.h"
#include "library/slurm_engine.h"

namespace trephine::library {
namespace {

std::string head(const std::string& name, const std::string& help) {
  return "# HELP " + name + " " + help + "\n# TYPE " + name + " gauge\n";
}

std::string line(const std::string& name, const std::string& labels, double v) {
  return name + (labels.empty() ? "" : "{" + labels + "}") + " " + to_text(v) + "\n";
}

struct FigureOfCase {
  const char *name, *help;
  double (*value)(const CaseRow&);
  bool published_only;
};

const std::vector<FigureOfCase> figures = {
    {"trephine_case_run_seconds", "Seconds of the case's last run, by the clock.",
     [](const CaseRow& r) { return r.seconds; }, true},
    {"trephine_case_cpu_seconds", "Seconds of CPU of its last build by the library.",
     [](const CaseRow& r) { return r.last.cpu_s; }, true},
    {"trephine_case_peak_memory_bytes", "Largest memory of its last run.",
     [](const CaseRow& r) { return 1024 * 1024 * r.peak_memory_mb; }, true},
    {"trephine_case_bytes", "Size of its files.", [](const CaseRow& r) { return static_cast<double>(r.bytes); }, true},
    {"trephine_case_triangles", "Triangles of its surfaces.",
     [](const CaseRow& r) { return static_cast<double>(r.triangles); }, true},
    {"trephine_case_deviation_max_mm", "Largest deviation of a surface from its unreduced one.",
     [](const CaseRow& r) { return r.deviation_max_mm; }, true},
    {"trephine_case_warnings", "Warnings of its last run.",
     [](const CaseRow& r) { return static_cast<double>(r.warnings.size()); }, true},
    {"trephine_case_age_seconds", "Age of its case.json.", [](const CaseRow& r) { return r.age_s; }, true},
    {"trephine_case_last_exit_code", "Exit code of its last build by the library.",
     [](const CaseRow& r) { return static_cast<double>(r.last.code); }, false},
};

std::string cluster_text(const std::vector<Batch>& open) {
  std::map<std::string, int> states = {{"waiting", 0}, {"begun", 0}, {"built", 0}, {"failed", 0}};
  int tries = 0;
  for (const Batch& batch : open) {
    const auto ended = ended_tasks(batch);
    for (const BatchJob& j : batch.jobs) {
      tries += j.tries;
      if (is_final(batch, j, ended))
        ++states[ended.at(j.name).result.code == 0 ? "built" : "failed"];
      else
        ++states[read_task(batch.folder, task_begun, j.name) ? "begun" : "waiting"];
    }
  }
  std::string out = head("trephine_cluster_jobs",
                         "Jobs of open batches by state; what Slurm lost counts as waiting or begun until `library "
                         "status` or a build asks it.");
  for (const auto& [state, n] : states) out += line("trephine_cluster_jobs", "state=" + in_quotes(state), n);
  return out + head("trephine_cluster_submissions", "How often the jobs of open batches were submitted, together.") +
         line("trephine_cluster_submissions", "", tries);
}

}  // namespace

void LibraryMetrics::add(const CaseRow& row) {
  const bool good = row.fault.empty();
  ++states_[good ? "published" : "unreadable"];
  states_["last_build_failed"] += row.last.code != 0;
  if (good) ++classes_[row.patient_class.empty() ? "unknown" : row.patient_class];
  for (const auto& [stage, seconds] : row.stage_seconds) {
    stages_[stage].first += seconds;
    ++stages_[stage].second;
  }
  of_cases_.resize(figures.size());
  for (std::size_t k = 0; k < figures.size(); ++k)
    if (good || !figures[k].published_only)
      of_cases_[k] += line(figures[k].name, "case=" + in_quotes(row.token), figures[k].value(row));
}

std::string LibraryMetrics::text(const std::vector<Batch>& open) const {
  std::string out = head("trephine_library_cases", "Cases by state; one whose last build failed may be published too.");
  for (const auto& [state, n] : states_) out += line("trephine_library_cases", "state=" + in_quotes(state), n);
  out += head("trephine_library_cases_of_class", "Published cases by the patient's class.");
  for (const auto& [name, n] : classes_) out += line("trephine_library_cases_of_class", "class=" + in_quotes(name), n);
  for (std::size_t k = 0; k < figures.size(); ++k)
    out += head(figures[k].name, figures[k].help) + (of_cases_.empty() ? "" : of_cases_[k]);
  out += head("trephine_stage_seconds", "Seconds of a stage, summed over the last runs of all cases that computed it.");
  for (const auto& [stage, sum] : stages_)
    out += line("trephine_stage_seconds", "stage=" + in_quotes(stage), sum.first);
  out += head("trephine_stage_runs", "In how many cases' last runs the stage was computed.");
  for (const auto& [stage, sum] : stages_) out += line("trephine_stage_runs", "stage=" + in_quotes(stage), sum.second);
  return out + cluster_text(open);
}

}  // namespace trephine::library
