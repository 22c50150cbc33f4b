// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/write_file.h"
#include "cli/argument.h"
#include "commands.h"
#include "itk/volume_write.h"
#include "segmentation/correct.h"
#include "stage_command.h"

namespace trephine {
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

Command correction_command() {
  using Kind = Argument::Kind;
  Command c;
  c.name = "correction";
  c.summary = "takes out what a person changed of a label";
  c.description =
      "Compares the labels that were exported with the labels as they came back from 3D Slicer or ITK-SNAP, and keeps "
      "the "
      "voxels that were added or removed, and nothing else. The stage `correct` applies them, also to a segmentation "
      "that was made anew meanwhile; a case's configuration names them by anatomy: corrections: {skull: FILE}. "
      "docs/other-programs.md goes through it step by step.";
  c.examples = {"trephine correction labels.seg.nrrd painted.seg.nrrd --label skull --output skull_correction.nrrd",
                "trephine correction labels.nii.gz painted.nii.gz --label 2 --output skull_correction.nrrd"};
  const Argument before = positional_argument(
      "before", Kind::in_file, "Labels as `export --labels` wrote them (.seg.nrrd, .nii.gz, .mha, ...).");
  const Argument after = positional_argument("after", Kind::in_file, "The same labels after painting.");
  const Argument output = required_argument("output", Kind::out_file, "Where the correction goes (.nrrd).");
  c.arguments = {before, after, output, report_argument()};
  c.groups = {ParameterGroup::of<CorrectionParams>("Parameters")};
  c.run = [](const ParsedCommand& parsed) {
    const auto& params = parsed.params<CorrectionParams>();
    run_with_report(parsed, [&](const Progress&) {
      Report report;
      const LabelFile made =
          correction_between(read_label_file(parsed.path("before")), read_label_file(parsed.path("after")),
                             params.label, params.painted_label.empty() ? params.label : params.painted_label, report);
      write_file(parsed.path("output"), encode_labels(made));
      return report;
    });
    return ExitCode::ok;
  };
  return c;
}

}  // namespace trephine
