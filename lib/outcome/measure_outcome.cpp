// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/measure_outcome.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/refusal.h"
#include "mask/filters.h"
#include "outcome/bone_fit.h"
#include "outcome/find_courses.h"
#include "outcome/find_made_holes.h"

namespace trephine::outcome {
namespace {

constexpr double points_mm = 4;
constexpr double sure = 0.5;
constexpr double beside_ratio = 0.25;  ///< of the surest course's confidence: another that is surer than this may be it
constexpr double through_mm = 4;       ///< beyond the hole's wall
const char* const remedy =
    "take the scan of this patient after the procedure, as it was made; docs/how-to/outcome.md says what it must show";

lesson::OutcomeRegistration registered(const BoneFit& fit, const BoneFit& mirror, const OutcomeParams& p) {
  if (fit.overlap_ratio < p.least_overlap_ratio)
    throw refusal("registration",
                  fmt::format("only {:.0f} % of the case's bone lies in the scan, below {:.0f} %",
                              100 * fit.overlap_ratio, 100 * p.least_overlap_ratio),
                  {remedy});
  if (fit.residual_mm > p.mirrored_ratio * mirror.residual_mm)
    throw refusal("registration",
                  fmt::format("the scan shows the case's head mirrored: bone lies {:.2f} mm off, mirrored {:.2f} mm",
                              fit.residual_mm, mirror.residual_mm),
                  {remedy});
  if (fit.residual_mm > p.largest_residual_mm || fit.matched_ratio < p.least_matched_ratio)
    throw refusal(
        "registration",
        fmt::format("the scan shows another head: bone lies {:.2f} mm off (at most {:.2f}), and {:.0f} % of it "
                    "has an edge within 2 mm (at least {:.0f})",
                    fit.residual_mm, p.largest_residual_mm, 100 * fit.matched_ratio, 100 * p.least_matched_ratio),
        {remedy});
  if (fit.scale_ratio > p.largest_scale_ratio)
    throw refusal(
        "registration",
        fmt::format("the scan would have to be stretched by {:.1f} % (at most {:.1f}): it shows another head, "
                    "or its voxels have another size than it says",
                    100 * fit.scale_ratio, 100 * p.largest_scale_ratio),
        {remedy});
  lesson::OutcomeRegistration r;
  r.residual_mm = fit.residual_mm;
  r.mirrored_residual_mm = std::min(1e3, mirror.residual_mm);
  r.widening_mm = fit.widening_mm;
  r.overlap_ratio = fit.overlap_ratio;
  r.matched_ratio = fit.matched_ratio;
  r.scale_ratio = fit.scale_ratio;
  r.points_count = std::int64_t(fit.points);
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t k = 0; k < 3; ++k) r.transform[4 * a + k] = fit.map.matrix.column[k][int(a)];
    r.transform[4 * a + 3] = fit.map.offset_mm[int(a)];
  }
  if (fit.residual_mm > p.doubtful_residual_mm) r.doubts.push_back("shape");
  if (fit.scale_ratio > p.doubtful_scale_ratio) r.doubts.push_back("scale");
  if (mirror.residual_mm < p.mirrored_ratio * fit.residual_mm) r.doubts.push_back("mirrored");
  r.sighting = r.doubts.empty() ? lesson::Sighting::found : lesson::Sighting::doubtful;
  return r;
}

bool passes_a_hole(const lesson::OutcomeCourse& c, const std::vector<lesson::OutcomeHole>& holes) {
  return std::any_of(holes.begin(), holes.end(), [&](const lesson::OutcomeHole& h) {
    const Vec3 d = c.outer_mm - h.outer_mm;
    return norm(d - h.out * dot(d, h.out)) < h.diameter_mm / 2 + through_mm;
  });
}

void judge_catheter(lesson::OutcomeRecord& r) {
  if (r.courses.empty()) return;
  const lesson::OutcomeCourse& best = r.courses.front();
  const auto doubt = [&](bool holds, const char* why) {
    if (holds) r.catheter_doubts.push_back(why);
  };
  doubt(r.registration.sighting != lesson::Sighting::found, "registration");
  doubt(std::count_if(r.courses.begin(), r.courses.end(),
                      [&](const auto& c) { return c.confidence >= beside_ratio * best.confidence; }) > 1,
        "two_courses");
  doubt(norm(best.outer_mm - best.inner_mm) < 0.1, "not_to_the_bone");
  doubt(!r.holes_beforehand && !passes_a_hole(best, r.holes), "no_hole");
  doubt(best.seen_mm < 20, "short");
  doubt(best.confidence < sure, "faint");
  r.catheter = r.catheter_doubts.empty() ? lesson::Sighting::found : lesson::Sighting::doubtful;
}

}  // namespace

lesson::OutcomeRecord measure_outcome(const cases::LoadedCase& loaded, const grid::HuVolume& scan,
                                      const OutcomeParams& params, const Progress& progress) {
  const CaseHead head(loaded, progress.part(0, 0.1));
  const ScanView view(scan);
  const std::vector<BonePoint> points = bone_points(loaded.haptic, head.bone, points_mm);
  const std::optional<BoneFit> fit = fit_bone(points, view, progress.part(0.1, 0.4));
  if (!fit)
    throw refusal("registration", "the scan shows no bone that could be the case's, or too little of it", {remedy});
  const std::optional<BoneFit> mirror = fit_bone(mirrored(points), view, progress.part(0.4, 0.6));
  lesson::OutcomeRecord r;
  r.case_token = loaded.manifest.case_token;
  r.registration = registered(*fit, mirror ? *mirror : BoneFit(), params);
  const LeftOutFits left_out(points, view, *fit, progress.part(0.6, 0.75));
  r.courses = find_courses(head, view, fit->map, progress.part(0.75, 0.85));
  r.holes = find_made_holes(head, view, fit->map, r.courses, progress.part(0.85, 1));
  for (lesson::OutcomeCourse& c : r.courses) {
    if (!loaded.manifest.burr_holes.empty()) continue;
    if (!passes_a_hole(c, r.holes)) c.confidence *= 0.6;
  }
  std::stable_sort(r.courses.begin(), r.courses.end(),
                   [](const auto& a, const auto& b) { return a.confidence > b.confidence; });
  for (lesson::OutcomeCourse& c : r.courses) c.error_mm = left_out.standard_error_mm(c.tip_mm);
  for (lesson::OutcomeHole& h : r.holes) h.error_mm = left_out.standard_error_mm(h.outer_mm);
  r.holes_beforehand = !loaded.manifest.burr_holes.empty();
  judge_catheter(r);
  const bool hole = std::any_of(r.holes.begin(), r.holes.end(), [](const auto& h) { return h.confidence >= sure; });
  if (!r.holes.empty())
    r.hole = hole && r.registration.sighting == lesson::Sighting::found ? lesson::Sighting::found
                                                                        : lesson::Sighting::doubtful;
  progress.report(1);
  return r;
}

}  // namespace trephine::outcome
