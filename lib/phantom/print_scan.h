// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/params.h"
#include "phantom/scan.h"
#include "print/print_record.h"
#include "surface/trimesh.h"

namespace trephine::phantom {

/// A printed head on the scanner, filled with gel, with a hole and a catheter in it.
struct PrintedParams {
  std::string print;
  double plastic_hu = 700, gel_hu = 35;
  std::array<double, 3> entry_mm{0, 0, 0}, tip_mm{0, 0, 0};
  double hole_mm = 0, catheter_mm = 2.5;
  template <class V>
  static void describe(V& v) {
    using P = PrintedParams;
    v.text(&P::print, "print",
           "NAME-print.json of a print (a format of `trephine export`): those parts are scanned, put together.");
    v.number(&P::plastic_hu, "print_plastic_hu", Range{-200, 3000}, "HU of what is printed.");
    v.number(&P::gel_hu, "print_gel_hu", Range{-200, 500}, "HU of the gel in it.");
    v.numbers(&P::entry_mm, "print_entry_mm", Range{-500, 500},
              "A place on the catheter's line outside of the bone, in the case's frame (LPS).");
    v.numbers(&P::tip_mm, "print_tip_mm", Range{-500, 500}, "Its tip. Where both are 0, there is no catheter.");
    v.number(&P::hole_mm, "print_hole_mm", Range{0, 25}, "Width of a hole through the bone along that line; 0: none.");
    v.number(&P::catheter_mm, "print_catheter_mm", Range{1, 5}, "Width of the catheter.");
  }
  bool has_catheter() const { return entry_mm != tip_mm; }
};

/// A part of the print as it is put together, in the parts' frame.
struct ScannedPart {
  std::string name;
  const surface::TriMesh* mesh = nullptr;
};

/// Scans the parts in the case's frame (the head's place in ScanParams turns and shifts them): each voxel of a raster
/// holds the shares of the parts (voxel/voxelize.h), gel where the skull holds it, water in the place of the
/// ventricles' core, which was dissolved, and air elsewhere. The same bytes whatever the thread count. Cancelled.
Scan scan_print(const print::PrintRecord& record, const std::vector<ScannedPart>& parts, const PrintedParams& params,
                const ScanParams& scan, std::uint64_t seed, const Progress& progress = {});

/// The same of files: `params.print` with the parts beside it. Throws Error 65 and 66 naming the file.
Scan scan_print(const PrintedParams& params, const ScanParams& scan, std::uint64_t seed, const Progress& progress = {});

}  // namespace trephine::phantom
