// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <vector>

namespace trephine {

/// A library or program that belongs to this program: the first of these paths, relative to the program's folder, at
/// which there is a file; empty where there is none. It is to be run with our rights, so whoever may put it there must
/// be able to act as us anyway: the file, its folder, and any link on the way belong to root or to the owner of the
/// program's file, and nobody else may write to them. Throws Error 70 naming file and folder where that is not so,
/// whatever lies at the other paths.
std::filesystem::path own_file(const std::vector<std::filesystem::path>& places);

}  // namespace trephine
