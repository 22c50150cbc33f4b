// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "lessons/spine/five_errors_rubric.h"

namespace trephine::lessons {

/// The finder alone: the exercise of group B.
struct PedicleFinderRubric : FiveErrorsRubric {
  std::string module;
  template <class V>
  static void describe(V& v) {
    v.word(&PedicleFinderRubric::module, "module", {"pedicle_finder"}, "The lesson that it scores.").is_required();
    v.template all_of<FiveErrorsRubric>();
  }
};

}  // namespace trephine::lessons
