// SPDX-License-Identifier: GPL-3.0-or-later
#include "publish/left_out.h"

#include <algorithm>
#include <set>

#include "base/error.h"
#include "base/params.h"
#include "meshing/decimate.h"
#include "meshing/smooth.h"

namespace trephine::publish {
namespace {

using config::CaseConfig, config::RecipeAnatomy, config::RecipeStep, config::SceneAnatomy;

/// What was refused: an anatomy, and the first of its steps whose output nobody may read.
struct Refused {
  std::string anatomy;
  std::size_t from_step = 0;
};

Refused refused_by_check(const CaseConfig& config, const Error& e) {
  for (const std::string& name : e.about())
    // For the one that is left out the check speaks against its field; what a stand-in replaces may still be of use to
    // others, such as a brain with a piece too many to the ventricles inside.
    if (const SceneAnatomy* a = config.find_shown(name); config.can_do_without(name))
      return {name, a->stand_in.empty() && !is_of_output(e.cause()) ? 0 : config.find_anatomy(name)->steps.size()};
  return {};
}

Refused refused_by(const CaseConfig& config, const Error& e) {
  if (!e.about().empty()) return refused_by_check(config, e);
  const std::string anatomy = anatomy_of_stage(config, e);
  if (!config.find_shown(anatomy)) return {};
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
    if (!config_.can_do_without(refused.anatomy)) return false;
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
    const SceneAnatomy* scene = config_.find_shown(refused.anatomy);
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
    auto& wider = made_.wider;  // of what is not there any more
    wider.erase(std::remove_if(wider.begin(), wider.end(), [&](const auto& w) { return w.anatomy == name; }),
                wider.end());
    auto& stood = made_.stand_ins;
    stood.erase(std::remove_if(stood.begin(), stood.end(), [&](const auto& s) { return s.anatomy == name; }),
                stood.end());
    if (config_.find_shown(name)->stand_in.empty()) {
      made_.missing.push_back({name, why});
      config_.leave_out(name);
    } else {
      stood.push_back({name, config_.let_stand_in(name), why});
    }
  }

  CaseConfig& config_;
  Concessions& made_;
};

/// The step of the recipe with those parameters; null: there is none.
template <class P>
RecipeStep* step_of(RecipeAnatomy& recipe) {
  for (RecipeStep& step : recipe.steps)
    if (step.params.set == &parameters_of<P>()) return &step;
  return nullptr;
}

bool widen(CaseConfig& config, const Error& e, Concessions& made) {
  if (e.cause() != Cause::too_many_triangles) return false;
  const std::string& name = e.about().front();
  const SceneAnatomy* scene = config.find_shown(name);
  const auto recipe = std::find_if(config.anatomies.begin(), config.anatomies.end(),
                                   [&](const RecipeAnatomy& a) { return a.name == name; });
  if (!config.can_do_without(name) || scene->max_deviation_mm <= 0 || recipe == config.anatomies.end()) return false;
  RecipeStep *decimation = step_of<meshing::DecimateParams>(*recipe),
             *smoothing = step_of<meshing::SmoothParams>(*recipe);
  if (!decimation) return false;
  auto reduced = decimation->params.as<meshing::DecimateParams>();
  auto smoothed = smoothing ? smoothing->params.as<meshing::SmoothParams>() : meshing::SmoothParams{};
  if (!smoothing) smoothed.max_displacement_mm = 0;
  const double asked_mm = reduced.max_deviation_mm, all_mm = scene->max_deviation_mm, least_part = 0.1;
  if (asked_mm <= 0) return false;
  if (asked_mm >= all_mm - smoothed.max_displacement_mm - 1e-9) {
    if (smoothed.max_displacement_mm < least_part * all_mm) return false;
    smoothed.max_displacement_mm /= 3;
    smoothing->params = AnyParams::make(smoothed);
  }
  reduced.max_deviation_mm = all_mm - smoothed.max_displacement_mm;
  decimation->params = AnyParams::make(reduced);
  const auto before =
      std::find_if(made.wider.begin(), made.wider.end(), [&](const auto& w) { return w.anatomy == name; });
  if (before == made.wider.end())
    made.wider.push_back({name, asked_mm, reduced.max_deviation_mm, scene->max_triangles});
  else
    before->used_mm = reduced.max_deviation_mm;
  return true;
}

}  // namespace

std::string words_of(const WiderBound& w) {
  return w.anatomy + ": reduced within " + to_text(ParameterValue(w.used_mm)) + " mm, not " +
         to_text(ParameterValue(w.asked_mm)) + ", to have at most " + std::to_string(w.max_triangles) + " triangles";
}

std::string anatomy_of_stage(const CaseConfig& config, const Error& e) {
  for (const RecipeAnatomy& a : config.anatomies)
    if (e.stage().rfind(a.name + ".", 0) == 0) return a.name;
  return "";
}

bool concede(CaseConfig& config, const Error& e, Concessions& made) {
  if (e.code() != ExitCode::quality) return false;
  if (widen(config, e, made)) return true;
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
  std::stable_sort(made.wider.begin(), made.wider.end(), before);
}

}  // namespace trephine::publish
