// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cases/load_case.h"
#include "lesson/outcome_record.h"
#include "picture/image.h"

namespace trephine::outcome {

/// Slices of the case's own CT through the surest course's tip and through its hole, with every course and hole on
/// them; of a spine through the middle of each screw, with the pedicles' ideal axes. Nothing of the second scan is in
/// it but these. Needs the case's CT; an image without pixels where nothing was found.
picture::Image outcome_picture(const cases::LoadedCase& loaded, const lesson::OutcomeRecord& record);

}  // namespace trephine::outcome
