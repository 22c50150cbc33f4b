// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <filesystem>

#include "base/params.h"
#include "base/progress.h"
#include "grid/grid.h"
#include "itk/transform.h"
#include "phantom/head.h"

namespace trephine::phantom {

enum class SecondScan { none, mr, ct, cta };

/// Parameters of another scan of the same head, taken on another day: turned and shifted.
struct SecondScanParams {
  SecondScan contrast = SecondScan::none;
  double voxel_mm = 1;
  std::array<double, 3> turn_deg{0, 0, 0}, shift_mm{0, 0, 0};
  double noise_ratio = 0.03, bias_ratio = 0.2;
  std::int64_t scan_seed = 1;

  template <class V>
  static void describe(V& v) {
    using P = SecondScanParams;
    v.choice(&P::contrast, "second_scan",
             {{"none", SecondScan::none}, {"mr", SecondScan::mr}, {"ct", SecondScan::ct}, {"cta", SecondScan::cta}},
             "Another scan of the head, as second/scan.nrrd: T1-weighted MR in sagittal slices, or a CT, or at "
             "level hard a CT angiography, whether the first scan has contrast agent or not.");
    v.number(&P::voxel_mm, "second_voxel_mm", Range{0.3, 10}, "Its voxels' size along each axis.");
    v.numbers(&P::turn_deg, "second_turn_deg", Range{-180, 180},
              "How the patient lies in it: turned about x, y, then z through the middle of the head.");
    v.numbers(&P::shift_mm, "second_shift_mm", Range{-200, 200}, "And shifted by that.");
    v.number(&P::noise_ratio, "second_noise_ratio", Range{0, 1},
             "Standard deviation of its noise: of MR as a share of white matter (Rician), of CT times 1000 HU.");
    v.number(&P::bias_ratio, "second_bias_ratio", Range{0, 0.9},
             "How much brighter and darker the coil makes parts of an MR scan.");
    v.integer(&P::scan_seed, "second_seed", Range{0, 2147483647}, "Number of its noise, bias and raster.");
  }
};

struct Second {
  grid::Grid<std::int16_t> volume;  ///< MR: white matter about 1000; CT: HU
  itk::LinearMap truth;             ///< from a place of the head to the same place in the second scan's frame
};

/// Scans the head. A voxel is the mean over 2 x 2 x 2 points where a tissue ends within it. The box of 200 x 230 x 240
/// mm about the head lies on the raster by chance. Same bytes for the same parameters. Contrast must not be none.
/// Throws Error 64 for an angiography at another level than hard, which has no vessels.
Second second_scan(const Head& head, const SecondScanParams& params, const Progress& progress = {});

/// Writes folder/scan.nrrd and folder/truth.tfm, the transform that a registration of the second scan onto the first
/// should find. Throws 73 and 74 as FileWriter.
void write_second_scan(const std::filesystem::path& folder, const Second& second);

}  // namespace trephine::phantom
