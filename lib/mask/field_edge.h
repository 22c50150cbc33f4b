// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mask/hu_view.h"

namespace trephine::mask {

/// Where the scanned field ends within a body: at the rim of a round field of view, at the side of a block that was cut
/// out obliquely, or where a face was taken out before the scan was given away.
struct FieldEdge {
  static constexpr float tissue_above_hu = -300;
  /// What was not measured: regions of one and the same value (padding) that reach the volume's sides.
  BitMask padding;
  /// The voxels of tissue that have a face neighbour in it.
  BitMask tissue;
};

/// Finds it from the values alone, for tags are often missing. Padding is the commonest value below -500 HU on the
/// volume's six sides, where it fills whole neighbourhoods of at least 1 ml: air that was measured is noisy. Tissue is
/// what has more than tissue_above_hu. A surface that was measured has voxels of mixed values before the air; it counts
/// as the field's edge only where, in cells of about 4 mm, four fifths of the tissue's outermost voxels lie directly at
/// the padding. Of two values of padding in one volume the rarer one is not seen.
///
/// Both masks are empty where there is no padding, and where none can be told from air: where no air about the body, 4
/// mm and more from it, was measured (less than 3 % of all such air), because then all air may have been set to one
/// value. The volume's own sides are no padding; segmentation/scan_edge.h has the share of a shape's rim that is the
/// edge of a volume, of a round field by its geometry, or of padding by its value, where nobody needs to know where.
/// The result is the same whatever the thread count. Throws Cancelled.
FieldEdge field_edge(const HuView& hu, const Progress& progress = {});

}  // namespace trephine::mask
