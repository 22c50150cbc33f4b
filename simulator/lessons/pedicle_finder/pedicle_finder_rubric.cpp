// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/pedicle_finder/pedicle_finder_rubric.h"

namespace trephine::lessons {

lesson::RubricType pedicle_finder_rubric() { return lesson::rubric_type<PedicleFinderRubric>("pedicle_finder"); }

}  // namespace trephine::lessons
