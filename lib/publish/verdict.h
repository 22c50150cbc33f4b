// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/report.h"
#include "cases/case.h"

namespace trephine::publish {

/// What a person reads at the end of a run: of every anatomy that the scene asked for whether it is good, doubtful,
/// simple (something stands for it), or left out, and what of the scan speaks against more: "skin, skull: good; brain:
/// simple; ventricles: left out (slices of 5 mm, noise of 31 HU)". Doubtful is what the scan is not suited for (`scan`,
/// the report of the stage of that name, may be null), the anatomy that the case is classed by where the class is
/// uncertain, and what is made of a scan that may be another patient's or that shows no head (`body_part`). What ends
/// at the scan's end or the field's edge, where a head does not, is cut off there and not good (`region`, the report of
/// the stage head_region, may be null): "skin, skull, brain: cut off above". Where the scan was put on voxels that are
/// larger along an axis (`resample`, likewise), that is said, for the deviations are those from the surfaces on these
/// voxels. What the case's findings say a person should look at stands behind it. Good says that it passed every check,
/// not that a person need not look.
std::string verdict_of(const std::vector<std::string>& wanted, const cases::CaseManifest& manifest, const Report* scan,
                       const Report* region, const Report* resample);

}  // namespace trephine::publish
