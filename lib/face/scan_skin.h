// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "base/progress.h"
#include "grid/grid.h"
#include "surface/trimesh.h"
#include "voxel/haptic_volume.h"

namespace trephine::face {

/// What the numbers of a scan are: HU, or brightness as in an MR.
enum class ScanValues { hu, brightness };

/// The skin that a scan shows, measured from its values alone, whatever a recipe says of it: the outer surface of the
/// largest connected thing that is brighter than air, positive inside. Passages into it that are narrower than 20 mm
/// are closed, so that dark bone behind a nostril is not reached from outside; the outer surface stays where it is, but
/// for clefts. Of an MR the limit lies at a quarter of the way from its background to its tissue. Where the scan ends
/// within the body there is no skin.
///
/// On cells of about 2 mm; the surface lies within half a cell of where the scan has it. Nothing where all values are
/// alike. The result has the same bits whatever the thread count. Throws Cancelled.
std::optional<grid::Field> scan_skin(const grid::HuVolume& scan, ScanValues values, const Progress& progress = {});

/// Of how much of the skin there is a surface within 1.5 mm of it: the area. A surface that merely lies under the skin,
/// as bone does, shows none or little of it.
double skin_shown_cm2(const grid::Field& skin, const surface::TriMesh& mesh, const Progress& progress = {});
/// Of how much of the skin the volume's values differ between the eight voxels around it.
double skin_shown_cm2(const grid::Field& skin, const grid::HuVolume& volume, const Progress& progress = {});
double skin_shown_cm2(const grid::Field& skin, const voxel::HapticVolume& volume, const Progress& progress = {});

/// From this much on a thing shows the skin. A face has 300 cm2 and more; of bone under thin skin, as on the bridge of
/// the nose, it is a few.
constexpr double skin_is_shown_cm2 = 40;

}  // namespace trephine::face
