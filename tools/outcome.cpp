// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>

#include "base/error.h"
#include "base/joined.h"
#include "base/log.h"
#include "base/text.h"
#include "base/warning.h"
#include "base/write_file.h"
#include "cases/load_hashed.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "cli/progress_display.h"
#include "dicom/import.h"
#include "outcome/case_chest.h"
#include "outcome/measure_outcome.h"
#include "outcome/outcome_picture.h"
#include "print/print_record.h"

namespace trephine::tools {
namespace {

/// Which series of the folder is read, and how.
struct ScanChoice {
  std::string token;
  dicom::GapPolicy gaps = dicom::GapPolicy::refuse;
  dicom::VolumeValues volume_values = dicom::VolumeValues::unsaid;
  std::string axes;
  template <class V>
  static void describe(V& v) {
    using P = ScanChoice;
    v.text(&P::token, "series_token",
           "Token of the series to read, where the folder holds several, as `trephine import --list` gives it.");
    v.choice(&P::gaps, "gaps", {{"refuse", dicom::GapPolicy::refuse}, {"interpolate", dicom::GapPolicy::interpolate}},
             "What to do where a slice is missing.");
    v.choice(&P::volume_values, "volume_values",
             {{"unsaid", dicom::VolumeValues::unsaid}, {"hu", dicom::VolumeValues::hu}},
             "What the values of a volume file are that is no DICOM: HU of a CT.");
    v.text(&P::axes, "axes",
           "Sides of the patient to which columns, rows and slices rise, in three letters such as LPS, against what "
           "the files say.");
  }
};

std::string at_text(Vec3 p) { return fmt::format("{:.1f}, {:.1f}, {:.1f}", p.x, p.y, p.z); }

std::string sighting_text(lesson::Sighting s, const std::vector<std::string>& doubts) {
  return lesson::to_text(s) + (doubts.empty() ? std::string() : " (" + joined(doubts) + ")");
}

std::string table_of(const lesson::OutcomeRecord& r, bool chest) {
  const lesson::OutcomeRegistration& g = r.registration;
  std::string out =
      fmt::format("registration    {}: bone {:.2f} mm off, mirrored {:.2f} mm; {:.0f} % of the case's bone\n",
                  sighting_text(g.sighting, g.doubts), g.residual_mm, g.mirrored_residual_mm, 100 * g.overlap_ratio);
  if (g.marks_count > 0)
    out = fmt::format("registration    {}: {} marks {:.2f} mm off; {:.2f} mm expected where the procedure aims\n",
                      sighting_text(g.sighting, g.doubts), g.marks_count, g.residual_mm, g.target_error_mm);
  if (!r.vertebrae.empty()) {
    out += fmt::format("level           shifted by a level bone lies {:.2f} mm off; {} vertebrae lie in the scan\n",
                       g.next_level_residual_mm, r.vertebrae.size());
    out += fmt::format("screws          {}\n", r.screws.empty() ? "none was found" : std::to_string(r.screws.size()));
    for (const lesson::OutcomeScrew& s : r.screws)
      out +=
          fmt::format("  {:<16} {}: tip {} mm (+- {:.2f}), {:.1f} mm long, {:.1f} mm wide\n", s.pedicle,
                      sighting_text(s.sighting, s.doubts), at_text(s.tip_mm), s.error_mm, s.length_mm, s.diameter_mm);
    return out;
  }
  if (chest) {
    out += fmt::format("lines           {}\n", r.lines.empty() ? "none was found" : std::to_string(r.lines.size()));
    for (const lesson::OutcomeLine& l : r.lines)
      out += fmt::format(
          "  {:<6} {}: tip {} mm (+- {:.2f}), {:.0f} mm from the skin, {:.0f} mm in the vein, {:.0f} mm in lung or "
          "pleura\n",
          l.side, sighting_text(l.sighting, l.doubts), at_text(l.tip_mm), l.error_mm, l.length_mm, l.in_vein_mm,
          l.in_lung_mm);
    return out;
  }
  out += fmt::format("catheter        {}\n",
                     r.courses.empty() ? "none was found" : sighting_text(r.catheter, r.catheter_doubts));
  for (const lesson::OutcomeCourse& c : r.courses)
    out += fmt::format(
        "  {:<6} tip {} mm (+- {:.2f}), {:.1f} mm from the inner table, bent by {:.1f} mm, {:.1f} mm wide as seen, "
        "confidence {:.2f}\n",
        c.side, at_text(c.tip_mm), c.error_mm, c.length_mm, c.bend_mm, c.width_mm, c.confidence);
  out += fmt::format("burr hole       {}\n", r.holes.empty() ? "none was found" : lesson::to_text(r.hole));
  for (const lesson::OutcomeHole& h : r.holes)
    out += fmt::format("  {:<6} middle {} mm (+- {:.2f}), {:.1f} mm wide, confidence {:.2f}\n", h.side,
                       at_text(h.outer_mm), h.error_mm, h.diameter_mm, h.confidence);
  for (const lesson::OutcomeOpening& o : r.openings)
    out += fmt::format(
        "opening         {}: middle {} mm (+- {:.2f}), {:.0f} cm2 of bone are missing, {:.0f} mm at its "
        "longest, confidence {:.2f}\n",
        o.side, at_text(o.middle_mm), o.error_mm, o.area_cm2, o.longest_mm, o.confidence);
  return out;
}

ExitCode run_outcome(const cli::ParsedCommand& parsed) {
  lesson::OutcomeRecord record;
  picture::Image picture;
  bool has_ct = false, chest = false;
  {
    cli::ProgressDisplay display(parsed.quiet);
    const Progress progress = display.start(parsed.command->name);
    cases::LoadParts parts;
    parts.ct = true;
    const cases::HashedCase read = cases::load_hashed_case(parsed.path("case"), parts);
    const auto& choice = parsed.params<ScanChoice>();
    dicom::ImportParams import;
    import.series = choice.token;
    import.gaps = choice.gaps;
    import.volume_values = choice.volume_values;
    import.axes = choice.axes;
    const dicom::ImportResult scan = dicom::import_series(parsed.path("series"), import, progress.part(0, 0.3));
    std::optional<print::PrintRecord> print;
    if (parsed.has("marks")) print = print::read_print(parsed.path("marks"));
    record = outcome::measure_outcome(read.loaded, scan.volume, parsed.params<outcome::OutcomeParams>(),
                                      progress.part(0.3, 0.95), print ? &*print : nullptr);
    record.case_sha256 = read.sha256;
    record.series_sha256 = scan.input_sha256;
    record.program = "trephine " TREPHINE_VERSION;
    has_ct = read.loaded.has_ct();
    chest = outcome::is_chest(read.loaded);
    picture = outcome::outcome_picture(read.loaded, record);
    display.finish(parsed.command->name, "");
  }
  const std::filesystem::path out = parsed.path("out");
  make_output_folder(out);
  const std::string json = lesson::to_json(record);
  lesson::parse_outcome(json);  // what is written is what will be read
  const std::filesystem::path shown = out / "outcome.png";
  std::error_code ignored;
  if (picture.width > 0)
    write_file(shown, picture::encode_png(picture));
  else
    std::filesystem::remove(shown, ignored);
  write_file(out / "outcome.json", json);
  if (!has_ct) log_warning("the case holds no CT to show what was found on, so that there is no picture");
  if (!parsed.quiet) std::cout << table_of(record, chest);
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand outcome_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "outcome";
  c.summary =
      "measures what a CT after a procedure shows: catheter, burr hole, pedicle screws, central line, in the frame of "
      "the "
      "case";
  c.description =
      "Lays a CT that was made after the procedure on the case by its bone, whatever else is new in it, and finds the "
      "catheter (course, tip) and the burr holes (place, width), or in a spine pedicle screws (axis, tip, head, "
      "diameter), "
      "each laid by its own vertebra, or in a chest central lines (course, tip, where it meets the vein). --out gets "
      "outcome.json, which `trephine-sim "
      "score-outcome` judges by the rubric of the lesson, and outcome.png, slices of the case's own CT with what was "
      "found. Nothing else of the second scan is written. Another patient's scan and a mirrored one are refused (80); "
      "what may be one of several courses, or is not sure, is called doubtful and is not judged. For training and "
      "research; "
      "not for clinical use.";
  c.examples = {"trephine outcome library/head-01 --series after/dicom --out after/outcome"};
  const cli::Argument folder = cli::positional_argument("case", Kind::in_folder, "Folder of the case.");
  c.arguments = {
      folder,
      cli::required_argument("series", Kind::in_scan, "The scan after the procedure: a folder, archive or file."),
      cli::required_argument("out", Kind::out_folder, "Folder for outcome.json and outcome.png."),
      cli::argument("marks", Kind::in_file,
                    "Of a printed head: NAME-print.json, by whose marks the scan is laid on the case.")};
  c.groups = {cli::ParameterGroup::of<outcome::OutcomeParams>("Outcome"), cli::ParameterGroup::of<ScanChoice>("Scan")};
  c.run = run_outcome;
  return c;
});

}  // namespace trephine::tools
