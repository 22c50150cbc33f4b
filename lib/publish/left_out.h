// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "cases/case.h"
#include "config/config.h"
#include "pipeline/executor.h"
#include "pipeline/graph.h"

namespace trephine::publish {

/// A surface that was reduced within a wider bound than its recipe or a person gave, and within the scene's.
struct WiderBound {
  std::string anatomy;
  double asked_mm = 0, used_mm = 0;  ///< of `decimate`
  std::int64_t max_triangles = 0;    ///< of the scene: more were left within asked_mm
};
std::string words_of(const WiderBound& wider);

/// What a case does without, or with less of, because it was refused.
struct Concessions {
  std::vector<cases::CaseMissing> missing;
  std::vector<cases::CaseStandIn> stand_ins;
  std::vector<WiderBound> wider;
};

/// The anatomy of which the stage was that threw the error; "" where it is of none.
std::string anatomy_of_stage(const config::CaseConfig& config, const Error& error);

/// Makes `config` one that can do without what the error refuses (80): of the anatomy whose stage, surface or haptic
/// shape it is, or which the consistency check finds fault with, the stand-in is made (`stand_in`), or it is left out
/// (`may_be_missing`). Fields that were refused, and those of an anatomy that the check finds wrong, are read by
/// nobody: what can do without them is made without, what needs them is conceded too. Before a surface with too many
/// triangles is replaced or left out, it is reduced within all that the scene's bound allows: first what smoothing
/// leaves of it, then smoothing yields two thirds of its part. Returns false, and changes nothing, where the scene can
/// do without none of them or a part of the case would not be there that it cannot do without.
bool concede(config::CaseConfig& config, const Error& e, Concessions& made);

/// Moves what a run has made to `known`, by key, for a run of another graph (ExecuteOptions::known).
void keep_made(const pipeline::Graph& graph, std::vector<pipeline::NodeResult>& results,
               std::map<std::string, pipeline::NodeResult>& known);

/// In the order of these anatomies: in which order they were refused depends on what a cache held.
void sort_as(const std::vector<std::string>& anatomies, Concessions& made);

}  // namespace trephine::publish
