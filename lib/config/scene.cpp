// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "config/reading.h"

namespace trephine::config {
namespace fs = std::filesystem;
namespace {

// The materials by name, from the file that the scene names.
Named<cases::MaterialParams> read_materials(ConfigReading& r, const fs::path& file) {
  MaterialsFileParams said;
  DeclaredReading reading{file, r.faults, {}, {}};
  reading.said = [&](const std::string& path, const YamlNode& at) {
    r.said.emplace_back(path, r.origin(ValueSource::scene, file, at));
  };
  if (const auto tree = read_yaml_or_fault(file, r.faults))
    read_declared(reading, *tree, parameters_of<MaterialsFileParams>(), &said);
  return said.materials;
}

std::string fault_of_material(const ConfigReading& r, const std::string& name) {
  if (r.materials.empty() || find_item(r.materials, name)) return "";
  std::vector<std::string> known;
  for (const auto& m : r.materials) known.push_back(m.first);
  return name + ", no such material" + did_you_mean(name, known);
}

// The HU that are touched, for they are the shape.
std::array<double, 2> window_of(const SceneShapeParams& shape) {
  const bool window = shape.window_hu != stages::HapticShapeParams().window_hu;
  if (!shape.transfer || window || !shape.transfer->fault().empty()) return shape.window_hu;
  const auto touched = voxel::touched_hu(voxel::resolved(*shape.transfer));
  return touched ? std::array<double, 2>{double((*touched)[0]), double((*touched)[1])} : shape.window_hu;
}

// The function that the file holds.
std::optional<voxel::TransferFunction> read_transfer(ConfigReading& r, const fs::path& file) {
  voxel::TransferFunction f;
  const std::size_t before = r.faults.count();
  if (const auto tree = read_yaml_or_fault(file, r.faults))
    read_declared({file, r.faults, {}, {}}, *tree, parameters_of<voxel::TransferFunction>(), &f);
  return r.faults.count() == before ? std::optional(f) : std::nullopt;
}

class SceneReader {
 public:
  SceneReader(ConfigReading& reading, const fs::path& file) : r_(reading), file_(file) {}

  void read() {
    const auto tree = read_yaml_or_fault(file_, r_.faults);
    // Without a recipe the anatomies are unknown, so what the scene says of them is not checked.
    if (!tree || r_.out.anatomies.empty()) return;
    auto& said = r_.out.scene_file.as<SceneFileParams>();
    DeclaredReading reading{file_, r_.faults, {}, {}};
    reading.fault_of_name = [&](const std::string& kind, const std::string& name) {
      return fault_of_name(kind, name, said);
    };
    reading.said = [&](const std::string& path, const YamlNode& at) {
      r_.said.emplace_back(path.rfind("haptic.", 0) == 0 ? path : "scene." + path,
                           r_.origin(ValueSource::scene, file_, at));
    };
    at_ = read_declared(reading, *tree, parameters_of<SceneFileParams>(), &said);
    if (said.haptic)
      for (auto& [name, shape] : said.haptic->shapes)
        if (const auto* f = find_item(transfers_, std::exchange(shape.transfer_file, ""))) shape.transfer = *f;
    check(said);
  }

 private:
  // Is asked in the order of declaration: the file of materials and the encoding are known before a shape is read.
  std::string fault_of_name(const std::string& kind, const std::string& name, const SceneFileParams& said) {
    const bool of_hu = said.haptic && said.haptic->encoding == voxel::HapticEncoding::hu;
    if (kind == "anatomy") return r_.fault_of_anatomy(name);
    if (kind == "landmark") return r_.fault_of_landmark(name);
    if (kind == "materials") return read_materials_of(name);
    if (kind == "transfer_file") return read_transfer_of(name);
    if (kind == "shape" && !of_hu) return r_.fault_of_anatomy(name);
    if (kind == "shape" && !is_plain_name(name)) return "a name has letters a-z, digits and _ only";
    if (kind == "material") return fault_of_material(r_, name);
    return "";
  }

  std::string read_materials_of(const std::string& name) {
    std::string fault;
    const fs::path path = r_.in_root(file_, name, fault);
    if (fault.empty()) r_.materials = read_materials(r_, path);
    return fault;
  }

  std::string read_transfer_of(const std::string& name) {
    std::string fault;
    const fs::path path = r_.in_root(file_, name, fault);
    if (!fault.empty() || find_item(transfers_, name)) return fault;
    if (const auto f = read_transfer(r_, path)) transfers_.emplace_back(name, *f);
    return "";
  }

  // Checks what the declarations cannot express: parts of the scene against each other and against the recipe.
  void check(const SceneFileParams& said) {
    const auto fault = [&](const char* key, const std::string& where, const std::string& what) {
      r_.faults.add(file_, at_.at(key), where, what);
    };
    for (const auto& [name, anatomy] : said.anatomies)
      if (find_item(said.anatomies, anatomy.stand_in))
        fault("anatomies", "anatomies." + name + ".stand_in", anatomy.stand_in + ", the scene shows it already");
    check_touched(said, fault);
    if (said.haptic && said.materials.empty()) fault("haptic", "haptic", "needs materials: FILE beside it");
    for (const auto& [name, drill] : said.burr_holes)
      if (!find_item(said.anatomies, name) && !(said.haptic && find_item(said.haptic->shapes, name)))
        fault("burr_holes", "burr_holes." + name, "the scene neither shows nor feels it");
    if (!said.burr_holes.empty() && r_.out.roles.burr_holes.bone.empty())
      fault("burr_holes", "burr_holes",
            "the pipeline does not say which bone they are placed on: burr_holes: {bone: ANATOMY, over: ANATOMY}");
    if (said.face && said.face->policy != FacePolicy::keep && !(r_.out.face_step() && r_.out.landmarks_step()))
      fault("face", "face.policy", "crop and deface need `landmarks` and `deface` in the pipeline");
    if (!said.haptic) return;
    check_windows(*said.haptic, fault);
    for (const auto& [name, shape] : said.haptic->shapes)
      if (shape.clear_of == name) fault("haptic", "haptic.shapes." + name + ".clear_of", "is the shape itself");
  }

  // Of surfaces that are touched as meshes.
  template <class Fault>
  void check_touched(const SceneFileParams& said, const Fault& fault) const {
    std::ptrdiff_t count = 0;
    for (const auto& [name, anatomy] : said.anatomies) {
      if (anatomy.touched_as.empty()) continue;
      const std::string where = "anatomies." + name + ".touched_as", what = fault_of_material(r_, anatomy.touched_as);
      const cases::MaterialParams* material = find_item(r_.materials, anatomy.touched_as);
      const std::string unfit = material ? cases::fault_of_mesh_material(*material) : "";
      if (!said.haptic)
        fault("anatomies", where, "needs haptic: beside it, for a surface is touched beside the haptic volume");
      else if (!what.empty() || !unfit.empty())
        fault("anatomies", where, what.empty() ? anatomy.touched_as + ": " + unfit : what);
      else if (++count == cases::max_touched_surfaces + 1)
        fault("anatomies", where,
              fmt::format("at most {} surfaces may be touched as meshes", cases::max_touched_surfaces));
    }
  }

  // Of raw HU: what is touched of two shapes may not be the same.
  template <class Fault>
  static void check_windows(const SceneHapticParams& haptic, const Fault& fault) {
    if (haptic.encoding != voxel::HapticEncoding::hu) return;
    for (std::size_t n = 0; n < haptic.shapes.size(); ++n)
      for (std::size_t m = 0; m < n; ++m) {
        const auto& [name, shape] = haptic.shapes[n];
        const auto& [other, before] = haptic.shapes[m];
        const std::array<double, 2> a = window_of(shape), b = window_of(before);
        if (a[0] > b[1] || b[0] > a[1] || !(shape.transfer || before.transfer)) continue;
        fault("haptic", "haptic.shapes." + name + (shape.transfer ? ".transfer" : ".window_hu"),
              fmt::format("{:g} to {:g} HU are touched, and {} is touched from {:g} to {:g} HU: they must not overlap",
                          a[0], a[1], other, b[0], b[1]));
      }
  }

  ConfigReading& r_;
  const fs::path& file_;
  Named<voxel::TransferFunction> transfers_;  // by the names of their files
  Places at_;
};

std::string name_of(FacePolicy policy) {
  return policy == FacePolicy::keep ? "keep" : policy == FacePolicy::crop ? "crop" : "deface";
}

}  // namespace

std::string FacePolicyParams::fault() const {
  if (believe != face::FaceBelief::both && believe_reason.find_first_not_of(" \t\r\n") == std::string::npos)
    return "believe_reason: is missing: why are these landmarks right?";
  if (policy != FacePolicy::keep || reason.find_first_not_of(" \t\r\n") != std::string::npos) return "";
  return std::string("reason: is ") + (reason.empty() ? "missing" : "blank") +
         ": why may the case show the patient's face?";
}

std::string SceneHapticParams::fault() const {
  if ((hardness_low_hu != 0 || hardness_high_hu != 0) && !(hardness_low_hu < hardness_high_hu))
    return "hardness_high_hu: must exceed hardness_low_hu";
  for (const auto& [name, shape] : shapes) {
    const bool window = shape.window_hu != stages::HapticShapeParams().window_hu;
    if (shape.transfer && !shape.transfer_file.empty())
      return "shapes." + name + ".transfer_file: is there beside transfer: give one of the two";
    const bool function = shape.transfer || !shape.transfer_file.empty();
    if (function && encoding != voxel::HapticEncoding::hu)
      return "shapes." + name + ".transfer: is of HU, and needs encoding: hu";
    if (function && window)
      return "shapes." + name + ".window_hu: is there beside transfer, which says what is touched: give one of the two";
    if (encoding == voxel::HapticEncoding::hu && !window && !function)
      return "shapes." + name + ".window_hu: is missing: give it, or transfer";
  }
  return "";
}

void read_scene(ConfigReading& reading, const fs::path& file) { SceneReader(reading, file).read(); }

void derive_scene(ConfigReading& r) {
  CaseConfig& out = r.out;
  const auto& said = out.scene_file.as<SceneFileParams>();
  // The recipe's order is used, so that the scene's order changes no byte of the case.
  for (const RecipeAnatomy& anatomy : out.anatomies)
    if (const SceneAnatomyParams* wanted = find_item(said.anatomies, anatomy.name)) {
      SceneAnatomy one;
      static_cast<SceneAnatomyParams&>(one) = *wanted;
      one.name = anatomy.name;
      if (const cases::MaterialParams* material = find_item(r.materials, wanted->touched_as)) {
        static_cast<cases::MaterialParams&>(one.material) = *material;
        one.material.name = wanted->touched_as;
      }
      if (said.strict) {
        one.may_be_missing = false;
        one.stand_in.clear();
      }
      out.scene.push_back(one);
    }
  for (const auto& [name, least] : said.landmarks) out.scene_landmarks.push_back({name, least.least});
  for (const auto& [name, drill] : said.burr_holes) {
    SceneDrill one;
    static_cast<stages::DrillParams&>(one) = drill;
    one.anatomy = name;
    out.drilled.push_back(one);
  }
  if (said.face) {
    out.face = name_of(said.face->policy);
    out.face_reason = said.face->reason;
    if (said.face->policy != FacePolicy::keep) {
      const ValueOrigin from{ValueSource::scene, "the scene's face policy", {}};
      out.face_belief = *said.face;
      if (out.face_reason.empty()) out.face_reason = out.face_belief.believe_reason;
      r.values.set_value("deface.policy", out.face, from);
      const AnyParams belief = AnyParams::make(out.face_belief);
      for (const char* name : {"believe", "believe_reason"})
        r.values.set_value(std::string("deface.") + name, belief.get(*belief.set->find(name)), from);
    }
  }
  out.ct = said.ct;
  if (!said.haptic) return;
  out.haptic.wanted = true;
  auto& stage = out.haptic.params.as<stages::VoxelizeStageParams>();
  static_cast<stages::HapticVolumeParams&>(stage) = *said.haptic;
  for (const auto& [name, shape] : said.haptic->shapes) {
    stage.shapes.emplace_back(name, shape);
    stage.shapes.back().second.window_hu = window_of(shape);
    if (const stages::DrillParams* drill = find_item(said.burr_holes, name)) stage.drill.emplace_back(name, *drill);
    SceneShape& felt = out.haptic.shapes.emplace_back();
    static_cast<cases::ShapeParams&>(felt) = shape;
    if (felt.transfer) felt.transfer = voxel::resolved(*felt.transfer);
    felt.name = name;
    if (const cases::MaterialParams* material = find_item(r.materials, shape.material)) {
      static_cast<cases::MaterialParams&>(felt.material) = *material;
      felt.material.name = shape.material;
    }
    // A value from --set may be any text; a value from the file was checked where it stands.
    const std::string path = "haptic.shapes." + name + ".material";
    if (const std::string what = fault_of_material(r, shape.material);
        !what.empty() && r.values.origin(path).source > ValueSource::scene)
      r.faults.add(Error(ExitCode::bad_config, r.values.origin(path).where, path, what));
  }
}

}  // namespace trephine::config
