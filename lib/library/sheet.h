// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "library/catalogue.h"

namespace trephine::library {

/// Writes contact_sheet.png and index.html into the library's folder: a thumbnail of every case (two pictures of its
/// report folder, of what sets the case apart and of an axial slice) and its figures. index.html lists the cases so
/// that they can be searched, filtered and sorted, and leads to their pages; it needs no server and no network, and
/// refers to the pictures where they lie. It holds only tokens, figures and warnings. Throws Error 66, 73 and 74.
void make_sheet(const std::filesystem::path& library);
bool has_sheet(const std::filesystem::path& library);

/// The case's pictures for an overview, as paths in the library: of what sets the case apart, and an axial slice; those
/// that are there.
std::vector<std::string> overview_pictures(const std::filesystem::path& library, const CaseRow& row);

/// The contents of the two files, of `count` cases that `row` reads by their place; they are read, painted and
/// forgotten some at a time, so that a library may have any number of cases. `row` is called from several threads.
struct Sheet {
  std::string png, html;
};
Sheet sheet_of(const std::filesystem::path& library, std::size_t count, const std::function<CaseRow(std::size_t)>& row);

}  // namespace trephine::library
