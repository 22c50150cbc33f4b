// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"
#include "cases/case.h"
#include "cases/case_names.h"

namespace trephine {
namespace {

using Json = nlohmann::ordered_json;

// The bytes at either end that a reader finds without parsing: the version first, the checksum last.
const std::string head = "{\n \"format\": \"trephine-case ";
const std::string tail_begin = ",\n \"checksum\": \"", tail_end = "\"\n}\n";
constexpr std::size_t hex_digits = 64;

[[noreturn]] void contradiction(const std::string& field, const std::string& what) {
  throw Error(ExitCode::internal, "case.json", field, what);
}

double finite(double v, const std::string& field) {
  if (!std::isfinite(v)) contradiction(field, "is not finite");
  return v + 0.0;
}

Json to_list(Vec3 v, const std::string& field) {
  return Json::array({finite(v.x, field), finite(v.y, field), finite(v.z, field)});
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
  out["colour_rgb"] =
      Json::array({finite(a.colour_rgb[0], at), finite(a.colour_rgb[1], at), finite(a.colour_rgb[2], at)});
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

void check_names(const CaseManifest& m) {
  std::set<std::string> files, anatomies;
  for (const auto& f : m.files) {
    if (!detail::is_case_file_name(f.name)) contradiction("files", "'" + f.name + "' is no name for a file of a case");
    if (!detail::is_sha256(f.sha256)) contradiction("files." + f.name, "has no SHA-256");
    if (!files.insert(f.name).second) contradiction("files", "'" + f.name + "' is named twice");
  }
  for (const auto& a : m.anatomies) {
    if (a.name.empty() || !anatomies.insert(a.name).second)
      contradiction("anatomies", "'" + a.name + "' is named twice");
    if (!a.file.empty() && !files.count(a.file))
      contradiction("anatomies." + a.name, "'" + a.file + "' is not in files");
  }
}

Json to_document(const CaseManifest& m) {
  Json out;
  out["case"] = m.case_token;
  out["frame"] = "LPS";
  out["unit"] = "mm";
  out["center_mm"] = to_list(m.center_mm, "center_mm");
  out["anatomies"] = Json::array();
  for (const auto& a : m.anatomies) out["anatomies"].push_back(to_anatomy(a));
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
  for (const auto& b : m.burr_holes)
    out["burr_holes"].push_back({{"name", b.name},
                                 {"position_mm", to_list(b.position_mm, "burr_holes." + b.name)},
                                 {"direction", to_list(b.direction, "burr_holes." + b.name)},
                                 {"diameter_mm", finite(b.diameter_mm, "burr_holes." + b.name)}});
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

// Reading. nlohmann's own exceptions (a wrong type, a missing key) become one Error in parse_case_json.

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

double to_number(const Json& v, const std::string& field) {
  if (!v.is_number() || !std::isfinite(v.get<double>())) refuse(field, "is not a finite number");
  return v.get<double>();
}

Vec3 to_vec3(const Json& v, const std::string& field) {
  if (!v.is_array() || v.size() != 3) refuse(field, "must be three numbers");
  return {to_number(v[0], field), to_number(v[1], field), to_number(v[2], field)};
}

std::uint64_t to_count(const Json& v, const std::string& field) {
  if (!v.is_number_unsigned()) refuse(field, "is not a count");
  return v.get<std::uint64_t>();
}

ParameterValue to_parameter(const Json& v, const std::string& field) {
  if (v.is_boolean()) return v.get<bool>();
  if (v.is_number_integer()) return v.get<std::int64_t>();
  if (v.is_number()) return to_number(v, field);
  if (v.is_string()) return v.get<std::string>();
  if (!v.is_array()) refuse(field, "is neither a value nor a list of numbers");
  std::vector<double> list;
  for (const auto& item : v) list.push_back(to_number(item, field));
  return list;
}

CaseValues to_values(const Json& object, const std::string& field) {
  CaseValues out;
  for (const auto& [name, value] : object.get_ref<const Json::object_t&>())
    out.emplace_back(name, to_parameter(value, field + "." + name));
  return out;
}

CaseAnatomy read_anatomy(const Json& v) {
  CaseAnatomy a;
  a.name = v.at("name").get<std::string>();
  const std::string at = "anatomies." + a.name;
  a.file = v.value("file", std::string());
  const Vec3 colour = to_vec3(v.at("colour_rgb"), at);
  a.colour_rgb = {colour.x, colour.y, colour.z};
  a.opacity = to_number(v.at("opacity"), at);
  a.triangles = to_count(v.at("triangles"), at);
  a.points = to_count(v.at("points"), at);
  a.volume_ml = to_number(v.at("volume_ml"), at);
  a.area_cm2 = to_number(v.at("area_cm2"), at);
  const Json& d = v.at("deviation_mm");
  a.deviation = {to_number(d.at("max"), at), to_number(d.at("p99"), at), to_number(d.at("rms"), at)};
  a.budget_asked_mm = to_number(v.at("budget_mm").at("asked"), at);
  a.budget_used_mm = to_number(v.at("budget_mm").at("used"), at);
  if (v.contains("figures")) a.figures = to_values(v.at("figures"), at);
  return a;
}

CaseManifest read_document(const Json& v) {
  CaseManifest m;
  m.case_token = v.at("case").get<std::string>();
  validate_case_token(m.case_token, ExitCode::bad_input);
  if (v.at("frame") != "LPS" || v.at("unit") != "mm") refuse("frame", "must be LPS in mm");
  m.center_mm = to_vec3(v.at("center_mm"), "center_mm");
  for (const auto& a : v.at("anatomies")) m.anatomies.push_back(read_anatomy(a));
  for (const auto& l : v.at("landmarks"))
    m.landmarks.push_back({l.at("name").get<std::string>(), to_vec3(l.at("position_mm"), "landmarks"),
                           to_number(l.at("confidence"), "landmarks"), l.at("source").get<std::string>()});
  for (const auto& t : v.at("targets"))
    m.targets.push_back({t.at("name").get<std::string>(), to_vec3(t.at("position_mm"), "targets"),
                         to_number(t.at("confidence"), "targets"), t.at("anatomy").get<std::string>()});
  for (const auto& b : v.at("burr_holes"))
    m.burr_holes.push_back({b.at("name").get<std::string>(), to_vec3(b.at("position_mm"), "burr_holes"),
                            to_vec3(b.at("direction"), "burr_holes"), to_number(b.at("diameter_mm"), "burr_holes")});
  m.face_policy = v.at("face").at("policy").get<std::string>();
  m.face_reason = v.at("face").at("reason").get<std::string>();
  const Json& p = v.at("provenance");
  m.program_version = p.at("program").get<std::string>();
  m.input_sha256 = p.at("input_sha256").get<std::string>();
  m.parameters = to_values(p.at("parameters"), "parameters");
  for (const auto& f : v.at("files"))
    m.files.push_back(
        {f.at("name").get<std::string>(), f.at("sha256").get<std::string>(), to_count(f.at("bytes"), "files")});
  return m;
}

// Throws where the bytes do not begin as a case of a version that we read.
void read_version(std::string_view json, CaseManifest& m) {
  if (json.substr(0, head.size()) != head) refuse("format", "not a case.json of Trephine");
  const std::string_view rest = json.substr(head.size(), 32);
  const std::string_view version = rest.substr(0, rest.find('"'));
  const auto dot = version.find('.');
  const auto major = parse_integer(version.substr(0, dot));
  const auto minor = dot == std::string_view::npos ? std::nullopt : parse_integer(version.substr(dot + 1));
  if (!major || !minor || *major < 1 || *minor < 0 || *major > 9999 || *minor > 9999)
    refuse("format", "the version is damaged");
  if (*major != case_version_major)
    refuse("format", "version " + std::string(version) + ", this program reads version " +
                         std::to_string(case_version_major) + "." + std::to_string(case_version_minor));
  m.version_major = static_cast<int>(*major);
  m.version_minor = static_cast<int>(*minor);
}

}  // namespace

std::string to_json(const CaseManifest& m) {
  validate_case_token(m.case_token, ExitCode::internal);
  check_names(m);
  std::string body;
  try {
    body = to_document(m).dump(1);
  } catch (const Json::exception&) {
    contradiction("", "a text is not UTF-8");
  }
  // "{\n ...\n}": between the version before it and the checksum after it.
  std::string out = head + std::to_string(m.version_major) + "." + std::to_string(m.version_minor) + "\",";
  out += body.substr(1, body.size() - 3);
  return out + tail_begin + sha256_of_bytes(out) + tail_end;
}

CaseManifest parse_case_json(std::string_view json) {
  CaseManifest version;
  read_version(json, version);
  const std::size_t tail = tail_begin.size() + hex_digits + tail_end.size();
  if (json.size() < head.size() + tail) refuse("checksum", "cut short");
  const std::string_view covered = json.substr(0, json.size() - tail);
  if (std::string(json.substr(covered.size())) != tail_begin + sha256_of_bytes(covered) + tail_end)
    refuse("checksum", "is not that of the file: it is damaged or was edited");
  try {
    CaseManifest m = read_document(Json::parse(json.begin(), json.end()));
    m.version_major = version.version_major;
    m.version_minor = version.version_minor;
    check_names(m);
    return m;
  } catch (const Json::exception&) {
    refuse("", "lacks a field, or one has the wrong type");
  } catch (const Error& e) {
    if (e.code() != ExitCode::internal) throw;
    refuse(e.field(), e.what());
  }
}

}  // namespace trephine
