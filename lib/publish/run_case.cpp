// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/run_case.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <random>

#include "base/error.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cases/case.h"
#include "grid/resample.h"
#include "head/head_region.h"
#include "page/page_notes.h"
#include "publish/case_content.h"
#include "publish/case_needs.h"
#include "publish/case_place.h"
#include "publish/early_warnings.h"
#include "publish/face_clearance.h"
#include "publish/left_out.h"
#include "publish/other_config.h"
#include "publish/page_files.h"
#include "publish/refused.h"
#include "publish/run_json.h"
#include "publish/scan_checks.h"
#include "publish/scene_limits.h"
#include "publish/series_hashes.h"
#include "publish/verdict.h"

namespace trephine::publish {
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

// A case's folder holds the case and nothing else: other outputs must go elsewhere.
void require_outside(const fs::path& case_folder, const fs::path& output, const char* flag) {
  if (output.empty()) return;
  const fs::path inside =
      fs::weakly_canonical(fs::absolute(output)).lexically_relative(fs::weakly_canonical(fs::absolute(case_folder)));
  if (inside.empty() || *inside.begin() == "..") return;
  throw Error(ExitCode::usage, output.string(), flag, "lies in the case's own folder, choose another");
}

// What was made for a case on the way to its content.
struct Made {
  pipeline::Graph graph;
  std::vector<pipeline::NodeResult> results;
  Concessions without;  // what was refused and is left out, or has a stand-in
  Clock::time_point publishing_began = Clock::now();
};

// Logs the warnings of every stage that the case needs, published or not, and returns them, the gravest first. This
// happens before anything is refused, because they may say why it will be.
std::vector<stages::GradedWarning> tell_warnings(const std::string& token,
                                                 const std::vector<std::string>& about_patients,
                                                 const std::map<std::string, dicom::FolderRest>& folders,
                                                 const Made& made) {
  using stages::Severity;
  struct Told : stages::GradedWarning {
    bool is_known = false;  // EarlyWarnings has logged it
  };
  std::vector<Told> all;
  for (const std::string& w : about_patients) all.push_back({{w, Severity::wrong}});
  for (const cases::CaseMissing& m : made.without.missing)
    all.push_back({{m.anatomy + ": left out: " + m.why, Severity::wrong}});
  for (const cases::CaseStandIn& s : made.without.stand_ins)
    all.push_back({{s.anatomy + ": " + s.by + " stands for it: " + s.why, Severity::wrong}});
  for (const WiderBound& w : made.without.wider) all.push_back({{words_of(w), Severity::look}});
  const auto add = [&](const std::string& by, const Warning& w, bool is_known) {
    all.push_back({{by + ": " + to_text(w), stages::kind_of(w).severity}, is_known});
  };
  for (const auto& [import, folder] : folders)
    for (const Warning& w : folder.warnings) add(import, w, false);
  for (std::size_t i = 0; i < made.results.size(); ++i)
    if (const pipeline::Node& node = made.graph.nodes[i]; !node.is_early)
      for (const Warning& w : made.results[i].warnings) add(node.name, w, node.type->warns_at_once());
  std::stable_sort(all.begin(), all.end(), [](const Told& a, const Told& b) { return a.severity < b.severity; });
  for (const Told& w : all)
    if (!w.is_known) log_warning(token + ": " + w.text);
  return {all.begin(), all.end()};
}

// The seconds of what was computed in this run, by node.
std::map<std::string, double> seconds_of(const Made& made) {
  std::map<std::string, double> seconds;
  for (std::size_t i = 0; i < made.results.size(); ++i)
    if (made.results[i].state == pipeline::NodeResult::State::computed)
      seconds[made.graph.nodes[i].name] = made.results[i].seconds;
  return seconds;
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

// Publishes the case. Everything has been made and checked, so only the disk can still fail. Pictures, page and
// run.json are not part of the case's checksummed bytes; they are written just before case.json, so that all change at
// nearly the same moment. case.json is last: where anything before it fails, the older case stands.
void publish(const fs::path& folder, const CaseContent& content, const std::string& run) {
  for (const CaseContent::File& f : content.files) cases::write_case_file(folder, f.stem, f.extension, f.bytes);
  for (const CasePicture& p : content.pictures) write_file(folder / "report" / p.name, p.png);
  write_file(folder / "run.json", run);
  cases::publish_case(folder, content.manifest);
  remove_other_pictures(folder / "report", content.pictures);
  try {
    cases::remove_unnamed_case_files(folder);
  } catch (const std::exception& e) {  // the case is published, whatever old files remain beside it
    log_warning(content.manifest.case_token + ": files of the older case are left: " + e.what());
  }
}

// What was made is kept beside the case's folder, which may hold the last valid case or not exist.
void show_refusal(const fs::path& folder, const RefusedRun& run, const Error& e, const Error& told,
                  pipeline::RunObserver& observer) {
  if (e.code() != ExitCode::quality && e.code() != ExitCode::privacy) return;
  try {
    observer.kept(folder, keep_refused(folder, run, e, told));
  } catch (const Error& failed) {  // the reason of the refusal matters more than this failure
    log_warning(run.config.case_token + ": what was made could not be kept for looking: " + failed.what());
  } catch (const std::exception&) {
    log_warning(run.config.case_token + ": what was made could not be kept for looking: too little memory");
  }
}

constexpr const char* no_picture_of_scan =
    "there are no pictures of the scan, for it shows a head and the scene says nothing of the face: say face: {policy: "
    "deface}, {policy: crop} or {policy: keep, reason: ...}";

fs::path cache_folder_of(const RunRequest& request) {
  if (!request.params.use_cache) return {};
  return request.cache.empty() ? request.library / ".trephine-cache" : request.cache;
}

config::CaseConfig read_config(const RunRequest& request) {
  config::ConfigOverrides overrides = request.overrides;
  if (!request.params.case_token.empty()) {
    cases::validate_case_token(request.params.case_token, ExitCode::usage);
    overrides.case_token = request.params.case_token;
  }
  overrides.profile = request.params.profile;
  config::CaseConfig config = config::read_case_config(request.config, overrides);
  if (config.series.empty())
    throw Error(ExitCode::usage, request.config.string(), "series",
                "the configuration names none, give --series FOLDER");
  return config;
}

void tell_choice(const config::CaseConfig& config) {
  for (const std::string& why : config.trade.stale) log_warning(config.case_token + ": " + why);
  if (!config.trade.rule.empty())
    log_line(config.case_token + ": " + config.trade.rule.text() + ": point " + config.trade.choice.point.name +
             " of " + config.trade.front_names() + ", " + config.trade.choice.why);
}

}  // namespace

static std::vector<int> wanted_of(const RunRequest& request, const config::CaseConfig& config,
                                  const pipeline::Graph& graph) {
  std::vector<int> wanted = wanted_nodes(graph, request.params.pictures, request.params.page);
  add_face_nodes(config, graph, wanted);
  return wanted;
}

Explanation explain_case(const RunRequest& request) {
  const config::CaseConfig config = read_config(request);
  const Progress cancelled({}, &cancel_requested());
  const pipeline::Graph graph = SeriesHashes(cancelled).graph_of(config);
  std::error_code ignored;
  const fs::path cache = cache_folder_of(request);
  return explain(config, graph, wanted_of(request, config, graph),
                 pipeline::StageCache(fs::exists(cache, ignored) ? cache : fs::path()));
}

namespace {

// What the scene asks for, shown or felt, in its order.
std::vector<std::string> wanted_anatomies(const config::CaseConfig& config) {
  std::vector<std::string> all;
  for (const config::RecipeAnatomy& a : config.anatomies)
    if (config.is_shown(a.name)) all.push_back(a.name);
  return all;
}

// Whether memory and disk are enough for the scan, as soon as its size is known.
void check_needs(const RunRequest& request, const config::CaseConfig& config, const pipeline::Graph& graph,
                 const dicom::ImportFigures& scan, pipeline::RunObserver& observer) {
  const ScanRaster raster = raster_of(scan);
  give_large_blocks_back(raster);
  const std::size_t anatomies = wanted_anatomies(config).size();
  const int resample = graph.find_stage<grid::ResampleParams>();
  ScanRaster used = raster;
  if (resample >= 0)
    used = used.on_voxels(graph.nodes[std::size_t(resample)].params.as<grid::ResampleParams>().spacing_mm);
  constexpr double head_mm = 260;  // what is left of a scan that is cut to the head
  if (graph.find_stage<head::HeadRegionParams>() >= 0) used = used.within(head_mm);
  const int finer = graph.find_stage<mask::ShapeInterpolateParams>();
  const MemoryNeed memory =
      memory_need(raster, used, anatomies,
                  finer < 0 ? nullptr : &graph.nodes[std::size_t(finer)].params.as<mask::ShapeInterpolateParams>());
  if (!memory.remedy.empty())
    log_warning(config.case_token + ": " + memory.text + ": " + memory.remedy);
  else if (!memory.text.empty())
    observer.estimated(memory.text);
  const CaseNeeds needs = case_needs(raster.count(), anatomies, config.ct.has_value(), request.params.page);
  if (!request.params.check_disk) return;
  const double cache_mb = request.params.use_cache && request.cache.empty() ? needs.cache_mb : 0;
  require_disk(request.library, needs.disk_mb + std::min(cache_mb, static_cast<double>(request.params.cache_limit_mb)));
}

// The folders that the run writes into.
void make_folders(const RunRequest& request, const fs::path& made_in) {
  make_output_folder(made_in / "meshes");
  if (request.params.pictures || request.params.page) make_output_folder(made_in / "report");
  for (const fs::path& f : {made_in, made_in / "meshes", made_in / "report"}) remove_stale_temporaries(f);
  if (!request.keep.empty()) make_output_folder(request.keep);
}

pipeline::ExecuteOptions execution_of(const RunRequest& request, const fs::path& made_in,
                                      const pipeline::StageCache& cache) {
  pipeline::ExecuteOptions execution;
  execution.keep = request.keep;
  if (request.keep.empty()) execution.spill = made_in;  // who keeps all needs the disk for that
  execution.cache = &cache;
  execution.cancel = &cancel_requested();
  execution.allow_external = request.params.allow_external;
  execution.seconds_before = cache.seconds_before();
  return execution;
}

// Computes what the case needs and makes its content of it. What is refused and the scene can do without is taken out
// of `config`, or something stands for it. Where this throws, `made` holds what there is.
CaseContent compute(const RunRequest& request, config::CaseConfig& config, SeriesHashes& series,
                    pipeline::ExecuteOptions execution, pipeline::RunObserver& observer, const Progress& progress,
                    Made& made) {
  execution.made = &made.results;
  const std::vector<std::string> wanted = wanted_anatomies(config);
  while (true) try {
      execution.asked = asked_of(config, made.graph);
      made.results = pipeline::execute(made.graph, wanted_of(request, config, made.graph), execution, observer);
      require_modalities(config, made.graph, made.results);
      made.publishing_began = Clock::now();
      observer.publishing();
      const bool pictures = request.params.pictures;
      const FaceClearance cleared = require_no_face(config, made.graph, made.results, pictures, progress.silent());
      if (pictures && !cleared.scan_may_be_seen) log_warning(config.case_token + ": " + no_picture_of_scan);
      const PicturesOf of = !pictures                  ? PicturesOf::nothing
                            : cleared.scan_may_be_seen ? PicturesOf::surfaces_and_scan
                                                       : PicturesOf::surfaces;
      CaseContent content =
          make_case_content(config, made.graph, made.results, "trephine " + request.program_version,
                            series.input(config), {of, request.params.report == DrawnReport::full}, progress);
      sort_as(wanted, made.without);
      content.manifest.missing = made.without.missing;
      content.manifest.stand_ins = made.without.stand_ins;
      for (const WiderBound& w : made.without.wider) content.remarks.push_back(words_of(w));
      content.manifest.figures.emplace_back(
          "verdict", verdict_text(judge_anatomies(wanted, content.manifest, content.evidence), content.manifest,
                                  content.evidence, content.remarks));
      return content;
    } catch (const Error& e) {
      if (!concede(config, e, made.without)) throw;
      keep_made(made.graph, made.results, execution.known);
      made.graph = series.graph_of(config);
    }
}

// Publishes and remembers for the next run what this one took.
void publish_and_remember(const RunRequest& request, const fs::path& folder, const CaseContent& content,
                          const std::string& run, const Made& made, const pipeline::StageCache& cache,
                          pipeline::RunObserver& observer) {
  publish(folder, content, run);
  observer.progressed(publishing_step, 1);
  remove_refused(refused_folder(request.library, content.manifest.case_token));
  std::map<std::string, double> seconds_by_node = seconds_of(made);
  seconds_by_node[publishing_step] = std::chrono::duration<double>(Clock::now() - made.publishing_began).count();
  cache.remember_seconds(seconds_by_node);
  cache.shrink_to(static_cast<std::uint64_t>(request.params.cache_limit_mb) * 1'000'000);
}

RunResult result_of(const fs::path& folder, const CaseContent& content) {
  RunResult result;
  result.case_folder = folder;
  result.case_token = content.manifest.case_token;
  result.anatomies = content.anatomies;
  result.table = case_table(content.anatomies);
  if (const ParameterValue* verdict = find_item(content.manifest.figures, "verdict"))
    result.table += "\n" + std::get<std::string>(*verdict) + "\n";
  if (content.manifest.face_policy == "keep")
    result.table += "\nface: the case shows it (" + content.manifest.face_reason + "); " +
                    how_to_take_face_off(content.manifest.landmarks) + "\n";
  return result;
}

}  // namespace

RunResult run_case(const RunRequest& request, pipeline::RunObserver& observer) {
  const auto start = Clock::now();
  config::CaseConfig config = read_config(request);
  if (config.case_token.empty()) config.case_token = random_token();
  const std::string token = config.case_token;
  try {
    const fs::path folder = request.library / token;
    const fs::path cache_folder = cache_folder_of(request);
    require_outside(folder, request.keep, "--keep");
    require_outside(folder, request.cache, "--cache");
    require_outside(folder, request.json, "--json");
    require_face_policy(config);
    tell_choice(config);
    // Before anything works beside it. A case that is there already may be up to date, and looking at the machine would
    // take longer than that run.
    if (std::error_code ignored; !fs::exists(folder / "case.json", ignored))
      if (const std::string seconds = seconds_expected(config.trade); !seconds.empty()) observer.estimated(seconds);

    NewFolders new_folders;
    for (const fs::path& f : {request.library, cache_folder, request.keep})
      if (!f.empty()) new_folders.expect(f);
    make_output_folder(request.library);
    CasePlace place(folder);
    const fs::path made_in = place.made_in();
    make_folders(request, made_in);
    const pipeline::StageCache cache(cache_folder);

    const Progress cancelled({}, &cancel_requested());
    const Progress publishing([&](double share) { observer.progressed(publishing_step, share); }, &cancel_requested());
    const double content_share = request.params.page ? (request.params.pictures ? 0.5 : 0.2) : 0.9;
    SeriesHashes series(cancelled);
    Made made;
    made.graph = series.graph_of(config);
    const std::vector<std::string> about_patients = require_one_patient(config, names_of_scans(made.graph), cancelled);
    const pipeline::ExecuteOptions execution = execution_of(request, made_in, cache);
    EarlyWarnings early(observer, token, execution.seconds_before, [&](const dicom::ImportFigures& scan) {
      check_needs(request, config, made.graph, scan, observer);
    });
    CaseContent content;
    try {
      content = compute(request, config, series, execution, early, publishing.part(0, content_share), made);
    } catch (const Error& e) {
      std::vector<stages::GradedWarning> warnings;
      if (!made.results.empty()) warnings = tell_warnings(token, about_patients, series.folders(), made);
      const std::optional<Error> other = with_other_configs(e, request.config, config);
      const Error told = other.value_or(e);
      show_refusal(refused_folder(request.library, token), {config, made.graph, made.results, cache, warnings}, e, told,
                   observer);
      if (!other) throw;
      throw told;
    }
    std::vector<stages::GradedWarning> warnings = tell_warnings(token, about_patients, series.folders(), made);
    const auto add_warnings = [&](const std::vector<std::string>& lines) {
      for (const std::string& line : lines) log_warning(token + ": " + line);
      for (const std::string& line : lines) warnings.push_back({line, stages::Severity::look});
    };
    add_warnings(cases::overlapping_holes(content.manifest.burr_holes));
    if (request.params.page)
      for (CasePicture& file :
           make_page_files(config, made.graph, made.results, content, warnings, publishing.part(content_share, 0.95)))
        content.pictures.push_back(std::move(file));
    cancelled.check();
    place.require_held();
    RunResult result = result_of(folder, content);
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    add_warnings(overrun(config.trade, seconds));
    result.json = run_json(made.graph, made.results, printed(series.folders().at(made.graph.nodes[0].name)),
                           content.anatomies, warnings, seconds);
    result.warnings = std::move(warnings);
    publish_and_remember(request, made_in, content, result.json, made, cache, observer);
    place.appear();
    return result;
  } catch (Error& e) {
    e.in_case(token);
    throw;
  }
}

}  // namespace trephine::publish
