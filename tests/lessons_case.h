// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the phantoms in which lessons are done have in common: cases of one haptic volume, made of plain shapes.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "case_samples.h"

namespace lesson_cases {

using namespace trephine;

/// The voxel of shapes whose numbers begin with 1, by how deep its centre lies in each of them (negative: outside).
/// What no other shape fills beside the first is empty.
template <std::size_t N>
std::int16_t voxel_of(const std::array<double, N>& depth_mm, double side_mm) {
  const auto filled = [&](std::size_t s) { return std::clamp(0.5 + depth_mm[s] / side_mm, 0.0, 1.0); };
  std::size_t best = 0;
  for (std::size_t s = 1; s < N; ++s)
    if (depth_mm[s] > depth_mm[best]) best = s;
  const int share = int(std::lround(255 * filled(best)));
  double others = 0;
  for (std::size_t s = 0; s < N; ++s)
    if (s != best) others += filled(s);
  const int bare = share < 255 && others < 0.9 * (1 - share / 255.0) ? voxel::haptic_bare_offset : 0;
  return share > 0 ? std::int16_t(1000 * (int(best) + 1) + bare + share) : std::int16_t(0);
}

/// A case that has this haptic volume, and no shape yet. The caller adds what is missing, and seals it.
inline case_samples::MemoryCase case_of(const std::string& token, const voxel::HapticVolume& volume) {
  case_samples::MemoryCase c;
  cases::CaseManifest& m = c.manifest;
  m.case_token = token;
  m.program_version = "trephine 0.1.0";
  m.input_sha256 = sha256_of_bytes("input");
  const std::string bytes = voxel::encode_haptic(volume);
  m.files.push_back(cases::describe_case_file("haptic", ".nrrd", bytes));
  m.haptic.file = m.files.back().name;
  c.files[m.haptic.file] = bytes;
  m.haptic.size = volume.voxels.size;
  m.haptic.spacing_mm = volume.voxels.spacing_mm;
  return c;
}

/// Adds a shape that is shown by the haptic volume itself.
inline void add_shape(cases::CaseManifest& m, const voxel::HapticShape& s, const char* material,
                      const cases::MaterialParams& values, bool cuttable, const std::array<double, 3>& colour_rgb) {
  cases::CaseShape shape;
  shape.name = s.name;
  shape.number = s.number;
  shape.window_low = s.window_low;
  shape.window_high = s.window_high;
  static_cast<cases::MaterialParams&>(shape.material) = values;
  shape.material.name = material;
  shape.cuttable = cuttable;
  shape.displayed = "haptic";
  m.haptic.shapes.push_back(shape);
  cases::CaseAnatomy a;
  a.name = s.name;
  a.colour_rgb = colour_rgb;
  m.anatomies.push_back(a);
}

/// The same in one of four colours, by its number.
inline void add_shape(cases::CaseManifest& m, const voxel::HapticShape& s, const char* material,
                      const cases::MaterialParams& values, bool cuttable) {
  const std::array<double, 3> colours[] = {
      {0.55, 0.65, 0.85}, {0.85, 0.65, 0.62}, {0.93, 0.89, 0.78}, {0.87, 0.68, 0.56}};
  add_shape(m, s, material, values, cuttable, colours[(s.number - 1) % 4]);
}

}  // namespace lesson_cases
