// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "base/error.h"

namespace trephine {
/// "case: file: field: what". Without the case for who shows it beside the case's name.
std::string error_text(const Error& error, bool with_case = true);
}  // namespace trephine
