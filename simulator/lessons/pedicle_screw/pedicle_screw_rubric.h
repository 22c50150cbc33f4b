// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/spine/five_errors_rubric.h"

namespace trephine::lessons {

/// The open exercise of group C.
struct PedicleScrewRubric : FiveErrorsRubric {
  std::string module;
  template <class V>
  static void describe(V& v) {
    v.word(&PedicleScrewRubric::module, "module", {"pedicle_screw"}, "The lesson that it scores.").is_required();
    v.template all_of<FiveErrorsRubric>();
  }
};

}  // namespace trephine::lessons
