// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/pedicle_screw/pedicle_screw_rubric.h"

namespace trephine::lessons {

lesson::RubricType pedicle_screw_rubric() { return lesson::rubric_type<PedicleScrewRubric>("pedicle_screw"); }

}  // namespace trephine::lessons
