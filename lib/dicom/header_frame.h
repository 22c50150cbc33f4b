// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "dicom/header.h"
#include "dicom/header_tags.h"

namespace trephine::dicom {

/// A frame's tags as text; an absent tag is nullopt.
struct RawFrame {
  std::optional<std::string> position, orientation, spacing, slope, intercept, thickness;

  std::optional<std::string>* slot(std::uint32_t tag) {
    switch (tag) {
      case t_position:
        return &position;
      case t_orientation:
        return &orientation;
      case t_spacing:
        return &spacing;
      case t_slope:
        return &slope;
      case t_intercept:
        return &intercept;
      case t_thickness:
        return &thickness;
      default:
        return nullptr;
    }
  }
  void fill_from(const RawFrame& o) {
    if (!position) position = o.position;
    if (!orientation) orientation = o.orientation;
    if (!spacing) spacing = o.spacing;
    if (!slope) slope = o.slope;
    if (!intercept) intercept = o.intercept;
    if (!thickness) thickness = o.thickness;
  }
};

/// The frame that the tags tell of, as far as they are right; what is missing or wrong is added to `faults`. An image
/// that is no CT may lack slope and intercept.
Frame frame_of(const RawFrame& raw, bool ct, std::vector<TagFault>& faults);

}  // namespace trephine::dicom
