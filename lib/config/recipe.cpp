// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/text.h"
#include "config/reading.h"

namespace trephine::config {
namespace fs = std::filesystem;
namespace {

// A hint for a fault, such as ": here ventricles.labels". It names another stage of the same anatomy that gives data of
// the wanted kind.
std::string hint_of_source(const std::string& source, stages::DataKind kind,
                           const std::vector<RecipeAnatomy>& anatomies) {
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
    r_.out.recipe_sha256 = digest_of(*tree);
    at_ = read_declared(reading(), *tree, parameters_of<RecipeFileParams>(), &said_);
    for (const auto& [name, said] : said_.anatomies) add_anatomy(name, said);
    check_ports();
    r_.out.roles = said_;
    if (r_.out.anatomies.empty()) return;
    r_.recipe = file_;
    for (const StepChoice& choice : recipe_steps(stages::StagePlace::scan))
      if (const AnyParams* said = find_item(said_.scan_steps, choice.name))
        add_scan_step(step_of(choice.name, *said));
      else if (stages::find_stage(choice.name)->in_every_recipe)
        add_scan_step(step_of(choice.name, {choice.set, choice.set->make()}));
  }

 private:
  void fault(const YamlNode& at, const std::string& path, const std::string& what) {
    r_.faults.add(file_, at, path, what);
  }

  DeclaredReading reading() {
    DeclaredReading all{file_, r_.faults, {}, {}};
    all.fault_of_name = [this](const std::string& kind, const std::string& name) {
      return kind == "anatomy" ? fault_of_anatomy(name) : kind == "target" ? fault_of_target(name) : std::string();
    };
    all.said = [this](const std::string& path, const YamlNode& at) {
      r_.said.emplace_back(path_of_value(path), r_.origin(ValueSource::recipe, file_, at));
    };
    return all;
  }

  // The path by which a value is set: skull.segment.lower_hu for anatomies.skull.stages.segment.lower_hu.
  static std::string path_of_value(const std::string& path) {
    const std::string anatomies = "anatomies.", stages = ".stages.";
    if (path.rfind(anatomies, 0) != 0) return path;
    const std::size_t end = path.find(stages);
    if (end == std::string::npos) return path.substr(anatomies.size());
    std::string value = path.substr(anatomies.size(), end - anatomies.size()) + "." + path.substr(end + stages.size());
    // An item of a list: arguments[0] is set as arguments.0.
    value.erase(std::remove(value.begin(), value.end(), ']'), value.end());
    std::replace(value.begin(), value.end(), '[', '.');
    return value;
  }

  std::string fault_of_anatomy(const std::string& name) const {
    if (const RecipeAnatomyFileParams* anatomy = find_item(said_.anatomies, name)) {
      const Steps& steps = anatomy->stages;
      const stages::StageType* last = steps.empty() ? nullptr : stages::find_stage(steps.back().first);
      return last && last->output == stages::DataKind::labels ? name + ", it gives labels and no surface" : "";
    }
    std::vector<std::string> known;
    for (const auto& anatomy : said_.anatomies) known.push_back(anatomy.first);
    return name + ", the pipeline has no such anatomy" + did_you_mean(name, known);
  }

  // A target may be a point that only some cases give, so an unknown name is refused only where it looks misspelt.
  std::string fault_of_target(const std::string& name) const {
    std::vector<std::string> known = head::findable_landmarks();
    for (const cases::CaseLandmark& l : r_.out.landmarks) known.push_back(l.name);
    if (std::find(known.begin(), known.end(), name) != known.end()) return "";
    const std::string near = did_you_mean(name, known);
    return near.empty() ? "" : name + ", no such landmark" + near;
  }

  static RecipeStep step_of(const std::string& stage, const AnyParams& said) {
    const auto& params = said.as<RecipeStepParams>();
    return {stages::find_stage(stage), params.params, params.ports, params.scan};
  }

  // Each step works on what the one before it gives, and the last one gives a surface.
  void add_anatomy(const std::string& name, const RecipeAnatomyFileParams& said) {
    RecipeAnatomy anatomy;
    static_cast<RecipeAnatomyParams&>(anatomy) = said;
    anatomy.name = name;
    const std::string where = "anatomies." + name + ".stages";
    stages::DataKind fed = stages::DataKind::volume;
    for (const auto& [stage, params] : said.stages) {
      RecipeStep step = step_of(stage, params);
      const stages::DataKind wanted = step.type->ports[0].kind;
      if (wanted != fed && !(wanted == stages::DataKind::field && fed == stages::DataKind::volume))
        fault(at_.key(where + "." + stage), where + "." + stage,
              std::string("works on a ") + stages::to_text(wanted) + " but gets a " + stages::to_text(fed));
      // Of a later step only a further volume is left to be said.
      const auto& ports = step.type->ports;
      const bool reads =
          anatomy.steps.empty() || std::any_of(ports.begin() + 1, ports.end(),
                                               [](const stages::Port& p) { return p.from == stages::From::scan; });
      if (!step.scan.empty() && !reads)
        fault(at_.at(where + "." + stage + ".scan"), where + "." + stage + ".scan",
              "the stage works on what the one before it gives, say the scan there");
      fed = step.type->output;
      anatomy.steps.push_back(std::move(step));
    }
    const bool complete = fed == stages::DataKind::mesh || fed == stages::DataKind::labels;
    if (at_.has(where) && (anatomy.steps.empty() || !complete))
      fault(at_.at(where), where, "must end in a surface, or in labels that other anatomies take");
    r_.out.anatomies.push_back(std::move(anatomy));
  }

  // A port may only read from an anatomy that stands before it in the recipe, so there are no cycles.
  void check_ports() {
    std::vector<RecipeAnatomy> before;
    for (const RecipeAnatomy& anatomy : r_.out.anatomies) {
      for (const RecipeStep& step : anatomy.steps)
        for (const auto& [port, source] : step.ports)
          check_source("anatomies." + anatomy.name + ".stages." + step.type->name, step, port, before,
                       " of an anatomy before this one");
      before.push_back(anatomy);
    }
  }

  bool check_source(const std::string& where, const RecipeStep& step, const std::string& port,
                    const std::vector<RecipeAnatomy>& among, const char* of) {
    const std::string& source = step.ports.at(port);
    const stages::DataKind kind = step.type->find_port(port)->kind;
    for (const RecipeAnatomy& anatomy : among)
      for (const RecipeStep& other : anatomy.steps)
        if (anatomy.name + "." + other.type->name == source && other.type->output == kind) return true;
    const std::string path = where + "." + port;
    fault(at_.at(path), path,
          source + ", must be the " + stages::to_text(kind) + of + ", as anatomy.stage" +
              hint_of_source(source, kind, among));
    return false;
  }

  void add_scan_step(RecipeStep step) {
    for (auto port = step.ports.begin(); port != step.ports.end();)
      if (check_source(step.type->name, step, port->first, r_.out.anatomies, " of an anatomy"))
        ++port;
      else
        port = step.ports.erase(port);
    r_.out.scan_steps.push_back(std::move(step));
  }

  ConfigReading& r_;
  const fs::path& file_;
  RecipeFileParams said_;
  Places at_;
};

}  // namespace

void read_recipe(ConfigReading& reading, const fs::path& file) { RecipeReader(reading, file).read(); }

}  // namespace trephine::config
