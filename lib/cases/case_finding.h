// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/vec3.h"
#include "cases/case_values.h"

namespace trephine::cases {

/// Something that a person should look at before the case is used. It is measured, and nothing is diagnosed.
struct CaseFinding {
  std::string kind, where, side;
  Vec3 position_mm;
  double confidence = 0;
  std::vector<std::string> concerns;
  std::string text;
  CaseValues figures;
  template <class V>
  static void describe(V& v) {
    using P = CaseFinding;
    v.text(&P::kind, "kind",
           "What it is: `dense_tissue`, `dark_tissue`, `midline_shift`, `wide_ventricles`, `bone_gap`, `metal`, "
           "`tube`; `other_patient`: a whole further scan, which may not be of this patient.")
        .of_form(some_text);
    v.text(&P::where, "where", "Where it lies, in words.").of_form(some_text);
    v.word(&P::side, "side", {"left", "right", "middle"}, "The patient's side.");
    v.numbers(&P::position_mm, "position_mm", case_range::finite, "Its middle.");
    v.number(&P::confidence, "confidence", case_range::share,
             "How sure it is that it is nothing usual; below 0.5 it is doubtful.");
    v.list(&P::concerns, "concerns", "The anatomies that may be wrong because of it.");
    v.text(&P::text, "text", "A sentence that says it.").of_form(some_text);
    v.map(&P::figures, "figures",
          "What was measured: `volume_ml`, `longest_mm`, `mean_hu`, `area_cm2`, `shift_mm`, ...")
        .not_always();
  }
};

}  // namespace trephine::cases
