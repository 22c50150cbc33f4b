// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "cases/case.h"
#include "pipeline/graph.h"
#include "stages/case_parts.h"
#include "stages/warning_kind.h"

namespace trephine::publish {

/// What an anatomy that the scene asks for came to.
enum class AnatomyState {
  good,      ///< it passed every check, which does not say that a person need not look
  doubtful,  ///< evidence speaks against it
  stand_in,  ///< something stands for it
  left_out,
};

struct AnatomyVerdict {
  std::string anatomy;
  AnatomyState state = AnatomyState::good;
  std::string stand_in;  ///< what stands for it
  std::string cut;       ///< where the scan's end or the field's edge cuts it: "above"; empty: nowhere
};

/// What each of the anatomies came to, by the manifest and by the `evidence` that speaks against it.
std::vector<AnatomyVerdict> judge_anatomies(const std::vector<std::string>& wanted, const cases::CaseManifest& manifest,
                                            const std::vector<stages::Evidence>& evidence);

/// What a warning speaks against, where it does (stages/warning_kind.h): the anatomies that it is about, or that of
/// whose recipe the stage is that gave it.
std::vector<stages::Evidence> evidence_of(const Warning& warning, const std::string& anatomy);
/// The anatomies of the scene by which `anatomy` comes to a user: itself, or where it is only a step of the recipe,
/// those that are made of it. What it only bounds (`within`) is not made of it.
std::vector<std::string> heirs_of(const std::string& anatomy, const pipeline::Graph& graph,
                                  const config::CaseConfig& config);
/// What sure findings speak against: the anatomies that they concern.
std::vector<stages::Evidence> evidence_of(const std::vector<cases::CaseFinding>& findings);

/// What a person reads at the end of a run, dense tissue first: "skin, skull: good; brain: simple; ventricles: left out
/// (slices of 5 mm, noise of 31 HU)", with the reasons of the evidence about these anatomies, the remarks, and what the
/// case's findings say a person should look at.
std::string verdict_text(const std::vector<AnatomyVerdict>& anatomies, const cases::CaseManifest& manifest,
                         const std::vector<stages::Evidence>& evidence, const std::vector<std::string>& remarks);

}  // namespace trephine::publish
