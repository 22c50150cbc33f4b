// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "cases/case.h"

namespace trephine::cases::detail {

/// Throws Error 70 naming the field where a value is not as its declaration says, or the manifest contradicts itself.
void check_manifest(const CaseManifest& manifest);

}  // namespace trephine::cases::detail
