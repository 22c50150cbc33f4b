// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "haptics/recording.h"

namespace trephine::window {

/// Adds a dot to a way, where it is at least `apart_mm` from the last one. Where there are too many, every second dot
/// is removed and the distance doubles, so that a long way costs no more than a short one.
void add_dot(std::vector<Vec3>& way, Vec3 at, double& apart_mm);

/// Where the tool went in a recording, as dots. Of a lesson, which has several tools: that of the tool which was in
/// hand at its end, as far as it touched or was within something.
std::vector<Vec3> way_of(const haptics::Recording& recording);
/// The same of a file. Throws as read_recording does; 65 where it is of another case.
std::vector<Vec3> way_of(const std::filesystem::path& file, const std::string& case_token);

}  // namespace trephine::window
