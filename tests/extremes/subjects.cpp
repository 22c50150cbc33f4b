// SPDX-License-Identifier: GPL-3.0-or-later
#include "subjects.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "base/error.h"
#include "grid/nrrd.h"

namespace trephine::extremes {
namespace {

// Labels for the stage that reads them: a file beside the tests' other scratch, of the balls.
std::string labels_file() {
  static const std::string file = [] {
    const auto folder = std::filesystem::temp_directory_path() / "trephine-extremes";
    std::filesystem::create_directories(folder);
    const std::string name = (folder / (std::to_string(getpid()) + ".nrrd")).string();
    const Field& field = base_scene().fields.at("");
    Mask mask(field);
    for (std::size_t v = 0; v < mask.count(); ++v) mask.voxels[v] = field.voxels[v] > 0;
    write_nrrd(name, mask);
    static std::string to_remove = name;
    std::atexit([] {
      std::error_code ignored;
      std::filesystem::remove(to_remove, ignored);
    });
    return name;
  }();
  return file;
}

struct Suited {
  const Scene& (*scene)();
  std::vector<std::string> ports;
  std::vector<std::pair<std::string, std::string>> base;
};

// What a stage needs in order to have something to work on, by its name, or name and method.
Suited suited(const std::string& stage, const std::string& method) {
  const std::string key = method.empty() ? stage : stage + " " + method;
  if (key == "segment brain") return {head_scene, {"skull"}, {{"lower_hu", "22"}}};
  if (key == "segment ventricles") return {head_scene, {"within"}, {{"lower_hu", "-15"}, {"upper_hu", "21.5"}}};
  if (stage == "landmarks") return {head_scene, {"brain", "ventricles"}, {}};
  if (stage == "deface") return {head_scene, {}, {}};
  if (stage == "anatomy") return {head_scene, {"skin", "skull", "brain", "ventricles", "landmarks"}, {}};
  if (stage == "canal") return {spine_scene, {}, {}};
  if (stage == "clavicle" || stage == "vein") return {chest_scene, {}, {}};
  if (stage == "labels") return {base_scene, {}, {{"file", labels_file()}}};
  if (stage == "snake") return {base_scene, {}, {{"bubbles_count", "1"}}};
  if (stage == "presegment") return {base_scene, {}, {{"lower_hu", "-500"}, {"upper_hu", "500"}}};
  if (stage == "burr_hole") return {head_scene, {"skin", "landmarks"}, {}};
  if (stage == "resample") return {base_scene, {}, {{"spacing_mm", "1,1,1"}}};
  if (stage == "measure") return {base_scene, {"reference"}, {}};
  return {base_scene, {}, {}};
}

}  // namespace

std::vector<Subject> subjects_of(const StageType& stage) {
  std::vector<std::string> methods{""};
  const AnyParams params = stage.make_params();
  if (const Parameter* method = params.set->find("method")) methods = method->choices;
  std::vector<Subject> all;
  for (const std::string& method : methods) {
    const Suited s = suited(stage.name, method);
    Subject subject{&stage, stage.name, &s.scene(), s.ports, s.base, false};
    if (!method.empty()) {
      subject.label += ", method " + method;
      subject.base.emplace_back("method", method);
    }
    all.push_back(std::move(subject));
  }
  return all;
}

std::vector<std::string> items_of(const Parameter& parameter, const std::string& text) {
  if (parameter.kind != ParameterKind::numbers) return {text};
  std::vector<std::string> items(1);
  for (const char c : text)
    if (c == ',')
      items.emplace_back();
    else
      items.back() += c;
  return items;
}

void set(AnyParams& params, const std::string& name, const std::string& text) {
  const Parameter* p = params.set->find(name);
  if (!p) throw Error(ExitCode::usage, "", name, "is no parameter");
  ParameterValue value;
  const std::string fault = parse_parameter(*p, items_of(*p, text), value);
  if (!fault.empty()) throw Error(ExitCode::usage, "", name, fault);
  p->set(params.object.get(), value);
}

AnyParams params_of(const Subject& subject) {
  AnyParams params = subject.stage->make_params();
  for (const auto& [name, text] : subject.base) set(params, name, text);
  return params;
}

StageInputs inputs_of(const Subject& subject) {
  StageInputs inputs;
  fill(inputs, *subject.stage, *subject.scene, subject.ports);
  return inputs;
}

}  // namespace trephine::extremes
