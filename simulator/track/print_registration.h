// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "base/params.h"
#include "base/rigid_fit.h"
#include "lesson/mark_fit.h"
#include "lesson/print_record.h"
#include "track/tracking_file.h"

namespace trephine::track {

struct MarkParams {
  double tip_ball_mm = 0;  ///< of the tool that touches; its file has it
  double largest_touch_mm = 1.2, largest_marks_mm = 1, largest_target_mm = 3, largest_check_mm = 1.5;
  template <class V>
  static void describe(V& v) {
    using P = MarkParams;
    v.number(&P::largest_touch_mm, "largest_touch_mm", Range{0.05, 10},
             "Refuse a mark whose touched places lie farther off a sphere of its size, root mean square.");
    v.number(&P::largest_marks_mm, "largest_marks_mm", Range{0.05, 10},
             "Refuse a registration whose marks lie farther off, root mean square.");
    v.number(&P::largest_target_mm, "largest_target_mm", Range{0.05, 50},
             "Refuse one whose expected error, where the procedure aims, is larger.");
    v.number(&P::largest_check_mm, "largest_check_mm", Range{0.05, 50},
             "Refuse a tool whose tip, held on a mark, seems to lie farther off it.");
  }
};

/// A sphere of known size through places on it; without those that do not belong to it.
struct TouchedSphere {
  Vec3 middle_mm;
  double residual_mm = 0;
  double spread_ratio = 0;  ///< 1/3 where the whole sphere was touched, 0 where one place was
  std::size_t used = 0;
};
/// None where the places are fewer than ten, or say nothing of a sphere.
std::optional<TouchedSphere> touched_sphere(const std::vector<Vec3>& places_mm, double radius_mm);

/// The middle of a mark over which the tip was slid, in the reference's frame. `number` is how it is called in a
/// message. Throws Error 80 where it was touched on too small a part, or the places lie on no such sphere.
Vec3 mark_middle(const std::vector<Vec3>& tips_mm, double radius_mm, int number, const MarkParams& params);

struct PrintPlace {
  RigidMap reference_to_case;
  lesson::MarkFit fit;  ///< of the case into the reference's frame
  double left_out_mm = 0, target_error_mm = 0;
  std::vector<TrackedTarget> targets;
  std::vector<std::size_t> exchanged;  ///< those that were touched, from 0, of which another mark was asked for
};
/// How a print lies before its reference. `asked` and `middles_mm`: the marks that were asked for, by their place in
/// the record, and where each was found; which mark each really is follows from how they lie. Throws Error 80 where
/// fewer than four lie as the print's do, their mirror image fits better, the tracker's mm are none, or the errors are
/// too large; with what to do.
PrintPlace place_print(const lesson::PrintRecord& print, const std::vector<std::size_t>& asked,
                       const std::vector<Vec3>& middles_mm, const MarkParams& params);

/// How far the tip of a tool, held on a mark, seems to be off the nearest one: the print or a body has moved, or two
/// bodies were exchanged. `tip_mm` in the case's frame.
double check_off_mm(const lesson::PrintRecord& print, Vec3 tip_mm, double tip_ball_mm);

}  // namespace trephine::track
