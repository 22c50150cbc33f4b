// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/left_out.h"

#include <algorithm>
#include <set>

#include "base/error.h"

namespace trephine::publish {
namespace {

using config::CaseConfig, config::RecipeAnatomy, config::RecipeStep, config::SceneAnatomy;

const SceneAnatomy* shown(const CaseConfig& config, const std::string& name) {
  for (const SceneAnatomy& a : config.scene)
    if (a.name == name) return &a;
  return nullptr;
}

bool can_do_without(const CaseConfig& config, const std::string& name) {
  const SceneAnatomy* a = shown(config, name);
  return a && (a->may_be_missing || !a->stand_in.empty());
}

/// What was refused: an anatomy, and the first of its steps whose output nobody may read.
struct Refused {
  std::string anatomy;
  std::size_t from_step = 0;
};

Refused refused_by_check(const CaseConfig& config, const Error& e) {
  for (const std::string& name : e.about())
    // For the one that is left out the check speaks against its field; what a stand-in replaces may still be of use to
    // others, such as a brain with a piece too many to the ventricles inside.
    if (const SceneAnatomy* a = shown(config, name); can_do_without(config, name))
      return {name,
              a->stand_in.empty() && e.cause() != Cause::refused_output ? 0 : config.find_anatomy(name)->steps.size()};
  return {};
}

Refused refused_by(const CaseConfig& config, const Error& e) {
  if (!e.about().empty()) return refused_by_check(config, e);
  const std::string anatomy = anatomy_of_stage(config, e);
  if (!shown(config, anatomy)) return {};
  const std::vector<RecipeStep>& steps = config.find_anatomy(anatomy)->steps;
  const auto step = std::find_if(steps.begin(), steps.end(),
                                 [&](const RecipeStep& s) { return e.stage() == anatomy + "." + s.type->name; });
  return {anatomy, std::size_t(step - steps.begin())};
}

/// Takes what was refused out of a configuration, and what cannot be without it.
class Conceding {
 public:
  Conceding(CaseConfig& config, Concessions& made) : config_(config), made_(made) {}

  bool concede(const Refused& refused, const std::string& why) {
    if (!can_do_without(config_, refused.anatomy)) return false;
    std::vector<std::string> needing;
    if (!forget(refused, needing)) return false;
    do_without(refused.anatomy, why);
    for (std::size_t n = 0; n < needing.size(); ++n) {
      const std::string name = needing[n];
      if (!config_.is_shown(name) ? !forget({name, 0}, needing)
                                  : !concede({name, 0}, "it is made of " + refused.anatomy + ", which was refused"))
        return false;
    }
    return true;
  }

 private:
  // Takes what was refused from every port that can do without; lists the anatomies that cannot.
  bool forget(const Refused& refused, std::vector<std::string>& needing) {
    std::set<std::string> lost;
    const std::vector<RecipeStep>& steps = config_.find_anatomy(refused.anatomy)->steps;
    for (std::size_t i = refused.from_step; i < steps.size(); ++i)
      lost.insert(refused.anatomy + "." + steps[i].type->name);
    // A check reads what stands for it.
    const SceneAnatomy* scene = shown(config_, refused.anatomy);
    const bool has_stand_in = scene && !scene->stand_in.empty();
    const auto drop = [&](RecipeStep& step) {
      if (step.type->is_check() && has_stand_in) return true;
      bool complete = true;
      for (auto port = step.ports.begin(); port != step.ports.end();)
        if (lost.count(port->second) == 0)
          ++port;
        else if (const stages::Port& p = *step.type->find_port(port->first);
                 p.required || (p.needed && p.needed(step.params)))
          complete = false, ++port;
        else
          port = step.ports.erase(port);
      return complete;
    };
    for (RecipeAnatomy& a : config_.anatomies)
      for (RecipeStep& step : a.steps)
        if (!drop(step) && std::find(needing.begin(), needing.end(), a.name) == needing.end())
          needing.push_back(a.name);
    bool complete = true;
    for (RecipeStep& step : config_.scan_steps) complete = drop(step) && complete;
    return complete;
  }

  void do_without(const std::string& name, const std::string& why) {
    auto& stood = made_.stand_ins;
    stood.erase(std::remove_if(stood.begin(), stood.end(), [&](const auto& s) { return s.anatomy == name; }),
                stood.end());
    if (shown(config_, name)->stand_in.empty()) {
      made_.missing.push_back({name, why});
      config_.leave_out(name);
    } else {
      stood.push_back({name, config_.let_stand_in(name), why});
    }
  }

  CaseConfig& config_;
  Concessions& made_;
};

}  // namespace

std::string anatomy_of_stage(const CaseConfig& config, const Error& e) {
  for (const RecipeAnatomy& a : config.anatomies)
    if (e.stage().rfind(a.name + ".", 0) == 0) return a.name;
  return "";
}

bool concede(CaseConfig& config, const Error& e, Concessions& made) {
  if (e.code() != ExitCode::quality) return false;
  const Refused refused = refused_by(config, e);
  if (refused.anatomy.empty()) return false;
  CaseConfig changed = config;
  Concessions all = made;
  if (!Conceding(changed, all).concede(refused, e.what())) return false;
  if (!changed.haptic.params.as<stages::VoxelizeStageParams>().region_of.empty() &&
      !changed.is_shown(changed.haptic.params.as<stages::VoxelizeStageParams>().region_of))
    return false;
  config = std::move(changed);
  made = std::move(all);
  return true;
}

void keep_made(const pipeline::Graph& graph, std::vector<pipeline::NodeResult>& results,
               std::map<std::string, pipeline::NodeResult>& known) {
  for (std::size_t i = 0; i < results.size(); ++i)
    if (results[i].state != pipeline::NodeResult::State::not_needed) {
      if (results[i].spilled) results[i].data = {};  // it is read back from disk where it is needed
      known[graph.nodes[i].key] = std::move(results[i]);
    }
  results.clear();
}

void sort_as(const std::vector<std::string>& anatomies, Concessions& made) {
  const auto before = [&](const auto& a, const auto& b) {
    const auto place = [&](const std::string& name) { return std::find(anatomies.begin(), anatomies.end(), name); };
    return place(a.anatomy) < place(b.anatomy);
  };
  std::stable_sort(made.missing.begin(), made.missing.end(), before);
  std::stable_sort(made.stand_ins.begin(), made.stand_ins.end(), before);
}

}  // namespace trephine::publish
