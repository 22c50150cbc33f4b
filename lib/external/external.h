// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"
#include "grid/labels.h"

namespace trephine::external {

struct ExternalWord {
  std::string text;
  template <class V>
  static void describe(V& v) {
    v.text(&ExternalWord::text, "", "One word, as it is: no shell reads it.");
  }
};

struct ExternalLabel {
  int value = 1;
  template <class V>
  static void describe(V& v) {
    v.integer(&ExternalLabel::value, "", Range{1, 32767}, "The label's value in the map.");
  }
};

struct ExternalParams {
  std::string program, version, labels_file = "labels.nii.gz";
  std::vector<ExternalWord> arguments, version_arguments{{"--version"}}, may_write;
  Named<ExternalWord> environment;
  Named<ExternalLabel> names;
  double time_limit_s = 3600, memory_limit_gb = 16;
  bool same_grid = true, require_confined = false;

  template <class V>
  static void describe(V& v) {
    using P = ExternalParams;
    v.text(&P::program, "program", "The program: a name that is found in PATH, or an absolute path.");
    v.text(
        &P::version, "version",
        "What the first line of its version must hold, such as 2.4; it counts for the cache, so that another version "
        "is another result.");
    v.list(&P::arguments, "arguments",
           "Its arguments. {input} stands for the scan (.nii.gz, HU), {output} for the file that it shall write, "
           "{folder} "
           "for the folder of both, {threads} for the number of threads.")
        .at_most(256);
    v.list(&P::version_arguments, "version_arguments", "Arguments by which it says its version.").at_most(16);
    v.text(&P::labels_file, "labels_file",
           "The map of labels that it writes, within the folder: .nii, .nii.gz, .nrrd.");
    v.map(&P::names, "names", "Names of labels by their values, for labels: {label: NAME}.").at_most(1000);
    v.map(&P::environment, "environment", "Variables of its environment, which is empty but for PATH, HOME and TMPDIR.")
        .at_most(64);
    v.list(&P::may_write, "may_write", "Folders in which it may write beside its own, absolute.").at_most(16);
    v.number(&P::time_limit_s, "time_limit_s", Range{0.1, 1e6}, "It is ended after this time.");
    v.number(&P::memory_limit_gb, "memory_limit_gb", Range{0.1, 1e5},
             "It is ended where its processes together take more memory than this.");
    v.flag(&P::same_grid, "same_grid", "Refuse labels that do not lie on the scan's voxels; else they are resampled.");
    v.flag(&P::require_confined, "require_confined",
           "Refuse where the kernel cannot take the network and other folders from it, instead of warning.");
  }
};

/// What is printed of it, and what a case records of the program.
struct ExternalResult {
  std::string said_version;
  std::string program_sha256;
  std::string output_sha256;
  std::string output_format;
  std::size_t labels_count = 0;
  double labelled_ml = 0;
  template <class V>
  static void describe(V& v) {
    using P = ExternalResult;
    v.text(&P::said_version, "said_version", "First line of what the program says of its version.");
    v.text(&P::program_sha256, "program_sha256", "SHA-256 of the program's file.");
    v.text(&P::output_sha256, "output_sha256", "SHA-256 of what it wrote.");
    v.text(&P::output_format, "output_format", "Format of that.");
    v.integer(&P::labels_count, "labels_count", Range{}, "Labels.");
    v.number(&P::labelled_ml, "labelled_ml", Range{}, "Volume with a label.");
  }
};

/// Lets another program label the volume. It runs as run_confined says (external/confined.h), with an empty home and
/// an empty folder of its own, which is removed afterwards. It gets the volume as NIfTI, HU, with nothing of the
/// patient but the voxels. What it wrote is not trusted: no link out of the folder is followed, and the map is checked
/// as decode_labels does.
///
/// The map has one layer of uint8 or int16 with the declared names. Warns where the program was not confined, and of
/// what the file's reader warns.
///
/// Throws Error: 64 for parameters that make no sense, and where the program says another version; 66 where there is no
/// such program; 70 where it exceeds a limit, is killed, or ends with another code than 0 (with the last line that it
/// said), or is not confined and had to be; 65 where its output is missing or no map of labels; 80 where the map lies
/// on another grid than the volume's (same_grid), or holds no label; 73, 74; Cancelled.
Outcome<grid::LabelFile, ExternalResult> run_external(const grid::HuVolume& volume, const ExternalParams& params,
                                                      const Progress& progress = {});

}  // namespace trephine::external
