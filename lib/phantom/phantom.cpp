// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/phantom.h"

#include "base/error.h"
#include "base/write_file.h"

namespace trephine::phantom {
namespace {

// A parameter that came later counts only where it is not at its default, so that older series keep their UIDs.
template <class P>
void append(std::string& text, const P& params) {
  const P fresh;
  for (const Parameter& p : parameters_of<P>().parameters)
    if (!p.came_later || p.get(&params) != p.get(&fresh)) text += p.name + "=" + to_text(p.get(&params)) + "\n";
}

// Of the body alone that is scanned: what another body might be is nothing of its.
void append_body(std::string& text, const BodyParams& body) {
  const bool chest = body.body == BodyParams::Body::chest;
  const ParameterSet& others = chest ? parameters_of<SpineParams>() : parameters_of<ChestParams>();
  const BodyParams fresh;
  for (const Parameter& p : parameters_of<BodyParams>().parameters)
    if (!others.find(p.name) && (!p.came_later || p.get(&body) != p.get(&fresh)))
      text += p.name + "=" + to_text(p.get(&body)) + "\n";
}

/// Things are of level hard, and lie around a patient on the back.
void check_hard(const PhantomParams& params) {
  const HardParams fresh;
  for (const Parameter& p : parameters_of<HardParams>().parameters)
    if (params.head.level != Level::hard && p.get(&params.head.hard) != p.get(&fresh))
      throw Error(ExitCode::usage, "", p.name, "has no effect at this level; add " + Setting{"level", "hard"});
  const ImplantParams nothing;
  for (const Parameter& p : parameters_of<ImplantParams>().parameters)
    if (params.head.implants.implants == Implants::none || params.head.level != Level::hard)
      if (p.get(&params.head.implants) != p.get(&nothing))
        throw Error(ExitCode::usage, "", p.name,
                    params.head.level == Level::hard
                        ? Message("has no effect where nothing is put in; add " + Setting{"implants", "catheter"})
                        : Message("has no effect at this level; add " + Setting{"level", "hard"}));
  const HardParams& hard = params.head.hard;
  const bool supine =
      params.scan.position == Position::head_first_supine || params.scan.position == Position::feet_first_supine;
  if (!supine && (hard.couch || hard.clamps || hard.mask || hard.board))
    throw Error(ExitCode::usage, "", "position", "couch, clamps, board and mask are those of a patient on the back");
}

const SeriesNames second_series{2, "sharp"};

template <class P>
void check_default(const P& params, const Message& why) {
  const P fresh;
  for (const Parameter& p : parameters_of<P>().parameters)
    if (p.name != "seed" && p.get(&params) != p.get(&fresh))
      throw Error(ExitCode::usage, "", p.name, "has no effect " + why);
}

// What is of the other body would be ignored.
void check_body(const PhantomParams& params) {
  using Body = BodyParams::Body;
  const Body body = params.body.body;
  if (body != Body::spine) check_default(params.body.spine, "but on a spine: " + Setting{"body", "spine"});
  if (body != Body::chest) check_default(params.body.chest, "but on a chest: " + Setting{"body", "chest"});
  if (body == Body::head) return;
  const char* why = "but on a head";
  check_default(params.head, why);
  check_default(params.head.hard, why);
  check_default(params.head.implants, why);
  check_default(params.second, why);
  const SpineScrews none;
  if (params.body.spine.screws.sides == SpineScrews::Sides::none)
    for (const Parameter& p : parameters_of<SpineScrews>().parameters)
      if (p.get(&params.body.spine.screws) != p.get(&none))
        throw Error(ExitCode::usage, "", p.name, "has no effect without screws: " + Setting{"screws", "both"});
  const ChestLine no_line;
  if (params.body.chest.line.sides == ChestLine::Sides::none)
    for (const Parameter& p : parameters_of<ChestLine>().parameters)
      if (p.name != "electrodes_count" && p.get(&params.body.chest.line) != p.get(&no_line))
        throw Error(ExitCode::usage, "", p.name, "has no effect without a line: " + Setting{"line", "right"});
  if (params.scan.contents != Contents::head)
    throw Error(ExitCode::usage, "", "contents", "only a head is scanned with marks");
}

// Of a print everything that is a body's would be ignored.
void check_print(const PhantomParams& params) {
  if (params.printed.print.empty())
    return check_default(params.printed, "but of a print; add " + Setting{"print", "NAME-print.json"});
  const char* why = "on a print";
  if (params.body.body != BodyParams::Body::head) throw Error(ExitCode::usage, "", "body", "a print is of a head");
  check_default(params.head, why);
  check_default(params.head.hard, why);
  check_default(params.head.implants, why);
  check_default(params.second, why);
}

PhantomResult make_print(const std::filesystem::path& out, const PhantomParams& params, const Progress& progress) {
  const Scan scanned = scan_print(params.printed, params.scan, std::uint64_t(params.head.seed), progress.part(0, 0.9));
  PhantomResult result;
  result.slices_count = static_cast<std::int64_t>(scanned.slices.size());
  // What the print is, and not where its file lies.
  PrintedParams printed = params.printed;
  printed.print = print::to_json(print::read_print(params.printed.print));
  std::string identity;
  append(identity, printed);
  result.series_mb = static_cast<double>(write_series(out / "dicom", scanned, params.scan, params.series,
                                                      identity + identity_of(params), progress.part(0.9, 1))) /
                     1e6;
  remove_series(out / "dicom", second_series);
  return result;
}

template <class Body>
PhantomResult make_body(const std::filesystem::path& out, const Body& body, const PhantomParams& params,
                        std::optional<std::int64_t> PhantomResult::*counted, const Progress& progress) {
  const Scan scanned = scan(body, params.scan, std::uint64_t(params.head.seed), progress.part(0, 0.8));
  PhantomResult result;
  result.slices_count = static_cast<std::int64_t>(scanned.slices.size());
  const std::uint64_t bytes =
      write_series(out / "dicom", scanned, params.scan, params.series, identity_of(params), progress.part(0.8, 0.9));
  result.series_mb = static_cast<double>(bytes) / 1e6;
  remove_series(out / "dicom", second_series);
  result.*counted = write_truth(out / "truth", body, scanned, params.scan, params.truth.labels);
  progress.report(1);
  return result;
}

std::uint64_t write_second_series(const std::filesystem::path& folder, const Head& head, const PhantomParams& params,
                                  const Progress& progress) {
  ScanParams with = params.scan;
  with.kernel_mm = params.head.hard.second_kernel_mm;
  const Scan scanned =
      scan(head, params.scan, Kernel{with.kernel_mm, params.head.hard.second_sharpen_ratio}, progress.part(0, 0.9));
  return write_series(folder, scanned, with, params.series, identity_of(params), progress.part(0.9, 1), second_series);
}

}  // namespace

std::string identity_of(const PhantomParams& params) {
  std::string text;
  if (params.body.body != BodyParams::Body::head) append_body(text, params.body);
  append(text, params.head);
  append(text, params.scan);
  append(text, params.series);
  if (params.head.level == Level::hard) append(text, params.head.hard);
  if (params.head.implants.implants != Implants::none) append(text, params.head.implants);
  return text;
}

grid::Grid<std::int16_t> volume_of(const Scan& scan) {
  grid::Grid<std::int16_t> grid;
  static_cast<grid::Lattice&>(grid) = lattice_of(scan);
  grid.voxels = scan.hu;
  return grid;
}

PhantomResult make_phantom(const std::filesystem::path& out, const PhantomParams& params, const Progress& progress) {
  const ScanParams& s = params.scan;
  if (s.upper_step_mm > 0 && s.slices_count < 2)
    throw Error(ExitCode::usage, "", "upper_step_mm", "needs two slices or more");
  check_print(params);
  check_body(params);
  check_hard(params);
  make_output_folder(out);
  if (!params.printed.print.empty()) return make_print(out, params, progress);
  if (params.body.body == BodyParams::Body::spine)
    return make_body(out, params.body.spine, params, &PhantomResult::pedicles_count, progress);
  if (params.body.body == BodyParams::Body::chest)
    return make_body(out, params.body.chest, params, &PhantomResult::truth_lines_count, progress);
  const Head head(params.head);
  const double first = params.head.hard.second_kernel_mm > 0 ? 0.4 : 0.7;  // of the progress
  const Scan scanned = scan(head, s, progress.part(0, first - 0.1));
  PhantomResult result;
  result.slices_count = static_cast<std::int64_t>(scanned.slices.size());
  const std::uint64_t bytes =
      write_series(out / "dicom", scanned, s, params.series, identity_of(params), progress.part(first - 0.1, first));
  result.series_mb = static_cast<double>(bytes) / 1e6;
  if (const HardParams& h = params.head.hard; h.second_kernel_mm > 0)
    result.second_series_mb =
        static_cast<double>(write_second_series(out / "dicom", head, params, progress.part(0.4, 0.7))) / 1e6;
  else
    remove_series(out / "dicom", second_series);
  result.volume_ml = write_truth(out / "truth", head, scanned, s, params.truth, progress.part(0.7, 0.9));
  if (params.second.contrast != SecondScan::none)
    write_second_scan(out / "second", second_scan(head, params.second, progress.part(0.9, 1)));
  progress.report(1);
  return result;
}

PhantomParams sample_phantom() {
  PhantomParams p;
  p.head.level = Level::clinical;
  p.head.seed = 2;
  p.scan.columns_count = p.scan.rows_count = 256;
  p.scan.field_of_view_mm = 240;
  p.scan.slices_count = 96;
  p.scan.slice_step_mm = p.scan.slice_thickness_mm = 2;
  p.scan.noise_hu = 5;
  p.scan.kernel_mm = 1.4;
  p.series.encoding = Encoding::jpeg_ls;
  return p;
}

}  // namespace trephine::phantom
