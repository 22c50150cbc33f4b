// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/stage.h"

#include <algorithm>

#include "base/error.h"

namespace trephine::stages {

const char* to_text(DataKind kind) {
  switch (kind) {
    case DataKind::volume:
      return "volume";
    case DataKind::field:
      return "field";
    case DataKind::mesh:
      return "surface";
    case DataKind::haptic:
      return "haptic volume";
    case DataKind::cutters:
      return "list of cutters";
    case DataKind::landmarks:
      return "list of landmarks";
    case DataKind::labels:
      return "map of labels";
    case DataKind::nothing:
      return "report";
  }
  return "";
}

PortDeclaration::PortDeclaration(std::string name, DataKind kind) {
  port_.name = std::move(name);
  port_.kind = kind;
  port_.from = kind == DataKind::volume      ? From::scan
               : kind == DataKind::cutters   ? From::cutters
               : kind == DataKind::haptic    ? From::haptic
               : kind == DataKind::landmarks ? From::landmarks
                                             : From::recipe;
}

Named<ParameterValue> figures_named(const std::string& before, const AnyParams& result) {
  Named<ParameterValue> figures = figures_of(result);
  for (auto& figure : figures) figure.first.insert(0, before);
  return figures;
}

bool StageType::warns_at_once() const {
  return is_check() && std::all_of(ports.begin(), ports.end(), [](const Port& p) { return p.from == From::import; });
}

bool StageType::reads(From from) const {
  return std::any_of(ports.begin(), ports.end(), [&](const Port& p) { return p.from == from; });
}

const Port* StageType::find_port(const std::string& port) const {
  for (const Port& p : ports)
    if (p.name == port) return &p;
  return nullptr;
}

std::vector<std::string> StageType::file_params() const {
  std::vector<std::string> names;
  const AnyParams params = make_params();
  for (const Parameter& p : params.set->parameters)
    if (p.source == "file") names.push_back(p.name);
  return names;
}

const StageType* find_stage(const std::string& name) {
  for (const StageType& t : stage_types())
    if (t.name == name) return &t;
  return nullptr;
}

const StageType& stage_named(const std::string& name) {
  if (const StageType* type = find_stage(name)) return *type;
  throw Error(ExitCode::internal, "", name, "no such stage is declared");
}

const StageType& stage_with(const ParameterSet& params) {
  for (const StageType& t : stage_types())
    if (t.make_params().set == &params) return t;
  throw Error(ExitCode::internal, "", params.parameters.empty() ? "" : params.parameters[0].name,
              "no stage is declared with these parameters");
}

bool StageType::finds(const std::string& landmark) const {
  return std::any_of(points.begin(), points.end(), [&](const StagePoint& p) { return p.names(landmark); });
}

picture::SlicePlane plane_of_landmark(const std::string& name) {
  for (const StageType& t : stage_types())
    for (const StagePoint& point : t.points)
      if (point.names(name)) return point.plane;
  return picture::SlicePlane::coronal;
}

std::vector<const StageType*> stages_of(StagePlace place) {
  std::vector<const StageType*> all;
  for (const StageType& t : stage_types())
    if (t.place == place) all.push_back(&t);
  return all;
}

}  // namespace trephine::stages
