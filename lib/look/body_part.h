// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <variant>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"

namespace trephine::look {

enum class BodyPart { any, head, spine, chest };

struct BodyPartParams {
  BodyPart expected = BodyPart::any;
  bool refuse = true;
  template <class V>
  static void describe(V& v) {
    v.choice(&BodyPartParams::expected, "expected",
             {{"any", BodyPart::any}, {"head", BodyPart::head}, {"spine", BodyPart::spine}, {"chest", BodyPart::chest}},
             "What is made of the scan. With `any` it is measured, and nothing is refused.");
    v.flag(&BodyPartParams::refuse, "refuse",
           "Whether a scan that shows another part of the body is refused. If not, that is a warning, and what is made "
           "of the scan is called doubtful.");
  }
};

/// What of the body cells of 3 mm show.
struct BodyPartSeen {
  double tissue_ml = 0;    ///< from -150 to 150 HU
  double enclosed_ml = 0;  ///< of the largest space that bone encloses; 0: none of 15 mm radius
  double enclosed_air_ratio = 0, enclosed_inner_air_ml = 0;
  double walled_ratio = 0;  ///< the share of its surface that has bone beside it
  double below_mm = 0;      ///< how far the scan goes on below it
  bool head = false;        ///< it is a cranial cavity: of its size, without air, all about it bone, and that symmetric
  /// Where that is not so, else missing: the longest space that bone encloses slice by slice, what it holds, and the
  /// share of all bone that lies within 60 mm of it in the slices.
  std::optional<double> canal_mm, canal_hu, bone_about_canal_ratio;
  template <class V>
  static void describe(V& v) {
    using P = BodyPartSeen;
    v.choice(&P::head, "shows_head", {{"no", false}, {"yes", true}}, "Whether bone encloses a cranial cavity.");
    v.number(&P::tissue_ml, "tissue_ml", Range{}, "Tissue from -150 to 150 HU.");
    v.number(&P::enclosed_ml, "enclosed_ml", Range{}, "The largest space that bone encloses.");
    v.number(&P::enclosed_air_ratio, "enclosed_air_ratio", Range{}, "Share of it that is air.");
    v.number(&P::enclosed_inner_air_ml, "enclosed_inner_air_ml", Range{}, "Air in it that no surface crosses.");
    v.number(&P::walled_ratio, "enclosed_walled_ratio", Range{}, "Share of its surface that has bone beside it.");
    v.number(&P::below_mm, "below_enclosed_mm", Range{}, "How far the scan goes on below it.");
    v.number(&P::canal_mm, "canal_mm", "Length of the longest space that bone encloses slice by slice.");
    v.number(&P::canal_hu, "canal_hu", "What it holds.");
    v.number(&P::bone_about_canal_ratio, "bone_about_canal_ratio", "Share of all bone that lies about it.");
  }
};

/// Whether the scan shows the part of the body that is made of it; unknown: what is made of it is doubtful.
enum class IsExpected { yes, not_told, unknown };

/// The stage's result.
struct BodyPartResult {
  BodyPartSeen seen;
  IsExpected is_expected = IsExpected::not_told;
  template <class V>
  static void describe(V& v) {
    v.all_of(&BodyPartResult::seen);
    v.choice(&BodyPartResult::is_expected, "is_expected",
             {{"yes", IsExpected::yes}, {"not told", IsExpected::not_told}, {"unknown", IsExpected::unknown}},
             "Whether it is the part of the body that was expected.");
  }
};

/// Takes well below a second of CPU time. The result is the same whatever the thread count. Throws Cancelled.
BodyPartSeen body_part_of(const grid::HuVolume& volume, const Progress& progress = {});

/// Whether it may be a head, whole or not: a cranial cavity, or a space as one that is small, open or cut. What must
/// not miss a head asks this.
bool may_be_head(const BodyPartSeen& seen);

/// Throws Error 80, or where params.refuse is false warns and says IsExpected::unknown, where it is surely another part
/// of the body than the expected one:
/// - for a head: lungs, or a spine alone; where only no cranial cavity is seen, it warns;
/// - for spine or chest: a head, and a scan that ends before a vertebra of which pedicles can be told, or a clavicle.
/// It is an early word: what it lets pass, the stages that look for the part may still refuse.
Outcome<std::monostate, BodyPartResult> judge_body_part(const grid::HuVolume& volume, const BodyPartParams& params,
                                                        const Progress& progress = {});

}  // namespace trephine::look
