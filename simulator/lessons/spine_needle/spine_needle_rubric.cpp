// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine_needle/spine_needle_rubric.h"

namespace trephine {

RubricType spine_needle_rubric() {
  return {"spine_needle", [] { return AnyParams::make<SpineNeedleRubric>(); }};
}

}  // namespace trephine
