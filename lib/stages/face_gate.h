// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "stages/stage.h"

namespace trephine {

/// Acceptance P4 over what a case is about to publish (segmentation/face_gate.h). Ports: skin (of the scan as it came),
/// landmarks (found in it), "surface.*", haptic. Its report says how near they come to the face; nearer than 5 mm
/// is 81.
StageType face_gate_stage();

}  // namespace trephine
