// SPDX-License-Identifier: GPL-3.0-or-later
#include "mask/scan_verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/joined.h"
#include "base/refusal.h"
#include "base/text.h"
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
  verdict.reasons.push_back(
      {Suitability::doubtful,
       {"skin", "skull", "brain"},
       {"head_moved",
        "the head moved while it was scanned, by {motion_mm:.1f} mm (above z = {above_mm:.0f} mm it lies "
        "{aside_mm:.1f} "
        "mm farther to the {side} and {along_mm:.1f} mm farther to the {end}): every surface has a step there",
        {{"motion_mm", norm(m.by_mm)},
         {"above_mm", m.at_mm.z},
         {"aside_mm", std::abs(left)},
         {"side", left > 0 ? "left" : "right"},
         {"along_mm", std::abs(back)},
         {"end", back > 0 ? "back" : "front"}}},
       fmt::format("the head moved by {:.1f} mm", norm(m.by_mm)),
       "choose another series, or look at the step in the pictures"});
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

bool ScanReason::concerns(const std::string& anatomy) const {
  return std::find(of.begin(), of.end(), anatomy) != of.end();
}

std::string ScanReason::verdict() const {
  return (of.empty() ? "" : std::string(to_text(is)) + " for " + listed(of) + ": ") + trephine::to_text(why);
}

Warning ScanReason::warning() const {
  Warning w = why;
  if (of.empty()) return w;
  w.form = "{suited} for {of}: " + why.form + "; {remedy}";
  w.values.insert(w.values.end(), {{"suited", to_text(is)}, {"of", listed(of)}, {"remedy", remedy}});
  return w;
}

std::string ScanSuitability::text() const {
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
  const std::string noise = fmt::format("noise of {:.0f} HU", f.noise_hu);
  const auto give_reason = [&](Suitability s, std::vector<std::string> of, Warning why, std::string brief,
                               const char* remedy) {
    out.reasons.push_back({s, std::move(of), std::move(why), std::move(brief), remedy});
  };
  if (const Suitability s = above(f.slice_step_mm, limits.doubtful_slice_mm, limits.unsuited_slice_mm);
      s != Suitability::suited) {
    for (Suitability* of : {&out.brain, &out.ventricles, &out.skull}) worsen(*of, s);
    give_reason(
        s, {"brain", "ventricles", "skull"},
        {"slices_far_apart", "slices {step_mm:.1f} mm apart", {{"step_mm", f.slice_step_mm}}},
        fmt::format("slices of {:.3g} mm", f.slice_step_mm),
        "take the series of the thinnest slices that there is (import --list shows all), or scan with slices of 1 mm");
  }
  if (f.edge_mm > limits.doubtful_edge_mm) {
    worsen(out.skull, Suitability::doubtful);
    give_reason(Suitability::doubtful, {"skull"},
                {"edges_blurred", "edges are blurred over {edge_mm:.1f} mm", {{"edge_mm", f.edge_mm}}},
                fmt::format("edges blurred over {:.1f} mm", f.edge_mm), "choose a series of a sharper kernel for bone");
  }
  if (!f.known()) {
    out.kernel = "unknown";
    for (Suitability* of : {&out.brain, &out.ventricles, &out.skull, &out.skin})
      if (*of == Suitability::suited) *of = Suitability::unknown;
    give_reason(Suitability::unknown, {},
                {"noise_unknown", "noise could not be measured: too little even soft tissue in the scan", {}}, "", "");
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
    give_reason(soft_tissue, {"brain", "ventricles"},
                {sharp ? "noise_of_sharp_kernel" : "noise",
                 std::string("noise of {noise_hu:.0f} HU a voxel, {cube_noise_hu:.0f} HU in a cube of 2 mm") +
                     (sharp ? ", of a kernel that enhances edges" : ""),
                 {{"noise_hu", f.noise_hu}, {"cube_noise_hu", f.cube_noise_hu}}},
                noise,
                sharp ? "choose the series with the softer kernel, where the study holds one: `trephine import --list` "
                        "shows all, and import.series takes one"
                      : "choose a series of thicker slices or a smoother kernel, or denoise it before");
  }
  if (const Suitability s = above(f.noise_hu, limits.doubtful_bone_noise_hu, limits.unsuited_bone_noise_hu);
      s != Suitability::suited) {
    worsen(out.skull, s);
    give_reason(s, {"skull"}, {"noise_in_bone", "noise of {noise_hu:.0f} HU a voxel", {{"noise_hu", f.noise_hu}}},
                noise, "choose a series of a smoother kernel or thicker slices");
  }
  if (f.noise_hu > limits.doubtful_skin_noise_hu) {
    out.skin = Suitability::doubtful;
    give_reason(out.skin, {"skin"},
                {"noise_in_skin",
                 "noise of {noise_hu:.0f} HU a voxel tears it where fat lies below",
                 {{"noise_hu", f.noise_hu}}},
                noise, "choose a series of a smoother kernel or thicker slices");
  }
  if (waxy) {
    worsen(out.ventricles, Suitability::doubtful);
    give_reason(Suitability::doubtful, {"ventricles"},
                smeared
                    ? Warning{"denoised",
                              "noise of only {noise_hu:.1f} HU that hangs together over {kernel_mm:.1f} mm: strongly "
                              "denoised",
                              {{"noise_hu", f.noise_hu}, {"kernel_mm", f.kernel_mm}}}
                    : Warning{"denoised",
                              "noise of only {cube_noise_hu:.1f} HU in a cube of 2 mm: strongly denoised",
                              {{"cube_noise_hu", f.cube_noise_hu}}},
                "strongly denoised", "choose the series without iterative reconstruction or with less of it");
  }
  if (f.artefact_ratio > limits.doubtful_artefact_ratio) {
    worsen(out.brain, Suitability::doubtful);
    worsen(out.ventricles, Suitability::doubtful);
    give_reason(Suitability::doubtful, {"brain", "ventricles"},
                {"artefacts",
                 "{artefacts_percent:.0f} % of the soft tissue is far more uneven than noise (streaks, blood, motion)",
                 {{"artefacts_percent", 100 * f.artefact_ratio}}},
                "uneven soft tissue", "choose a series with metal artefact reduction, and look at the pictures");
  }
  return out;
}

Outcome<std::monostate, ScanResult> judge_scan(const grid::HuVolume& volume, const ScanLimits& limits,
                                               const Progress& progress) {
  Outcome<std::monostate, ScanResult> out;
  out.result.figures = measure_scan(volume, progress);
  ScanVerdict verdict = judge_scan(out.result.figures, limits);
  if (const std::optional<Motion> motion = find_motion(volume, progress)) {
    blame(*motion, verdict);
    out.result.motion_mm = norm(motion->by_mm);
  }
  std::string remedy;
  for (const ScanReason& r : verdict.reasons) {
    out.warnings.push_back(r.warning());
    remedy += (remedy.empty() ? "" : ". ") + trephine::to_text(out.warnings.back());
    ScanBecause& because = out.result.because;
    for (const auto& [anatomy, text] : {std::pair{"brain", &because.brain},
                                        {"ventricles", &because.ventricles},
                                        {"skull", &because.skull},
                                        {"skin", &because.skin}})
      if (r.concerns(anatomy)) *text += (text->empty() ? "" : ", ") + r.brief;
  }
  out.result.kernel = verdict.kernel;
  out.result.suited = verdict;
  out.result.verdict = verdict.text();
  out.result.remedy = remedy.empty() ? "none needed" : remedy;
  const Suitability worst = std::max({verdict.brain, verdict.ventricles, verdict.skull}, [](auto a, auto b) {
    const auto rank = [](Suitability s) { return s == Suitability::unknown ? 0 : int(s) + 1; };
    return rank(a) < rank(b);
  });
  if (limits.refuse && worst == Suitability::unsuited)
    throw refusal("scan", remedy, {"or let it pass with a warning: `refuse` of the stage `scan` to false"});
  return out;
}

}  // namespace trephine::mask
