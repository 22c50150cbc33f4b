// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "base/params.h"
#include "base/progress.h"
#include "base/result.h"
#include "grid/grid.h"

namespace trephine::mask {

struct ShapeInterpolateParams {
  double thicker_than_mm = 1.6;
  double step_mm = 1.4;
  double reach_steps = 4;
  double thin_steps = 1;

  template <class V>
  static void describe(V& v) {
    using P = ShapeInterpolateParams;
    v.number(&P::thicker_than_mm, "thicker_than_mm", Range{0.2, 20},
             "Only fields whose slices lie farther apart than this, and 1.5 times as far as the voxels within a slice, "
             "get slices in between; others stay as they are.");
    v.number(&P::step_mm, "step_mm", Range{0.2, 10}, "Largest distance of slices afterwards.");
    v.number(&P::reach_steps, "reach_steps", Range{0.5, 20},
             "How far the outlines of neighbouring slices may lie apart to be joined by a slope, in steps of the "
             "slices; at wider ledges the grey values say where the surface lies.");
    v.number(
        &P::thin_steps, "thin_steps", Range{0, 10},
        "Where a shape, or the gap beside it, is thinner within the slice than twice this many steps of the slices "
        "(plates of bone, sulci), it is interpolated linearly, which keeps thin parts joined; counted up to the "
        "reach.");
  }
};

/// What is printed of it.
struct ShapeInterpolateResult {
  double slice_step_before_mm = 0;
  double slice_step_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = ShapeInterpolateResult;
    v.number(&P::slice_step_before_mm, "slice_step_before_mm", Range{}, "Distance of slices before.");
    v.number(&P::slice_step_mm, "slice_step_mm", Range{}, "Distance of slices.");
  }
};

/// Shape-based interpolation [Raya1990]: adds slices between the thick slices of a field, so that its surface has no
/// terraces where it is nearly parallel to the slices. The outline of every given slice stays where it is; between two
/// slices the surface runs smoothly from one outline to the next, because what is interpolated (by cubics that never
/// overshoot, [Fritsch1984]) is the distance to the outline within the slice and not the grey value, which changes only
/// at the outline. On ledges wider than the reach,
/// such as the vertex above the last slice that shows it, the grey values (the partial volume) place the surface.
///
/// The thick axis is found; the result has an odd number of steps for each given one, the given slices among them, the
/// field's frame, and half a given step more at both ends, so that a shape which the scan cuts ends where it did
/// before. It is cropped to the shape. Its unit is mm within the slice near thick parts.
///
/// What it cannot do: it draws no detail that lies between slices, and a surface seen in a single slice is a guess.
///
/// Where no slices are thick, the field itself is given, not a copy. Throws Error 65 where a value is not finite;
/// Cancelled.
Outcome<std::shared_ptr<const grid::Field>, ShapeInterpolateResult> shape_interpolate(
    const std::shared_ptr<const grid::Field>& field, const ShapeInterpolateParams& params,
    const Progress& progress = {});

/// The axis (0, 1, 2) whose steps are thick by `params`; -1 where none is.
int thick_axis(const grid::Lattice& lattice, const ShapeInterpolateParams& params);

/// How many steps of the result lie in one of the lattice along its thick axis: odd; 1 where none is thick.
int interpolated_steps(const grid::Lattice& lattice, const ShapeInterpolateParams& params);

}  // namespace trephine::mask
