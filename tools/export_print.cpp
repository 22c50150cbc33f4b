// SPDX-License-Identifier: GPL-3.0-or-later
#include "export_print.h"

#include <fmt/format.h>

#include "cases/load_hashed.h"
#include "meshio/export_format.h"
#include "print/print_head.h"

namespace trephine::tools {
namespace {

meshio::ExportFile encoded(const char* format_name, const std::vector<print::PrintedPart>& parts,
                           const std::string& stem, const Progress& progress) {
  std::vector<meshio::ExportSurface> surfaces;
  for (const print::PrintedPart& p : parts) surfaces.push_back({&p.mesh, p.name, p.colour_rgb, 1, false});
  const meshio::ExportFormat& format = meshio::export_format(format_name);
  const auto made = meshio::encode_surfaces(format, surfaces, stem, progress.part(0, 0.5));
  meshio::verify_export(format, surfaces, made, progress.part(0.5, 1));
  return made.back();
}

std::string table_of(const print::PrintRecord& r) {
  std::string out = "part              triangles   volume, ml   box, mm                smallest wall, mm\n";
  for (const print::PrintPart& p : r.parts)
    out += fmt::format("{:<16} {:>10} {:>12.1f}   {:>5.0f} x {:>3.0f} x {:>3.0f} {:>19.2f}\n", p.name,
                       p.triangles_count, p.volume_ml, p.size_mm[0], p.size_mm[1], p.size_mm[2], p.smallest_wall_mm);
  out += "between                           smallest gap, mm\n";
  for (const print::PrintGap& g : r.gaps) out += fmt::format("{:<32} {:>17.2f}\n", g.a + ", " + g.b, g.smallest_mm);
  return out + fmt::format("{} marks of {:.1f} mm; {:.0f} ml of gel fill it\n", r.marks.size(),
                           r.marks.empty() ? 0.0 : r.marks[0].diameter_mm, r.gel_ml);
}

}  // namespace

const char* print_format_help =
    "Format print is a head to be printed, of a case whose skull is felt: the skull above a flat cut with spheres by "
    "which a CT is laid on the case, pieces of bone at Kocher's points that can be replaced, the ventricles, a base "
    "into "
    "which the case's name is engraved, and a lid. Each part is an STL where it belongs when all is put together; the "
    "3MF "
    "holds all of them side by side, as they are printed; NAME-print.json has the frame, the marks, and the measured "
    "walls "
    "and gaps. Skin is never printed, and nothing of the face below the cut.";

cli::ParameterGroup print_group() { return cli::ParameterGroup::of<print::PrintParams>("Print"); }

PrintExport export_print(const cli::ParsedCommand& parsed, const std::string& name, Report& report,
                         const Progress& progress) {
  const cases::HashedCase read = cases::load_hashed_case(parsed.path("input"));
  print::Printed made = print::print_head(read.loaded, parsed.params<print::PrintParams>(), progress.part(0, 0.7));
  const std::string stem = name.empty() ? read.loaded.manifest.case_token : name;
  print::PrintRecord& record = made.record;
  record.case_sha256 = read.sha256;
  record.program = "trephine " TREPHINE_VERSION;
  PrintExport out;
  for (std::size_t n = 0; n < made.parts.size(); ++n) {
    out.files.push_back(encoded("stl", {made.parts[n]}, stem + "-" + made.parts[n].name, progress.part(0.7, 0.85)));
    record.parts[n].file = out.files.back().name;
    report.add(record.parts[n].name + ".smallest_wall_mm", record.parts[n].smallest_wall_mm);
  }
  report.add("smallest_wall_mm", record.smallest_wall_mm);
  report.add("smallest_gap_mm", record.smallest_gap_mm);
  out.files.push_back(encoded("3mf", print::on_a_plate(made.parts), stem + "-print", progress.part(0.85, 1)));
  out.files.push_back({stem + "-print.json", print::to_json(record)});
  print::parse_print(out.files.back().bytes);  // what is written is what will be read
  for (const Warning& w : made.warnings) report.warn(to_text(w));
  out.table = table_of(record);
  return out;
}

}  // namespace trephine::tools
