// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/config_head.h"

#include <algorithm>

#include "base/log.h"
#include "base/text.h"
#include "cases/landmarks.h"
#include "stages/data_files.h"

namespace trephine {
namespace fs = std::filesystem;
namespace {

const StageType* head_stage(const std::string& name) {
  static const StageType types[] = {resample_stage(), landmarks_stage(), deface_stage(), anatomy_stage()};
  for (const StageType& type : types)
    if (type.name == name) return &type;
  return nullptr;
}

}  // namespace

std::string hint_of_source(const std::string& source, DataKind kind, const std::vector<RecipeAnatomy>& anatomies) {
  const std::string name = source.substr(0, source.find('.'));
  std::string made;
  for (const RecipeAnatomy& anatomy : anatomies)
    if (anatomy.name == name)
      for (const RecipeStep& step : anatomy.steps)
        if (step.type->output == kind) made += (made.empty() ? "" : " or ") + name + "." + step.type->name;
  return made.empty() ? "" : ": here " + made;
}

void read_given_landmarks(const fs::path& file, const YamlNode& node, CaseConfig& out, ConfigFaults& faults) {
  MapReader landmarks(file, node, "landmarks", faults);
  for (const auto& entry : node.entries)
    if (const auto p = landmarks.numbers(entry.first.text, 3, {-1e5, 1e5}))
      out.landmarks.push_back({entry.first.text, {(*p)[0], (*p)[1], (*p)[2]}, 1, "given"});
}

std::vector<std::string> read_landmarks_file(const fs::path& file, bool wins, CaseConfig& out) {
  std::vector<std::string> names;
  const auto read = std::get<std::shared_ptr<const HeadLandmarks>>(load_data(file, DataKind::landmarks));
  for (const CaseLandmark& point : read->landmarks) {
    names.push_back(point.name);
    const auto known = std::find_if(out.landmarks.begin(), out.landmarks.end(),
                                    [&](const CaseLandmark& l) { return l.name == point.name; });
    if (known == out.landmarks.end())
      out.landmarks.push_back(point);
    else if (wins)
      *known = point;
    else
      throw Error(ExitCode::bad_config, file.string(), "landmarks." + point.name,
                  "is given here and in the configuration, which is meant?");
  }
  return names;
}

void drop_unused_landmarks(const std::vector<std::string>& names, CaseConfig& out) {
  const auto is_in = [](const std::vector<std::string>& all, const std::string& name) {
    return std::find(all.begin(), all.end(), name) != all.end();
  };
  std::vector<std::string> used = findable_landmarks();
  for (const CaseDrill& hole : out.burr_holes) used.push_back(hole.params.as<BurrHoleParams>().toward);
  for (const SceneLandmark& l : out.scene_landmarks) used.push_back(l.name);
  const auto unused = [&](const CaseLandmark& l) { return is_in(names, l.name) && !is_in(used, l.name); };
  for (const CaseLandmark& l : out.landmarks)
    if (const std::string near = nearest_name(l.name, used); unused(l) && !near.empty())
      log_warning(printable(l.name) + ", no landmark of that name is used, did you mean " + near + "?");
  out.landmarks.erase(std::remove_if(out.landmarks.begin(), out.landmarks.end(), unused), out.landmarks.end());
}

void read_head_step(const fs::path& file, const std::string& stage, const YamlNode& node, CaseConfig& out,
                    ConfigFaults& faults) {
  RecipeStep step;
  step.type = head_stage(stage);
  step.params = step.type->make_params();
  MapReader map(file, node, stage, faults);
  map.parameters(step.params);
  for (const Port& port : step.type->ports) {
    if (port.kind != DataKind::field) continue;  // the volume and the landmarks come by themselves
    const auto source = map.text(port.name);
    if (!source) {
      if (port.required && !node.find(port.name)) map.fault(node, port.name, "is missing: " + port.help);
      continue;
    }
    const std::size_t dot = source->find('.');
    const RecipeAnatomy* anatomy = dot == std::string::npos ? nullptr : out.find_anatomy(source->substr(0, dot));
    const RecipeStep* made = anatomy ? anatomy->find_step(source->substr(dot + 1)) : nullptr;
    if (!made || made->type->output != port.kind)
      map.fault(*node.find(port.name), port.name,
                *source + ", must be the " + to_text(port.kind) + " of an anatomy, as anatomy.stage" +
                    hint_of_source(*source, port.kind, out.anatomies));
    else
      step.ports[port.name] = *source;
  }
  map.finish();
  out.head.push_back(std::move(step));
}

void read_face_policy(const fs::path& file, const YamlNode& node, CaseConfig& out, ConfigFaults& faults) {
  MapReader body(file, node, "face", faults);
  const std::string policy = body.required(body.text("policy"), "policy");
  out.face = policy;
  if (!policy.empty() && policy != "keep" && policy != "crop" && policy != "deface")
    body.fault(*node.find("policy"), "policy", policy + ", must be crop, deface or keep");
  out.face_reason = body.text("reason").value_or("");
  if (policy == "keep" && !node.find("reason"))
    body.fault(node, "reason", "is missing: why may the case show the patient's face?");
  if (node.find("reason") && out.face_reason.find_first_not_of(" \t\r\n") == std::string::npos)
    body.fault(*node.find("reason"), "reason", "is blank: why may the case show the patient's face?");
  if (policy == "crop" || policy == "deface") {
    const RecipeStep* deface = out.find_head_step(deface_step);
    if (!deface || !out.find_head_step(landmarks_step))
      body.fault(*node.find("policy"), "policy", policy + ", needs `landmarks` and `deface` in the pipeline");
    else
      deface->params.set->find("policy")->set(deface->params.object.get(), policy);
  }
  body.finish();
}

std::string fault_of_landmark(const std::string& name, const CaseConfig& config) {
  std::vector<std::string> known;
  if (config.find_head_step(landmarks_step)) known = findable_landmarks();
  for (const CaseLandmark& l : config.landmarks) known.push_back(l.name);
  if (std::find(known.begin(), known.end(), name) != known.end()) return "";
  const std::string near = nearest_name(name, known);
  return name + ", no such landmark is given" + (config.find_head_step(landmarks_step) ? " or can be found" : "") +
         (near.empty() ? "" : ", did you mean " + near + "?");
}

void read_scene_landmarks(const fs::path& file, const YamlNode& node, CaseConfig& out, ConfigFaults& faults) {
  MapReader map(file, node, "landmarks", faults);
  for (const auto& entry : node.entries)
    if (const std::string fault = fault_of_landmark(entry.first.text, out); !fault.empty())
      faults.add(file, entry.first, "landmarks." + entry.first.text, fault);
    else if (const auto least = map.number(entry.first.text, {0, 1}))
      out.scene_landmarks.push_back({entry.first.text, *least});
}

}  // namespace trephine
