// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <vector>

#include "base/params.h"
#include "base/vec3.h"
#include "cases/case.h"

namespace trephine::meshio {

/// The points of a case as markups of 3D Slicer (slicer.readthedocs.io, developer guide, Markups; schema 1.0.3), LPS,
/// mm. Slicer reads one markup of a file, so each is a file of its own.

struct MarkupsParams {
  double trajectory_mm = 0;
  template <class V>
  static void describe(V& v) {
    v.number(&MarkupsParams::trajectory_mm, "trajectory_mm", Range{1, 300},
             "Length of a burr hole's trajectory from the bone inwards; 0: until it is abreast of the target that lies "
             "nearest to its axis, or 60 mm where the case has no target ahead within 20 mm of the axis.")
        .none_at_zero();
  }
};

struct MarkupPoint {
  std::string label, description;
  Vec3 position_mm;
};

/// A list of points, or, of two points, a line.
struct Markup {
  std::string name;  ///< of the file, before .mrk.json
  bool line = false;
  std::array<double, 3> colour_rgb{1, 0.5, 0.5};
  std::vector<MarkupPoint> points;
};

/// Landmarks ("landmarks"), targets ("targets") and one line for each burr hole ("trajectory-NAME"; its points are
/// NAME_entry, the middle of the hole on the bone's surface, and NAME_end, on the axis). What the case has none of is
/// left out. Descriptions say source and confidence, diameter, and how far beside the end the target lies.
std::vector<Markup> markups_of_case(const cases::CaseManifest& manifest, const MarkupsParams& params = {});

/// The file's bytes; cases::parse_slicer_markups reads the same positions back, bit for bit. Throws Error 70 where a
/// line has not two points.
std::string encode_slicer_markups(const Markup& markup);

}  // namespace trephine::meshio
