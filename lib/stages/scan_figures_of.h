// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "mask/scan_figures.h"
#include "stages/stage.h"

namespace trephine::stages {

/// What measure_scan says of the volume at the port "volume", measured once in a run.
inline mask::ScanFigures scan_figures_of(const StageInputs& in, const Progress& progress) {
  return *in.once<mask::ScanFigures>("scan figures", {"volume"}, progress, [&] {
    return std::make_shared<const mask::ScanFigures>(mask::measure_scan(*in.get<grid::HuVolume>("volume"), progress));
  });
}

}  // namespace trephine::stages
