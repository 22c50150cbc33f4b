// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "report_of.h"
#include "segmentation/snake.h"
#include "segmentation_snake_shapes.h"

// Balls for a snake to find, and a snake that has run.
namespace trephine::segmentation_test {

constexpr Vec3 centre{0.2, -0.3, 0.4};

/// The speed of a shape of signed distance d (positive inside), its edge blurred.
inline double soft(double d) { return std::tanh(d); }

inline grid::Field ball_speed(const grid::Lattice& l, double radius) {
  return sampled(l, [&](Vec3 p) { return soft(radius - norm(p - centre)); });
}

struct Evolved {
  grid::Field field;
  Report report;
};

inline Evolved run(const grid::Field& speed, const segmentation::SnakeParams& p,
                   const segmentation::SnakeMasks& masks = {}) {
  Evolved r;
  r.field = value_of(r.report, segmentation::snake(speed, masks, p));
  for (const float v : r.field.voxels) EXPECT_TRUE(std::isfinite(v) && v != 0);
  return r;
}

inline std::string stopped_by(const Evolved& r) { return std::get<std::string>(*r.report.find("stopped_by")); }

inline double figure(const Evolved& r, const char* name) { return std::get<double>(*r.report.find(name)); }

}  // namespace trephine::segmentation_test
