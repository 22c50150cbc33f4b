// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "desk/desk_library.h"
#include "desk/json_reply.h"

namespace trephine::desk {

/// What a file says of itself: the lines of comment at its begin but for commands, at most some 500 bytes.
std::string first_comment(const std::filesystem::path& file);

/// The scenes that lie beside the one of the case, in the order of their names: {file, as the configuration would say
/// it; about; cuts_holes; chosen}. Files that are no scene are left out.
Json scenes_of(const DeskLibrary& library, const DeskCase& one);

}  // namespace trephine::desk
