// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "base/params.h"
#include "contact/contact.h"

namespace trephine::device {

/// The task of a simulated hand: it comes from one side, presses on the first surface that it meets there, and moves
/// over it in a circle.
struct HandPathParams {
  enum class Task { own, circle, drill };
  Task hand_task = Task::own;
  std::string site = "kocher_right";
  double hole_diameter_mm = 14, layer_mm = 1, past_mm = 0.5, feed_force_n = 1, press_n = 0;
  std::array<double, 3> from{0, 0, 1};
  double depth_mm = 1, radius_mm = 15, approach_mm = 10;
  template <class V>
  static void describe(V& v) {
    using P = HandPathParams;
    v.choice(&P::hand_task, "hand_task", {{"own", Task::own}, {"circle", Task::circle}, {"drill", Task::drill}},
             "What the hand does; own: it drills a hole with --drill, else it moves in a circle.");
    v.text(&P::site, "site", "Landmark or burr hole of the case at which the hand drills.");
    v.number(&P::hole_diameter_mm, "hole_diameter_mm", Range{0.1, 60}, "Diameter of the hole that the hand drills.");
    v.number(&P::layer_mm, "layer_mm", Range{0.05, 10}, "Depth of each layer of the hand's spiral path.");
    v.number(&P::past_mm, "past_mm", Range{-5, 5}, "How far behind the inner table the path ends.");
    v.number(&P::feed_force_n, "feed_force_n", Range{0, 20},
             "Force above which the drilling hand waits before it goes on; 0: it never waits.");
    v.number(
        &P::press_n, "press_n", Range{0, 50},
        "Force with which the drilling hand presses on what it touches, however fast that gives way; 0: it follows "
        "its path, and presses as feed_force_n allows.");
    v.numbers(&P::from, "from", Range{-1, 1}, "Direction, LPS, from which the hand approaches the volume's centre.");
    v.number(&P::depth_mm, "depth_mm", Range{-50, 50}, "How far behind the surface the hand aims.");
    v.number(&P::radius_mm, "radius_mm", Range{0, 200}, "Radius of the circle that the hand follows.");
    v.number(&P::approach_mm, "approach_mm", Range{0, 200}, "Distance before the surface at which the hand begins.");
  }
};

struct HandPath {
  std::vector<Vec3> points_mm;
  std::size_t loop_from = 0;  ///< where the circle begins
  int shape = 0;              ///< the shape over which it moves
  Vec3 axis{0, 0, 1};         ///< of the tool
};

/// A hole through what is drilled (bit n: shape n): the tip goes in layers, each a spiral out or back, down to past_mm
/// behind the inner table. The tool stands across the outer surface. The hand first marks an incision above it.
/// Throws Error 64 where there is no such site, 65 where nothing to drill lies there.
HandPath drill_path(const contact::ContactVolume& contact, std::uint64_t drilled,
                    const std::vector<std::pair<std::string, Vec3>>& sites, double tool_radius_mm,
                    const HandPathParams& params);

/// Throws Error 78 where the direction is zero, or no touchable surface lies that way.
HandPath path_over(const contact::ContactVolume& contact, const contact::TouchableFaces& faces,
                   const HandPathParams& params);

}  // namespace trephine::device
