// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "base/params.h"
#include "base/progress.h"
#include "cases/load_case.h"
#include "page/page_notes.h"

namespace trephine::page {

struct PageParams {
  double max_mb = 6;

  template <class V>
  static void describe(V& v) {
    v.number(&PageParams::max_mb, "max_mb", Range{1, 1000},
             "Megabytes that the page should not exceed: the slices of the CT are shown on larger voxels, up to twice "
             "as large a side, until it is so small; the page says so.");
  }
};

/// The page of a case: one HTML file that shows its surfaces in 3D beside the slices, with its figures, and needs no
/// server, no network and no other file (docs/reference/case-page.md; web/ holds its script). Slices show the case's CT
/// where it has one, else the haptic volume. A shape without a surface of its own is contoured coarsely from the haptic
/// volume, and the page says so. Slices have at most 256 voxels a side, and fewer where the page would exceed `max_mb`;
/// it may exceed it all the same where surfaces, or slices on voxels twice as large, do. It holds nothing but what the
/// case and the notes hold. The same input gives the same bytes, whatever the thread count. Throws Error 70 where the
/// deviations are not one a point.
std::string make_case_page(const cases::LoadedCase& loaded, const PageNotes& notes, const PageParams& params = {},
                           const Progress& progress = {});

/// The same for a case on disk, with the notes that its report folder holds. Throws as load_case and read_page_notes
/// do.
std::string make_case_page(const std::filesystem::path& case_folder, const PageParams& params = {},
                           const Progress& progress = {});

/// What the page needs, as directives of a content security policy: its own script and style, and nothing else.
std::string case_page_policy();

}  // namespace trephine::page
