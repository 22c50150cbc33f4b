// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "outcome/measure_outcome.h"

namespace trephine::outcome {

/// How the bone of a case fits a scan; `mirrored_residual_mm` is of the mirrored case.
struct Fitness {
  double overlap_ratio = 0, residual_mm = 0, mirrored_residual_mm = 0, matched_ratio = 0;
};

/// Throws Error 80 with the field `registration` where too little of the case is in the scan (`lies`: "bone lies",
/// "vertebrae lie"), where the scan shows the case mirrored, or another `body` ("head", "spine").
void refuse_misfit(const Fitness& fit, const char* lies, const char* body, const OutcomeParams& params,
                   const char* remedy);

}  // namespace trephine::outcome
