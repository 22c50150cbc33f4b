// SPDX-License-Identifier: GPL-3.0-or-later
#include "subjects.h"

#include <filesystem>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "base/write_file.h"
#include "grid/labels.h"
#include "grid/nrrd.h"
#include "scratch_folder.h"

namespace trephine::extremes {
namespace {

// It goes when the process ends.
const std::filesystem::path& scratch_folder() {
  static const ScratchFolder folder;
  return folder.path();
}

// Labels for the stage that reads them: a file of the balls.
std::string labels_file() {
  static const std::string file = [] {
    const std::string name = (scratch_folder() / "labels.nrrd").string();
    const grid::Field& field = usual_scene(Body::balls).fields.at("");
    grid::Mask mask(field);
    for (std::size_t v = 0; v < mask.count(); ++v) mask.voxels[v] = field.voxels[v] > 0;
    grid::write_nrrd(name, mask);
    return name;
  }();
  return file;
}

// A correction of the same balls: one slice more, one less.
std::string correction_file() {
  static const std::string file = [] {
    const std::string name = (scratch_folder() / "correction.nrrd").string();
    const grid::Field& field = usual_scene(Body::balls).fields.at("");
    grid::Mask mask(field);
    const int middle = field.size[2] / 2;
    for (int j = 0; j < field.size[1]; ++j)
      for (int i = 0; i < field.size[0]; ++i) {
        mask.at(i, j, middle) = field.at(i, j, middle) > 0 ? 0 : 1;
        mask.at(i, j, middle + 1) = field.at(i, j, middle + 1) > 0 ? 2 : 0;
      }
    grid::LabelFile map;
    map.lattice = mask;
    map.samples = mask;
    for (const char* segment : {"added", "removed"}) {
      map.segments.emplace_back();
      map.segments.back().id = map.segments.back().name = segment;
      map.segments.back().value = int(map.segments.size());
    }
    write_file(name, grid::encode_labels(map));
    return name;
  }();
  return file;
}

struct Suited {
  Body body;
  std::vector<std::string> ports;
  std::vector<std::pair<std::string, std::string>> base;
};

// What a stage needs in order to have something to work on.
Suited suited(const std::string& stage) {
  if (stage == "brain") return {Body::head, {"skull"}, {{"lower_hu", "22"}, {"edge", "fixed"}}};
  if (stage == "ventricles") return {Body::head, {}, {{"upper_hu", "21.5"}, {"edge", "fixed"}}};
  if (stage == "landmarks") return {Body::head, {"brain", "ventricles"}, {}};
  if (stage == "face_gate") return {Body::head, {"surface.*"}, {}};
  if (stage == "deface") return {Body::head, {}, {}};
  if (stage == "anatomy") return {Body::head, {"skin", "skull", "brain", "ventricles", "landmarks"}, {}};
  if (stage == "canal") return {Body::spine, {}, {}};
  if (stage == "pedicles") return {Body::lumbar, {}, {}};
  if (stage == "t1_contrast" || stage == "vessels") return {Body::head, {"skull"}, {}};
  if (stage == "zone") return {Body::head, {"skull", "ventricles"}, {}};
  if (stage == "clavicle" || stage == "vein") return {Body::chest, {}, {}};
  if (stage == "labels") return {Body::balls, {}, {{"file", labels_file()}}};
  if (stage == "correct") return {Body::balls, {}, {{"file", correction_file()}}};
  // It ends well and labels nothing: what a program may do is in external_test.
  if (stage == "external") return {Body::balls, {}, {{"program", "/bin/true"}, {"version", "true"}}};
  if (stage == "snake") return {Body::balls, {}, {{"bubbles_count", "1"}}};
  if (stage == "presegment") return {Body::balls, {}, {{"lower_hu", "-500"}, {"upper_hu", "500"}}};
  if (stage == "burrhole") return {Body::head, {"over", "landmarks"}, {}};
  if (stage == "register") return {Body::head, {}, {{"finest_mm", "4"}, {"samples_count", "2000"}}};
  if (stage == "resample") return {Body::balls, {}, {{"spacing_mm", "1,1,1"}}};
  if (stage == "measure") return {Body::balls, {"reference"}, {}};
  if (stage == "voxelize") return {Body::balls, {"shape.*", "cutters.*"}, {}};
  return {Body::balls, {}, {}};
}

}  // namespace

std::vector<Subject> subjects_of(const stages::StageType& stage) {
  std::vector<std::string> methods{""};
  const AnyParams params = stage.make_params();
  if (const Parameter* method = params.set->find("method")) methods = method->choices;
  std::vector<Subject> all;
  for (const std::string& method : methods) {
    const Suited s = suited(stage.name);
    Subject subject{&stage, stage.name, s.body, s.ports, s.base};
    if (!method.empty()) {
      subject.label += ", method " + method;
      subject.base.emplace_back("method", method);
    }
    all.push_back(std::move(subject));
  }
  return all;
}

std::vector<std::string> items_of(const Parameter& parameter, const std::string& text) {
  return parameter.kind == ParameterKind::numbers ? split_at(text, ',') : std::vector<std::string>{text};
}

void set(AnyParams& params, const std::string& name, const std::string& text) {
  for (const ParameterLeaf& leaf : leaves_of(params)) {
    if (leaf.path != name) continue;
    ParameterValue value;
    const std::string fault = parse_parameter(*leaf.parameter, items_of(*leaf.parameter, text), value);
    if (!fault.empty()) throw Error(ExitCode::usage, "", name, fault);
    return leaf.parameter->set(leaf.object, value);
  }
  throw Error(ExitCode::usage, "", name, "is no parameter");
}

AnyParams params_of(const Subject& subject) {
  AnyParams params = subject.stage->make_params();
  for (const auto& [name, text] : subject.base) set(params, name, text);
  return params;
}

bool fill(stages::StageInputs& inputs, const Subject& subject, const Scene& scene) {
  return fill(inputs, *subject.stage, scene, subject.ports);
}

stages::StageInputs inputs_of(const Subject& subject) {
  stages::StageInputs inputs;
  fill(inputs, subject, usual_scene(subject.body));
  return inputs;
}

bool is_slow(const Subject& subject, const std::string& parameter, const std::string& text) {
  const std::string& stage = subject.stage->name;
  if (stage == "landmarks" || stage == "register" || stage == "denoise" || stage == "pedicles") return true;
  if (stage == "face_gate")
    return text == "2,000 slices of 2 x 2" || text.find("voxels of 2 x 2") == 0 || text.find("voxels of 10 x") == 0;
  if (stage == "smooth" && parameter == "iterations_count") return text == "100000";
  return (stage == "segment" && parameter == "close_mm" && text == "30") ||
         (stage == "simplify" && parameter == "close_handles_mm" && text == "60") ||
         (stage == "remesh" && parameter == "max_deviation_mm" && text == "1e-06");
}

}  // namespace trephine::extremes
