// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/graph_nodes.h"

#include <utility>

#include "base/error.h"
#include "base/hash.h"
#include "pipeline/executor.h"
#include "stages/import.h"

namespace trephine::pipeline {

Node node_of(const stages::StageType& type, const std::string& name, AnyParams params) {
  Node node;
  node.name = name;
  node.type = &type;
  node.params = std::move(params);
  node.output = type.output;
  return node;
}

static std::string name_of(const stages::StageType& type, const std::string& of) {
  return of.empty() ? type.name_in_case() : of + "." + type.name_in_case();
}

Node node_with(const AnyParams& params, const std::string& of) {
  const stages::StageType& type = stages::stage_with(*params.set);
  return node_of(type, name_of(type, of), params);
}

std::string import_name(const std::string& scan) {
  return name_of(stages::stage_with(parameters_of<stages::ImportStageParams>()), scan);
}

Node import_node(const dicom::SeriesChoice& series, const std::string& hash, const std::string& scan) {
  stages::ImportStageParams params;
  static_cast<dicom::ImportParams&>(params) = series.params;
  params.input = series.folder_or_file.string();
  Node node = node_with(AnyParams::make(params), scan);
  node.file_sha256["input"] = hash;
  return node;
}

void add_file_hashes(Node& node) {
  for (const std::string& p : node.type->file_params())
    if (const auto file = std::get<std::string>(node.params.get(*node.params.set->find(p))); !file.empty())
      node.file_sha256[p] = sha256_of_file(file);
}

Node node_of_step(const config::RecipeStep& step, const std::string& name) {
  Node node = node_of(*step.type, name, step.params);
  add_file_hashes(node);
  return node;
}
// What a stage made, or refused, of other content must not be known by the hash of the old one.
static void require_same_files(const Node& node) {
  for (const std::string& p : node.type->file_params()) {
    const auto hashed = node.file_sha256.find(p);
    if (hashed == node.file_sha256.end() || p == "input") continue;  // a series is hashed as it is read
    const auto file = std::get<std::string>(node.params.get(*node.params.set->find(p)));
    if (sha256_of_file(file) != hashed->second)
      throw Error(ExitCode::bad_input, file, p, "changed while it was read: run it again");
  }
}

stages::StageOutcome compute_node(const Node& node, stages::StageInputs inputs, const Progress& progress) {
  inputs.file_sha256 = node.file_sha256;
  try {
    stages::StageOutcome made = node.type->run(node.params, inputs, progress);
    require_same_files(node);
    return made;
  } catch (const Error& e) {
    if (e.code() == ExitCode::quality) require_same_files(node);
    throw;
  }
}

std::string anatomy_of(const std::string& source) { return source.substr(0, source.find('.')); }

}  // namespace trephine::pipeline
