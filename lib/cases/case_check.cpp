// SPDX-License-Identifier: GPL-3.0-or-later
#include "cases/case_check.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"

namespace trephine::cases {
namespace {

[[noreturn]] void contradiction(const std::string& field, const std::string& what) {
  throw Error(ExitCode::internal, "case.json", field, what);
}

void check_unique(std::set<std::string>& seen, const std::string& name, const std::string& field) {
  if (!seen.insert(name).second) contradiction(field, "'" + name + "' is named twice");
}

// A figure's name ends in its unit. A figure with a unit must be a number, and a count must be a whole one.
std::string fault_of_figures(const CaseValues& values) {
  for (const auto& [name, value] : values) {
    if (name.empty()) return "figures: a name is empty";
    const auto ends_in = [&name = name](const std::string& unit) {
      return name.size() > unit.size() && name.compare(name.size() - unit.size(), unit.size(), unit) == 0;
    };
    const bool whole = std::holds_alternative<std::int64_t>(value);
    if (ends_in("_count") && !(whole && std::get<std::int64_t>(value) >= 0))
      return "figures." + name + ": must be a whole number from 0 on";
    for (const char* unit : {"_mm", "_mm3", "_ml", "_cm2", "_ratio", "_percent", "_deg", "_hu", "_s", "_n"})
      if (ends_in(unit) && !whole && !std::holds_alternative<double>(value))
        return "figures." + name + ": must be a number";
  }
  return "";
}

// The comparisons are false for NaN, so NaN is refused as well.
std::string fault_of_largest(double p99, double rms, double largest, const std::string& unit) {
  for (const auto& [name, value] : {std::make_pair("p99", p99), {"rms", rms}})
    if (!(value <= largest)) return name + unit + ": lies between 0 and the largest";
  return "";
}

void check_files(const CaseManifest& m) {
  std::set<std::string> names;
  for (const auto& f : m.files) check_unique(names, f.name, "files");
  // The use of a file decides how it is read.
  std::set<std::string> used;
  const auto use = [&](const std::string& file, const std::string& at, const std::string& field) {
    if (file.empty()) return;
    check_unique(used, file, at + "." + field);
    if (!names.count(file)) contradiction(at, "'" + file + "' is not in files");
  };
  for (const auto& a : m.anatomies) use(a.file, "anatomies." + a.name, "file");
  use(m.haptic.file, "haptic", "file");
  use(m.haptic.hardness_file, "haptic", "hardness_file");
  use(m.ct.file, "ct", "file");
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

void check_haptic(const CaseManifest& m) {
  const CaseHaptic& h = m.haptic;
  if (h.file.empty() && (!h.shapes.empty() || !h.hardness_file.empty())) contradiction("haptic.file", "is missing");
  std::set<std::string> names;
  for (std::size_t i = 0; i < h.shapes.size(); ++i) {
    const CaseShape& s = h.shapes[i];
    check_unique(names, s.name, "haptic.shapes");
    if (i > 0 && s.number <= h.shapes[i - 1].number)
      contradiction("haptic.shapes." + s.name + ".number", "numbers must be unique and ascend");
    const CaseAnatomy* anatomy = m.find_anatomy(s.name);
    if (s.displayed == "surface" && (!anatomy || anatomy->file.empty()))
      contradiction("haptic.shapes." + s.name + ".displayed", "'surface', but no anatomy of that name has a file");
  }
  check_windows(h.shapes);
}

void check_names(const CaseManifest& m) {
  std::set<std::string> anatomies, landmarks, targets, holes;
  for (const auto& a : m.anatomies) check_unique(anatomies, a.name, "anatomies");
  for (const auto& a : m.missing) check_unique(anatomies, a.anatomy, "missing");
  std::set<std::string> stood_for;
  for (const auto& a : m.stand_ins) check_unique(stood_for, a.anatomy, "stand_ins");
  for (const auto& l : m.landmarks) check_unique(landmarks, l.name, "landmarks");
  for (const auto& t : m.targets) check_unique(targets, t.name, "targets");
  for (const auto& b : m.burr_holes) {
    check_unique(holes, b.name, "burr_holes");
    for (const std::string& name : b.cut)
      if (!m.find_anatomy(name) && std::none_of(m.haptic.shapes.begin(), m.haptic.shapes.end(),
                                                [&](const CaseShape& s) { return s.name == name; }))
        contradiction("burr_holes." + b.name + ".cut", "'" + name + "' is neither an anatomy nor a haptic shape");
  }
}

}  // namespace

std::string CaseDeviation::fault() const { return fault_of_largest(p99_mm, rms_mm, max_mm, ""); }
std::string CaseMismatch::fault() const { return fault_of_largest(p99_mm, rms_mm, max_mm, "_mm"); }
std::string fault_of_mesh_material(const MaterialParams& material) {
  if (!material.front.touchable) return "its front is not touchable";
  if (material.front.pop_through_n > 0)
    return "its front pops (pop_through_n), and nothing goes through a surface that is touched as a mesh";
  return "";
}

std::string CaseAnatomy::fault() const {
  if (touched_as) {
    if (file.empty()) return "touched_as: is there without a surface";
    if (const std::string what = fault_of_mesh_material(*touched_as); !what.empty()) return "touched_as: " + what;
  }
  return fault_of_figures(figures);
}
std::string CaseBurrHole::fault() const {
  return std::abs(norm(direction) - 1) <= 1e-6 ? fault_of_figures(figures) : "direction: is not of length 1";
}

std::string CaseManifest::fault() const {
  for (const auto& [name, value] : figures) {
    if (name != "class") continue;
    const auto* text = std::get_if<std::string>(&value);
    bool known = false;
    for (const char* one : {"normal", "hydrocephalic", "shifted", "small", "uncertain", "unknown"})
      known = known || (text && *text == one);
    if (!known) return "figures.class: " + to_text(value).substr(0, 80) + ", is no class";
  }
  const auto touched =
      std::count_if(anatomies.begin(), anatomies.end(), [](const CaseAnatomy& a) { return a.touched_as.has_value(); });
  if (touched > max_touched_surfaces)
    return "anatomies: " + std::to_string(touched) + " are touched as meshes, at most " +
           std::to_string(max_touched_surfaces) + " may be";
  if (touched > 0 && haptic.file.empty()) return "anatomies: some are touched as meshes without a haptic volume";
  return fault_of_figures(figures);
}

void detail::check_manifest(const CaseManifest& m) {
  // The declarations only read it.
  const std::string fault = fault_of(parameters_of<CaseManifest>(), const_cast<CaseManifest*>(&m));
  if (const std::size_t colon = fault.find(": "); colon != std::string::npos)
    contradiction(fault.substr(0, colon), fault.substr(colon + 2));
  check_files(m);
  check_haptic(m);
  check_names(m);
}

}  // namespace trephine::cases
