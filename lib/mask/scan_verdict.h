// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/params.h"
#include "base/result.h"
#include "mask/scan_figures.h"

namespace trephine::mask {

/// From which measure on a scan is doubtful or unsuited; chosen on phantoms (docs/validation/scan-quality.md).
struct ScanLimits {
  double doubtful_cube_noise_hu = 13, unsuited_cube_noise_hu = 23;
  double doubtful_noise_hu = 40, unsuited_noise_hu = 80;
  double doubtful_bone_noise_hu = 75, unsuited_bone_noise_hu = 150;
  double doubtful_skin_noise_hu = 100;
  double doubtful_slice_mm = 3.5, unsuited_slice_mm = 7;
  double waxy_noise_hu = 2.5, waxy_kernel_mm = 2.2, waxy_cube_noise_hu = 1.2, doubtful_edge_mm = 3;
  double doubtful_artefact_ratio = 0.04;
  bool refuse = false;

  template <class V>
  static void describe(V& v) {
    using P = ScanLimits;
    v.number(&P::doubtful_cube_noise_hu, "doubtful_cube_noise_hu", Range{0, 1000},
             "Noise in a cube of 2 mm above which brain and ventricles are doubtful.");
    v.number(&P::unsuited_cube_noise_hu, "unsuited_cube_noise_hu", Range{0, 1000},
             "Noise in a cube of 2 mm above which a scan is unsuited for brain and ventricles.");
    v.number(&P::doubtful_noise_hu, "doubtful_noise_hu", Range{0, 1000},
             "Noise of a voxel above which brain and ventricles are doubtful.");
    v.number(&P::unsuited_noise_hu, "unsuited_noise_hu", Range{0, 1000},
             "Noise of a voxel above which a scan is unsuited for brain and ventricles.");
    v.number(&P::doubtful_bone_noise_hu, "doubtful_bone_noise_hu", Range{0, 2000},
             "Noise of a voxel above which the skull is doubtful.");
    v.number(&P::unsuited_bone_noise_hu, "unsuited_bone_noise_hu", Range{0, 2000},
             "Noise of a voxel above which a scan is unsuited for the skull.");
    v.number(&P::doubtful_skin_noise_hu, "doubtful_skin_noise_hu", Range{0, 2000},
             "Noise of a voxel above which the skin is doubtful: fat then has voxels as dark as air, and is torn.");
    v.number(&P::doubtful_slice_mm, "doubtful_slice_mm", Range{0, 50},
             "Distance of slices above which everything is doubtful.");
    v.number(&P::unsuited_slice_mm, "unsuited_slice_mm", Range{0, 50},
             "Distance of slices above which a scan is unsuited for everything.");
    v.number(
        &P::waxy_noise_hu, "waxy_noise_hu", Range{0, 100},
        "Noise of a voxel below which a scan that is correlated over waxy_kernel_mm is taken for strongly denoised: "
        "doubtful for ventricles.");
    v.number(&P::waxy_cube_noise_hu, "waxy_cube_noise_hu", Range{0, 100},
             "Noise in a cube of 2 mm below which a scan is taken for strongly denoised, however it is correlated.");
    v.number(&P::waxy_kernel_mm, "waxy_kernel_mm", Range{0, 20}, "See waxy_noise_hu.");
    v.number(&P::doubtful_edge_mm, "doubtful_edge_mm", Range{0, 20},
             "Width of the kernel at edges above which the skull is doubtful.");
    v.number(&P::doubtful_artefact_ratio, "doubtful_artefact_ratio", Range{0, 1},
             "Share of tiles with streaks or the like above which brain and ventricles are doubtful.");
    v.flag(&P::refuse, "refuse", "Refuse a scan that is unsuited, with 80, instead of warning of it.");
  }
  std::string fault() const;
};

enum class Suitability { suited, doubtful, unsuited, unknown };
const char* to_text(Suitability s);

/// What a scan is suited for, by anatomy. Of the skin unknown only where the noise is.
struct ScanSuitability {
  Suitability brain = Suitability::suited, ventricles = Suitability::suited, skull = Suitability::suited,
              skin = Suitability::suited;
  template <class V>
  static void describe(V& v) {
    using P = ScanSuitability;
    const auto choices = {std::pair{"suited", Suitability::suited},
                          {"doubtful", Suitability::doubtful},
                          {"unsuited", Suitability::unsuited},
                          {"unknown", Suitability::unknown}};
    v.choice(&P::brain, "brain", choices, "What the scan is for the brain.");
    v.choice(&P::ventricles, "ventricles", choices, "What it is for the ventricles.");
    v.choice(&P::skull, "skull", choices, "What it is for the skull.");
    v.choice(&P::skin, "skin", choices, "What it is for the skin.");
  }
  std::string text() const;  ///< "doubtful for brain and ventricles, suited for skull"
};

/// Why a scan is no more than that.
struct ScanReason {
  Suitability is = Suitability::doubtful;
  std::vector<std::string> of;  ///< anatomies; empty: of every one it cannot be said
  Warning why;                  ///< what was measured
  std::string brief;            ///< the same in a few words
  std::string remedy;           ///< what a person can do; empty: nothing
  bool concerns(const std::string& anatomy) const;
  std::string verdict() const;  ///< "doubtful for skull: noise of 90 HU a voxel"
  Warning warning() const;      ///< the same and the remedy
};

struct ScanVerdict : ScanSuitability {
  std::string kernel;  ///< soft, sharp, denoised, or unknown
  std::vector<ScanReason> reasons;
};

ScanVerdict judge_scan(const ScanFigures& figures, const ScanLimits& limits);

/// Why the scan is not suited, by anatomy, in a few words; empty where it is.
struct ScanBecause {
  std::string brain, ventricles, skull, skin;
  template <class V>
  static void describe(V& v) {
    using P = ScanBecause;
    v.text(&P::brain, "brain_because", "Why the scan is not suited for the brain, in words.").not_always();
    v.text(&P::ventricles, "ventricles_because", "Why it is not for the ventricles.").not_always();
    v.text(&P::skull, "skull_because", "Why it is not for the skull.").not_always();
    v.text(&P::skin, "skin_because", "Why it is not for the skin.").not_always();
  }
};

/// The stage's result.
struct ScanResult {
  ScanFigures figures;
  std::optional<double> motion_mm;  ///< where the head moved (mask/motion.h)
  std::string kernel;
  ScanSuitability suited;
  ScanBecause because;
  std::string verdict, remedy;  ///< in words
  template <class V>
  static void describe(V& v) {
    using P = ScanResult;
    v.all_of(&P::figures);
    v.number(&P::motion_mm, "motion_mm", "How far the head moved between two slices.");
    v.text(&P::kernel, "kernel", "soft, sharp, denoised or unknown.");
    v.all_of(&P::suited);
    v.all_of(&P::because);
    v.text(&P::verdict, "verdict", "What the scan is suited for, in words.");
    v.text(&P::remedy, "remedy", "What a person can do, in words.");
  }
};

/// Measures and judges the scan of a head; warns of every reason.
/// Throws Error 80 with the remedy where the scan is unsuited and limits.refuse is set, 65 for values that are not
/// finite.
Outcome<std::monostate, ScanResult> judge_scan(const grid::HuVolume& volume, const ScanLimits& limits,
                                               const Progress& progress = {});

}  // namespace trephine::mask
