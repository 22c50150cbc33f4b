// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "cases/case_parts.h"
#include "cases/json_at.h"

namespace trephine::detail {
namespace {

[[noreturn]] void contradiction(const std::string& field, const std::string& what) {
  throw Error(ExitCode::internal, "case.json", field, what);
}

double finite(double v, const std::string& field) {
  if (!std::isfinite(v)) contradiction(field, "is not finite");
  return v + 0.0;  // -0 becomes 0, so that equal values give equal bytes
}

Json to_list(Vec3 v, const std::string& field) {
  return Json::array({finite(v.x, field), finite(v.y, field), finite(v.z, field)});
}

Json to_colour(const std::array<double, 3>& c, const std::string& field) {
  return Json::array({finite(c[0], field), finite(c[1], field), finite(c[2], field)});
}

Json to_value(const ParameterValue& value, const std::string& field) {
  if (const auto* v = std::get_if<double>(&value)) return finite(*v, field);
  if (const auto* v = std::get_if<std::int64_t>(&value)) return *v;
  if (const auto* v = std::get_if<bool>(&value)) return *v;
  if (const auto* v = std::get_if<std::string>(&value)) return *v;
  Json list = Json::array();
  for (const double v : std::get<std::vector<double>>(value)) list.push_back(finite(v, field));
  return list;
}

Json to_object(const CaseValues& values, const std::string& field) {
  Json out = Json::object();
  for (const auto& [name, value] : values) {
    if (out.contains(name)) contradiction(field, "'" + name + "' is given twice");
    out[name] = to_value(value, field + "." + name);
  }
  return out;
}

Json to_anatomy(const CaseAnatomy& a) {
  const std::string at = "anatomies." + a.name;
  Json out;
  out["name"] = a.name;
  if (!a.file.empty()) out["file"] = a.file;
  out["colour_rgb"] = to_colour(a.colour_rgb, at);
  out["opacity"] = finite(a.opacity, at);
  out["triangles"] = a.triangles;
  out["points"] = a.points;
  out["volume_ml"] = finite(a.volume_ml, at);
  out["area_cm2"] = finite(a.area_cm2, at);
  out["deviation_mm"] = {{"max", finite(a.deviation.max_mm, at)},
                         {"p99", finite(a.deviation.p99_mm, at)},
                         {"rms", finite(a.deviation.rms_mm, at)}};
  out["budget_mm"] = {{"asked", finite(a.budget_asked_mm, at)}, {"used", finite(a.budget_used_mm, at)}};
  if (!a.figures.empty()) out["figures"] = to_object(a.figures, at);
  return out;
}

Json to_face(const CaseFace& f, const std::string& at) {
  return {{"touchable", f.touchable},
          {"stiffness_n_per_mm", finite(f.stiffness_n_per_mm, at)},
          {"damping_n_s_per_mm", finite(f.damping_n_s_per_mm, at)},
          {"static_friction_ratio", finite(f.static_friction_ratio, at)},
          {"dynamic_friction_ratio", finite(f.dynamic_friction_ratio, at)},
          {"pop_through_n", finite(f.pop_through_n, at)}};
}

Json to_material(const CaseMaterial& m, const std::string& at) {
  return {{"name", m.name},
          {"colour_rgb", to_colour(m.colour_rgb, at)},
          {"front", to_face(m.front, at + ".front")},
          {"back", to_face(m.back, at + ".back")},
          {"drag_n_s_per_mm", finite(m.drag_n_s_per_mm, at)},
          {"shaft_friction_n_per_mm", finite(m.shaft_friction_n_per_mm, at)},
          {"removal_energy_j_per_mm3", finite(m.removal_energy_j_per_mm3, at)}};
}

Json to_shape(const CaseShape& s) {
  const std::string at = "haptic.shapes." + s.name;
  Json out;
  out["name"] = s.name;
  out["number"] = s.number;
  out["window"] = Json::array({s.window_low, s.window_high});
  out["cuttable"] = s.cuttable;
  out["displayed"] = s.displayed;
  out["volume_ml"] = finite(s.volume_ml, at);
  out["material"] = to_material(s.material, at + ".material");
  const CaseMismatch& d = s.mismatch;
  if (d.samples > 0)
    out["mismatch"] = {{"bias_mm", finite(d.bias_mm, at)},
                       {"rms_mm", finite(d.rms_mm, at)},
                       {"p99_mm", finite(d.p99_mm, at)},
                       {"max_mm", finite(d.max_mm, at)},
                       {"missed_ratio", finite(d.missed_ratio, at)},
                       {"samples", d.samples}};
  return out;
}

Json to_haptic(const CaseHaptic& h) {
  Json out;
  out["file"] = h.file;
  if (!h.hardness_file.empty()) out["hardness_file"] = h.hardness_file;
  out["encoding"] = h.encoding;
  out["size"] = Json::array({h.size[0], h.size[1], h.size[2]});
  out["spacing_mm"] = to_list(h.spacing_mm, "haptic.spacing_mm");
  out["shapes"] = Json::array();
  for (const CaseShape& s : h.shapes) out["shapes"].push_back(to_shape(s));
  return out;
}

Json to_ct(const CaseCt& c) {
  return {{"file", c.file},
          {"size", Json::array({c.size[0], c.size[1], c.size[2]})},
          {"spacing_mm", to_list(c.spacing_mm, "ct.spacing_mm")}};
}

Json to_burr_hole(const CaseBurrHole& b) {
  const std::string at = "burr_holes." + b.name;
  Json out = {{"name", b.name},
              {"position_mm", to_list(b.position_mm, at)},
              {"direction", to_list(b.direction, at)},
              {"diameter_mm", finite(b.diameter_mm, at)}};
  out["cut"] = b.cut;
  if (!b.figures.empty()) out["figures"] = to_object(b.figures, at);
  return out;
}

Json to_document(const CaseManifest& m) {
  Json out;
  out["case"] = m.case_token;
  out["frame"] = "LPS";
  out["unit"] = "mm";
  out["center_mm"] = to_list(m.center_mm, "center_mm");
  out["anatomies"] = Json::array();
  for (const auto& a : m.anatomies) out["anatomies"].push_back(to_anatomy(a));
  for (const auto& a : m.missing) out["missing"].push_back({{"anatomy", a.anatomy}, {"why", a.why}});
  if (!m.haptic.file.empty()) out["haptic"] = to_haptic(m.haptic);
  if (!m.ct.file.empty()) out["ct"] = to_ct(m.ct);
  out["landmarks"] = Json::array();
  for (const auto& l : m.landmarks)
    out["landmarks"].push_back({{"name", l.name},
                                {"position_mm", to_list(l.position_mm, "landmarks." + l.name)},
                                {"confidence", finite(l.confidence, "landmarks." + l.name)},
                                {"source", l.source}});
  out["targets"] = Json::array();
  for (const auto& t : m.targets)
    out["targets"].push_back({{"name", t.name},
                              {"position_mm", to_list(t.position_mm, "targets." + t.name)},
                              {"confidence", finite(t.confidence, "targets." + t.name)},
                              {"anatomy", t.anatomy}});
  out["burr_holes"] = Json::array();
  for (const auto& b : m.burr_holes) out["burr_holes"].push_back(to_burr_hole(b));
  if (!m.figures.empty()) out["figures"] = to_object(m.figures, "figures");
  out["face"] = {{"policy", m.face_policy}, {"reason", m.face_reason}};
  out["provenance"] = {{"program", m.program_version},
                       {"input_sha256", m.input_sha256},
                       {"parameters", to_object(m.parameters, "parameters")}};
  auto files = m.files;
  std::sort(files.begin(), files.end(), [](const CaseFile& a, const CaseFile& b) { return a.name < b.name; });
  out["files"] = Json::array();
  for (const auto& f : files) out["files"].push_back({{"name", f.name}, {"sha256", f.sha256}, {"bytes", f.bytes}});
  return out;
}

}  // namespace

std::string manifest_text(const CaseManifest& m) {
  try {
    return to_document(m).dump(1);
  } catch (const Json::exception&) {
    contradiction("", "a text is not UTF-8");
  }
}

}  // namespace trephine::detail
