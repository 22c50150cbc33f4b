// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/body_scan.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/parallel.h"

namespace trephine::phantom {
namespace {

constexpr double fwhm_per_sigma = 2.3548200450309493;
constexpr double max_step_mm = 0.5;  // across a slice

}  // namespace

Vec3 default_centre_mm() {
  const ScanParams fresh;
  return {fresh.centre_mm[0], fresh.centre_mm[1], fresh.centre_mm[2]};
}

itk::LinearMap lies_at(Vec3 origin_mm, const ScanParams& p) { return itk::then({Mat3(), origin_mm}, head_pose(p)); }

Scan scan_body(const HuAt& hu, const ScanParams& params, std::uint64_t seed, const Progress& progress,
               const Artefacts& artefacts) {
  Scan out;
  out.columns = params.columns_count, out.rows = params.rows_count;
  out.pixel_mm = pixel_spacing_mm(params);
  out.slices = slice_poses(params);
  out.padded = params.round_field;
  const std::size_t per_slice = std::size_t(out.columns) * std::size_t(out.rows);
  out.hu.resize(per_slice * out.slices.size());
  const double sigma_px = params.kernel_mm / fwhm_per_sigma / out.pixel_mm;
  const int across = std::max(1, int(std::ceil(params.slice_thickness_mm / max_step_mm)));
  std::atomic<int> done{0};
  parallel_for(0, params.slices_count, 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k) {
      progress.check();
      const SlicePose& pose = out.slices[std::size_t(k)];
      const Vec3 normal = normalized(cross(pose.row, pose.column));
      SliceImage image(out.columns, out.rows, -1000);
      for (int j = 0; j < out.rows; ++j)
        for (int i = 0; i < out.columns; ++i) {
          double sum = 0;
          for (int a = 0; a < across; ++a)
            sum += hu(out.position_mm(i, j, k) + normal * (((a + 0.5) / across - 0.5) * params.slice_thickness_mm),
                      out.pixel_mm);
          image.at(i, j) = float(sum / across);
        }
      blur(image, sigma_px);
      if (artefacts) artefacts(image, pose, out.pixel_mm);
      add_noise(image, sigma_px, params.noise_hu, seed, std::uint64_t(k));
      quantize(image, params.round_field, &out.hu[per_slice * std::size_t(k)]);
      progress.report(++done / double(params.slices_count));
    }
  });
  return out;
}

grid::Mask labelled(const Scan& scan, const std::function<int(Vec3 lps_mm)>& label) {
  grid::Mask mask(lattice_of(scan));
  parallel_for(0, mask.size[2], 1, [&](std::int64_t from, std::int64_t to) {
    for (int k = int(from); k < to; ++k)
      for (int j = 0; j < mask.size[1]; ++j)
        for (int i = 0; i < mask.size[0]; ++i)
          mask.at(i, j, k) = std::uint8_t(label(mask.to_world_mm({double(i), double(j), double(k)})));
  });
  return mask;
}

}  // namespace trephine::phantom
