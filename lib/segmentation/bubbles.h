// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"

namespace trephine::segmentation {

/// A ball from which a snake grows.
struct Bubble {
  Vec3 centre_mm;  ///< LPS
  double radius_mm = 0;
};

/// Reads "x,y,z,radius; x,y,z,radius": numbers in mm, with spaces allowed around them. Throws Error 64 where the text
/// has another form, a radius is not above 0, or a number is beyond 1e6.
std::vector<Bubble> parse_bubbles(const std::string& text);
/// Writes the balls in the same form, to 0.1 mm.
std::string to_text(const std::vector<Bubble>& bubbles);

/// Places up to `count` balls where the speed is above 0, away from its lattice's edge: the largest that fits, then the
/// largest whose centre lies outside all before, and so on while they reach min_radius_mm. The search uses voxels of 1
/// mm or more; the balls are nine tenths of what fits. Throws Error 80 where none fits, saying how large the largest
/// would be.
std::vector<Bubble> place_bubbles(const grid::Field& speed, int count, double min_radius_mm,
                                  const Progress& progress = {});

/// The union of the balls as a field in mm, positive inside, on the lattice. Throws Error 80, naming the ball by its
/// number from 1, where one holds no voxel centre because it lies outside the lattice or is smaller than its voxels.
grid::Field bubble_field(const std::vector<Bubble>& bubbles, const grid::Lattice& lattice);

/// Throws Error 80, naming the ball by its number from 1, where the speed is nowhere above 0 in a ball.
void check_bubbles(const std::vector<Bubble>& bubbles, const grid::Field& speed);

}  // namespace trephine::segmentation
