// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "outcome/measure_outcome.h"

namespace trephine::outcome {

/// measure_outcome() of a chest: its central lines. Throws as it does.
lesson::OutcomeRecord measure_chest(const cases::LoadedCase& loaded, const grid::HuVolume& scan,
                                    const OutcomeParams& params, const Progress& progress = {});

}  // namespace trephine::outcome
