// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "haptics/frame.h"
#include "native/binding.h"

namespace trephine::python {

/// Ticks as rows of an array with the names of ServoFrame.
py::array array_of_frames(std::vector<haptics::ServoFrame> frames);
py::array array_of_frame(const haptics::ServoFrame& frame);

}  // namespace trephine::python
