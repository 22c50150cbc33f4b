// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine_needle/spine_needle_rubric.h"

namespace trephine::lessons {

lesson::RubricType spine_needle_rubric() { return lesson::rubric_type<SpineNeedleRubric>("spine_needle"); }

}  // namespace trephine::lessons
