// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/measure_outcome.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "base/pi.h"
#include "base/refusal.h"
#include "mask/filters.h"
#include "outcome/case_chest.h"
#include "outcome/case_spine.h"
#include "outcome/find_courses.h"
#include "outcome/find_made_holes.h"
#include "outcome/laid.h"
#include "outcome/marks.h"
#include "outcome/measure_chest.h"
#include "outcome/measure_spine.h"

namespace trephine::outcome {
namespace {

constexpr double points_mm = 4;
constexpr double sure = 0.5;
constexpr double beside_ratio = 0.25;  ///< of the surest course's confidence: another that is surer than this may be it
constexpr double above_cut_mm = 10;    ///< of a print: nearer to its cut are rim and base
constexpr double through_mm = 4;       ///< beyond the hole's wall
const char* const remedy =
    "take the scan of this patient after the procedure, as it was made; docs/how-to/outcome.md says what it must show";

const char* const marks_remedy =
    "take a CT that shows the whole print with all its marks, as it was made; docs/how-to/print.md says how";

lesson::OutcomeRegistration registered(const MarkFit& fit, const print::PrintRecord& print, const OutcomeParams& p) {
  if (fit.mirrored_marks > fit.marks || (fit.mirrored_marks == fit.marks && fit.marks >= least_marks &&
                                         fit.residual_mm > p.mirrored_ratio * fit.mirrored_residual_mm))
    throw refusal("marks",
                  fmt::format("the scan shows the print mirrored: {} marks fit so, {} as they were printed",
                              fit.mirrored_marks, fit.marks),
                  {marks_remedy});
  if (fit.marks < least_marks)
    throw refusal("marks",
                  fmt::format("{} of the print's {} marks were found where they belong, and {} are needed", fit.marks,
                              print.marks.size(), least_marks),
                  {marks_remedy});
  if (fit.residual_mm > p.largest_marks_mm)
    throw refusal("marks",
                  fmt::format("the marks lie {:.2f} mm off (at most {:.2f}): it is another print, or it is bent",
                              fit.residual_mm, p.largest_marks_mm),
                  {marks_remedy});
  lesson::OutcomeRegistration r;
  r.residual_mm = fit.residual_mm;
  r.mirrored_residual_mm = std::min(1e3, fit.mirrored_residual_mm);
  r.overlap_ratio = r.matched_ratio = double(fit.marks) / double(print.marks.size());
  r.marks_count = std::int64_t(fit.marks);
  for (const print::PrintTarget& t : print.targets)
    r.target_error_mm = std::max(r.target_error_mm, fit.error_mm(t.case_mm));
  r.transform = rows_of(fit.map);
  if (fit.residual_mm > p.doubtful_marks_mm) r.doubts.push_back("marks");
  if (fit.mirrored_marks == fit.marks) r.doubts.push_back("mirrored");
  r.sighting = r.doubts.empty() ? lesson::Sighting::found : lesson::Sighting::doubtful;
  return r;
}

Laid laid_by_marks(const cases::LoadedCase& loaded, const ScanView& view, const print::PrintRecord& print,
                   const OutcomeParams& params, const Progress& progress) {
  if (print.case_token != loaded.manifest.case_token)
    throw Error(ExitCode::bad_input, "", "marks", "the print was made of another case, by its name");
  if (print.marks.empty()) throw Error(ExitCode::bad_input, "", "marks", "the print has no marks");
  const auto fit = std::make_shared<MarkFit>(
      fit_marks(print.marks, find_spheres(view, 0.5 * print.marks.front().diameter_mm, progress)));
  return {
      {fit->map.turn, fit->map.offset_mm}, registered(*fit, print, params), [fit](Vec3 p) { return fit->error_mm(p); }};
}
bool passes_a_hole(const lesson::OutcomeCourse& c, const lesson::OutcomeRecord& r) {
  const auto across_mm = [&](Vec3 middle_mm, Vec3 out) {
    const Vec3 d = c.outer_mm - middle_mm;
    return norm(d - out * dot(d, out));
  };
  return std::any_of(r.holes.begin(), r.holes.end(),
                     [&](const auto& h) { return across_mm(h.outer_mm, h.out) < h.diameter_mm / 2 + through_mm; }) ||
         std::any_of(r.openings.begin(), r.openings.end(), [&](const auto& o) {
           // The radius of its area: a long cleft is no way in far beside it.
           return o.confidence >= sure && across_mm(o.middle_mm, o.out) < 10 * std::sqrt(o.area_cm2 / pi) + through_mm;
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
  doubt(!r.holes_beforehand && !passes_a_hole(best, r), "no_hole");
  doubt(best.seen_mm < 20, "short");
  doubt(best.confidence < sure, "faint");
  r.catheter = r.catheter_doubts.empty() ? lesson::Sighting::found : lesson::Sighting::doubtful;
}

}  // namespace

lesson::OutcomeRecord measure_outcome(const cases::LoadedCase& loaded, const grid::HuVolume& scan,
                                      const OutcomeParams& params, const Progress& progress,
                                      const print::PrintRecord* print) {
  if (is_spine(loaded) && !print) return measure_spine(loaded, scan, params, progress);
  if (is_chest(loaded) && !print) return measure_chest(loaded, scan, params, progress);
  const CaseHead head(loaded, progress.part(0, 0.1));
  const ScanView view(scan);
  const Laid laid = print ? laid_by_marks(loaded, view, *print, params, progress.part(0.1, 0.75))
                          : laid_by_bone(bone_points(loaded.haptic, head.bone, points_mm), view, "head", remedy, params,
                                         progress.part(0.1, 0.75));
  lesson::OutcomeRecord r;
  r.case_token = loaded.manifest.case_token;
  r.registration = laid.registration;
  r.courses = find_courses(head, view, laid.map, progress.part(0.75, 0.85));
  MadeGaps gaps = find_made_holes(head, view, laid.map, r.courses, print != nullptr, progress.part(0.85, 1));
  r.holes = std::move(gaps.holes);
  if (!print) r.openings = std::move(gaps.openings);  // a print is open at its cut
  if (print) {                                        // below the cut nothing was printed
    const itk::LinearMap to_print = print::map_of(print->case_to_print);
    r.holes.erase(std::remove_if(r.holes.begin(), r.holes.end(),
                                 [&](const lesson::OutcomeHole& h) {
                                   return to_print(h.outer_mm).z < h.diameter_mm / 2 + above_cut_mm;
                                 }),
                  r.holes.end());
  }
  for (lesson::OutcomeCourse& c : r.courses) {
    if (!loaded.manifest.burr_holes.empty()) continue;
    if (!passes_a_hole(c, r)) c.confidence *= 0.6;
  }
  std::stable_sort(r.courses.begin(), r.courses.end(),
                   [](const auto& a, const auto& b) { return a.confidence > b.confidence; });
  for (lesson::OutcomeCourse& c : r.courses) c.error_mm = laid.error_mm(c.tip_mm);
  for (lesson::OutcomeHole& h : r.holes) h.error_mm = laid.error_mm(h.outer_mm);
  for (lesson::OutcomeOpening& o : r.openings) o.error_mm = laid.error_mm(o.middle_mm);
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
