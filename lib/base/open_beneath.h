// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

namespace trephine {

/// Opens `relative` for reading so that what is opened lies beneath `folder`, whatever links and ".." there are and
/// whoever exchanges them meanwhile (openat2 with RESOLVE_BENEATH; where the kernel has none, part by part, and then no
/// link is followed). An absolute link is refused even if it leads beneath the folder. Returns a descriptor for the
/// caller to close, or -1 with errno: EXDEV where it leads out, ELOOP for links in a circle. A FIFO does not block.
int open_beneath(const std::filesystem::path& folder, const std::filesystem::path& relative);

}  // namespace trephine
