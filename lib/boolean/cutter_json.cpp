// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "boolean/cutter.h"

namespace trephine::boolean {
namespace {

using Json = nlohmann::ordered_json;
using Kind = Cutter::Kind;

constexpr std::pair<const char*, Kind> kinds[] = {{"cylinder", Kind::cylinder},
                                                  {"cone", Kind::cone},
                                                  {"ellipsoid", Kind::ellipsoid},
                                                  {"sphere", Kind::sphere},
                                                  {"mesh", Kind::mesh}};

[[noreturn]] void refuse(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

/// One cutter's members, each described once: `write` puts it into the object, `read` takes it out.
template <class Visitor>
void visit(Visitor&& v, Kind kind) {
  v("name", &Cutter::name);
  if (kind == Kind::mesh) return v("file", &Cutter::mesh_file);
  v("position_mm", &Cutter::position_mm);
  if (kind == Kind::sphere) return v("radius_mm", &Cutter::radius_mm);
  v("direction", &Cutter::direction);
  if (kind == Kind::ellipsoid) {
    v("across", &Cutter::across);
    return v("radii_mm", &Cutter::radii_mm);
  }
  v("radius_mm", &Cutter::radius_mm);
  if (kind == Kind::cone) v("end_radius_mm", &Cutter::end_radius_mm);
  v("above_mm", &Cutter::above_mm);
  v("depth_mm", &Cutter::depth_mm);
}

Json value_of(const std::string& s) { return s; }
Json value_of(double d) { return d; }
Json value_of(Vec3 p) { return Json::array({p.x, p.y, p.z}); }
Json value_of(const std::array<double, 3>& a) { return Json::array({a[0], a[1], a[2]}); }

void take(const Json& j, const std::string& at, std::string& out) {
  if (!j.is_string()) refuse(at, "must be a text");
  out = j.get<std::string>();
}

void take(const Json& j, const std::string& at, double& out) {
  if (!j.is_number() || !std::isfinite(j.get<double>())) refuse(at, "must be a finite number");
  out = j.get<double>();
}

void take(const Json& j, const std::string& at, std::array<double, 3>& out) {
  if (!j.is_array() || j.size() != 3) refuse(at, "must be three numbers");
  for (std::size_t i = 0; i < 3; ++i) take(j[i], at, out[i]);
}

void take(const Json& j, const std::string& at, Vec3& out) {
  std::array<double, 3> a;
  take(j, at, a);
  out = {a[0], a[1], a[2]};
}

Cutter read_cutter(const Json& j, const std::string& at) {
  if (!j.is_object()) refuse(at, "must be an object");
  Cutter c;
  std::string kind;
  if (!j.contains("kind")) refuse(at + ".kind", "is missing");
  take(j["kind"], at + ".kind", kind);
  bool known = false;
  for (const auto& [name, k] : kinds)
    if (kind == name) {
      c.kind = k;
      known = true;
    }
  if (!known) refuse(at + ".kind", "must be cylinder, cone, ellipsoid, sphere or mesh");
  std::size_t taken = 1;
  std::vector<std::string> names{"kind"};
  visit(
      [&](const char* name, auto member) {
        names.push_back(name);
        if (!j.contains(name)) {
          if (std::string(name) == "name") return;
          refuse(at + "." + name, "is missing");
        }
        take(j[name], at + "." + name, c.*member);
        ++taken;
      },
      c.kind);
  if (j.size() != taken)
    for (const auto& [key, value] : j.items())
      if (std::find(names.begin(), names.end(), key) == names.end()) refuse(at, "has an unknown key");
  if (c.kind != Kind::mesh) with_field(at, [&] { check_cutter(c, ExitCode::bad_input); });
  return c;
}

}  // namespace

std::string cutters_json(const std::vector<Cutter>& cutters) {
  Json list = Json::array();
  for (const Cutter& c : cutters) {
    Json j;
    for (const auto& [name, k] : kinds)
      if (c.kind == k) j["kind"] = name;
    visit([&](const char* name, auto member) { j[name] = value_of(c.*member); }, c.kind);
    list.push_back(std::move(j));
  }
  return Json{{"cutters", std::move(list)}}.dump(1) + "\n";
}

std::vector<Cutter> parse_cutters_json(const std::string& text) {
  Json j;
  try {
    j = Json::parse(text);
  } catch (const Json::exception&) {
    refuse("cutters", "is no JSON");
  }
  if (!j.is_object() || j.size() != 1 || !j.contains("cutters") || !j["cutters"].is_array())
    refuse("cutters", "must be an object with one list, cutters");
  std::vector<Cutter> all;
  for (const Json& c : j["cutters"]) all.push_back(read_cutter(c, "cutters[" + std::to_string(all.size()) + "]"));
  return all;
}

}  // namespace trephine::boolean
