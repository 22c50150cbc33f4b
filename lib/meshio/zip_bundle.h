// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "meshio/export_mesh.h"

namespace trephine::meshio {

/// A ZIP archive with these files in one folder, as 3D Slicer's bundles (.mrb) are, or without one where it is empty:
/// names may hold a further folder ("Data/skull.vtp"). Times are the first of January 1980, so that the same files give
/// the same bytes. Throws Error 70 where libzip cannot make it.
std::string bundle_of(const std::string& folder, const std::vector<ExportFile>& files);

}  // namespace trephine::meshio
