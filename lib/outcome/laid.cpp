// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/laid.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "base/refusal.h"
#include "outcome/misfit.h"
#include "print/print_record.h"

namespace trephine::outcome {
namespace {

lesson::OutcomeRegistration registered(const BoneFit& fit, const BoneFit& mirror, const char* body, const char* remedy,
                                       const OutcomeParams& p) {
  refuse_misfit({fit.overlap_ratio, fit.residual_mm, mirror.residual_mm, fit.matched_ratio}, "bone lies", body, p,
                remedy);
  if (fit.scale_ratio > p.largest_scale_ratio)
    throw refusal("registration",
                  fmt::format("the scan would have to be stretched by {:.1f} % (at most {:.1f}): it shows another {}, "
                              "or its voxels have another size than it says",
                              100 * fit.scale_ratio, 100 * p.largest_scale_ratio, body),
                  {remedy});
  lesson::OutcomeRegistration r;
  r.residual_mm = fit.residual_mm;
  r.mirrored_residual_mm = std::min(1e3, mirror.residual_mm);
  r.widening_mm = fit.widening_mm;
  r.overlap_ratio = fit.overlap_ratio;
  r.matched_ratio = fit.matched_ratio;
  r.scale_ratio = fit.scale_ratio;
  r.points_count = std::int64_t(fit.points);
  r.transform = print::rows_of(fit.map);
  if (fit.residual_mm > p.doubtful_residual_mm) r.doubts.push_back("shape");
  if (fit.scale_ratio > p.doubtful_scale_ratio) r.doubts.push_back("scale");
  if (mirror.residual_mm < p.mirrored_ratio * fit.residual_mm) r.doubts.push_back("mirrored");
  r.sighting = r.doubts.empty() ? lesson::Sighting::found : lesson::Sighting::doubtful;
  return r;
}

}  // namespace

Laid laid_by_bone(const std::vector<BonePoint>& points, const ScanView& scan, const char* body, const char* remedy,
                  const OutcomeParams& params, const Progress& progress) {
  const std::optional<BoneFit> fit = fit_bone(points, scan, progress.part(0, 0.5));
  if (!fit)
    throw refusal("registration", "the scan shows no bone that could be the case's, or too little of it", {remedy});
  const std::optional<BoneFit> mirror = fit_bone(mirrored(points), scan, progress.part(0.5, 0.75));
  Laid laid{fit->map, registered(*fit, mirror ? *mirror : BoneFit(), body, remedy, params), {}};
  const auto left_out = std::make_shared<LeftOutFits>(points, scan, *fit, progress.part(0.75, 1));
  laid.error_mm = [left_out](Vec3 p) { return left_out->standard_error_mm(p); };
  return laid;
}

}  // namespace trephine::outcome
