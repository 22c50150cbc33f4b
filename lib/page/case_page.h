// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "base/progress.h"
#include "cases/load_case.h"
#include "page/page_notes.h"

namespace trephine {

/// The page of a case: one HTML file that shows its surfaces in 3D beside the slices, with its figures, and needs no
/// server, no network and no other file (docs/case-page.md; web/ holds its script). Slices show the case's CT where it
/// has one, else the haptic volume. A shape without a surface of its own is contoured coarsely from the haptic volume,
/// and the page says so. It holds nothing but what the case and the notes hold. The same input gives the same bytes,
/// whatever the thread count. Throws Error 70 where the deviations are not one a point.
std::string make_case_page(const LoadedCase& loaded, const PageNotes& notes, const Progress& progress = {});

/// The same for a case on disk, with the notes that its report folder holds. Throws as load_case and read_page_notes
/// do.
std::string make_case_page(const std::filesystem::path& case_folder, const Progress& progress = {});

}  // namespace trephine
