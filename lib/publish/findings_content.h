// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cases/case.h"
#include "grid/labels.h"
#include "pipeline/executor.h"
#include "publish/case_pictures.h"
#include "stages/case_parts.h"

namespace trephine::publish {

/// What each node's result adds to the case, in the order of the nodes. A check that is made early is made again with
/// the whole case.
std::vector<stages::CaseParts> parts_of(const pipeline::Graph& graph, const std::vector<pipeline::NodeResult>& results);

/// The node whose labels show what a person should look at; -1 where there is none.
int examination_of(const pipeline::Graph& graph);

/// Whether a sure finding concerns the anatomy: what is measured of it is then uncertain.
bool is_in_doubt(const std::vector<cases::CaseFinding>& findings, const std::string& anatomy);

/// Those of a confidence that is told with the verdict.
std::vector<const cases::CaseFinding*> sure(const std::vector<cases::CaseFinding>& findings);

/// The sure findings in a few words, each with its side, for the verdict: tissue as dense as blood, or all others.
/// Empty where there is none. Of more than three the rest is counted.
std::string findings_text(const std::vector<cases::CaseFinding>& findings, bool bleeds);

/// findings.png: of every finding that is sure, of at most nine, the axial slice of the scan through its middle, with
/// the outline of its voxels (`labels`: the stage's output, in which finding n has the value n) or, where it has none,
/// a ring about its place. Nothing where no finding is sure or none lies in the scan.
std::optional<CasePicture> make_findings_picture(const grid::HuVolume& scan, const grid::LabelFile& labels,
                                                 const std::vector<cases::CaseFinding>& findings,
                                                 const Progress& progress = {});

}  // namespace trephine::publish
