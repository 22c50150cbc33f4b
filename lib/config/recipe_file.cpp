// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/recipe_file.h"

namespace trephine::config {
namespace {

// The ports whose source a recipe names. The first port of an anatomy's step takes what the step before it gives.
bool is_named(const stages::StageType& stage, const stages::Port& port) {
  return port.from == stages::From::recipe && (stage.place != stages::StagePlace::anatomy || &port != &stage.ports[0]);
}

Parameter port_parameter(const stages::Port& port) {
  Parameter p;
  p.name = port.name;
  p.help = port.help + ", as anatomy.stage";
  p.kind = ParameterKind::text;
  p.required = port.required;
  p.source = "output";
  p.get = [name = port.name](const void* q) {
    const auto& ports = static_cast<const RecipeStepParams*>(q)->ports;
    const auto found = ports.find(name);
    return ParameterValue(found == ports.end() ? std::string() : found->second);
  };
  p.set = [name = port.name](void* q, const ParameterValue& value) {
    static_cast<RecipeStepParams*>(q)->ports[name] = std::get<std::string>(value);
  };
  return p;
}

// Which of the case's scans the step reads, where it reads one at all.
bool reads_scan(const stages::StageType& stage) {
  if (stage.place != stages::StagePlace::anatomy) return false;
  for (const stages::Port& port : stage.ports)
    if (port.kind == stages::DataKind::volume || port.or_volume) return true;
  return false;
}

Parameter scan_parameter() {
  Parameter p;
  p.name = "scan";
  p.help = "The scan of the case that the step reads, by its name below `scans`, laid on the CT; empty: the CT.";
  p.kind = ParameterKind::text;
  p.source = "scan";
  p.get = [](const void* q) { return ParameterValue(static_cast<const RecipeStepParams*>(q)->scan); };
  p.set = [](void* q, const ParameterValue& value) {
    static_cast<RecipeStepParams*>(q)->scan = std::get<std::string>(value);
  };
  return p;
}

ParameterSet step_set(const stages::StageType& stage) {
  const auto params_of = [](void* q) { return static_cast<RecipeStepParams*>(q)->params.object.get(); };
  const ParameterSet& own = *stage.make_params().set;
  ParameterSet set;
  for (const Parameter& p : own.parameters) set.parameters.push_back(parameter_of_holder(p, params_of));
  for (const stages::Port& port : stage.ports)
    if (is_named(stage, port)) set.parameters.push_back(port_parameter(port));
  if (reads_scan(stage)) set.parameters.push_back(scan_parameter());
  set.make = [&stage] {
    auto step = std::make_shared<RecipeStepParams>();
    step->params = stage.make_params();
    return step;
  };
  if (own.fault)
    set.fault = [fault = own.fault, params_of](const void* q) { return fault(params_of(const_cast<void*>(q))); };
  return set;
}

}  // namespace

std::vector<StepChoice> recipe_steps(stages::StagePlace place) {
  static const std::map<std::string, ParameterSet> sets = [] {
    std::map<std::string, ParameterSet> all;
    for (const stages::StageType& stage : stages::stage_types()) all[stage.name] = step_set(stage);
    return all;
  }();
  std::vector<StepChoice> choices;
  for (const stages::StageType* stage : stages::stages_of(place))
    choices.push_back({stage->name, stage->summary, &sets.at(stage->name)});
  return choices;
}

}  // namespace trephine::config
