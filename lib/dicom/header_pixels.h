// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "dicom/elements.h"
#include "dicom/header.h"

namespace trephine::dicom {

/// Whether the pixel data that the header tells of can be read as it tells: their shape, that the file holds them, and
/// in a compressed file which fragments belong to which frame. `representation` is PixelRepresentation, -1 where the
/// file has none. Fills is_signed, fragments and frame_fragments; the first thing that is wrong is added to the
/// header's faults. Reads the fragments' lengths and the offset table, no pixels.
void check_pixels(FileHeader& header, ByteSource& source, int representation);

}  // namespace trephine::dicom
