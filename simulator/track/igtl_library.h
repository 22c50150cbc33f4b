// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "track/igtl/igtl_messages.h"

namespace trephine::track {

/// igtl_messages.so, loaded at the first call. Throws as own_library does.
const IgtlFunctions& igtl();

}  // namespace trephine::track
