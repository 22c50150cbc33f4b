// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <random>
#include <string>

#include "base/error.h"
#include "pacs/label_objects.h"
#include "pacs/object.h"

namespace trephine::pacs_samples {

/// Slices of 37 x 29 pixels, whose count is no multiple of 8, at these heights over each other; tilted where `lean` is
/// not 0: each slice is moved along its rows' direction by that share of its height.
inline pacs::SliceSet slices_at(const std::vector<double>& heights_mm, double lean = 0) {
  pacs::SliceSet s;
  s.columns = 37;
  s.rows = 29;
  s.dx_mm = 0.7;
  s.dy_mm = 0.9;
  s.thickness_mm = 2;
  for (const double h : heights_mm) s.origins_mm.push_back({-11.25, -13.5 + lean * h, 40 + h});
  return s;
}
inline const std::vector<double> uniform_mm{0, 2, 4, 6, 8, 10, 12, 14, 16, 18};
inline const std::vector<double> uneven_mm{0, 1, 2, 3, 4, 6, 8, 10, 12.5, 16};

inline pacs::CaseIdentity identity() {
  return pacs::identity_of_case("head-01", std::string(64, 'a'), "trephine test");
}

/// Pixels by chance; none on every fourth slice.
inline pacs::Segment noise(const std::string& name, const pacs::SliceSet& s, unsigned seed) {
  std::mt19937 random(seed);
  pacs::Segment out{name, {0.25, 0.5, 0.9}, pacs::SliceBits(s.origins_mm.size())};
  for (std::size_t k = 0; k < out.bits.size(); ++k) {
    if (k % 4 == seed % 4) continue;
    std::vector<std::uint8_t> pixels(s.pixels());
    for (std::uint8_t& p : pixels) p = random() % 3 == 0;
    out.bits[k] = pacs::packed(pixels);
  }
  return out;
}

inline pacs::LabelObject decoded(const std::string& bytes) {
  return pacs::decode_label_object(dicom::Origin::memory(bytes));
}

inline std::string fault_of(const std::string& bytes) {
  try {
    decoded(bytes);
  } catch (const Error& e) {
    return std::to_string(int(e.code())) + " " + e.field() + ": " + e.message().text();
  }
  return "";
}

}  // namespace trephine::pacs_samples
