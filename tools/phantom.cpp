// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/phantom.h"

#include "cli/command.h"
#include "stage_command.h"

namespace trephine::tools {

const cli::OwnCommand phantom_command([] {
  cli::Command c;
  c.name = "phantom";
  c.summary = "makes a synthetic head, spine or chest as a CT series, with its truth";
  c.description =
      "Scans an analytic head (skin, skull, brain, ventricles), whose surfaces are known to a fraction of a "
      "micrometre, with a simulated CT scanner: partial volume, kernel blur, correlated noise, tilt and, at clinical "
      "level, cupping, streaks and sulci. FOLDER/dicom holds the series; FOLDER/truth holds its labels, surfaces, "
      "landmarks and truth.json, which `measure --truth` reads; FOLDER/second, if asked for, another scan of the head "
      "and "
      "where it lies. With --body spine it is a lumbar spine of plain shapes, "
      "whose pedicles truth.json holds; with --body chest a chest with clavicles, subclavian veins and arteries, and "
      "lungs, whose middle lines and sternal notch truth.json holds. With --print it is a printed head, filled with "
      "gel, "
      "with a hole and a catheter if they are given, and no truth is written. The same parameters give the same bytes.";
  c.examples = {"trephine phantom head --variant hydrocephalic --seed 7",
                "trephine phantom head --level clinical --tilt-deg 13.5 --slice-step-mm 2.5 --slices-count 80",
                "trephine phantom head --level hard --mask --couch --clamps --noise-hu 30 --second-kernel-mm 0.6",
                "trephine phantom spine --body spine --columns-count 256 --rows-count 256 --field-of-view-mm 240",
                "trephine phantom chest --body chest --columns-count 256 --rows-count 256 --field-of-view-mm 330 "
                "--slices-count 112"};
  cli::Argument out;
  out.name = "folder";
  out.kind = cli::Argument::Kind::out_folder;
  out.help = "Folder in which dicom/ and truth/ are made.";
  out.required = out.positional = true;
  c.arguments = {out, report_argument()};
  c.groups = {cli::ParameterGroup::of<phantom::BodyParams>("Body"),
              cli::ParameterGroup::of<phantom::HeadParams>("Head"),
              cli::ParameterGroup::of<phantom::HardParams>("Hard"),
              cli::ParameterGroup::of<phantom::ImplantParams>("Implants"),
              cli::ParameterGroup::of<phantom::ScanParams>("Scanner"),
              cli::ParameterGroup::of<phantom::SeriesParams>("Series"),
              cli::ParameterGroup::of<phantom::TruthParams>("Truth"),
              cli::ParameterGroup::of<phantom::SecondScanParams>("Second scan"),
              cli::ParameterGroup::of<phantom::PrintedParams>("Print")};
  c.run = [](const cli::ParsedCommand& parsed) {
    phantom::PhantomParams params;
    params.body = parsed.params<phantom::BodyParams>();
    params.head = parsed.params<phantom::HeadParams>();
    params.head.hard = parsed.params<phantom::HardParams>();
    params.head.implants = parsed.params<phantom::ImplantParams>();
    params.scan = parsed.params<phantom::ScanParams>();
    params.series = parsed.params<phantom::SeriesParams>();
    params.truth = parsed.params<phantom::TruthParams>();
    params.second = parsed.params<phantom::SecondScanParams>();
    params.printed = parsed.params<phantom::PrintedParams>();
    run_with_report(parsed, [&](const Progress& progress) {
      return printed(figures_of(phantom::make_phantom(parsed.path("folder"), params, progress)), {});
    });
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::tools
