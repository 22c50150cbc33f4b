// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/text.h"
#include "config/reading.h"

namespace trephine {
namespace fs = std::filesystem;
namespace {

// A hint for a fault, such as ": here ventricles.labels". It names another stage of the same anatomy that gives data of
// the wanted kind.
std::string hint_of_source(const std::string& source, DataKind kind, const std::vector<RecipeAnatomy>& anatomies) {
  const std::string name = source.substr(0, source.find('.'));
  std::string made;
  for (const RecipeAnatomy& anatomy : anatomies)
    if (anatomy.name == name)
      for (const RecipeStep& step : anatomy.steps)
        if (step.type->output == kind) made += (made.empty() ? "" : " or ") + name + "." + step.type->name;
  return made.empty() ? "" : ": here " + made;
}

class RecipeReader {
 public:
  RecipeReader(ConfigReading& reading, const fs::path& file) : r_(reading), file_(file) {}

  void read() {
    const auto tree = read_yaml_or_fault(file_, r_.faults);
    if (!tree) return;
    std::vector<std::string> others = {"anatomies"};
    for (const StageType* type : stages_of(StagePlace::scan)) others.push_back(type->name);
    const YamlNode* anatomies = tree->find("anatomies");
    if (!anatomies)
      fault(*tree, "anatomies", "is missing: how each anatomy is made");
    else if (anatomies->kind != YamlNode::Kind::map)
      fault(*anatomies, "anatomies", "must hold keys and values");
    else
      read_anatomies(*anatomies);
    // The roles name anatomies, so they are read now that the anatomies are known.
    RecipeFileParams said;
    read_declared(reading("recipe"), *tree, "", parameters_of<RecipeFileParams>(), &said, others);
    r_.out.roles = said;
    if (r_.out.anatomies.empty()) return;
    r_.recipe = file_;
    for (const StageType* type : stages_of(StagePlace::scan))
      if (const YamlNode* node = tree->find(type->name))
        read_scan_step(*type, *node);
      else if (type->name == resample_step)
        read_scan_step(*type, nothing());  // any scan can be resampled
  }

 private:
  static YamlNode nothing() {
    YamlNode node;
    node.kind = YamlNode::Kind::map;
    return node;
  }
  void fault(const YamlNode& at, const std::string& key, const std::string& what) {
    r_.faults.add(file_, at, key, what);
  }

  DeclaredReading reading(const std::string& cut) {
    DeclaredReading all{file_, r_.faults, {}, {}};
    all.fault_of_name = [this](const std::string& kind, const std::string& name) {
      return kind == "anatomy" ? r_.fault_of_anatomy(name) : kind == "target" ? fault_of_target(name) : std::string();
    };
    all.said = [this, cut](const std::string& path, const YamlNode& at) {
      const std::string prefix = cut + ".";
      r_.said.emplace_back(path.rfind(prefix, 0) == 0 ? path.substr(prefix.size()) : path,
                           r_.origin(ValueSource::recipe, file_, at));
    };
    return all;
  }

  // A target may be a point that only some cases give, so an unknown name is refused only where it looks misspelt.
  std::string fault_of_target(const std::string& name) const {
    std::vector<std::string> known = findable_landmarks();
    for (const CaseLandmark& l : r_.out.landmarks) known.push_back(l.name);
    if (std::find(known.begin(), known.end(), name) != known.end()) return "";
    const std::string near = did_you_mean(name, known);
    return near.empty() ? "" : name + ", no such landmark" + near;
  }

  void read_anatomies(const YamlNode& anatomies) {
    if (anatomies.entries.empty()) fault(anatomies, "anatomies", "names none");
    for (const auto& [key, node] : anatomies.entries) {
      const std::string where = "anatomies." + key.text;
      RecipeAnatomy anatomy;
      anatomy.name = key.text;
      if (!is_plain_name(key.text)) fault(key, where, "a name has letters a-z, digits and _ only");
      read_declared(reading("anatomies"), node, where, parameters_of<RecipeAnatomyParams>(),
                    static_cast<RecipeAnatomyParams*>(&anatomy), {"stages"});
      if (node.kind != YamlNode::Kind::map) continue;
      if (const YamlNode* steps = node.find("stages"))
        read_steps(*steps, where, anatomy);
      else
        fault(node, where + ".stages", "is missing: the stages that make the anatomy");
      r_.out.anatomies.push_back(std::move(anatomy));
    }
    check_ports(anatomies);
  }

  // A step is `- name` or `- name: {parameters and ports}`.
  void read_steps(const YamlNode& list, const std::string& where, RecipeAnatomy& anatomy) {
    if (list.kind != YamlNode::Kind::list) return fault(list, where + ".stages", "must be a list");
    for (const YamlNode& item : list.items) {
      const bool bare = item.kind == YamlNode::Kind::scalar;
      if (!bare && !(item.kind == YamlNode::Kind::map && item.entries.size() == 1)) {
        fault(item, where + ".stages", "each item is a stage: `- name` or `- name: {...}`");
        continue;
      }
      const YamlNode& name = bare ? item : item.entries[0].first;
      const StageType* type = find_stage(name.text);
      if (!type || type->place != StagePlace::anatomy) {
        std::vector<std::string> known;
        for (const StageType* t : stages_of(StagePlace::anatomy)) known.push_back(t->name);
        fault(name, where + ".stages", name.text + ", no such stage" + did_you_mean(name.text, known));
        continue;
      }
      if (anatomy.find_step(name.text)) fault(name, where + ".stages", name.text + ", the stage is repeated");
      const YamlNode none = nothing();
      const YamlNode& body =
          bare || item.entries[0].second.kind == YamlNode::Kind::null ? none : item.entries[0].second;
      RecipeStep step = step_of(*type, body, where + "." + name.text, {type->ports.begin() + 1, type->ports.end()});
      const DataKind fed = anatomy.steps.empty() ? DataKind::volume : anatomy.steps.back().type->output;
      if (type->ports[0].kind != fed && !(type->ports[0].kind == DataKind::field && fed == DataKind::volume))
        fault(name, where + "." + name.text,
              std::string("works on a ") + to_text(type->ports[0].kind) + " but gets a " + to_text(fed));
      anatomy.steps.push_back(std::move(step));
    }
    if (anatomy.steps.empty() || anatomy.steps.back().type->output != DataKind::mesh)
      fault(list, where + ".stages", "must end in a surface");
  }

  // Reads the parameters of a stage and the sources of its ports.
  RecipeStep step_of(const StageType& type, const YamlNode& node, const std::string& where,
                     const std::vector<Port>& ports) {
    RecipeStep step;
    step.type = &type;
    step.params = type.make_params();
    std::vector<std::string> names;
    for (const Port& port : ports) names.push_back(port.name);
    read_declared(reading("anatomies"), node, where, *step.params.set, step.params.object.get(), names);
    for (const Port& port : ports) {
      const YamlNode* source = node.find(port.name);
      if (source && source->kind == YamlNode::Kind::scalar && !source->text.empty())
        step.ports[port.name] = source->text;
      else if (source)
        fault(*source, where + "." + port.name, "must be a text");
    }
    return step;
  }

  // A port may only read from an anatomy that stands before it in the recipe, so there are no cycles.
  void check_ports(const YamlNode& anatomies) {
    const std::vector<RecipeAnatomy>& all = r_.out.anatomies;
    for (std::size_t i = 0; i < all.size(); ++i)
      for (const RecipeStep& step : all[i].steps)
        for (const Port& port : step.type->ports) {
          const auto source = step.ports.find(port.name);
          const YamlNode* at = anatomies.find(all[i].name);
          const std::string where = "anatomies." + all[i].name + "." + step.type->name + "." + port.name;
          const std::vector<RecipeAnatomy> before(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(i));
          if (source != step.ports.end())
            check_source(*at, where, source->second, port.kind, before, " of an anatomy before this one");
          else if (port.required && &port != &step.type->ports[0])
            fault(*at, where, "is missing: " + port.help);
        }
  }

  bool check_source(const YamlNode& at, const std::string& where, const std::string& source, DataKind kind,
                    const std::vector<RecipeAnatomy>& among, const char* of) {
    for (const RecipeAnatomy& anatomy : among)
      for (const RecipeStep& step : anatomy.steps)
        if (anatomy.name + "." + step.type->name == source && step.type->output == kind) return true;
    fault(at, where,
          source + ", must be the " + to_text(kind) + of + ", as anatomy.stage" + hint_of_source(source, kind, among));
    return false;
  }

  // Ports that take a field name the anatomy. The volume and the landmarks are connected by the program.
  void read_scan_step(const StageType& type, const YamlNode& node) {
    std::vector<Port> ports;
    for (const Port& port : type.ports)
      if (port.kind == DataKind::field) ports.push_back(port);
    if (node.kind != YamlNode::Kind::map) return fault(node, type.name, "must hold keys and values");
    RecipeStep step = step_of(type, node, type.name, ports);
    for (const Port& port : ports) {
      const auto source = step.ports.find(port.name);
      if (source == step.ports.end()) {
        if (port.required && !node.find(port.name))
          fault(node, type.name + "." + port.name, "is missing: " + port.help);
      } else if (!check_source(*node.find(port.name), type.name + "." + port.name, source->second, port.kind,
                               r_.out.anatomies, " of an anatomy")) {
        step.ports.erase(source);
      }
    }
    r_.out.scan_steps.push_back(std::move(step));
  }

  ConfigReading& r_;
  const fs::path& file_;
};

}  // namespace

void read_recipe(ConfigReading& reading, const fs::path& file) { RecipeReader(reading, file).read(); }

}  // namespace trephine
