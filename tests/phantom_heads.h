// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Synthetic heads and their scans as several tests use them: whose head, how it is scanned, and what is true of it.
#include "head/head_landmarks.h"
#include "phantom/head.h"
#include "phantom/phantom.h"

namespace trephine::phantom_heads {

inline phantom::Head head_of(phantom::Level level, int seed, phantom::Variant variant = phantom::Variant::normal) {
  phantom::HeadParams who;
  who.level = level;
  who.seed = seed;
  who.variant = variant;
  return phantom::Head(who);
}

/// Slices without gaps that are so high together.
inline phantom::ScanParams scan_of(int pixels, int slices, double noise_hu, double height_mm = 192,
                                   double field_of_view_mm = 240) {
  phantom::ScanParams how;
  how.columns_count = how.rows_count = pixels;
  how.field_of_view_mm = field_of_view_mm;
  how.slices_count = slices;
  how.slice_step_mm = how.slice_thickness_mm = height_mm / slices;
  how.noise_hu = noise_hu;
  how.subvoxel_mm = std::max(how.subvoxel_mm, 0.5 * field_of_view_mm / pixels);  // two pieces along a pixel
  return how;
}

/// The landmarks by which a face is found, where they truly are.
inline head::HeadLandmarks face_landmarks(const phantom::Head& head, double confidence = 1,
                                          const char* source = "truth") {
  head::HeadLandmarks l;
  for (const char* name : {"nasion", "tragus_left", "tragus_right"})
    l.landmarks.push_back({name, head.landmark(name), confidence, source});
  return l;
}

}  // namespace trephine::phantom_heads
