// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "pacs/label_objects.h"
#include "segmentation/correct.h"
#include "stage_command.h"

namespace trephine::tools {
namespace {

struct CorrectionParams {
  std::string label, painted_label;
  template <class V>
  static void describe(V& v) {
    using P = CorrectionParams;
    v.text(&P::label, "label",
           "The label that was painted: its value, or a segment's name or ID; empty for everything that is not 0.");
    v.text(&P::painted_label, "painted_label",
           "The same label in AFTER, where it has another name or value there; empty: as in BEFORE.");
  }
};

}  // namespace

const cli::OwnCommand correction_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "correction";
  c.summary = "takes out what a person changed of a label";
  c.description =
      "Compares the labels that were exported with the labels as they came back from 3D Slicer or ITK-SNAP, and keeps "
      "the "
      "voxels that were added or removed, and nothing else. The stage `correct` applies them, also to a segmentation "
      "that was made anew meanwhile; a case's configuration names them by anatomy: corrections: {skull: FILE}. "
      "docs/how-to/paint.md goes through it step by step.";
  c.examples = {"trephine correction labels.seg.nrrd painted.seg.nrrd --label skull --output skull_correction.nrrd",
                "trephine correction labels.nii.gz painted.nii.gz --label 2 --output skull_correction.nrrd"};
  const cli::Argument before = cli::positional_argument(
      "before", Kind::in_file, "Labels as `export --labels` wrote them (.seg.nrrd, .nii.gz, .mha, ...).");
  const cli::Argument after = cli::positional_argument("after", Kind::in_file, "The same labels after painting.");
  const cli::Argument output = cli::required_argument("output", Kind::out_file, "Where the correction goes (.nrrd).");
  c.arguments = {before, after, output, report_argument()};
  c.groups = {cli::ParameterGroup::of<CorrectionParams>("Parameters")};
  c.run = [](const cli::ParsedCommand& parsed) {
    const auto& params = parsed.params<CorrectionParams>();
    run_with_report(parsed, [&](const Progress&) {
      const auto made = segmentation::correction_between(
          pacs::read_label_file(parsed.path("before")), pacs::read_label_file(parsed.path("after")), params.label,
          params.painted_label.empty() ? params.label : params.painted_label);
      write_file(parsed.path("output"), grid::encode_labels(made.value));
      return printed(made);
    });
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
