// SPDX-License-Identifier: GPL-3.0-or-later
#include "rubric_file.h"

#include <map>

#include "base/joined.h"
#include "base/text.h"
#include "config/declared.h"
#include "lessons/rubric_types.h"

namespace trephine::tools {
namespace {

ParameterSet file_set(const lesson::RubricType& type) {
  ParameterSet set;
  for (const Parameter& p : parameters_of<config::VersionParams>().parameters)
    set.parameters.push_back(
        parameter_of_holder(p, [](void* file) -> void* { return &static_cast<RubricFile*>(file)->version; }));
  const ParameterSet& rubric = *type.make().set;
  for (const Parameter& p : rubric.parameters)
    set.parameters.push_back(
        parameter_of_holder(p, [](void* file) { return static_cast<RubricFile*>(file)->rubric.object.get(); }));
  set.make = [make = type.make] { return std::make_shared<RubricFile>(RubricFile{{}, make()}); };
  if (rubric.fault)
    set.fault = [fault = rubric.fault](const void* file) {
      return fault(static_cast<const RubricFile*>(file)->rubric.object.get());
    };
  return set;
}

const lesson::RubricType* find_type(const config::YamlNode& module) {
  for (const lesson::RubricType& t : lessons::rubric_types())
    if (t.module == module.text) return &t;
  return nullptr;
}

}  // namespace

AnyParams rubric_file_params(const lesson::RubricType& type) {
  static const std::map<std::string, ParameterSet> sets = [] {
    std::map<std::string, ParameterSet> all;
    for (const lesson::RubricType& t : lessons::rubric_types()) all.emplace(t.module, file_set(t));
    return all;
  }();
  const ParameterSet& set = sets.at(type.module);
  return {&set, set.make()};
}

AnyParams read_rubric_yaml(const std::filesystem::path& file) {
  config::ConfigFaults faults;
  const config::YamlNode tree = config::read_yaml(file);
  const lesson::RubricType* type = &lessons::rubric_types().front();  // where the file names none, that is its fault
  const config::YamlNode* module = tree.kind == config::YamlNode::Kind::map ? tree.find("module") : nullptr;
  if (module && module->kind == config::YamlNode::Kind::scalar) {
    type = find_type(*module);
    if (!type) {
      faults.add(file, *module, "module",
                 printable(module->text) + ", no such lesson; known are " +
                     joined(lessons::rubric_types(), ", ", &lesson::RubricType::module));
      faults.raise();
    }
  }
  const AnyParams said = rubric_file_params(*type);
  config::read_declared({file, faults, {}, {}}, tree, *said.set, said.object.get());
  faults.raise();
  return static_cast<const RubricFile*>(said.object.get())->rubric;
}

}  // namespace trephine::tools
