// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "modules/move_plan.h"

namespace trephine {

/// What a script asks of the hand in a head. Throws Error 65, naming the step, for a place that the case does not have,
/// a tool that the lesson does not have, or skin that cannot be felt there.
std::vector<HandMove> plan_head_moves(const LessonScript& script, const ScriptScene& scene, const ScriptAim& aim);

}  // namespace trephine
