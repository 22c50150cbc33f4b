// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/scan_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/refusal.h"
#include "base/result.h"
#include "mask/motion.h"

namespace trephine::mask {
namespace {

constexpr double sharp_correlation = 0.35;  // of neighbours 0.5 mm apart; a kernel of 1 mm has 0.7

void worsen(Suitability& s, Suitability to) {
  if (s == Suitability::unknown || to > s) s = to;
}

Suitability above(double value, double doubtful, double unsuited) {
  return value > unsuited ? Suitability::unsuited : value > doubtful ? Suitability::doubtful : Suitability::suited;
}

void blame(const Motion& m, ScanVerdict& verdict) {
  for (Suitability* s : {&verdict.skin, &verdict.skull, &verdict.brain}) worsen(*s, Suitability::doubtful);
  const double left = m.by_mm.x, back = m.by_mm.y;
  verdict.reasons.push_back(fmt::format(
      "doubtful for skin, skull and brain: the head moved while it was scanned, by {:.1f} mm (above z = {:.0f} mm it "
      "lies "
      "{:.1f} mm farther to the {} and {:.1f} mm farther to the {}): every surface has a step there; choose another "
      "series, or look at the step in the pictures",
      norm(m.by_mm), m.at_mm.z, std::abs(left), left > 0 ? "left" : "right", std::abs(back),
      back > 0 ? "back" : "front"));
}

}  // namespace

const char* to_text(Suitability s) {
  switch (s) {
    case Suitability::suited:
      return "suited";
    case Suitability::doubtful:
      return "doubtful";
    case Suitability::unsuited:
      return "unsuited";
    case Suitability::unknown:
      break;
  }
  return "unknown";
}

std::string ScanLimits::fault() const {
  if (doubtful_cube_noise_hu > unsuited_cube_noise_hu) return "doubtful_cube_noise_hu: is above unsuited_cube_noise_hu";
  if (doubtful_noise_hu > unsuited_noise_hu) return "doubtful_noise_hu: is above unsuited_noise_hu";
  if (doubtful_bone_noise_hu > unsuited_bone_noise_hu) return "doubtful_bone_noise_hu: is above unsuited_bone_noise_hu";
  if (doubtful_slice_mm > unsuited_slice_mm) return "doubtful_slice_mm: is above unsuited_slice_mm";
  return "";
}

std::string ScanVerdict::text() const {
  const std::string of_skin = skin == Suitability::doubtful ? ", doubtful for skin" : "";
  if (brain == ventricles && brain == skull)
    return fmt::format("{} for brain, ventricles and skull{}", to_text(brain), of_skin);
  if (brain == ventricles)
    return fmt::format("{} for brain and ventricles, {} for skull{}", to_text(brain), to_text(skull), of_skin);
  return fmt::format("{} for brain, {} for ventricles, {} for skull{}", to_text(brain), to_text(ventricles),
                     to_text(skull), of_skin);
}

ScanVerdict judge_scan(const ScanFigures& f, const ScanLimits& limits) {
  ScanVerdict out;
  const auto say = [&](Suitability s, const std::string& of, const std::string& why, const std::string& remedy) {
    out.reasons.push_back(fmt::format("{} for {}: {}; {}", to_text(s), of, why, remedy));
  };
  if (const Suitability s = above(f.slice_step_mm, limits.doubtful_slice_mm, limits.unsuited_slice_mm);
      s != Suitability::suited) {
    for (Suitability* of : {&out.brain, &out.ventricles, &out.skull}) worsen(*of, s);
    say(s, "brain, ventricles and skull", fmt::format("slices {:.1f} mm apart", f.slice_step_mm),
        "choose the series with slices of 1 mm (import --list shows all), or scan with such");
  }
  if (f.edge_mm > limits.doubtful_edge_mm) {
    worsen(out.skull, Suitability::doubtful);
    say(Suitability::doubtful, "skull", fmt::format("edges are blurred over {:.1f} mm", f.edge_mm),
        "choose a series of a sharper kernel for bone");
  }
  if (!f.known()) {
    out.kernel = "unknown";
    for (Suitability* of : {&out.brain, &out.ventricles, &out.skull, &out.skin})
      if (*of == Suitability::suited) *of = Suitability::unknown;
    out.reasons.push_back("noise could not be measured: too little even soft tissue in the scan");
    return out;
  }
  const bool sharp = f.neighbour_correlation_ratio < sharp_correlation && f.pixel_mm < 0.75;
  // Filters that keep edges leave the little noise that is left as fine as it was: the kernel alone does not tell.
  const bool smeared = f.noise_hu < limits.waxy_noise_hu && f.kernel_mm > limits.waxy_kernel_mm;
  const bool waxy = smeared || f.cube_noise_hu < limits.waxy_cube_noise_hu;
  out.kernel = waxy ? "denoised" : sharp ? "sharp" : "soft";
  const Suitability soft_tissue =
      std::max(above(f.noise_hu, limits.doubtful_noise_hu, limits.unsuited_noise_hu),
               above(f.cube_noise_hu, limits.doubtful_cube_noise_hu, limits.unsuited_cube_noise_hu));
  if (soft_tissue != Suitability::suited) {
    worsen(out.brain, soft_tissue);
    worsen(out.ventricles, soft_tissue);
    say(soft_tissue, "brain and ventricles",
        fmt::format("noise of {:.0f} HU a voxel, {:.0f} HU in a cube of 2 mm{}", f.noise_hu, f.cube_noise_hu,
                    sharp ? ", of a kernel that enhances edges" : ""),
        sharp ? "choose the series with the softer kernel (import --list shows all, --set import.series=s2 takes the "
                "second)"
              : "choose a series of thicker slices or a smoother kernel, or denoise it before");
  }
  if (const Suitability s = above(f.noise_hu, limits.doubtful_bone_noise_hu, limits.unsuited_bone_noise_hu);
      s != Suitability::suited) {
    worsen(out.skull, s);
    say(s, "skull", fmt::format("noise of {:.0f} HU a voxel", f.noise_hu),
        "choose a series of a smoother kernel or thicker slices");
  }
  if (f.noise_hu > limits.doubtful_skin_noise_hu) {
    out.skin = Suitability::doubtful;
    say(out.skin, "skin", fmt::format("noise of {:.0f} HU a voxel tears it where fat lies below", f.noise_hu),
        "choose a series of a smoother kernel or thicker slices");
  }
  if (waxy) {
    worsen(out.ventricles, Suitability::doubtful);
    say(Suitability::doubtful, "ventricles",
        smeared ? fmt::format("noise of only {:.1f} HU that hangs together over {:.1f} mm: strongly denoised",
                              f.noise_hu, f.kernel_mm)
                : fmt::format("noise of only {:.1f} HU in a cube of 2 mm: strongly denoised", f.cube_noise_hu),
        "choose the series without iterative reconstruction or with less of it");
  }
  if (f.artefact_ratio > limits.doubtful_artefact_ratio) {
    worsen(out.brain, Suitability::doubtful);
    worsen(out.ventricles, Suitability::doubtful);
    say(Suitability::doubtful, "brain and ventricles",
        fmt::format("{:.0f} % of the soft tissue is far more uneven than noise (streaks, blood, motion)",
                    100 * f.artefact_ratio),
        "choose a series with metal artefact reduction, and look at the pictures");
  }
  return out;
}

void judge_scan(const grid::HuVolume& volume, const ScanLimits& limits, Report& report, const Progress& progress) {
  const ScanFigures figures = measure_scan(volume, progress);
  ScanVerdict verdict = judge_scan(figures, limits);
  const std::optional<Motion> motion = find_motion(volume, progress);
  if (motion) blame(*motion, verdict);
  add_result(report, figures);
  if (motion) report.add("motion_mm", norm(motion->by_mm));
  report.add("kernel", verdict.kernel);
  report.add("brain", to_text(verdict.brain));
  report.add("ventricles", to_text(verdict.ventricles));
  report.add("skull", to_text(verdict.skull));
  report.add("skin", to_text(verdict.skin));
  std::string remedy;
  for (const std::string& r : verdict.reasons) {
    report.warn(r);
    remedy += (remedy.empty() ? "" : ". ") + r;
  }
  report.add("verdict", verdict.text());
  report.add("remedy", remedy.empty() ? "none needed" : remedy);
  const Suitability worst = std::max({verdict.brain, verdict.ventricles, verdict.skull}, [](auto a, auto b) {
    const auto rank = [](Suitability s) { return s == Suitability::unknown ? 0 : int(s) + 1; };
    return rank(a) < rank(b);
  });
  if (limits.refuse && worst == Suitability::unsuited)
    throw refusal("scan", remedy, {"or let it pass with a warning: `refuse` of the stage `scan` to false"});
}

}  // namespace trephine::mask
