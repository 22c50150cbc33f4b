// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "base/warning.h"
#include "dicom/catalogue.h"
#include "dicom/hu.h"

namespace trephine::dicom {

/// Parts the slices of one stack that do not belong together, though they have one SeriesInstanceUID: several studies
/// or frames of reference, kernels that lie within each other, and acquisitions (dicom/slabs.h). (Slabs of several
/// acquisitions one after the other are one series; and where most slices have a UID of their own, an anonymiser gave
/// each file a new one.) Slices of several patients stay together: analyse_series refuses them.
std::vector<std::vector<FrameRef>> part_mixture(std::vector<FrameRef> stack);

/// For each series that may be used, finds the single slices that have its UID and lie among or beside its own but were
/// parted from it or left out, and those of another UID that continue it: Series::odd says how each differs.
void find_odd_slices(std::vector<Series>& series, const std::vector<LeftOut>& left_out);

/// Throws Error 65 where the stack is not a volume, as analyse_stack does, but names an odd slice where one lies in the
/// gap; 65 where slices contradict each other in who the patient is (dicom/identity.h) and no reason is given, or in an
/// attribute of the rule `equal` (dicom/attributes.h); 65 where a CT's values are not in HU, unless any unit is taken
/// for it; 81 where the pixels are said to hold text and no reason is given for using them.
StackGeometry analyse_series(const Series& series, const ImportParams& params);

/// Of what should not change within a series but does, and of values that are unusual for a CT.
Warnings warnings_of_changes(const Series& series, const HuCounts& counts);

}  // namespace trephine::dicom
