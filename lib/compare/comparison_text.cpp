// SPDX-License-Identifier: GPL-3.0-or-later
// A comparison as a table for a person, and as JSON.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.h"
#include "base/text_table.h"
#include "compare/compare_cases.h"

namespace trephine::compare {
namespace {

using Json = nlohmann::ordered_json;

const char* name_of(PointChange::Kind kind) {
  return kind == PointChange::Kind::landmark ? "landmark" : kind == PointChange::Kind::target ? "target" : "burr_hole";
}

std::string number(double v, int digits) { return fmt::format("{:.{}f}", v, digits); }
std::string volume(const std::optional<double>& ml) { return ml ? number(*ml, 3) : "-"; }

std::string anatomies_text(const CaseComparison& c) {
  std::vector<std::vector<std::string>> rows{
      {"anatomy", "max mm", "p99 mm", "rms mm", "bias mm", "old ml", "new ml", "change %", "note"}};
  for (const AnatomyChange& a : c.anatomies) {
    std::vector<std::string> row{a.name};
    if (a.deviation) {
      const metrics::DeviationStats& d = a.deviation->both;
      for (const double v : {d.max_mm, d.p99_mm, d.rms_mm, d.bias_mm}) row.push_back(number(v, 4));
    } else {
      row.insert(row.end(), 4, a.same_bytes ? "0" : "-");
    }
    row.push_back(volume(a.old_ml));
    row.push_back(volume(a.new_ml));
    const std::optional<double> change_ml = a.change_ml();
    row.push_back(change_ml && *a.old_ml > 0 ? fmt::format("{:+.3f}", 100 * *change_ml / *a.old_ml) : "-");
    std::string note = a.same_bytes ? "same bytes" : a.not_measured;
    if (a.deviation && (a.old_is_felt || a.new_is_felt))
      note = a.old_is_felt == a.new_is_felt ? "of the haptic volumes"
             : a.old_is_felt                ? "old one of the haptic volume"
                                            : "new one of the haptic volume";
    row.push_back(note);
    rows.push_back(row);
  }
  return text_table(rows, "lrrrrrrrl");
}

std::string place_text(const std::optional<Vec3>& p) {
  return p ? fmt::format("{:.2f}, {:.2f}, {:.2f}", p->x, p->y, p->z) : "-";
}

std::string points_text(const CaseComparison& c) {
  if (c.points.empty()) return "";
  std::vector<std::vector<std::string>> rows{
      {"point", "kind", "moved mm", "turned deg", "old mm (LPS)", "new mm (LPS)"}};
  for (const PointChange& p : c.points)
    rows.push_back({p.name, p.kind == PointChange::Kind::burr_hole ? "burr hole" : name_of(p.kind),
                    p.moved_mm ? number(*p.moved_mm, 3) : "-", p.turned_deg ? number(*p.turned_deg, 2) : "",
                    place_text(p.old_mm), place_text(p.new_mm)});
  return "\n" + text_table(rows, "llrrrr");
}

std::string value_text(const std::optional<ParameterValue>& value) {
  if (!value) return "-";
  const std::string text = printable(trephine::to_text(*value));
  return text.size() > 60 ? text.substr(0, 57) + "..." : text;
}

std::string values_text(const char* title, const std::vector<ValueChange>& changes) {
  if (changes.empty()) return "";
  std::vector<std::vector<std::string>> rows{{title, "old", "new"}};
  for (const ValueChange& v : changes)
    rows.push_back({printable(v.name), value_text(v.old_value), value_text(v.new_value)});
  return "\n" + text_table(rows, "lll");
}

Json json_of(const std::optional<ParameterValue>& value) {
  if (!value) return nullptr;
  return std::visit([](const auto& v) { return Json(v); }, *value);
}

Json json_of(const std::vector<ValueChange>& changes) {
  Json out = Json::array();
  for (const ValueChange& v : changes)
    out.push_back({{"name", v.name}, {"old", json_of(v.old_value)}, {"new", json_of(v.new_value)}});
  return out;
}

Json json_of(const std::optional<Vec3>& p) { return p ? Json{p->x, p->y, p->z} : Json(nullptr); }
Json json_of(const std::optional<double>& v) { return v ? Json(*v) : Json(nullptr); }
Json json_of(const metrics::DeviationStats& d) {
  return {
      {"max_mm", d.max_mm}, {"p99_mm", d.p99_mm}, {"rms_mm", d.rms_mm}, {"mean_mm", d.mean_mm}, {"bias_mm", d.bias_mm}};
}

Json json_of(const AnatomyChange& a) {
  Json json{{"name", a.name}, {"in", to_text(a.in)}, {"same_bytes", a.same_bytes}};
  if (a.deviation) {
    json["deviation"] = json_of(a.deviation->both);
    json["new_to_old"] = json_of(a.deviation->mesh_to_reference);
    json["old_to_new"] = json_of(a.deviation->reference_to_mesh);
    json["samples_count"] = a.deviation->both.samples;
    json["of_haptic_volume"] = {{"old", a.old_is_felt}, {"new", a.new_is_felt}};
  }
  if (!a.not_measured.empty()) json["not_measured"] = a.not_measured;
  json["volume_ml"] = {{"old", json_of(a.old_ml)}, {"new", json_of(a.new_ml)}, {"change", json_of(a.change_ml())}};
  json["triangles_count"] = {{"old", a.old_triangles ? Json(*a.old_triangles) : Json(nullptr)},
                             {"new", a.new_triangles ? Json(*a.new_triangles) : Json(nullptr)}};
  return json;
}

Json json_of(const PointChange& p) {
  Json json{{"name", p.name},
            {"kind", name_of(p.kind)},
            {"in", to_text(p.in)},
            {"moved_mm", json_of(p.moved_mm)},
            {"position_mm", {{"old", json_of(p.old_mm)}, {"new", json_of(p.new_mm)}}}};
  if (p.kind == PointChange::Kind::burr_hole)
    json["turned_deg"] = json_of(p.turned_deg);
  else
    json["confidence"] = {{"old", p.old_mm ? Json(p.old_confidence) : Json(nullptr)},
                          {"new", p.new_mm ? Json(p.new_confidence) : Json(nullptr)}};
  return json;
}

}  // namespace

std::string comparison_text(const CaseComparison& c) {
  if (c.identical) return c.old_token + ": the two cases are the same, every value and every file\n";
  std::string text = c.old_token + " (old) and " + c.new_token + " (new), made from " +
                     (c.same_input ? "the same scan" : "different scans") + "\n\n";
  text += anatomies_text(c) + points_text(c) + values_text("figure", c.figures) + values_text("about", c.about) +
          values_text("parameter", c.parameters);
  if (c.parameters.empty()) text += "\nNo effective parameter differs.\n";
  return text;
}

std::string comparison_json(const CaseComparison& c) {
  Json json{{"old", c.old_token}, {"new", c.new_token}, {"identical", c.identical}, {"same_input", c.same_input}};
  json["anatomies"] = json["points"] = Json::array();
  for (const AnatomyChange& a : c.anatomies) json["anatomies"].push_back(json_of(a));
  for (const PointChange& p : c.points) json["points"].push_back(json_of(p));
  json["about"] = json_of(c.about);
  json["figures"] = json_of(c.figures);
  json["parameters"] = json_of(c.parameters);
  json["warnings"] = c.warnings;
  return json.dump(2) + "\n";
}

}  // namespace trephine::compare
