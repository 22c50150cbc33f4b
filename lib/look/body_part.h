// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/params.h"
#include "base/progress.h"
#include "base/report.h"
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
           "of the scan is told as doubtful.");
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
  /// Where that is not so: the longest space that bone encloses slice by slice, what it holds, and the share of all
  /// bone that lies within 60 mm of it in the slices.
  double canal_mm = 0, canal_hu = 0, bone_about_canal_ratio = 0;
};

/// Takes well below a second of CPU time. The result is the same whatever the thread count. Throws Cancelled.
BodyPartSeen body_part_of(const grid::HuVolume& volume, const Progress& progress = {});

/// Adds what is seen to the report. Throws Error 80, or where params.refuse is false warns and reports is_expected
/// "unknown", where it is surely another part of the body than the expected one:
/// - for a head: lungs, or a spine alone; where only no cranial cavity is seen, it warns;
/// - for spine or chest: a head, and a scan that ends before a vertebra of which pedicles can be told, or a clavicle.
/// It is an early word: what it lets pass, the stages that look for the part may still refuse.
void judge_body_part(const grid::HuVolume& volume, const BodyPartParams& params, Report& report,
                     const Progress& progress = {});

}  // namespace trephine::look
