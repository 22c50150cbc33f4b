// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "cases/case.h"
#include "config/config.h"
#include "pipeline/executor.h"

namespace trephine::publish {

/// The kind of a finding that concerns a whole scan and has no place in a slice.
extern const char* const other_patient;

/// Of each further scan whose registration was within its limits, but stretches more than two scans of one head usually
/// do, a finding that asks whether it is the same patient. It concerns the anatomies that the scene asks for and that
/// are made of that scan, whatever else they are made of; its place is `middle_mm`. What such a scan shows may
/// be another person's brain in this person's skull, so it is sure enough to be told with the verdict and to make the
/// class `uncertain`. `parts` are those of the graph's nodes.
std::vector<cases::CaseFinding> findings_of_scans(const config::CaseConfig& config, const pipeline::Graph& graph,
                                                  const std::vector<stages::CaseParts>& parts, Vec3 middle_mm);

/// Whether the anatomy is made of a scan of which a finding says that it may be another patient's.
bool may_be_of_another(const cases::CaseManifest& manifest, const std::string& anatomy);

/// What a procedure aims at in an anatomy that may be another patient's is doubtful: lowers the confidence of these
/// targets and of the landmarks of their names below 0.5, but for points that a person gave. The manifest's findings
/// are known. A scene's own limits of confidence were judged before, by what the landmarks' stage said.
void doubt_the_targets(cases::CaseManifest& manifest);

/// The same of all landmarks and targets, beside a warning that speaks against the places of landmarks
/// (stages/warning_kind.h). A scan that was stretched still shows where its face is, so that the landmarks' stage says
/// nothing of it.
void doubt_landmarks(const Warnings& warnings, cases::CaseManifest& manifest);

}  // namespace trephine::publish
