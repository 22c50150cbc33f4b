// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/run_case.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <map>
#include <random>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cases/case.h"
#include "page/page_notes.h"
#include "publish/case_content.h"
#include "publish/case_place.h"
#include "publish/left_out.h"
#include "publish/page_files.h"
#include "publish/refused.h"
#include "publish/run_json.h"
#include "publish/scan_checks.h"

namespace trephine {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

// The name comes from the system's entropy: a case's name is never derived from the patient (acceptance case P3).
std::string random_token() {
  std::random_device source;
  std::string token = "case-";
  for (int i = 0; i < 10; ++i) token += "0123456789abcdefghijkmnpqrstuvwxyz"[source() % 34];
  return token;
}

}  // namespace

void require_face_policy(const CaseConfig& config) {
  if (!config.face.empty()) return;
  std::string shown;
  for (const SceneAnatomy& wanted : config.scene)
    if (config.find_anatomy(wanted.name)->shows_face) shown = wanted.name;
  if (config.haptic.wanted && config.haptic.encoding() == HapticEncoding::hu) {
    for (const RecipeAnatomy& a : config.anatomies)
      if (a.shows_face) shown = "the haptic volume of raw HU";
  } else {
    for (const SceneShape& shape : config.haptic.shapes)
      if (config.find_anatomy(shape.name)->shows_face) shown = shape.name + " in the haptic volume";
  }
  if (config.ct)
    for (const RecipeAnatomy& a : config.anatomies)
      if (a.shows_face) shown = "the CT";
  if (!shown.empty())
    throw Error(ExitCode::privacy, "", "scene.face",
                shown +
                    " shows the patient's face; the scene must say face: {policy: deface}, {policy: crop} or "
                    "{policy: keep, reason: ...}");
}

namespace {

// Removes the folders that the run made and left empty because it failed.
class NewFolders {
 public:
  ~NewFolders() {
    std::error_code ignored;
    for (auto f = missing_.rbegin(); f != missing_.rend(); ++f)
      fs::remove(*f, ignored);  // fails where the folder holds something
  }
  // To be called before the folder is made.
  void expect(const fs::path& folder) {
    std::vector<fs::path> missing;
    std::error_code error;
    for (fs::path f = fs::absolute(folder).lexically_normal();
         f.has_relative_path() && fs::status(f, error).type() == fs::file_type::not_found; f = f.parent_path())
      missing.push_back(f);
    missing_.insert(missing_.end(), missing.rbegin(), missing.rend());
  }

 private:
  std::vector<fs::path> missing_;
};

// A case's folder holds the case and nothing else: other outputs must go elsewhere.
void require_outside(const fs::path& case_folder, const fs::path& output, const char* flag) {
  if (output.empty()) return;
  const fs::path inside =
      fs::weakly_canonical(fs::absolute(output)).lexically_relative(fs::weakly_canonical(fs::absolute(case_folder)));
  if (inside.empty() || *inside.begin() == "..") return;
  throw Error(ExitCode::usage, output.string(), flag, "lies in the case's own folder, choose another");
}

// Collects the results of a run on the way to the case.
struct Run {
  explicit Run(const RunRequest& r) : request(r) {}
  const RunRequest& request;
  CaseConfig config;
  Graph graph;
  std::vector<NodeResult> results;
  std::string input_sha256;
  std::map<std::string, std::string> scans_sha256;
  std::map<std::string, Report> folders;    // other content of the folders of series, by the node that imports each
  std::vector<std::string> about_patients;  // whether all scans are of one
  std::vector<std::string> warnings;
  std::vector<CaseMissing> missing;  // what was refused and left out
};

std::string hash_input(Run& run, const Progress& cancelled) {
  try {
    return hash_of_series_input(run.config.series, run.config.import, cancelled, &run.folders["import"]);
  } catch (const Error& e) {
    if (e.code() != ExitCode::usage) throw;
    throw Error(e.code(), e.file(), e.field(), std::string(e.what()) + "; --set import.series=s1 chooses the first");
  }
}

// Every series is hashed once, though an anatomy that is left out needs another graph.
void make_graph_of(Run& run, const Progress& cancelled) {
  if (run.input_sha256.empty()) run.input_sha256 = hash_input(run, cancelled);
  run.graph = make_graph(run.config, run.input_sha256, [&](const std::string& name, const SeriesChoice& scan) {
    std::string& sha256 = run.scans_sha256[name];
    if (sha256.empty())
      sha256 = hash_of_series_input(scan.folder_or_file, scan.params, cancelled, &run.folders[name + ".import"]);
    return sha256;
  });
}

// Logs the warnings of every stage that the case needs, published or not. This happens before anything is refused,
// because they may say why it will be.
void tell_warnings(Run& run) {
  run.warnings.insert(run.warnings.end(), run.about_patients.begin(), run.about_patients.end());
  for (const auto& [import, folder] : run.folders)
    for (const std::string& w : folder.warnings) run.warnings.push_back(import + ": " + w);
  for (const CaseMissing& m : run.missing) run.warnings.push_back(m.anatomy + ": left out: " + m.why);
  for (std::size_t i = 0; i < run.graph.nodes.size(); ++i)
    for (const std::string& w : run.results[i].report.warnings)
      run.warnings.push_back(run.graph.nodes[i].name + ": " + w);
  const std::string early = stage_of(StageRole::suitability).name + ": ";  // EarlyWarnings has told these
  for (const std::string& w : run.warnings)
    if (w.rfind(early, 0) != 0) log_warning(run.config.case_token + ": " + w);
}

// Tells at once what the scan is not suited for: a run that is refused later may be refused because of it.
class EarlyWarnings : public RunObserver {
 public:
  EarlyWarnings(RunObserver& observer, std::string token, double publishing_s)
      : observer_(observer), token_(std::move(token)), publishing_s_(publishing_s) {}
  void planned(const std::vector<std::pair<std::string, double>>& expected_s) override {
    auto all = expected_s;
    all.emplace_back(publishing_step, publishing_s_);
    observer_.planned(all);
  }
  void started(const std::string& node) override { observer_.started(node); }
  void progressed(const std::string& node, double fraction) override { observer_.progressed(node, fraction); }
  void finished(const std::string& node, const std::string& how, double seconds, const Report& report) override {
    if (node == stage_of(StageRole::suitability).name)
      for (const std::string& w : report.warnings) log_warning(token_ + ": " + node + ": " + w);
    observer_.finished(node, how, seconds, report);
  }

 private:
  RunObserver& observer_;
  std::string token_;
  double publishing_s_;
};

// The seconds of what was computed in this run, by node.
std::map<std::string, double> seconds_of(const Run& run) {
  std::map<std::string, double> seconds;
  for (std::size_t i = 0; i < run.results.size(); ++i)
    if (run.results[i].state == NodeResult::State::computed) seconds[run.graph.nodes[i].name] = run.results[i].seconds;
  return seconds;
}

// A budget of time cannot be enforced: the case is complete and valid, only later than wanted.
void tell_overrun(Run& run, double seconds) {
  const double budget_s = run.config.trade.rule.seconds;
  if (budget_s <= 0 || seconds <= budget_s) return;
  run.warnings.push_back("took " + to_text(ParameterValue(std::round(10 * seconds) / 10)) + " s, the budget is " +
                         to_text(ParameterValue(budget_s)) + " s: this machine or its load is not that of " +
                         run.config.trade.front_names());
  log_warning(run.config.case_token + ": " + run.warnings.back());
}

// What a run leaves in the report folder.
bool is_of_report(const fs::path& file) {
  return file.extension() == ".png" || file.extension() == ".f32" || file.filename() == page_file ||
         file.filename() == page_notes_file;
}

// Pictures and pages of an older state of the case could be mistaken for this one's.
void remove_other_pictures(const fs::path& folder, const std::vector<CasePicture>& pictures) {
  std::error_code ignored;
  std::vector<fs::path> others;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (is_of_report(entry.path()) && std::none_of(pictures.begin(), pictures.end(), [&](const CasePicture& p) {
          return entry.path().filename() == p.name;
        }))
      others.push_back(entry.path());
  for (const fs::path& f : others) fs::remove(f, ignored);
}

// Publishes the case. Everything has been made and checked, so only the disk can still fail. Pictures and page are not
// part of the case's checksummed bytes; they are written last, just before case.json, so that both change at nearly the
// same moment.
void publish(const Run& run, const fs::path& folder, const CaseContent& content) {
  for (const CaseContent::File& f : content.files) write_case_file(folder, f.stem, f.extension, f.bytes);
  for (const CasePicture& p : content.pictures) write_file(folder / "report" / p.name, p.png);
  publish_case(folder, content.manifest);
  remove_other_pictures(folder / "report", content.pictures);
  try {
    remove_unnamed_case_files(folder);
  } catch (const std::exception& e) {  // the case is published, whatever old files remain beside it
    log_warning(run.config.case_token + ": files of the older case are left: " + e.what());
  }
}

// What was made is kept beside the case's folder, which may hold the last valid case or not exist.
void show_refusal(const Run& run, const StageCache& cache, const Error& e, RunObserver& observer) {
  if (e.code() != ExitCode::quality && e.code() != ExitCode::privacy) return;
  const fs::path folder = refused_folder(run.request.library, run.config.case_token);
  try {
    keep_refused(folder, {run.config, run.graph, run.results, cache, run.warnings}, e);
    observer.kept(folder);
  } catch (const Error& failed) {  // the reason of the refusal matters more than this failure
    log_warning(run.config.case_token + ": what was made could not be kept for looking: " + failed.what());
  } catch (const std::exception&) {
    log_warning(run.config.case_token + ": what was made could not be kept for looking: too little memory");
  }
}

fs::path cache_folder_of(const RunRequest& request) {
  if (!request.params.use_cache) return {};
  return request.cache.empty() ? request.library / ".trephine-cache" : request.cache;
}

CaseConfig read_config(const RunRequest& request) {
  ConfigOverrides overrides = request.overrides;
  if (!request.params.case_token.empty()) {
    validate_case_token(request.params.case_token, ExitCode::usage);
    overrides.case_token = request.params.case_token;
  }
  overrides.profile = request.params.profile;
  CaseConfig config = read_case_config(request.config, overrides);
  if (config.series.empty())
    throw Error(ExitCode::usage, request.config.string(), "series",
                "the configuration names none, give --series FOLDER");
  return config;
}

void tell_choice(const CaseConfig& config) {
  if (!config.trade.rule.empty())
    log_line(config.case_token + ": " + config.trade.rule.text() + ": point " + config.trade.choice.point.name +
             " of " + config.trade.front_names() + ", " + config.trade.choice.why);
}

}  // namespace

Explanation explain_case(const RunRequest& request) {
  Run run(request);
  run.config = read_config(request);
  make_graph_of(run, Progress({}, &cancel_requested()));
  std::error_code ignored;
  const fs::path cache = cache_folder_of(request);
  return explain(run.config, run.graph, wanted_nodes(run.graph, request.params.pictures, request.params.page),
                 StageCache(fs::exists(cache, ignored) ? cache : fs::path()));
}

RunResult run_case(const RunRequest& request, RunObserver& observer) {
  const auto start = Clock::now();
  Run run(request);
  run.config = read_config(request);
  if (run.config.case_token.empty()) run.config.case_token = random_token();
  const std::string token = run.config.case_token;
  try {
    const fs::path folder = request.library / token;
    const fs::path cache_folder = cache_folder_of(request);
    require_outside(folder, request.keep, "--keep");
    require_outside(folder, request.cache, "--cache");
    require_outside(folder, request.json, "--json");
    require_face_policy(run.config);
    tell_choice(run.config);

    NewFolders new_folders;
    for (const fs::path& f : {request.library, cache_folder, request.keep})
      if (!f.empty()) new_folders.expect(f);
    make_output_folder(request.library);
    CasePlace place(folder);
    const fs::path made_in = place.made_in();
    make_output_folder(made_in / "meshes");
    if (request.params.pictures || request.params.page) make_output_folder(made_in / "report");
    for (const fs::path& f : {made_in, made_in / "meshes", made_in / "report"}) remove_stale_temporaries(f);
    if (!request.keep.empty()) make_output_folder(request.keep);
    const StageCache cache(cache_folder);

    const Progress cancelled({}, &cancel_requested());
    const Progress publishing([&](double share) { observer.progressed(publishing_step, share); }, &cancel_requested());
    const double content_share = request.params.page ? (request.params.pictures ? 0.5 : 0.2) : 0.9;
    ExecuteOptions execution;
    make_graph_of(run, cancelled);
    execution.keep = request.keep;
    execution.cache = &cache;
    execution.cancel = &cancel_requested();
    execution.allow_external = request.params.allow_external;
    run.about_patients = require_one_patient(run.config, names_of_scans(run.graph), cancelled);
    execution.seconds_before = cache.seconds_before();
    const auto before = execution.seconds_before.find(publishing_step);
    EarlyWarnings early(observer, token, before == execution.seconds_before.end() ? 4 : before->second);
    auto publishing_began = Clock::now();
    CaseContent content;
    try {
      execution.made = &run.results;
      for (bool complete = false; !complete;) try {
          run.results = execute(run.graph, wanted_nodes(run.graph, request.params.pictures, request.params.page),
                                execution, early);
          require_modalities(run.config, run.graph, run.results);
          publishing_began = Clock::now();
          observer.publishing();
          content = make_case_content(run.config, run.graph, run.results, "trephine " + request.program_version,
                                      run.input_sha256, request.params.pictures, publishing.part(0, content_share));
          complete = true;
        } catch (const Error& e) {
          const std::string anatomy = refused_anatomy(run.config, e);
          if (anatomy.empty()) throw;
          run.missing.push_back({anatomy, e.what()});
          run.config.leave_out(anatomy);
          keep_made(run.graph, run.results, execution.known);
          make_graph_of(run, cancelled);
        }
      content.manifest.missing = run.missing;
      tell_warnings(run);
    } catch (const Error& e) {
      if (run.warnings.empty() && !run.results.empty()) tell_warnings(run);
      show_refusal(run, cache, e, observer);
      throw;
    }
    if (request.params.page)
      for (CasePicture& file : make_page_files(run.config, run.graph, run.results, content, run.warnings,
                                               publishing.part(content_share, 0.95)))
        content.pictures.push_back(std::move(file));
    cancelled.check();
    publish(run, made_in, content);
    observer.progressed(publishing_step, 1);
    remove_refused(refused_folder(request.library, token));
    std::map<std::string, double> seconds_by_node = seconds_of(run);
    seconds_by_node[publishing_step] = std::chrono::duration<double>(Clock::now() - publishing_began).count();
    cache.remember_seconds(seconds_by_node);
    cache.shrink_to(static_cast<std::uint64_t>(request.params.cache_limit_mb) * 1'000'000);

    RunResult result;
    result.case_folder = folder;
    result.case_token = token;
    result.anatomies = content.anatomies;
    result.table = case_table(content.anatomies);
    if (content.manifest.face_policy == "keep")
      result.table += "\nface: the case shows it (" + content.manifest.face_reason +
                      "); `--set scene.face.policy=deface` takes it off\n";
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    tell_overrun(run, seconds);
    result.warnings = run.warnings;
    result.json = run_json(run.graph, run.results, run.folders["import"], content.anatomies, run.warnings, seconds);
    write_file(made_in / "run.json", result.json);
    place.appear();
    return result;
  } catch (Error& e) {
    e.in_case(token);
    throw;
  }
}

}  // namespace trephine
