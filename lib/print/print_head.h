// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/progress.h"
#include "base/warning.h"
#include "cases/load_case.h"
#include "print/print_params.h"
#include "print/print_record.h"
#include "surface/trimesh.h"

namespace trephine::print {

/// A part with its surface, in the frame of the parts, where it belongs when all is put together.
struct PrintedPart {
  std::string name;
  std::array<double, 3> colour_rgb{0.8, 0.8, 0.8};
  surface::TriMesh mesh;
};

/// What was made of a case to be printed. The record lacks the files' names, the hash of the case and the program.
struct Printed {
  std::vector<PrintedPart> parts;
  PrintRecord record;
  Warnings warnings;
};

/// A head that can be printed: the skull above a flat cut with its registration marks, replaceable inserts at Kocher's
/// points, the ventricles on a stem, a base that closes the skull from below, and the lid of its pouring hole. Each
/// part is one piece with a valid surface (meshing/validity.h). Walls and gaps are measured on these surfaces and
/// nowhere taken for granted. No part is made of skin, and none of what lies below the cut. The same bytes whatever the
/// thread count.
///
/// Throws Error 65 where the case lacks what a part needs (a felt `skull`, `ventricles`, landmarks); 80 where a part
/// cannot be made so, or its measured wall or gap is below what was asked for; Cancelled.
Printed print_head(const cases::LoadedCase& loaded, const PrintParams& params, const Progress& progress = {});

/// The parts side by side on a plate at z = 0, as they are printed.
std::vector<PrintedPart> on_a_plate(std::vector<PrintedPart> parts);

}  // namespace trephine::print
