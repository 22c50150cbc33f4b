// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "cases/case_parts.h"
#include "cases/json_at.h"

namespace trephine::detail {
namespace {

Vec3 to_vec3(const JsonAt& v) {
  const auto n = v.numbers(3);
  return {n[0], n[1], n[2]};
}

std::array<double, 3> to_colour(const JsonAt& v) {
  const auto n = v.numbers(3);
  return {n[0], n[1], n[2]};
}

ParameterValue to_parameter(const JsonAt& v) {
  if (v.value().is_boolean()) return v.flag();
  if (v.value().is_number_integer()) return v.integer(std::numeric_limits<std::int64_t>::min(), INT64_MAX >> 1);
  if (v.value().is_number()) return v.number();
  if (v.value().is_string()) return v.text();
  std::vector<double> list;
  for (const JsonAt& item : v.items()) list.push_back(item.number());
  return list;
}

CaseValues to_values(const JsonAt& at) {
  CaseValues out;
  if (!at.value().is_object()) at.refuse("is not an object");
  for (const auto& [name, value] : at.value().get_ref<const Json::object_t&>())
    out.emplace_back(name, to_parameter({value, at.path() + "." + name}));
  return out;
}

std::vector<std::string> to_texts(const JsonAt& at) {
  std::vector<std::string> out;
  for (const JsonAt& item : at.items()) out.push_back(item.text());
  return out;
}

CaseAnatomy to_anatomy(const JsonAt& v) {
  CaseAnatomy a;
  a.name = v["name"].text();
  if (const auto file = v.optional("file")) a.file = file->text();
  a.colour_rgb = to_colour(v["colour_rgb"]);
  a.opacity = v["opacity"].number();
  a.triangles = v["triangles"].count();
  a.points = v["points"].count();
  a.volume_ml = v["volume_ml"].number();
  a.area_cm2 = v["area_cm2"].number();
  const JsonAt d = v["deviation_mm"], b = v["budget_mm"];
  a.deviation = {d["max"].number(), d["p99"].number(), d["rms"].number()};
  a.budget_asked_mm = b["asked"].number();
  a.budget_used_mm = b["used"].number();
  if (const auto figures = v.optional("figures")) a.figures = to_values(*figures);
  return a;
}

CaseFace to_face(const JsonAt& v) {
  CaseFace f;
  f.touchable = v["touchable"].flag();
  f.stiffness_n_per_mm = v["stiffness_n_per_mm"].number();
  f.damping_n_s_per_mm = v["damping_n_s_per_mm"].number();
  f.static_friction_ratio = v["static_friction_ratio"].number();
  f.dynamic_friction_ratio = v["dynamic_friction_ratio"].number();
  f.pop_through_n = v["pop_through_n"].number();
  return f;
}

CaseMaterial to_material(const JsonAt& v) {
  CaseMaterial m;
  m.name = v["name"].text();
  m.colour_rgb = to_colour(v["colour_rgb"]);
  m.front = to_face(v["front"]);
  m.back = to_face(v["back"]);
  m.drag_n_s_per_mm = v["drag_n_s_per_mm"].number();
  m.shaft_friction_n_per_mm = v["shaft_friction_n_per_mm"].number();
  m.removal_energy_j_per_mm3 = v["removal_energy_j_per_mm3"].number();
  return m;
}

CaseShape to_shape(const JsonAt& v) {
  CaseShape s;
  s.name = v["name"].text();
  s.number = static_cast<int>(v["number"].integer(1, 1000));
  const JsonAt window = v["window"];
  if (window.items().size() != 2) window.refuse("must be two whole numbers");
  s.window_low = static_cast<std::int16_t>(window.item(0).integer(INT16_MIN, INT16_MAX));
  s.window_high = static_cast<std::int16_t>(window.item(1).integer(INT16_MIN, INT16_MAX));
  s.material = to_material(v["material"]);
  s.cuttable = v["cuttable"].flag();
  s.displayed = v["displayed"].text();
  s.volume_ml = v["volume_ml"].number();
  if (const auto d = v.optional("mismatch")) {
    s.mismatch.bias_mm = (*d)["bias_mm"].number();
    s.mismatch.rms_mm = (*d)["rms_mm"].number();
    s.mismatch.p99_mm = (*d)["p99_mm"].number();
    s.mismatch.max_mm = (*d)["max_mm"].number();
    s.mismatch.missed_ratio = (*d)["missed_ratio"].number();
    s.mismatch.samples = (*d)["samples"].count();
    if (s.mismatch.samples == 0) (*d)["samples"].refuse("0: where nothing was measured, mismatch must be left out");
  }
  return s;
}

std::array<int, 3> to_size(const JsonAt& v) {
  std::array<int, 3> size{};
  if (v.items().size() != 3) v.refuse("must be three whole numbers");
  for (std::size_t i = 0; i < 3; ++i) size[i] = static_cast<int>(v.item(i).integer(1, INT32_MAX));
  return size;
}

CaseCt to_ct(const JsonAt& v) {
  if (v["file"].text().empty()) v["file"].refuse("is empty");
  return {v["file"].text(), to_size(v["size"]), to_vec3(v["spacing_mm"])};
}

CaseHaptic to_haptic(const JsonAt& v) {
  CaseHaptic h;
  h.file = v["file"].text();
  if (h.file.empty()) v["file"].refuse("is empty");
  if (const auto hardness = v.optional("hardness_file")) {
    h.hardness_file = hardness->text();
    if (h.hardness_file.empty()) hardness->refuse("is empty, must be left out");
  }
  h.encoding = v["encoding"].text();
  h.size = to_size(v["size"]);
  h.spacing_mm = to_vec3(v["spacing_mm"]);
  for (const JsonAt& s : v["shapes"].items()) h.shapes.push_back(to_shape(s));
  return h;
}

CaseBurrHole to_burr_hole(const JsonAt& v) {
  CaseBurrHole b;
  b.name = v["name"].text();
  b.position_mm = to_vec3(v["position_mm"]);
  b.direction = to_vec3(v["direction"]);
  b.diameter_mm = v["diameter_mm"].number();
  if (const auto cut = v.optional("cut")) b.cut = to_texts(*cut);
  if (const auto figures = v.optional("figures")) b.figures = to_values(*figures);
  return b;
}

}  // namespace

CaseManifest read_manifest(std::string_view json) {
  const Json document = parse_json(json);
  const JsonAt v(document, "");
  CaseManifest m;
  m.case_token = v["case"].text();
  validate_case_token(m.case_token, ExitCode::bad_input);
  if (v["frame"].text() != "LPS") v["frame"].refuse("must be LPS");
  if (v["unit"].text() != "mm") v["unit"].refuse("must be mm");
  m.center_mm = to_vec3(v["center_mm"]);
  for (const JsonAt& a : v["anatomies"].items()) m.anatomies.push_back(to_anatomy(a));
  if (const auto missing = v.optional("missing"))
    for (const JsonAt& a : missing->items()) m.missing.push_back({a["anatomy"].text(), a["why"].text()});
  if (const auto haptic = v.optional("haptic")) m.haptic = to_haptic(*haptic);
  if (const auto ct = v.optional("ct")) m.ct = to_ct(*ct);
  for (const JsonAt& l : v["landmarks"].items())
    m.landmarks.push_back({l["name"].text(), to_vec3(l["position_mm"]), l["confidence"].number(), l["source"].text()});
  for (const JsonAt& t : v["targets"].items())
    m.targets.push_back({t["name"].text(), to_vec3(t["position_mm"]), t["confidence"].number(), t["anatomy"].text()});
  for (const JsonAt& b : v["burr_holes"].items()) m.burr_holes.push_back(to_burr_hole(b));
  if (const auto figures = v.optional("figures")) m.figures = to_values(*figures);
  m.face_policy = v["face"]["policy"].text();
  m.face_reason = v["face"]["reason"].text();
  const JsonAt p = v["provenance"];
  m.program_version = p["program"].text();
  m.input_sha256 = p["input_sha256"].text();
  m.parameters = to_values(p["parameters"]);
  for (const JsonAt& f : v["files"].items())
    m.files.push_back({f["name"].text(), f["sha256"].text(), f["bytes"].count()});
  return m;
}

}  // namespace trephine::detail
