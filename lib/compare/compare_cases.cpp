// SPDX-License-Identifier: GPL-3.0-or-later
#include "compare/compare_cases.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/pi.h"
#include "base/text.h"
#include "meshing/contour.h"
#include "voxel/shape_field.h"

namespace trephine::compare {
namespace {

/// The names of both, in the order of the first.
template <class T>
std::vector<std::string> names_of(const std::vector<T>& a, const std::vector<T>& b) {
  std::vector<std::string> names;
  for (const auto* list : {&a, &b})
    for (const T& item : *list)
      if (std::find(names.begin(), names.end(), item.name) == names.end()) names.push_back(item.name);
  return names;
}

template <class T>
const T* find_named(const std::vector<T>& list, const std::string& name) {
  for (const T& item : list)
    if (item.name == name) return &item;
  return nullptr;
}

InCases in_of(const void* a, const void* b) {
  return a && b ? InCases::both : a ? InCases::only_old : InCases::only_new;
}

/// What is seen of an anatomy: its own surface, or what is felt of it.
struct Seen {
  surface::TriMesh own;
  const surface::TriMesh* surface = nullptr;
  bool felt = false;
};

const cases::CaseShape* felt_shape(const cases::LoadedCase& c, const std::string& name) {
  return c.has_haptic() ? find_named(c.manifest.haptic.shapes, name) : nullptr;
}

Seen seen_of(const cases::LoadedCase& c, const std::string& name, bool as_felt, const Progress& progress) {
  Seen seen;
  const surface::TriMesh* surface = as_felt ? nullptr : c.find_surface(name);
  if (surface && !surface->triangles.empty()) {
    seen.surface = surface;
  } else if (const cases::CaseShape* shape = felt_shape(c, name)) {
    meshing::ContourParams params;
    params.min_component_mm3 = 0;
    params.keep_cavities = true;
    seen.own = meshing::contour(voxel::shape_field(c.haptic, shape->number, progress), params, progress).value;
    seen.surface = &seen.own;
    seen.felt = true;
  }
  return seen;
}

/// Whether both show the anatomy by the same bytes: of its own file about the same centre, or of the haptic volume.
bool same_file(const cases::LoadedCase& a, const cases::LoadedCase& b, const cases::CaseAnatomy& x,
               const cases::CaseAnatomy& y) {
  if (x.file.empty() != y.file.empty()) return false;
  const bool felt = x.file.empty();
  const cases::CaseFile *f = a.manifest.find_file(felt ? a.manifest.haptic.file : x.file),
                        *g = b.manifest.find_file(felt ? b.manifest.haptic.file : y.file);
  if (!f || !g || f->sha256 != g->sha256) return false;
  if (!felt) return a.manifest.center_mm == b.manifest.center_mm;
  const cases::CaseShape *s = felt_shape(a, x.name), *t = felt_shape(b, y.name);
  return s && t && s->number == t->number && s->window_low == t->window_low && s->window_high == t->window_high;
}

AnatomyChange anatomy_change(const cases::LoadedCase& a, const cases::LoadedCase& b, const std::string& name,
                             const CompareParams& params, const Progress& progress) {
  AnatomyChange change;
  change.name = name;
  const cases::CaseAnatomy *x = a.manifest.find_anatomy(name), *y = b.manifest.find_anatomy(name);
  const auto fill = [](const cases::CaseAnatomy* from, auto& ml, auto& triangles) {
    if (!from) return;
    ml = from->volume_ml;
    if (!from->file.empty()) triangles = from->triangles;
  };
  fill(x, change.old_ml, change.old_triangles);
  fill(y, change.new_ml, change.new_triangles);
  change.in = in_of(x, y);
  if (!x || !y) {
    change.not_measured = x ? "is not in the new case" : "is not in the old case";
    return change;
  }
  change.same_bytes = same_file(a, b, *x, *y);
  if (change.same_bytes) return change;
  // A mesh and a volume of one shape differ by their making: where both are felt, what is felt is compared.
  const cases::CaseShape *s = felt_shape(a, name), *t = felt_shape(b, name);
  const bool as_felt = x->file.empty() != y->file.empty() && s && t;
  if (as_felt) {
    change.old_ml = s->volume_ml;
    change.new_ml = t->volume_ml;
  }
  const Seen old_seen = seen_of(a, name, as_felt, progress.part(0, 0.2)),
             new_seen = seen_of(b, name, as_felt, progress.part(0.2, 0.4));
  change.old_is_felt = old_seen.felt;
  change.new_is_felt = new_seen.felt;
  if (!old_seen.surface || !new_seen.surface)
    change.not_measured = std::string("the ") + (old_seen.surface ? "new" : "old") + " case shows no surface of it";
  else
    change.deviation =
        metrics::measure_deviation(*new_seen.surface, *old_seen.surface, params.deviation, progress.part(0.4, 1));
  return change;
}

}  // namespace

std::optional<double> AnatomyChange::change_ml() const {
  if (!old_ml || !new_ml || old_is_felt != new_is_felt) return std::nullopt;
  return *new_ml - *old_ml;
}

namespace {

double angle_deg(Vec3 a, Vec3 b) { return std::atan2(norm(cross(a, b)), dot(a, b)) * 180 / pi; }

template <class T, class More>
void add_points(std::vector<PointChange>& out, PointChange::Kind kind, const std::vector<T>& a, const std::vector<T>& b,
                More more) {
  for (const std::string& name : names_of(a, b)) {
    const T *x = find_named(a, name), *y = find_named(b, name);
    PointChange change;
    change.kind = kind;
    change.name = name;
    change.in = in_of(x, y);
    if (x) change.old_mm = x->position_mm;
    if (y) change.new_mm = y->position_mm;
    if (x && y) change.moved_mm = norm(y->position_mm - x->position_mm);
    more(change, x, y);
    out.push_back(change);
  }
}

/// Adds what differs; a value's text decides, because 1 and 1.0 are one value in JSON.
void add_changes(std::vector<ValueChange>& out, const cases::CaseValues& a, const cases::CaseValues& b,
                 const std::string& prefix = "") {
  const auto find = [](const cases::CaseValues& values, const std::string& name) -> const ParameterValue* {
    for (const auto& [key, value] : values)
      if (key == name) return &value;
    return nullptr;
  };
  for (const auto& [name, value] : a) {
    const ParameterValue* other = find(b, name);
    if (!other)
      out.push_back({prefix + name, value, {}});
    else if (trephine::to_text(*other) != trephine::to_text(value))
      out.push_back({prefix + name, value, *other});
  }
  for (const auto& [name, value] : b)
    if (!find(a, name)) out.push_back({prefix + name, {}, value});
}

template <class T>
void add_figures(std::vector<ValueChange>& out, const std::vector<T>& a, const std::vector<T>& b) {
  for (const T& x : a)
    if (const T* y = find_named(b, x.name)) add_changes(out, x.figures, y->figures, x.name + ".");
}

cases::CaseValues values_of(const AnyParams& params) {
  cases::CaseValues v;
  for (const ParameterLeaf& leaf : leaves_of(params)) v.emplace_back(leaf.path, leaf.value());
  return v;
}

// A text without what it begins with.
std::string without(const std::string& text, const std::string& begin) {
  return text.rfind(begin, 0) == 0 ? text.substr(begin.size()) : text;
}

// Its place in the volume says nothing, and what was measured of it comes with every change of a surface.
cases::CaseValues shape_values(cases::CaseShape s) {
  s.mismatch = {};
  cases::CaseValues v;
  for (auto& [path, value] : values_of(AnyParams::make(s)))
    if (path == "material.name")
      v.emplace_back("material", value);
    else if (path != "name" && path != "number" && path != "window")
      v.emplace_back(without(path, "material."), value);
  return v;
}

// All but the lists, which are compared item by item, and the files, which are compared by their content.
cases::CaseValues about(const cases::CaseManifest& m) {
  cases::CaseManifest rest = m;
  rest.anatomies.clear();
  rest.missing.clear();
  rest.stand_ins.clear();
  rest.landmarks.clear();
  rest.targets.clear();
  rest.burr_holes.clear();
  rest.haptic.shapes.clear();
  rest.figures.clear();
  rest.parameters.clear();
  rest.files.clear();
  cases::CaseValues v;
  for (auto& [path, value] : values_of(AnyParams::make(rest)))
    if (path != "case" && path.find("file") == std::string::npos) v.emplace_back(without(path, "provenance."), value);
  const auto add_hash = [&](const char* name, const std::string& file) {
    if (const cases::CaseFile* f = file.empty() ? nullptr : m.find_file(file)) v.emplace_back(name, f->sha256);
  };
  add_hash("haptic.sha256", m.haptic.file);
  add_hash("hardness.sha256", m.haptic.hardness_file);
  add_hash("ct.sha256", m.ct.file);
  return v;
}

void add_shapes(std::vector<ValueChange>& out, const std::vector<cases::CaseShape>& a,
                const std::vector<cases::CaseShape>& b) {
  for (const std::string& name : names_of(a, b)) {
    const cases::CaseShape *x = find_named(a, name), *y = find_named(b, name);
    if (x && y)
      add_changes(out, shape_values(*x), shape_values(*y), "haptic." + name + ".");
    else
      add_changes(out, x ? cases::CaseValues{{"shape", x->material.name}} : cases::CaseValues{},
                  y ? cases::CaseValues{{"shape", y->material.name}} : cases::CaseValues{}, "haptic." + name + ".");
  }
}

}  // namespace

const char* to_text(InCases in) {
  return in == InCases::both ? "both" : in == InCases::only_old ? "only_old" : "only_new";
}

CaseComparison compare_cases(const cases::LoadedCase& old_case, const cases::LoadedCase& new_case,
                             const CompareParams& params, const Progress& progress) {
  const cases::CaseManifest &a = old_case.manifest, &b = new_case.manifest;
  CaseComparison out;
  out.old_token = a.case_token;
  out.new_token = b.case_token;
  out.same_input = a.input_sha256 == b.input_sha256;
  out.identical = cases::to_json(a) == cases::to_json(b);
  if (!out.same_input)
    out.warnings.emplace_back(
        "the two cases are made from different scans: distances say something only where both lie in one frame");

  const std::vector<std::string> anatomies = names_of(a.anatomies, b.anatomies);
  for (std::size_t i = 0; i < anatomies.size(); ++i) {
    const Progress part = progress.part(double(i) / double(anatomies.size()), double(i + 1) / double(anatomies.size()));
    out.anatomies.push_back(
        with_field(anatomies[i], [&] { return anatomy_change(old_case, new_case, anatomies[i], params, part); }));
    const AnatomyChange& made = out.anatomies.back();
    if (made.deviation && made.old_is_felt != made.new_is_felt)
      out.warnings.push_back(made.name + ": one case displays it from its haptic volume and the other from a surface");
  }
  using Kind = PointChange::Kind;
  const auto confidence = [](PointChange& change, const auto* x, const auto* y) {
    if (x) change.old_confidence = x->confidence;
    if (y) change.new_confidence = y->confidence;
  };
  add_points(out.points, Kind::landmark, a.landmarks, b.landmarks, confidence);
  add_points(out.points, Kind::target, a.targets, b.targets, confidence);
  add_points(out.points, Kind::burr_hole, a.burr_holes, b.burr_holes,
             [](PointChange& change, const cases::CaseBurrHole* x, const cases::CaseBurrHole* y) {
               if (x && y) change.turned_deg = angle_deg(x->direction, y->direction);
             });
  add_changes(out.about, about(a), about(b));
  add_shapes(out.about, a.haptic.shapes, b.haptic.shapes);
  add_changes(out.figures, a.figures, b.figures);
  add_figures(out.figures, a.anatomies, b.anatomies);
  for (const cases::CaseBurrHole& x : a.burr_holes)
    if (const cases::CaseBurrHole* y = find_named(b.burr_holes, x.name)) {
      cases::CaseValues of_x = x.figures, of_y = y->figures;
      of_x.emplace_back("diameter_mm", x.diameter_mm);
      of_y.emplace_back("diameter_mm", y->diameter_mm);
      add_changes(out.figures, of_x, of_y, x.name + ".");
    }
  add_changes(out.parameters, a.parameters, b.parameters);
  return out;
}

std::vector<std::string> beyond_limits(const CaseComparison& comparison, const CompareParams& params) {
  std::vector<std::string> beyond;
  const auto say = [&](const std::string& name, const std::string& what, double is, double most, const char* unit) {
    beyond.push_back(name + " " + what + " " + trephine::to_text(is) + unit + ", the limit is " +
                     trephine::to_text(most) + unit);
  };
  for (const AnatomyChange& a : comparison.anatomies) {
    if (a.same_bytes) continue;
    if (params.max_deviation_mm > 0 && !a.deviation)
      beyond.push_back(a.name + " " + a.not_measured);
    else if (params.max_deviation_mm > 0 && !(a.deviation->both.max_mm <= params.max_deviation_mm))
      say(a.name, "deviates by", a.deviation->both.max_mm, params.max_deviation_mm, " mm");
    if (params.max_volume_ratio <= 0) continue;
    if (const std::optional<double> change_ml = a.change_ml(); !change_ml) {
      if (a.in == InCases::both)
        beyond.push_back(a.name +
                         " has a mesh in one case and a haptic volume in the other, so its volumes do not compare");
      else if (params.max_deviation_mm <= 0)
        beyond.push_back(a.name + " " + a.not_measured);
    } else if (const double ratio = std::abs(*change_ml) / *a.old_ml; !(ratio <= params.max_volume_ratio)) {
      say(a.name, "changed its volume by", ratio, params.max_volume_ratio, " of it");
    }
  }
  if (params.max_point_mm <= 0) return beyond;
  for (const PointChange& p : comparison.points)
    if (!p.moved_mm)
      beyond.push_back(p.name + " is not in the " + (p.in == InCases::only_old ? "new" : "old") + " case");
    else if (!(*p.moved_mm <= params.max_point_mm))
      say(p.name, "moved by", *p.moved_mm, params.max_point_mm, " mm");
  return beyond;
}

}  // namespace trephine::compare
