// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/misfit.h"

#include <fmt/format.h>

#include "base/refusal.h"

namespace trephine::outcome {

void refuse_misfit(const Fitness& fit, const char* lies, const char* body, const OutcomeParams& p, const char* remedy) {
  if (fit.overlap_ratio < p.least_overlap_ratio)
    throw refusal("registration",
                  fmt::format("only {:.0f} % of the case's {} in the scan, below {:.0f} %", 100 * fit.overlap_ratio,
                              lies, 100 * p.least_overlap_ratio),
                  {remedy});
  if (fit.residual_mm > p.mirrored_ratio * fit.mirrored_residual_mm)
    throw refusal("registration",
                  fmt::format("the scan shows the case's {} mirrored: bone lies {:.2f} mm off, mirrored {:.2f} mm",
                              body, fit.residual_mm, fit.mirrored_residual_mm),
                  {remedy});
  if (fit.residual_mm > p.largest_residual_mm || fit.matched_ratio < p.least_matched_ratio)
    throw refusal(
        "registration",
        fmt::format("the scan shows another {}: bone lies {:.2f} mm off (at most {:.2f}), and {:.0f} % of it "
                    "has an edge within 2 mm (at least {:.0f})",
                    body, fit.residual_mm, p.largest_residual_mm, 100 * fit.matched_ratio, 100 * p.least_matched_ratio),
        {remedy});
}

}  // namespace trephine::outcome
