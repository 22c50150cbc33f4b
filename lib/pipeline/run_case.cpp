// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/run_case.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <random>

#include "base/error.h"
#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/write_file.h"
#include "cases/case.h"
#include "cases/glb.h"
#include "meshing/validity.h"
#include "pipeline/case_lock.h"
#include "pipeline/case_pictures.h"
#include "pipeline/run_json.h"

namespace trephine {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

// From the system's entropy: a case's name is never derived from the patient (acceptance P3).
std::string random_token() {
  std::random_device source;
  std::string token = "case-";
  for (int i = 0; i < 10; ++i) token += "0123456789abcdefghijkmnpqrstuvwxyz"[source() % 34];
  return token;
}

double number(const Report& report, const char* name) {
  const ParameterValue* v = report.find(name);
  if (!v) return 0;
  if (const auto* d = std::get_if<double>(v)) return *d;
  if (const auto* i = std::get_if<std::int64_t>(v)) return static_cast<double>(*i);
  return 0;
}

std::string text(const Report& report, const char* name) {
  const ParameterValue* v = report.find(name);
  const auto* s = v ? std::get_if<std::string>(v) : nullptr;
  return s ? *s : std::string();
}

// Skin of a head is a face: it is published only where the scene says so, and why.
void require_face_policy(const CaseConfig& config) {
  if (!config.face.empty()) return;
  for (const SceneAnatomy& wanted : config.scene)
    if (config.find_anatomy(wanted.name)->shows_face)
      throw Error(ExitCode::privacy, "", "scene.face",
                  wanted.name + " shows the patient's face; the scene must say `face: {policy: keep, reason: ...}`");
}

// A case folder in which nothing was ever published goes again where the run fails: nothing is left behind that looks
// like a case. Made and destroyed under the case's lock, for only there it is certain that no other run publishes.
struct UnpublishedFolder {
  explicit UnpublishedFolder(const fs::path& f) : folder(f) {}
  fs::path folder;
  ~UnpublishedFolder() {
    std::error_code ignored;
    // Where the disk does not say whether there is a case, there may be one.
    if (fs::symlink_status(folder / "case.json", ignored).type() != fs::file_type::not_found) return;
    // Only what a run of ours makes; a file of somebody else's keeps the folder.
    for (const char* ours : {"meshes", "report"}) fs::remove_all(folder / ours, ignored);
    for (const auto& entry : fs::directory_iterator(folder, ignored))
      if (entry.path().filename() != ".lock") return;
    fs::remove(folder / ".lock", ignored);
    fs::remove(folder, ignored);
  }
};

// Folders that the run makes and leaves empty, for it failed, go again.
class NewFolders {
 public:
  ~NewFolders() {
    std::error_code ignored;
    for (auto f = missing_.rbegin(); f != missing_.rend(); ++f)
      fs::remove(*f, ignored);  // not where something is in it
  }
  // Before it is made.
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

// A case's folder holds the case and nothing else: what the user asks for beside it goes elsewhere.
void require_outside(const fs::path& case_folder, const fs::path& output, const char* flag) {
  if (output.empty()) return;
  const fs::path inside =
      fs::weakly_canonical(fs::absolute(output)).lexically_relative(fs::weakly_canonical(fs::absolute(case_folder)));
  if (inside.empty() || *inside.begin() == "..") return;
  throw Error(ExitCode::usage, output.string(), flag, "lies in the case's own folder, choose another");
}

// What a run's results are collected in on the way to the case.
struct Run {
  explicit Run(const RunRequest& r) : request(r) {}
  const RunRequest& request;
  CaseConfig config;
  Graph graph;
  std::vector<NodeResult> results;
  Report folder;  // what else lay in the series' folder
  CaseManifest manifest;
  std::vector<AnatomyResult> anatomies;
  std::vector<std::string> warnings;

  const NodeResult& at(int node) const { return results[static_cast<std::size_t>(node)]; }
  const TriMesh& mesh(int node) const { return *std::get<std::shared_ptr<const TriMesh>>(at(node).data); }
  const Report& report_of(const std::string& node) const {
    static const Report none;
    const int i = graph.find(node);
    return i < 0 ? none : at(i).report;
  }
};

// The nodes whose data or report the case needs; what only they need is computed too, nothing else.
std::vector<int> wanted_nodes(const Graph& graph, bool pictures) {
  std::vector<int> wanted;
  if (pictures) wanted.push_back(0);
  for (const Graph::Anatomy& a : graph.anatomies) {
    wanted.push_back(a.surface);
    wanted.push_back(a.measure);
  }
  // The reports of every stage of a published anatomy go into the case; a stage that the cache lets us skip has its
  // there.
  return wanted;
}

void hold_against_limits(const SceneAnatomy& limit, const AnatomyResult& result) {
  if (limit.max_triangles > 0 && result.triangles_after > limit.max_triangles)
    throw Error(ExitCode::quality, "", limit.name,
                std::to_string(result.triangles_after) + " triangles, the scene allows " +
                    std::to_string(limit.max_triangles) + "; decimation stopped by " + result.stopped_by);
  if (limit.max_deviation_mm > 0 && !(result.deviation_max_mm <= limit.max_deviation_mm))
    throw Error(ExitCode::quality, "", limit.name,
                "deviates by " + to_text(result.deviation_max_mm) +
                    " mm from the unreduced surface, the scene allows " + to_text(limit.max_deviation_mm) + " mm");
}

// The sum of the bounds that the stages which moved the surface were given, and of what they used.
void add_budget(const Run& run, const RecipeAnatomy& recipe, CaseAnatomy& out) {
  for (const RecipeStep& step : recipe.steps) {
    const Report& report = run.report_of(recipe.name + "." + step.type->name);
    for (const char* bound : {"max_deviation_mm", "max_displacement_mm"})
      if (const Parameter* p = step.params.set->find(bound)) {
        out.budget_asked_mm += std::get<double>(step.params.get(*p));
        out.budget_used_mm += number(report, step.type->name == "smooth" ? "displacement_max_mm" : "deviation_max_mm");
      }
  }
}

// Fills the anatomy's part of the manifest; the bytes of its GLB are returned, not yet written: an anatomy after it may
// still be refused.
std::string finish_anatomy(Run& run, std::size_t index) {
  const Graph::Anatomy& nodes = run.graph.anatomies[index];
  const RecipeAnatomy& recipe = *run.config.find_anatomy(nodes.name);
  const TriMesh& surface = run.mesh(nodes.surface);
  const Report& measured = run.at(nodes.measure).report;

  GlbParams glb;
  glb.center_mm = run.manifest.center_mm;
  glb.name = nodes.name;
  glb.colour_rgb = recipe.colour_rgb;
  glb.opacity = recipe.opacity_ratio;
  std::string bytes = make_glb(surface, glb);
  // What is published is float32 about the case's centre: the invariant must hold for that, not for our doubles.
  require_valid(read_glb(std::string_view(bytes)).mesh);

  CaseAnatomy out;
  out.name = nodes.name;
  out.colour_rgb = recipe.colour_rgb;
  out.opacity = recipe.opacity_ratio;
  out.triangles = surface.triangles.size();
  out.points = surface.points_mm.size();
  out.volume_ml = volume_mm3(surface) / 1000;
  out.area_cm2 = area_mm2(surface) / 100;
  out.deviation = {number(measured, "deviation_max_mm"), number(measured, "deviation_p99_mm"),
                   number(measured, "deviation_rms_mm")};
  add_budget(run, recipe, out);

  AnatomyResult result;
  result.name = nodes.name;
  const Report& decimated = run.report_of(nodes.name + ".decimate");
  result.triangles_before = static_cast<std::int64_t>(number(run.at(nodes.first_surface).report, "triangles_count"));
  result.triangles_after = static_cast<std::int64_t>(out.triangles);
  result.bytes_after = bytes.size();
  // A GLB is 24 bytes a vertex (position, normal) and 12 a triangle; a closed surface has half as many points.
  result.bytes_before = static_cast<std::uint64_t>(result.triangles_before) * 24;
  result.deviation_max_mm = out.deviation.max_mm;
  result.deviation_p99_mm = out.deviation.p99_mm;
  result.deviation_rms_mm = out.deviation.rms_mm;
  result.volume_ml = out.volume_ml;
  result.stopped_by = text(decimated, "stopped_by");
  for (const RecipeStep& step : recipe.steps) {
    const int node = run.graph.find(nodes.name + "." + step.type->name);
    if (node < 0) continue;
    result.seconds += run.at(node).seconds;
    for (const auto& f : run.at(node).report.figures)
      out.figures.emplace_back(step.type->name + "." + f.first, f.second);
  }
  for (const SceneAnatomy& limit : run.config.scene)
    if (limit.name == nodes.name) hold_against_limits(limit, result);

  const CaseFile file = describe_case_file("meshes/" + nodes.name, ".glb", bytes);
  out.file = file.name;
  run.manifest.files.push_back(file);
  run.manifest.anatomies.push_back(std::move(out));
  run.anatomies.push_back(result);
  return bytes;
}

void fill_provenance(Run& run, const std::string& input_hash) {
  CaseManifest& m = run.manifest;
  m.case_token = run.config.case_token;
  m.landmarks = run.config.landmarks;
  m.face_policy = run.config.face.empty() ? "none" : run.config.face;
  m.face_reason = run.config.face_reason;
  m.program_version = "trephine " + run.request.program_version;
  m.input_sha256 = input_hash;
  // Of the stages that the case was made by, and no others: parameters of what the scene does not demand change no
  // byte.
  for (const Node& node : run.graph.nodes)
    for (const Parameter& p : node.params.set->parameters)
      m.parameters.emplace_back(node.name + "." + p.name, node.params.get(p));
}

// The middle of the first surface's bounds, joined with the others', to whole mm: exact in float32 like the surfaces'
// own.
Vec3 center_of(const Run& run) {
  Bounds all;
  for (const Graph::Anatomy& a : run.graph.anatomies) {
    const Bounds b = bounds_of(run.mesh(a.surface));
    for (int i = 0; i < 3; ++i) {
      all.min_mm[i] = std::min(all.min_mm[i], b.min_mm[i]);
      all.max_mm[i] = std::max(all.max_mm[i], b.max_mm[i]);
    }
  }
  const Vec3 c = (all.min_mm + all.max_mm) / 2;
  return {std::round(c.x), std::round(c.y), std::round(c.z)};
}

std::string hash_input(Run& run, const Progress& cancelled) {
  try {
    return hash_of_series_input(run.config.series, run.config.import, cancelled, &run.folder);
  } catch (const Error& e) {
    if (e.code() != ExitCode::usage) throw;
    throw Error(e.code(), e.file(), e.field(), std::string(e.what()) + "; --set import.series=s1 chooses the first");
  }
}

// Of every stage that the case needs, published or not, and before anything is refused: they may say why it will be.
void tell_warnings(Run& run) {
  for (const std::string& w : run.folder.warnings) run.warnings.push_back("import: " + w);
  for (std::size_t i = 0; i < run.graph.nodes.size(); ++i)
    for (const std::string& w : run.results[i].report.warnings)
      run.warnings.push_back(run.graph.nodes[i].name + ": " + w);
  for (const std::string& w : run.warnings) log_warning(run.config.case_token + ": " + w);
}

std::vector<CasePicture> make_pictures(const Run& run, const Progress& cancelled) {
  std::vector<PictureAnatomy> shown;
  for (const Graph::Anatomy& a : run.graph.anatomies) {
    const RecipeAnatomy& recipe = *run.config.find_anatomy(a.name);
    shown.push_back({a.name, &run.mesh(a.surface), recipe.colour_rgb, recipe.opacity_ratio});
  }
  return make_case_pictures(*std::get<std::shared_ptr<const HuVolume>>(run.at(0).data), shown, cancelled);
}

// Pictures of an older state of the case would be taken for this one's.
void remove_other_pictures(const fs::path& folder, const std::vector<CasePicture>& pictures) {
  std::error_code ignored;
  std::vector<fs::path> others;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().extension() == ".png" && std::none_of(pictures.begin(), pictures.end(), [&](const CasePicture& p) {
          return entry.path().filename() == p.name;
        }))
      others.push_back(entry.path());
  for (const fs::path& f : others) fs::remove(f, ignored);
}

// Everything is made and may be published: from here on nothing but the disk can stop it. The pictures are not part of
// the case's bytes; they are written last before case.json, so that both change at nearly the same moment.
void publish(const Run& run, const fs::path& folder, const std::vector<std::string>& glbs,
             const std::vector<CasePicture>& pictures) {
  for (std::size_t i = 0; i < glbs.size(); ++i)
    write_case_file(folder, "meshes/" + run.graph.anatomies[i].name, ".glb", glbs[i]);
  for (const CasePicture& p : pictures) write_file(folder / "report" / p.name, p.png);
  publish_case(folder, run.manifest);
  remove_other_pictures(folder / "report", pictures);
  try {
    remove_unnamed_case_files(folder);
  } catch (const std::exception& e) {  // the case is published, whatever is left beside it
    log_warning(run.config.case_token + ": files of the older case are left: " + e.what());
  }
}

}  // namespace

RunResult run_case(const RunRequest& request, RunObserver& observer) {
  const auto start = Clock::now();
  Run run(request);
  ConfigOverrides overrides = request.overrides;
  if (!request.params.case_token.empty()) {
    validate_case_token(request.params.case_token, ExitCode::usage);
    overrides.case_token = request.params.case_token;
  }
  run.config = read_case_config(request.config, overrides);
  if (run.config.series.empty())
    throw Error(ExitCode::usage, request.config.string(), "series",
                "the configuration names none, give --series FOLDER");
  if (run.config.case_token.empty()) run.config.case_token = random_token();
  const std::string token = run.config.case_token;
  try {
    const fs::path folder = request.library / token;
    const fs::path cache_folder = !request.params.use_cache ? fs::path()
                                  : request.cache.empty()   ? request.library / ".trephine-cache"
                                                            : request.cache;
    require_outside(folder, request.keep, "--keep");
    require_outside(folder, request.cache, "--cache");
    require_outside(folder, request.json, "--json");
    require_face_policy(run.config);

    NewFolders new_folders;
    for (const fs::path& f : {request.library, cache_folder, request.keep})
      if (!f.empty()) new_folders.expect(f);
    make_output_folder(request.library);
    make_output_folder(folder);
    const CaseLock lock(folder);
    const UnpublishedFolder cleanup(folder);
    make_output_folder(folder / "meshes");
    if (request.params.pictures) make_output_folder(folder / "report");
    for (const fs::path& f : {folder, folder / "meshes", folder / "report"}) remove_stale_temporaries(f);
    if (!request.keep.empty()) make_output_folder(request.keep);
    const StageCache cache(cache_folder);

    const Progress cancelled({}, &cancel_requested());
    ExecuteOptions execution;
    execution.series = run.config.series;
    execution.input_sha256 = hash_input(run, cancelled);
    execution.keep = request.keep;
    execution.cache = &cache;
    execution.cancel = &cancel_requested();
    run.graph = make_graph(run.config, execution.input_sha256);
    run.results = execute(run.graph, wanted_nodes(run.graph, request.params.pictures), execution, observer);
    tell_warnings(run);

    run.manifest.center_mm = center_of(run);
    fill_provenance(run, execution.input_sha256);
    std::vector<std::string> glbs;
    for (std::size_t i = 0; i < run.graph.anatomies.size(); ++i) {
      cancelled.check();
      glbs.push_back(finish_anatomy(run, i));
    }
    const auto pictures = request.params.pictures ? make_pictures(run, cancelled) : std::vector<CasePicture>{};
    cancelled.check();
    publish(run, folder, glbs, pictures);
    cache.shrink_to(static_cast<std::uint64_t>(request.params.cache_limit_mb) * 1'000'000);

    RunResult result;
    result.case_folder = folder;
    result.case_token = token;
    result.anatomies = run.anatomies;
    result.warnings = run.warnings;
    result.table = case_table(run.anatomies);
    result.json = run_json(run.graph, run.results, run.folder, run.anatomies, run.warnings,
                           std::chrono::duration<double>(Clock::now() - start).count());
    write_file(folder / "run.json", result.json);
    return result;
  } catch (Error& e) {
    e.in_case(token);
    throw;
  }
}

}  // namespace trephine
