// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/joined.h"
#include "base/text.h"
#include "cases/load_case.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "commands/drilled_case.h"
#include "commands/session_options.h"
#include "surface/bounds.h"

namespace trephine::commands {
namespace {

using Json = nlohmann::ordered_json;

struct CheckParams {
  bool json = false;
  template <class V>
  static void describe(V& v) {
    using P = CheckParams;
    v.flag(&P::json, "json", "Print one JSON object instead of text.");
  }
};

std::string point_text(Vec3 p) { return fmt::format("{:.1f}, {:.1f}, {:.1f}", p.x, p.y, p.z); }

surface::Bounds bounds_of_all(const cases::LoadedCase& c) {
  surface::Bounds all;
  for (const surface::TriMesh& mesh : c.surfaces) surface::include(all, surface::bounds_of(mesh));
  return all;
}

std::size_t triangles_of(const cases::LoadedCase& c) {
  std::size_t n = 0;
  for (const surface::TriMesh& mesh : c.surfaces) n += mesh.triangles.size();
  return n;
}

void print_anatomies(const cases::LoadedCase& c) {
  const cases::CaseManifest& m = c.manifest;
  std::cout << fmt::format("{} anatomies, {} triangles\n", m.anatomies.size(), grouped_text(triangles_of(c)));
  for (const cases::CaseAnatomy& a : m.anatomies) {
    if (a.file.empty())
      std::cout << fmt::format("  {:<16} no surface\n", printable(a.name));
    else
      std::cout << fmt::format("  {:<16} {:>9} triangles, {:.1f} ml, deviation at most {:.3f} mm (p99 {:.3f})\n",
                               printable(a.name), grouped_text(a.triangles), a.volume_ml, a.deviation.max_mm,
                               a.deviation.p99_mm);
  }
}

// "touchable yes, stiffness_n_per_mm 0.8": what the material declares below that name.
std::string values_text(const std::vector<ParameterLeaf>& leaves, const std::string& below) {
  std::string text;
  for (const ParameterLeaf& leaf : leaves) {
    const bool here = below.empty() ? leaf.path.find('.') == std::string::npos : leaf.path.rfind(below, 0) == 0;
    const ParameterValue value = leaf.value();
    if (here && value != ParameterValue(0.0))
      text += (text.empty() ? "" : ", ") + leaf.parameter->name + " " + to_text(value);
  }
  return text.empty() ? "nothing" : text;
}

void print_shape(const cases::CaseShape& s) {
  std::cout << fmt::format("  {} {:<14} values {} to {}, {:.1f} ml, shown from the {}{}\n", s.number, printable(s.name),
                           s.window_low, s.window_high, s.volume_ml,
                           s.displayed == "haptic" ? "haptic volume" : "surface", s.cuttable ? ", cuttable" : "");
  const AnyParams material = AnyParams::make(static_cast<const cases::MaterialParams&>(s.material));
  const std::vector<ParameterLeaf> values = leaves_of(material);
  std::cout << fmt::format("      material {}: {}\n      front: {}\n      back: {}\n", printable(s.material.name),
                           values_text(values, ""),
                           s.material.front.touchable ? values_text(values, "front.") : "not touchable",
                           s.material.back.touchable ? values_text(values, "back.") : "not touchable");
  const cases::CaseMismatch& d = s.mismatch;
  if (d.samples > 0)
    std::cout << fmt::format(
        "      felt against seen: bias {:.3f}, RMS {:.3f}, p99 {:.3f}, max {:.3f} mm, missed {:.2f} %, "
        "{} samples\n",
        d.bias_mm, d.rms_mm, d.p99_mm, d.max_mm, 100 * d.missed_ratio, grouped_text(d.samples));
}

// Of a surface that is touched as a mesh.
void print_touched(const cases::CaseAnatomy& a) {
  const AnyParams material = AnyParams::make(static_cast<const cases::MaterialParams&>(*a.touched_as));
  std::cout << fmt::format("  {} is touched as a mesh, on both sides as material {}: {}\n", printable(a.name),
                           printable(a.touched_as->name), values_text(leaves_of(material), "front."));
}

void print_haptic(const cases::LoadedCase& c) {
  const cases::CaseHaptic& h = c.manifest.haptic;
  if (!c.has_haptic()) {
    std::cout << "no haptic volume\n";
    return;
  }
  std::cout << fmt::format("haptic volume, {}: {} x {} x {} voxels of {:g} x {:g} x {:g} mm{}, {} shapes\n", h.encoding,
                           h.size[0], h.size[1], h.size[2], h.spacing_mm.x, h.spacing_mm.y, h.spacing_mm.z,
                           h.hardness_file.empty() ? "" : ", with hardness", h.shapes.size());
  for (const cases::CaseShape& s : h.shapes) print_shape(s);
  for (const cases::CaseAnatomy& a : c.manifest.anatomies)
    if (a.touched_as) print_touched(a);
}

std::string figure_text(const ParameterValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{:.3f}", *number);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return to_text(value);
}

void print_places(const cases::CaseManifest& m) {
  for (const cases::CaseLandmark& l : m.landmarks)
    std::cout << fmt::format("landmark {:<16} {} mm, {}, confidence {:.2f}\n", printable(l.name),
                             point_text(l.position_mm), printable(l.source), l.confidence);
  for (const cases::CaseTarget& t : m.targets)
    std::cout << fmt::format("target {:<16} {} mm{}, confidence {:.2f}\n", printable(t.name), point_text(t.position_mm),
                             t.anatomy.empty() ? "" : ", in " + printable(t.anatomy), t.confidence);
  for (const cases::CaseBurrHole& b : m.burr_holes) {
    const std::string cut = joined(b.cut, ", ", [](const std::string& name) { return printable(name); });
    std::cout << fmt::format("burr hole {:<16} {} mm, diameter {:g} mm, {}\n", printable(b.name),
                             point_text(b.position_mm), b.diameter_mm, cut.empty() ? "nothing cut" : "cut from " + cut);
    for (const auto& [name, value] : b.figures)
      std::cout << fmt::format("      {} {}\n", printable(name), printable(figure_text(value)));
  }
}

void print_text(const cases::LoadedCase& c, double seconds) {
  const cases::CaseManifest& m = c.manifest;
  std::cout << fmt::format("case {}, format {}.{}, made by {}\n", m.case_token, m.version_major, m.version_minor,
                           printable(m.program_version));
  std::cout << fmt::format("frame LPS, mm, centre {}", point_text(m.center_mm));
  if (triangles_of(c) > 0) {
    const surface::Bounds b = bounds_of_all(c);
    std::cout << fmt::format("; surfaces from {} to {}", point_text(b.min_mm), point_text(b.max_mm));
  }
  std::cout << fmt::format("\nface: {}\n", printable(m.face_policy));
  print_anatomies(c);
  print_haptic(c);
  print_places(m);
  std::cout << fmt::format("{} files, {} bytes, verified and loaded in {:.3f} s\n", m.files.size(),
                           grouped_text(static_cast<long long>(c.bytes)), seconds);
}

Json list_of(Vec3 v) { return Json::array({v.x, v.y, v.z}); }

// What was loaded, and no copy of case.json: that is JSON already.
void print_json(const cases::LoadedCase& c, double seconds) {
  const cases::CaseManifest& m = c.manifest;
  Json out = {{"case", m.case_token},
              {"format", fmt::format("{}.{}", m.version_major, m.version_minor)},
              {"program", m.program_version},
              {"frame", "LPS"},
              {"unit", "mm"},
              {"center_mm", list_of(m.center_mm)},
              {"triangles", triangles_of(c)},
              {"anatomies", Json::array()},
              {"haptic", nullptr},
              {"landmarks", m.landmarks.size()},
              {"targets", m.targets.size()},
              {"burr_holes", m.burr_holes.size()},
              {"files", m.files.size()},
              {"bytes", c.bytes},
              {"seconds", seconds}};
  for (std::size_t i = 0; i < m.anatomies.size(); ++i) {
    const surface::TriMesh& mesh = c.surfaces[i];
    Json a = {{"name", m.anatomies[i].name}, {"triangles", mesh.triangles.size()}, {"points", mesh.points_mm.size()}};
    if (!mesh.triangles.empty()) {
      const surface::Bounds b = surface::bounds_of(mesh);
      a["min_mm"] = list_of(b.min_mm);
      a["max_mm"] = list_of(b.max_mm);
    }
    out["anatomies"].push_back(a);
  }
  if (c.has_haptic()) {
    Json shapes = Json::array();
    for (const cases::CaseShape& s : m.haptic.shapes) {
      Json shape = {{"name", s.name},
                    {"number", s.number},
                    {"window", {s.window_low, s.window_high}},
                    {"material", s.material.name},
                    {"cuttable", s.cuttable},
                    {"displayed", s.displayed}};
      if (s.mismatch.samples > 0) shape["mismatch_rms_mm"] = s.mismatch.rms_mm;
      shapes.push_back(shape);
    }
    out["haptic"] = {{"encoding", m.haptic.encoding},
                     {"size", m.haptic.size},
                     {"spacing_mm", list_of(m.haptic.spacing_mm)},
                     {"hardness", !c.haptic.hardness.voxels.empty()},
                     {"shapes", shapes}};
  }
  std::cout << out.dump(1, ' ', false, Json::error_handler_t::replace) << "\n";
}

}  // namespace

const cli::OwnCommand check_command([] {
  cli::Command c;
  c.name = "check";
  c.summary = "loads a case as the simulator does, verifies all of it and prints what is in it";
  c.description =
      "Every size, checksum and value is checked before use (docs/reference/case-package.md says which). Exit code 66 "
      "says that "
      "a file is missing. Exit code 65, with one line that names the file, says that one is damaged or contradicts "
      "case.json, or that the case has another major version.\n\n"
      "With --after the recording of a session in which the tool cut is run again, and the case as it was at its end "
      "is "
      "written to --out, with the drilled haptic volume; then that case is checked and printed.";
  cli::Argument folder;
  folder.name = "case";
  folder.kind = cli::Argument::Kind::in_folder;
  folder.help = "Folder of the case.";
  folder.positional = folder.required = true;
  cli::Argument after =
      cli::argument("after", cli::Argument::Kind::in_file,
                    "A recording in which the tool cut: write the case as it was at its end to --out.");
  cli::Argument out = cli::argument("out", cli::Argument::Kind::out_folder, "Folder of the case that --after writes.");
  c.arguments = {folder, after, before_argument(), out};
  c.groups = {cli::ParameterGroup::of<CheckParams>("Parameters")};
  c.examples = {"trephine-sim check library/sample", "trephine-sim check library/sample --json",
                "trephine-sim check library/sample --after hole.servo --out library/sample-drilled"};
  c.run = [](const cli::ParsedCommand& parsed) {
    const auto begin = std::chrono::steady_clock::now();
    if (parsed.has("after") != parsed.has("out"))
      throw Error(ExitCode::usage, "", "--after, --out", "are given together or not at all");
    const bool drilled = parsed.has("after");
    const std::vector<std::string> named = parsed.all("before");
    if (drilled)
      write_drilled_case(parsed.path("case"), parsed.path("after"), parsed.path("out"), {named.begin(), named.end()});
    const cases::LoadedCase loaded = cases::load_case(parsed.path(drilled ? "out" : "case"), cases::whole_case);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (parsed.params<CheckParams>().json)
      print_json(loaded, seconds);
    else
      print_text(loaded, seconds);
    return ExitCode::ok;
  };
  return c;
});

}  // namespace trephine::commands
