// SPDX-License-Identifier: GPL-3.0-or-later
#include "outcome/measure_chest.h"

#include <algorithm>

#include "outcome/find_lines.h"
#include "outcome/laid.h"

namespace trephine::outcome {
namespace {

constexpr double bone_hu = 250;           ///< ribs are thinner than a skull
constexpr double most_moved_mm = 3;       ///< of a clavicle against the rest
constexpr double least_seen_ratio = 0.5;  ///< of a clavicle
const char* const remedy =
    "take the scan of this patient's chest after the procedure, as it was made; docs/how-to/outcome.md says what it "
    "must show";

}  // namespace

lesson::OutcomeRecord measure_chest(const cases::LoadedCase& loaded, const grid::HuVolume& scan,
                                    const OutcomeParams& params, const Progress& progress) {
  const CaseChest chest(loaded);
  const ScanView view(scan, bone_hu);
  const Laid laid = laid_by_bone(chest.thorax, view, "chest", remedy, params, progress.part(0, 0.8));
  // Arms that lie otherwise turn a clavicle, and the vein with it.
  std::array<double, 2> moved_mm{1e3, 1e3};
  for (const std::size_t side : {0u, 1u}) {
    const BoneFit own = refined_fit(chest.clavicles[side], view, laid.map);
    if (own.overlap_ratio >= least_seen_ratio && own.points > 0)
      moved_mm[side] = std::min(1e3, norm(own.map(chest.clavicle_mm[side]) - laid.map(chest.clavicle_mm[side])));
  }
  lesson::OutcomeRecord r;
  r.case_token = loaded.manifest.case_token;
  r.registration = laid.registration;
  r.lines = find_lines(chest, view, laid.map, progress.part(0.8, 1));
  for (lesson::OutcomeLine& line : r.lines) {
    line.error_mm = laid.error_mm(line.tip_mm);
    line.clavicle_moved_mm = moved_mm[line.side == "left"];
    const bool two = std::any_of(r.lines.begin(), r.lines.end(), [&](const lesson::OutcomeLine& other) {
      return &other != &line && other.side == line.side;
    });
    const auto doubt = [&](bool holds, const char* why) {
      if (holds) line.doubts.insert(line.doubts.begin(), why);
    };
    doubt(two, "two_lines");
    doubt(line.clavicle_moved_mm > most_moved_mm, "clavicle");
    doubt(r.registration.sighting != lesson::Sighting::found, "registration");
    line.sighting = line.doubts.empty() ? lesson::Sighting::found : lesson::Sighting::doubtful;
  }
  progress.report(1);
  return r;
}

}  // namespace trephine::outcome
