// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "phantom/scan.h"

namespace trephine::phantom {

/// One slice in HU, and what the scanner does to it after the exposure.
struct SliceImage {
  SliceImage(int columns, int rows, float fill) : columns(columns), rows(rows), hu(std::size_t(columns) * rows, fill) {}
  int columns, rows;
  std::vector<float> hu;
  float& at(int i, int j) { return hu[std::size_t(j) * columns + i]; }
};

/// Gaussian blur in place, border pixels repeated outwards; nothing below 0.05 pixels.
void blur(SliceImage& image, double sigma_px);

/// Beam hardening: tissue in the middle of the field reads lower by up to `depth_hu`.
void add_cupping(SliceImage& image, const SlicePose& pose, double pixel_mm, double depth_hu);

/// Bright and dark rays from a metal filling, in slices that pass within 5 mm of it: a drawing of the artefact, not a
/// projection.
void add_streaks(SliceImage& image, const SlicePose& pose, double pixel_mm, Vec3 metal_mm, double height_hu,
                 std::uint64_t seed);

/// Beam hardening along a rod of metal, in slices that pass within 6 mm of it: tissue beyond its ends and beside it
/// reads lower by up to `depth_hu`: a drawing of the artefact, not a projection.
void add_dark_band(SliceImage& image, const SlicePose& pose, double pixel_mm, Vec3 from_mm, Vec3 to_mm,
                   double depth_hu);

/// Normal noise of that standard deviation, correlated as the kernel does.
void add_noise(SliceImage& image, double sigma_px, double noise_hu, std::uint64_t seed, std::uint64_t slice);

/// Adds `ratio` times what the image, already blurred by sigma_px, keeps beyond a kernel twice as wide.
void sharpen(SliceImage& image, double sigma_px, double ratio);

/// Noise of one scan as each of its kernels shows it: white noise of the rays that gives noise_hu through a Gaussian of
/// first_sigma_px, seen through one of sigma_px that is sharpened by `ratio`. A slice as thick as `slices_in_one` steps
/// is the mean over those, so that overlapping slices share noise.
void add_shared_noise(SliceImage& image, double first_sigma_px, double sigma_px, double ratio, double noise_hu,
                      double slices_in_one, std::uint64_t seed, int slice);

/// Rounds to the nearest integer within [-1024, 3071], the range of 12 bits; padding_hu outside the inscribed circle
/// where asked for.
void quantize(const SliceImage& image, bool round_field, std::int16_t* out);

}  // namespace trephine::phantom
