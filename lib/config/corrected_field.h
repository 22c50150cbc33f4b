// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "config/config.h"

namespace trephine::config {

/// The step whose field a correction by hand of that anatomy changes, or has changed: "skull.segment". Empty where the
/// recipe has no such anatomy, or it has no field that could be corrected.
std::string corrected_field(const CaseConfig& config, const std::string& anatomy);

}  // namespace trephine::config
