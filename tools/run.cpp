// SPDX-License-Identifier: GPL-3.0-or-later
#include <atomic>
#include <iostream>

#include "base/log.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "cli/progress_display.h"
#include "library/sheet.h"
#include "mask/scan_verdict.h"
#include "named_values.h"
#include "publish/run_case.h"

namespace trephine::tools {
namespace {

// A library that has an overview keeps it true. The case is published, whatever becomes of its overview.
void refresh_sheet(const std::filesystem::path& library) {
  if (!library::has_sheet(library)) return;
  try {
    library::make_sheet(library);
  } catch (const Error& e) {
    log_warning("index.html and contact_sheet.png are of before this run: " + std::string(e.what()) +
                "; make them with `trephine library list " + library.string() + " --sheet`");
  }
}

constexpr double min_line_s = 1;  // stages that take less are told by the table at the end alone

// Shows the run's stages on the terminal: those that take long or have something to say.
class DisplayObserver : public pipeline::RunObserver {
 public:
  explicit DisplayObserver(bool quiet) : quiet_(quiet), display_(quiet) {}
  void kept(const std::filesystem::path& folder, bool with_pictures) override {
    if (!quiet_)
      log_line((with_pictures ? "pictures of what was made are kept for looking in "
                              : "the message alone is kept, for there is nothing that may be looked at, in ") +
               folder.string());
  }
  void estimated(const std::string& needs) override {
    if (!quiet_) log_line(needs);
  }
  void planned(const std::vector<std::pair<std::string, double>>& expected_s) override { display_.plan(expected_s); }
  void publishing() override {
    if (cached_ > 0 && !quiet_)
      log_line(std::to_string(cached_) + (cached_ == 1 ? " stage" : " stages") + " came from the cache");
    cached_ = 0;
    display_.start(publish::publishing_step);
  }
  void started(const std::string& node) override { display_.start(node); }
  void progressed(const std::string& node, double fraction) override { display_.report(node, fraction); }
  void finished(const std::string& node, bool cached, double, const stages::StageOutcome& made) override {
    cached_ += cached;
    std::string note;
    if (const auto* scan = result_if<mask::ScanResult>(made.result))
      note = scan->verdict + (cached ? ", from the cache" : "");
    display_.finish(node, note, min_line_s);
  }

 private:
  bool quiet_;
  std::atomic<int> cached_{0};
  cli::ProgressDisplay display_;
};

struct BesideParams {
  bool explain = false, sheet = true;
  template <class V>
  static void describe(V& v) {
    v.flag(&BesideParams::sheet, "sheet",
           "Make index.html and contact_sheet.png of the library again, where it has them.");
    v.flag(&BesideParams::explain, "explain",
           "Say what would be computed, what is cached or skipped, how long it took last time, and why; compute "
           "nothing (as JSON with --json).");
  }
};

}  // namespace

const cli::OwnCommand run_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "run";
  c.summary = "builds a patient case from a CT series, as a configuration describes it";
  c.description =
      "Reads the series, computes what the configuration's scene needs and nothing else, checks the results against "
      "the scene's limits, and publishes the case as LIBRARY/CASE/case.json with its surfaces and pictures. The "
      "library holds the old case or the new one, never a mixture. The same input, configuration and version give the "
      "same bytes.";
  c.examples = {"trephine run configs/sample.yaml --out out",
                "trephine run configs/ct_head.yaml --series DICOM-FOLDER --out library --case head-01",
                "trephine run configs/sample.yaml --out out --set skull.decimate.max_deviation_mm=0.2"};
  const cli::Argument config = cli::positional_argument("config", Kind::in_file, "Configuration of the case (.yaml).");
  const cli::Argument out =
      cli::required_argument("out", Kind::out_folder, "Library: the folder in which the case's folder is made.");
  cli::Argument set =
      cli::argument("set", Kind::text, "Override anatomy.stage.parameter=value, or import.parameter=value.");
  cli::Argument root =
      cli::argument("root", Kind::in_folder, "A further folder that paths in the configuration may lead to.");
  cli::Argument scan = cli::argument(
      "scan", Kind::text, "NAME=PATH: a further scan that the configuration names (mr=FOLDER); overrides its path.");
  set.repeated = root.repeated = scan.repeated = true;
  cli::Argument modality =
      cli::argument("modality", Kind::choice,
                    "ct says that the values of a volume file that is no DICOM (--series head.nii.gz) are "
                    "HU; the same as --set import.volume_values=hu.");
  modality.choices = {"ct"};
  cli::Argument rule = cli::argument("series_rule", Kind::choice,
                                     "best takes the series that `import --list` proposes; the same as --set "
                                     "import.series_rule=best.");
  rule.choices = {"best"};
  c.arguments = {
      config,
      out,
      cli::argument("series", Kind::in_scan,
                    "Folder, ZIP archive or volume file with the CT; overrides the configuration's."),
      modality,
      rule,
      cli::argument("landmarks", Kind::in_file,
                    "Landmarks that a person placed (.mrk.json or .fcsv of 3D Slicer); they replace others."),
      scan,
      set,
      root,
      cli::argument("keep", Kind::out_folder, "Also write the output of every stage into this folder."),
      cli::argument("cache", Kind::out_folder, "Folder of the stage cache, instead of LIBRARY/.trephine-cache."),
      cli::argument("json", Kind::out_file, "Also write run.json (times, reports, memory) here.")};
  c.groups = {cli::ParameterGroup::of<publish::RunParams>("Parameters"),
              cli::ParameterGroup::of<BesideParams>("Beside the case")};
  c.only_looks = [](const cli::ParsedCommand& parsed) { return parsed.params<BesideParams>().explain; };
  c.run = [](const cli::ParsedCommand& parsed) {
    publish::RunRequest request;
    request.config = parsed.path("config");
    request.library = parsed.path("out");
    request.overrides.series = parsed.path("series");
    request.overrides.landmarks = parsed.path("landmarks");
    request.overrides.set = parsed.all("set");
    request.overrides.scans = named_paths("--scan", parsed.all("scan"));
    if (parsed.has("modality")) request.overrides.set.insert(request.overrides.set.begin(), "import.volume_values=hu");
    if (parsed.has("series_rule"))
      request.overrides.set.insert(request.overrides.set.begin(), "import.series_rule=best");
    for (const std::string& r : parsed.all("root")) request.overrides.roots.emplace_back(r);
    request.params = parsed.params<publish::RunParams>();
    request.keep = parsed.path("keep");
    request.cache = parsed.path("cache");
    request.json = parsed.path("json");
    request.program_version = TREPHINE_VERSION;
    if (parsed.params<BesideParams>().explain) {
      const publish::Explanation explanation = publish::explain_case(request);
      std::cout << publish::explanation_table(explanation);
      if (parsed.has("json")) write_file(parsed.path("json"), publish::explanation_json(explanation));
      return ExitCode::ok;
    }
    publish::RunResult result;
    {
      DisplayObserver observer(parsed.quiet);
      result = publish::run_case(request, observer);
    }
    if (parsed.params<BesideParams>().sheet) refresh_sheet(request.library);
    if (!parsed.quiet) std::cout << "\n" << result.table << "\n" << (result.case_folder / "case.json").string() << "\n";
    if (parsed.has("json")) write_file(parsed.path("json"), result.json);
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
