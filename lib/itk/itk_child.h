// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "base/child.h"
#include "base/child_message.h"
#include "grid/grid.h"

namespace trephine::itk::itk_child {

/// ITK runs in a program of its own, trephine-itk, which lies beside ours and is started as a bounded child
/// (base/child.h) for one task. So no other program loads ITK, and a file or a volume that brings ITK down ends the
/// task alone.

/// Begins a request; both sides must be of one build, so it says which.
MessageWriter request();
/// Reads what request() wrote. Throws Error 70 where the other side is of another version.
MessageReader opened(const char* worker, std::string_view bytes);

/// Runs a worker of trephine-itk. Throws as run_child, and Error 70 where trephine-itk is not there.
ChildResult run(const char* worker, const MessageWriter& request, const ChildLimits& limits,
                const Progress& progress = {});

void put(MessageWriter& to, const grid::Grid<float>& grid);
/// Throws Error 70 where lattice and samples disagree.
grid::Grid<float> take_grid(MessageReader& from, const char* worker);

}  // namespace trephine::itk::itk_child
