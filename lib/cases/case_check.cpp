// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <set>

#include "base/error.h"
#include "cases/case_names.h"
#include "cases/case_parts.h"
#include "cases/material.h"
#include "voxel/haptic_volume.h"

namespace trephine::detail {
namespace {

[[noreturn]] void contradiction(const std::string& field, const std::string& what) {
  throw Error(ExitCode::internal, "case.json", field, what);
}

// The comparison is false for NaN, so NaN is refused as well.
void check_range(double v, double least, double most, const std::string& field, const char* what) {
  if (!(v >= least && v <= most)) contradiction(field, what);
}

constexpr double huge = 1e12, farthest_mm = 1e4;

void check_not_negative(std::initializer_list<double> values, const std::string& field) {
  for (const double v : values) check_range(v, 0, huge, field, "a number must be 0 or more, and finite");
}

void check_finite(std::initializer_list<double> values, const std::string& field) {
  for (const double v : values) check_range(v, -huge, huge, field, "a number is not finite");
}

void check_point(Vec3 p, const std::string& field) { check_finite({p.x, p.y, p.z}, field); }

void check_colour(const std::array<double, 3>& rgb, const std::string& field) {
  for (const double c : rgb) check_range(c, 0, 1, field, "colours lie between 0 and 1");
}

void check_choice(const std::string& value, std::initializer_list<const char*> known, const std::string& field) {
  if (std::any_of(known.begin(), known.end(), [&](const char* k) { return value == k; })) return;
  std::string all;
  for (const char* k : known) all += (all.empty() ? "" : ", ") + std::string(k);
  contradiction(field, "'" + value.substr(0, 80) + "' is none of " + all);
}

void check_unique(std::set<std::string>& seen, const std::string& name, const std::string& field) {
  if (name.empty()) contradiction(field, "a name is empty");
  if (!seen.insert(name).second) contradiction(field, "'" + name + "' is named twice");
}

// A figure's name ends in its unit. A figure with a unit must be a number, and a count must be a whole one.
void check_values(const CaseValues& values, const std::string& at) {
  std::set<std::string> names;
  for (const auto& [name, value] : values) {
    check_unique(names, name, at);
    const auto ends_in = [&name = name](const std::string& unit) {
      return name.size() > unit.size() && name.compare(name.size() - unit.size(), unit.size(), unit) == 0;
    };
    const bool whole = std::holds_alternative<std::int64_t>(value);
    if (ends_in("_count") && !(whole && std::get<std::int64_t>(value) >= 0))
      contradiction(at + "." + name, "must be a whole number from 0 on");
    for (const char* unit : {"_mm", "_mm3", "_ml", "_cm2", "_ratio", "_percent", "_deg", "_hu", "_s", "_n"})
      if (ends_in(unit) && !whole && !std::holds_alternative<double>(value))
        contradiction(at + "." + name, "must be a number");
  }
}

std::set<std::string> check_files(const CaseManifest& m) {
  std::set<std::string> names;
  for (const auto& f : m.files) {
    if (!is_case_file_name(f.name)) contradiction("files", "'" + f.name + "' is no name for a file of a case");
    if (!is_sha256(f.sha256)) contradiction("files." + f.name, "has no SHA-256");
    if (f.bytes > most_file_bytes) contradiction("files." + f.name, "is larger than a file of a case can be");
    check_unique(names, f.name, "files");
  }
  // The use of a file decides how it is read.
  std::set<std::string> used;
  for (const auto& a : m.anatomies)
    if (!a.file.empty()) check_unique(used, a.file, "anatomies." + a.name + ".file");
  for (const std::string& f : {m.haptic.file, m.haptic.hardness_file})
    if (!f.empty()) check_unique(used, f, "haptic.file");
  if (!m.ct.file.empty()) check_unique(used, m.ct.file, "ct.file");
  return names;
}

void check_anatomies(const CaseManifest& m, const std::set<std::string>& files) {
  std::set<std::string> names;
  for (const auto& a : m.anatomies) {
    check_unique(names, a.name, "anatomies");
    const std::string at = "anatomies." + a.name;
    if (!a.file.empty() && !files.count(a.file)) contradiction(at, "'" + a.file + "' is not in files");
    check_colour(a.colour_rgb, at + ".colour_rgb");
    check_range(a.opacity, 0, 1, at + ".opacity", "lies between 0 and 1");
    check_finite({a.volume_ml}, at + ".volume_ml");
    check_not_negative({a.area_cm2}, at + ".area_cm2");
    const CaseDeviation& d = a.deviation;
    check_range(d.max_mm, 0, farthest_mm, at + ".deviation_mm.max", "lies between 0 and 10000 mm");
    check_range(d.p99_mm, 0, d.max_mm, at + ".deviation_mm.p99", "lies between 0 and the largest");
    check_range(d.rms_mm, 0, d.max_mm, at + ".deviation_mm.rms", "lies between 0 and the largest");
    check_range(a.budget_asked_mm, 0, farthest_mm, at + ".budget_mm.asked", "lies between 0 and 10000 mm");
    check_range(a.budget_used_mm, 0, farthest_mm, at + ".budget_mm.used", "lies between 0 and 10000 mm");
    check_values(a.figures, at + ".figures");
  }
}

void check_missing(const CaseManifest& m) {
  std::set<std::string> names;
  for (const auto& a : m.anatomies) names.insert(a.name);
  for (const auto& a : m.missing) check_unique(names, a.anatomy, "missing");
}

void check_material(const CaseMaterial& m, const std::string& at) {
  if (m.name.empty()) contradiction(at + ".name", "is empty");
  const std::string fault = fault_of(m);
  if (const std::size_t colon = fault.find(": "); colon != std::string::npos)
    contradiction(at + "." + fault.substr(0, colon), fault.substr(colon + 2));
}

bool is_shape_name(const std::string& name) {
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

void check_shape(const CaseShape& s, const CaseManifest& m) {
  const std::string at = "haptic.shapes." + s.name;
  if (!is_shape_name(s.name)) contradiction("haptic.shapes", "a name is not made of a-z, 0-9 and _");
  check_range(s.number, 1, haptic_max_shapes, at + ".number", "must be a whole number from 1 to 32");
  if (s.window_low > s.window_high) contradiction(at + ".window", "its low end is above its high end");
  check_choice(s.displayed, {"surface", "haptic"}, at + ".displayed");
  const CaseAnatomy* anatomy = m.find_anatomy(s.name);
  if (s.displayed == "surface" && (!anatomy || anatomy->file.empty()))
    contradiction(at + ".displayed", "'surface', but no anatomy of that name has a file");
  check_not_negative({s.volume_ml}, at + ".volume_ml");
  check_material(s.material, at + ".material");
  const CaseMismatch& d = s.mismatch;
  check_finite({d.bias_mm}, at + ".mismatch");
  check_range(d.max_mm, 0, farthest_mm, at + ".mismatch.max_mm", "lies between 0 and 10000 mm");
  check_range(d.p99_mm, 0, d.max_mm, at + ".mismatch.p99_mm", "lies between 0 and the largest");
  check_range(d.rms_mm, 0, d.max_mm, at + ".mismatch.rms_mm", "lies between 0 and the largest");
  check_range(d.missed_ratio, 0, 1, at + ".mismatch.missed_ratio", "lies between 0 and 1");
}

void check_windows(const std::vector<CaseShape>& shapes) {
  auto by_window = shapes;
  std::sort(by_window.begin(), by_window.end(),
            [](const CaseShape& a, const CaseShape& b) { return a.window_low < b.window_low; });
  for (std::size_t i = 1; i < by_window.size(); ++i)
    if (by_window[i].window_low <= by_window[i - 1].window_high)
      contradiction("haptic.shapes." + by_window[i].name + ".window",
                    "overlaps that of '" + by_window[i - 1].name + "'");
}

void check_voxels(const std::array<int, 3>& size, Vec3 spacing_mm, const std::string& at) {
  for (int i = 0; i < 3; ++i) {
    check_range(size[i], 1, 65535, at + ".size", "lies between 1 and 65535");
    check_range(spacing_mm[i], 1e-6, 1e6, at + ".spacing_mm", "must be above 0 and finite");
  }
}

void check_ct(const CaseManifest& m, const std::set<std::string>& files) {
  if (m.ct.file.empty()) return;
  if (!files.count(m.ct.file)) contradiction("ct", "'" + m.ct.file + "' is not in files");
  check_voxels(m.ct.size, m.ct.spacing_mm, "ct");
}

void check_haptic(const CaseManifest& m, const std::set<std::string>& files) {
  const CaseHaptic& h = m.haptic;
  if (h.file.empty()) {
    if (!h.shapes.empty() || !h.hardness_file.empty()) contradiction("haptic.file", "is missing");
    return;
  }
  for (const std::string& f : {h.file, h.hardness_file})
    if (!f.empty() && !files.count(f)) contradiction("haptic", "'" + f + "' is not in files");
  check_choice(h.encoding, {"occupancy", "hu"}, "haptic.encoding");
  check_voxels(h.size, h.spacing_mm, "haptic");
  std::set<std::string> names;
  for (std::size_t i = 0; i < h.shapes.size(); ++i) {
    check_unique(names, h.shapes[i].name, "haptic.shapes");
    if (i > 0 && h.shapes[i].number <= h.shapes[i - 1].number)
      contradiction("haptic.shapes." + h.shapes[i].name + ".number", "numbers must be unique and ascend");
    check_shape(h.shapes[i], m);
  }
  check_windows(h.shapes);
}

void check_places(const CaseManifest& m) {
  std::set<std::string> landmarks, targets, holes;
  for (const auto& l : m.landmarks) {
    check_unique(landmarks, l.name, "landmarks");
    check_point(l.position_mm, "landmarks." + l.name);
    check_range(l.confidence, 0, 1, "landmarks." + l.name + ".confidence", "lies between 0 and 1");
    check_choice(l.source, {"found", "estimated", "given", "truth"}, "landmarks." + l.name + ".source");
  }
  for (const auto& t : m.targets) {
    check_unique(targets, t.name, "targets");
    check_point(t.position_mm, "targets." + t.name);
    check_range(t.confidence, 0, 1, "targets." + t.name + ".confidence", "lies between 0 and 1");
  }
  for (const auto& b : m.burr_holes) {
    const std::string at = "burr_holes." + b.name;
    check_unique(holes, b.name, "burr_holes");
    check_point(b.position_mm, at);
    check_range(norm(b.direction), 1 - 1e-6, 1 + 1e-6, at + ".direction", "is not of length 1");
    check_range(b.diameter_mm, 1e-6, 1e6, at + ".diameter_mm", "must be above 0 and finite");
    check_values(b.figures, at + ".figures");
    for (const std::string& name : b.cut)
      if (!m.find_anatomy(name) && std::none_of(m.haptic.shapes.begin(), m.haptic.shapes.end(),
                                                [&](const CaseShape& s) { return s.name == name; }))
        contradiction(at + ".cut", "'" + name + "' is neither an anatomy nor a haptic shape");
  }
}

}  // namespace

void check_manifest(const CaseManifest& m) {
  const std::set<std::string> files = check_files(m);
  check_point(m.center_mm, "center_mm");
  check_anatomies(m, files);
  check_missing(m);
  check_haptic(m, files);
  check_ct(m, files);
  check_places(m);
  check_values(m.figures, "figures");
  for (const auto& [name, value] : m.figures)
    if (name == "class") {
      if (!std::holds_alternative<std::string>(value)) contradiction("figures.class", "must be a text");
      check_choice(std::get<std::string>(value),
                   {"normal", "hydrocephalic", "shifted", "small", "uncertain", "unknown"}, "figures.class");
    }
  check_choice(m.face_policy, {"none", "keep", "crop", "deface"}, "face.policy");
  if (m.program_version.empty()) contradiction("provenance.program", "is empty");
  if (!is_sha256(m.input_sha256)) contradiction("provenance.input_sha256", "is no SHA-256");
}

}  // namespace trephine::detail
