// SPDX-License-Identifier: GPL-3.0-or-later
#include "library/metrics.h"

#include <functional>
#include <map>

#include "base/text.h"
#include "library/slurm_engine.h"

namespace trephine::library {
namespace {

// A label's value: backslash, quote and newline are escaped; printable() leaves no newline.
std::string label(const std::string& text) {
  std::string out = "\"";
  for (const char c : printable(text)) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

class Text {
 public:
  void begin(const std::string& name, const std::string& help) {
    name_ = name;
    text_ += "# HELP " + name + " " + help + "\n# TYPE " + name + " gauge\n";
  }
  void value(const std::string& labels, double v) {
    text_ += name_ + (labels.empty() ? "" : "{" + labels + "}") + " " + to_text(v) + "\n";
  }
  std::string take() { return std::move(text_); }

 private:
  std::string name_, text_;
};

void of_each_case(Text& out, const std::vector<CaseRow>& rows, const std::string& name, const std::string& help,
                  const std::function<double(const CaseRow&)>& value, bool published_only = true) {
  out.begin(name, help);
  for (const CaseRow& row : rows)
    if (!published_only || row.fault.empty()) out.value("case=" + label(row.token), value(row));
}

void add_counts(Text& out, const std::vector<CaseRow>& rows) {
  std::map<std::string, int> states = {{"published", 0}, {"unreadable", 0}, {"last_build_failed", 0}}, classes;
  for (const CaseRow& row : rows) {
    ++states[row.fault.empty() ? "published" : "unreadable"];
    states["last_build_failed"] += row.last.code != 0;
    if (row.fault.empty()) ++classes[row.patient_class.empty() ? "unknown" : row.patient_class];
  }
  out.begin("trephine_library_cases", "Cases by state; one whose last build failed may be published too.");
  for (const auto& [state, n] : states) out.value("state=" + label(state), n);
  out.begin("trephine_library_cases_of_class", "Published cases by the patient's class.");
  for (const auto& [name, n] : classes) out.value("class=" + label(name), n);
}

void add_stages(Text& out, const std::vector<CaseRow>& rows) {
  std::map<std::string, std::pair<double, int>> stages;
  for (const CaseRow& row : rows)
    for (const auto& [stage, seconds] : row.stage_seconds) {
      stages[stage].first += seconds;
      ++stages[stage].second;
    }
  out.begin("trephine_stage_seconds", "Seconds of a stage, summed over the last runs of all cases that computed it.");
  for (const auto& [stage, sum] : stages) out.value("stage=" + label(stage), sum.first);
  out.begin("trephine_stage_runs", "In how many cases' last runs the stage was computed.");
  for (const auto& [stage, sum] : stages) out.value("stage=" + label(stage), sum.second);
}

void add_cluster(Text& out, const std::vector<Batch>& open) {
  std::map<std::string, int> states = {{"waiting", 0}, {"begun", 0}, {"built", 0}, {"failed", 0}};
  int tries = 0;
  for (const Batch& batch : open) {
    const auto ended = ended_tasks(batch);
    for (const BatchJob& j : batch.jobs) {
      tries += j.tries;
      if (is_final(j, ended, batch.max_tries))
        ++states[ended.at(j.name).result.code == 0 ? "built" : "failed"];
      else
        ++states[read_task(batch.folder, task_begun, j.name) ? "begun" : "waiting"];
    }
  }
  out.begin("trephine_cluster_jobs", "Jobs of open batches by state.");
  for (const auto& [state, n] : states) out.value("state=" + label(state), n);
  out.begin("trephine_cluster_submissions", "How often the jobs of open batches were submitted, together.");
  out.value("", tries);
}

}  // namespace

std::string library_metrics(const std::vector<CaseRow>& rows, const std::vector<Batch>& open) {
  Text out;
  add_counts(out, rows);
  of_each_case(out, rows, "trephine_case_run_seconds", "Seconds of the case's last run, by the clock.",
               [](const CaseRow& r) { return r.seconds; });
  of_each_case(out, rows, "trephine_case_cpu_seconds", "Seconds of CPU of its last build by the library.",
               [](const CaseRow& r) { return r.last.cpu_s; });
  of_each_case(out, rows, "trephine_case_peak_memory_bytes", "Largest memory of its last run.",
               [](const CaseRow& r) { return 1024 * 1024 * r.peak_memory_mb; });
  of_each_case(out, rows, "trephine_case_bytes", "Size of its files.",
               [](const CaseRow& r) { return static_cast<double>(r.bytes); });
  of_each_case(out, rows, "trephine_case_triangles", "Triangles of its surfaces.",
               [](const CaseRow& r) { return static_cast<double>(r.triangles); });
  of_each_case(out, rows, "trephine_case_deviation_max_mm", "Largest deviation of a surface from its unreduced one.",
               [](const CaseRow& r) { return r.deviation_max_mm; });
  of_each_case(out, rows, "trephine_case_warnings", "Warnings of its last run.",
               [](const CaseRow& r) { return static_cast<double>(r.warnings.size()); });
  of_each_case(out, rows, "trephine_case_age_seconds", "Age of its case.json.",
               [](const CaseRow& r) { return r.age_s; });
  of_each_case(
      out, rows, "trephine_case_last_exit_code", "Exit code of its last build by the library.",
      [](const CaseRow& r) { return static_cast<double>(r.last.code); }, false);
  add_stages(out, rows);
  add_cluster(out, open);
  return out.take();
}

}  // namespace trephine::library
