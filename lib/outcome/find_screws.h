// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "lesson/outcome_record.h"
#include "outcome/fit_vertebrae.h"

namespace trephine::outcome {

/// Finds rods of metal in the bone of the case's vertebrae, screws and needles, from the lowest: their axis by the
/// middle of the metal across it, tip, seat of the head, diameter and length where it drops to half between metal and
/// what is around. A scan that ends at 3071 HU shows no half of metal: then it is extrapolated from two lower levels,
/// for titanium. Screws that a rod joins are parted by the bone they lie in. The verdict on the registration is the
/// caller's; what of a screw itself is not sure is in `doubts`. Cancelled.
std::vector<lesson::OutcomeScrew> find_screws(const CaseSpine& spine, const ScanView& scan, const SpineFit& fit,
                                              const Progress& progress = {});

}  // namespace trephine::outcome
