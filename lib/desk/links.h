// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "desk/desk_library.h"

namespace trephine::desk {

/// The desk reads and writes in the library and beside its configurations, and nowhere else: it follows no symbolic
/// link there, wherever it leads, for whoever put it there would choose what is read and overwritten.

/// Throws Error 65 where a link is, or lies in, the case's folder, what the library knows of it, or the desk's own
/// folder. An empty token asks for the library's own folders alone.
void require_no_links(const DeskOptions& options, const std::string& token);

/// The same of a folder, or file, and all that lies below. What is not there is none.
void require_no_links(const std::filesystem::path& place);

}  // namespace trephine::desk
