// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/measure_spine.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/refusal.h"
#include "outcome/find_screws.h"
#include "outcome/misfit.h"
#include "print/print_record.h"

namespace trephine::outcome {
namespace {

constexpr double bone_hu = 250;        ///< vertebrae are thinner than a skull
constexpr double most_stretch = 0.06;  ///< of one vertebra, which thick slices stretch too
const char* const remedy =
    "take the scan of this patient's spine after the procedure, as it was made; docs/how-to/outcome.md says what it "
    "must show";

lesson::OutcomeRegistration registered(const SpineFit& fit, const OutcomeParams& p) {
  refuse_misfit({fit.overlap_ratio, fit.residual_mm, fit.mirrored_residual_mm, fit.matched_ratio}, "vertebrae lie",
                "spine", p, remedy);
  lesson::OutcomeRegistration r;
  r.residual_mm = fit.residual_mm;
  r.mirrored_residual_mm = std::min(1e3, fit.mirrored_residual_mm);
  r.next_level_residual_mm = std::min(1e3, fit.next_level_residual_mm);
  r.overlap_ratio = fit.overlap_ratio;
  r.matched_ratio = fit.matched_ratio;
  r.points_count = std::int64_t(fit.points_count);
  r.widening_mm = fit.all.widening_mm;
  r.transform = print::rows_of(fit.all.map);
  for (std::size_t n = 0; n < fit.of_level.size(); ++n)
    if (fit.is_seen(n)) r.scale_ratio = std::max(r.scale_ratio, std::min(1.0, fit.of_level[n].scale_ratio));
  if (fit.residual_mm > p.doubtful_residual_mm) r.doubts.push_back("shape");
  if (fit.mirrored_residual_mm < p.mirrored_ratio * fit.residual_mm) r.doubts.push_back("mirrored");
  if (fit.next_level_residual_mm < p.level_ratio * fit.residual_mm) r.doubts.push_back("level");
  r.sighting = r.doubts.empty() ? lesson::Sighting::found : lesson::Sighting::doubtful;
  return r;
}

}  // namespace

lesson::OutcomeRecord measure_spine(const cases::LoadedCase& loaded, const grid::HuVolume& scan,
                                    const OutcomeParams& params, const Progress& progress) {
  const CaseSpine spine(loaded);
  const ScanView view(scan, bone_hu);
  const std::optional<SpineFit> fit = fit_vertebrae(spine, view, progress.part(0, 0.8));
  if (!fit)
    throw refusal("registration", "the scan shows no bone that could be the case's, or too little of it", {remedy});
  lesson::OutcomeRecord r;
  r.case_token = loaded.manifest.case_token;
  r.registration = registered(*fit, params);
  r.screws = find_screws(spine, view, *fit, progress.part(0.8, 0.95));
  for (std::size_t n = 0; n < spine.levels.size(); ++n) {
    if (!fit->is_seen(n)) continue;
    const BoneFit& f = fit->of_level[n];
    r.vertebrae.push_back({spine.levels[n].number, print::rows_of(f.map), f.residual_mm, std::int64_t(f.points)});
    const LeftOutFits left_out(fit->points[n], view, f);
    for (lesson::OutcomeScrew& s : r.screws) {
      const auto of = std::find_if(spine.pedicles.begin(), spine.pedicles.end(),
                                   [&](const cases::CasePedicle& p) { return p.name == s.pedicle; });
      if (of == spine.pedicles.end() || spine.level_of(*of) != int(n)) continue;
      s.error_mm = left_out.standard_error_mm(s.tip_mm);
      if (f.residual_mm > params.doubtful_residual_mm) s.doubts.push_back("vertebra");
      if (f.scale_ratio > most_stretch) s.doubts.push_back("scale");
    }
  }
  for (lesson::OutcomeScrew& s : r.screws) {
    if (r.registration.sighting != lesson::Sighting::found) s.doubts.push_back("registration");
    s.sighting = s.doubts.empty() ? lesson::Sighting::found : lesson::Sighting::doubtful;
  }
  progress.report(1);
  return r;
}

}  // namespace trephine::outcome
