// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/config_haptic.h"

#include <algorithm>

#include "base/text.h"
#include "cases/material.h"
#include "pipeline/config_head.h"

namespace trephine {
namespace fs = std::filesystem;
namespace {

// The bone that burr holes are placed on, and the skin over which Kocher's point is measured.
constexpr const char* skull_name = "skull";

std::vector<std::string> anatomy_names(const CaseConfig& config) {
  std::vector<std::string> names;
  for (const RecipeAnatomy& a : config.anatomies) names.push_back(a.name);
  return names;
}

bool known_anatomy(const CaseConfig& config, const YamlNode& key, const std::string& where, const fs::path& file,
                   ConfigFaults& faults) {
  if (config.find_anatomy(key.text)) return true;
  const std::string near = nearest_name(key.text, anatomy_names(config));
  faults.add(file, key, where,
             key.text + ", the pipeline has no such anatomy" + (near.empty() ? "" : ", did you mean " + near + "?"));
  return false;
}

// `{...}` or nothing.
bool is_map_or_nothing(const fs::path& file, const YamlNode& node, const std::string& where, ConfigFaults& faults) {
  if (node.kind == YamlNode::Kind::map || node.kind == YamlNode::Kind::null) return true;
  faults.add(file, node, where, "must hold keys and values");
  return false;
}

// One line, the shape's own.
struct ShapeReader {
  const fs::path& file;
  const std::vector<CaseMaterial>& materials;
  CaseConfig& out;
  ConfigFaults& faults;

  void read(const YamlNode& key, const YamlNode& node) {
    const std::string where = "haptic.shapes." + key.text;
    const bool hu = out.haptic.spec.encoding == HapticEncoding::hu;
    if (!is_map_or_nothing(file, node, where, faults)) return;
    if (!hu && !known_anatomy(out, key, where, file, faults)) return;
    if (!is_plain_name(key.text)) return faults.add(file, key, where, "a name has letters a-z, digits and _ only");
    SceneShape shape;
    HapticShapeSpec spec;
    shape.name = spec.name = key.text;
    MapReader body(file, node, where, faults);
    set_material(body, node, shape);
    shape.cuttable = flag(body, node, "cuttable");
    if (hu) {
      if (const auto window = body.numbers("window_hu", 2, {-32768, 32767})) {
        spec.low_hu = static_cast<std::int16_t>((*window)[0]);
        spec.high_hu = static_cast<std::int16_t>((*window)[1]);
        if (spec.low_hu > spec.high_hu || spec.low_hu != (*window)[0] || spec.high_hu != (*window)[1])
          body.fault(*node.find("window_hu"), "window_hu", "must be two whole HU, the lower one first");
      } else if (!node.find("window_hu")) {
        body.fault(node, "window_hu", "is missing");
      }
    } else {
      spec.clear_of = body.text("clear_of").value_or("");
      spec.clear_mm = body.number("clear_mm", {0.1, 100}).value_or(0);
      if (!spec.clear_of.empty()) known_anatomy(out, *node.find("clear_of"), where + ".clear_of", file, faults);
      if (spec.clear_of == spec.name) body.fault(*node.find("clear_of"), "clear_of", "is the shape itself");
      if (spec.clear_of.empty() != (spec.clear_mm == 0)) body.fault(node, "clear_of", "and clear_mm go together");
    }
    body.finish();
    for (const SceneDrill& d : out.drilled)
      if (d.anatomy == spec.name) {
        spec.drilled = true;
        spec.widen_mm = d.widen_mm;
      }
    out.haptic.spec.shapes.push_back(spec);
    out.haptic.shapes.push_back(shape);
  }

  void set_material(MapReader& body, const YamlNode& node, SceneShape& shape) {
    const std::string name = body.required(body.text("material"), "material");
    if (name.empty() || materials.empty()) return;
    std::vector<std::string> known;
    for (const CaseMaterial& m : materials) {
      known.push_back(m.name);
      if (m.name == name) shape.material = m;
    }
    if (!shape.material.name.empty()) return;
    const std::string near = nearest_name(name, known);
    body.fault(*node.find("material"), "material",
               name + ", no such material" + (near.empty() ? "" : ", did you mean " + near + "?"));
  }

  static bool flag(MapReader& body, const YamlNode& node, const std::string& key) {
    const auto text = body.text(key);
    if (text && *text != "true" && *text != "false")
      body.fault(*node.find(key), key, *text + ", must be true or false");
    return text == "true";
  }
};

}  // namespace

std::vector<CaseMaterial> read_materials(const fs::path& file, ConfigFaults& faults) {
  std::vector<CaseMaterial> all;
  const auto tree = read_yaml_or_fault(file, faults);
  if (!tree) return all;
  MapReader map(file, *tree, "", faults);
  if (const YamlNode* version = map.any("trephine"); !version || version->text != "1")
    map.fault(version ? *version : *tree, "trephine", "must be 1, the version of the configuration's format");
  const YamlNode* materials = map.map("materials");
  if (!tree->find("materials")) map.fault(*tree, "materials", "is missing");
  map.finish();
  if (!materials) return all;
  for (const auto& [key, node] : materials->entries) {
    const std::string where = "materials." + key.text;
    const std::size_t before = faults.count();
    MapReader body(file, node, where, faults);
    AnyParams material = AnyParams::make<MaterialParams>();
    body.parameters(material);
    AnyParams faces[2] = {AnyParams::make<MaterialFaceParams>(), AnyParams::make<MaterialFaceParams>()};
    for (int side = 0; side < 2; ++side) {
      const char* name = side == 0 ? "front" : "back";
      if (const YamlNode* face = body.map(name)) {
        MapReader reader(file, *face, where + "." + name, faults);
        reader.parameters(faces[side]);
        reader.finish();
      } else if (!node.find(name)) {
        body.fault(node, name, "is missing");
      }
    }
    body.finish();
    all.push_back(make_material(key.text, material.as<MaterialParams>(), faces[0].as<MaterialFaceParams>(),
                                faces[1].as<MaterialFaceParams>()));
    // Not where a value was refused already: the default in its place is nobody's fault.
    if (const std::string what = fault_of(all.back()); !what.empty() && faults.count() == before)
      faults.add(file, node, where, what);
  }
  return all;
}

void read_haptic_scene(const fs::path& file, const YamlNode& node, const std::vector<CaseMaterial>& materials,
                       CaseConfig& out, ConfigFaults& faults) {
  MapReader map(file, node, "haptic", faults);
  out.haptic.wanted = true;
  map.parameters(out.haptic.params);
  const std::string encoding = map.text("encoding").value_or("occupancy");
  if (encoding == "hu") out.haptic.spec.encoding = HapticEncoding::hu;
  if (encoding != "hu" && encoding != "occupancy")
    map.fault(*node.find("encoding"), "encoding", encoding + ", must be occupancy or hu");
  out.haptic.spec.region_of = map.text("region_of").value_or("");
  if (!out.haptic.spec.region_of.empty()) known_anatomy(out, *node.find("region_of"), "haptic.region_of", file, faults);
  const auto& params = out.haptic.params.as<VoxelizeParams>();
  if ((node.find("hardness_low_hu") || node.find("hardness_high_hu")) &&
      !(params.hardness_low_hu < params.hardness_high_hu))
    map.fault(node, "hardness_high_hu", "must exceed hardness_low_hu");
  const YamlNode* shapes = map.map("shapes");
  if (!node.find("shapes")) map.fault(node, "shapes", "is missing");
  map.finish();
  if (!shapes) return;
  if (shapes->entries.size() > haptic_max_shapes)
    map.fault(*shapes, "shapes", "at most " + std::to_string(haptic_max_shapes) + " shapes");
  ShapeReader reader{file, materials, out, faults};
  for (const auto& [key, shape] : shapes->entries) reader.read(key, shape);
  if (shapes->entries.empty()) map.fault(*shapes, "shapes", "names none");
}

void read_drilled(const fs::path& file, const YamlNode& node, CaseConfig& out, ConfigFaults& faults) {
  for (const auto& [key, options] : node.entries) {
    const std::string where = "burr_holes." + key.text;
    if (!known_anatomy(out, key, where, file, faults) || !is_map_or_nothing(file, options, where, faults)) continue;
    MapReader body(file, options, where, faults);
    out.drilled.push_back({key.text, body.number("widen_mm", {0, 50}).value_or(0)});
    body.finish();
  }
  if (!node.entries.empty() && !out.find_anatomy(skull_name))
    faults.add(file, node, "burr_holes", "the pipeline has no skull to place them on");
}

void read_burr_holes(const fs::path& file, const YamlNode& node, CaseConfig& out, ConfigFaults& faults) {
  constexpr std::size_t most = 16;
  if (node.items.size() > most) return faults.add(file, node, "burr_holes", "at most " + std::to_string(most));
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    CaseDrill hole{"burr_hole_" + std::to_string(i + 1), AnyParams::make<BurrHoleParams>()};
    const std::string where = "burr_holes[" + std::to_string(i) + "]";
    if (node.items[i].kind != YamlNode::Kind::map) {
      faults.add(file, node.items[i], where, "must hold keys and values");
      continue;
    }
    MapReader body(file, node.items[i], where, faults);
    body.parameters(hole.params);
    body.finish();
    out.burr_holes.push_back(std::move(hole));
  }
}

void check_burr_holes(const fs::path& file, const YamlNode& tree, CaseConfig& out, ConfigFaults& faults) {
  const YamlNode* at = tree.find("burr_holes");
  if (!out.drilled.empty() && out.burr_holes.empty())
    faults.add(file, at ? *at : tree, "burr_holes",
               "is missing: the scene cuts them, e.g. [{at: kocher, side: right, diameter_mm: 14}]");
  for (const CaseDrill& hole : out.burr_holes) try {
      const auto& params = hole.params.as<BurrHoleParams>();
      if (const std::string fault = params.toward.empty() ? "" : fault_of_landmark(params.toward, out); !fault.empty())
        throw Error(ExitCode::bad_config, "", "toward", fault);
      if (out.find_head_step(landmarks_step))
        check_request(params, ExitCode::bad_config);  // what is not given is looked for
      else
        request_of(params, hole.name, out.landmark_positions_mm(), ExitCode::bad_config);
    } catch (const Error& e) {
      faults.add(file, at ? *at : tree, hole.name + "." + e.field(), e.what());
    }
  // "What no scene requires is not computed": the same case may be built for a scene that drills and one that does not.
  if (out.drilled.empty()) out.burr_holes.clear();
}

}  // namespace trephine
