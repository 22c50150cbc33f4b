// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace trephine::haptics {

/// What a tool that takes up blood and water takes, and how near to a wound it does (ToolKind::takes_up).
constexpr double taken_ml_per_s = 3, takes_within_mm = 8;

}  // namespace trephine::haptics
