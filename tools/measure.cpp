// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/measure.h"

#include <algorithm>

#include "base/error.h"
#include "base/time_limit.h"
#include "base/write_file.h"
#include "cli/command.h"
#include "grid/bounded_read.h"
#include "meshio/read_mesh.h"
#include "meshio/vtp.h"
#include "metrics/certify.h"
#include "phantom/measure_truth.h"
#include "picture/deviation_picture.h"
#include "stage_command.h"

namespace trephine::tools {
namespace {

struct LabelParams {
  int label = 0, last_label = 0;
  template <class V>
  static void describe(V& v) {
    using P = LabelParams;
    v.integer(&P::label, "label", Range{0, 255},
              "With --labels: the label to compare with; 0: every voxel that is not 0.");
    v.integer(&P::last_label, "last_label", Range{0, 255},
              "With --label: all labels from that one to this, together; 0: only that one.");
  }
};

struct LimitParams {
  double total_limit_s = 3600;
  template <class V>
  static void describe(V& v) {
    v.number(&LimitParams::total_limit_s, "total_limit_s", Range{0.1, 86400},
             "Limit on the wall clock time of all of it; after it the measuring is given up (exit code 70).");
  }
};

// A mask of the voxels that have the requested labels.
grid::Mask selected(grid::Mask labels, const LabelParams& params) {
  const int first = params.label ? params.label : 1;
  const int last = !params.label ? 255 : std::max(params.label, params.last_label);
  for (std::uint8_t& v : labels.voxels) v = v >= first && v <= last;
  return labels;
}

cli::Argument file_argument(const char* name, const char* help) {
  cli::Argument a;
  a.name = name;
  a.help = help;
  return a;
}

phantom::Anatomy anatomy_named(const std::string& name) {
  for (const phantom::Anatomy a : phantom::all_anatomies)
    if (name == phantom::name_of(a)) return a;
  throw Error(ExitCode::usage, "", "--anatomy",
              "is needed with --truth: which of the truth's anatomies the surface is");
}

// A flag that would have no effect is refused.
void check_flags(const cli::ParsedCommand& parsed) {
  if (parsed.has("reference") + parsed.has("labels") + parsed.has("truth") > 1)
    throw Error(ExitCode::usage, "", "--reference, --labels, --truth", "at most one of them can be given");
  if (!parsed.has("reference") && (parsed.has("picture") || parsed.params<metrics::CertifyParams>().certify))
    throw Error(ExitCode::usage, "", parsed.has("picture") ? "--picture" : "--certify",
                "is of a comparison, give --reference too");
  if (parsed.has("anatomy") && !parsed.has("truth"))
    throw Error(ExitCode::usage, "", "--anatomy", "is of the truth, give --truth too");
  for (const char* label : {"label", "last_label"})
    if (parsed.given.count(label) && !parsed.has("labels"))
      throw Error(ExitCode::usage, "", label == std::string("label") ? "--label" : "--last-label",
                  "is one of the labels, give --labels too");
  if (parsed.given.count("last_label") && !parsed.given.count("label"))
    throw Error(ExitCode::usage, "", "--last-label", "ends a range, give --label, where it begins, too");
}

// Reads a file of ours directly, and a file of another program by the reader of its format.
surface::TriMesh read_surface(const std::filesystem::path& file) {
  if (file.extension() == ".vtp") return meshio::read_vtp(file);
  return meshio::read_mesh_file(file).value;
}

// Measures the surface, or the field where the file is a .nrrd.
Report measure_against_truth(const cli::ParsedCommand& parsed, const Progress& progress) {
  const phantom::Anatomy anatomy = anatomy_named(parsed.text("anatomy"));
  const phantom::Truth truth = phantom::read_truth(parsed.path("truth"));
  const auto& params = parsed.params<metrics::MeasureParams>();
  const auto known = [&] { return phantom::truth_surface(truth, anatomy, progress.part(0, 0.4)); };
  if (parsed.path("surface").extension() == ".nrrd") {
    const grid::Field field = grid::read_foreign_field(parsed.path("surface"));
    return printed(
        figures_of(phantom::measure_against_truth(field, known(), params.sample_count, progress.part(0.4, 1))), {});
  }
  const surface::TriMesh surface = read_surface(parsed.path("surface"));
  return printed(phantom::measure_against_truth(surface, known(), params, progress.part(0.4, 1)));
}

Report measure_against_mesh(const cli::ParsedCommand& parsed, const surface::TriMesh& mesh, const Progress& progress) {
  const surface::TriMesh reference = read_surface(parsed.path("reference"));
  Report report = printed(metrics::measure_surface(mesh, metrics::MeshReference{&reference},
                                                   parsed.params<metrics::MeasureParams>(), progress.part(0, 0.4)));
  if (const auto& certify = parsed.params<metrics::CertifyParams>(); certify.certify) {
    const auto proven = figures_of(
        metrics::CertifiedFigures(metrics::certify_deviation(mesh, reference, certify, progress.part(0.4, 0.8))));
    report.figures.insert(report.figures.end(), proven.begin(), proven.end());
  }
  if (parsed.has("picture"))
    write_file(parsed.path("picture"),
               picture::encode_png(picture::deviation_picture(mesh, reference, 0, progress.part(0.8, 1))));
  return report;
}

}  // namespace

const cli::OwnCommand measure_command([] {
  const stages::StageType& stage = stages::stage_named("measure");
  cli::Command c;
  c.name = stage.name;
  c.summary = stage.summary;
  c.description = stage.description +
                  " Against labels it also gives Dice. Against the truth of a phantom, distances are to its analytic "
                  "surface (caps, where the scan cuts the surface, are left out); a field is compared with the truth "
                  "on its own voxels, with Dice, volume and, for a skull, how much too thick it is.";
  c.examples = stage.examples;
  cli::Argument surface = file_argument(
      "surface",
      "Surface to measure (.vtp, .stl, .ply, .obj, .vtk, .glb); with --truth also the field of an anatomy (.nrrd).");
  surface.positional = surface.required = true;
  cli::Argument anatomy = file_argument("anatomy", "The anatomy of the truth that the surface or field shows.");
  anatomy.kind = cli::Argument::Kind::choice;
  for (const phantom::Anatomy a : phantom::all_anatomies) anatomy.choices.push_back(phantom::name_of(a));
  cli::Argument picture = file_argument(
      "picture", "With --reference: the surface coloured by its distance to it, red outside, blue inside (.png).");
  picture.kind = cli::Argument::Kind::out_file;
  c.arguments = {surface,
                 file_argument("reference", "Surface to compare with, in the same formats."),
                 file_argument("labels", "Labels to compare with (.nrrd)."),
                 file_argument("truth", "Truth of a phantom (truth.json)."),
                 anatomy,
                 picture,
                 report_argument()};
  c.groups = {{"Parameters", stage.make_params},
              cli::ParameterGroup::of<LabelParams>("Labels"),
              cli::ParameterGroup::of<metrics::CertifyParams>("Proof"),
              cli::ParameterGroup::of<LimitParams>("Limit")};
  c.run = [](const cli::ParsedCommand& parsed) {
    check_flags(parsed);
    const auto measure = [&](const Progress& progress) -> Report {
      if (parsed.has("truth")) return measure_against_truth(parsed, progress);
      if (parsed.path("surface").extension() == ".nrrd")
        throw Error(ExitCode::usage, parsed.path("surface").string(), "--truth",
                    "is needed for a field: it is measured against a phantom's truth alone");
      const surface::TriMesh mesh = read_surface(parsed.path("surface"));
      const auto& params = parsed.params<metrics::MeasureParams>();
      if (parsed.has("labels")) {
        const grid::Mask labels =
            selected(grid::read_foreign_mask(parsed.path("labels")), parsed.params<LabelParams>());
        return printed(metrics::measure_surface(mesh, metrics::LabelReference{&labels, 0}, params, progress));
      }
      if (!parsed.has("reference")) return printed(metrics::measure_surface(mesh, {}, params, progress));
      return measure_against_mesh(parsed, mesh, progress);
    };
    run_with_report(parsed, [&](const Progress& progress) {
      return within_time(parsed.params<LimitParams>().total_limit_s, progress,
                         [&](const TimeLimit& limit) { return measure(limit.progress()); });
    });
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
