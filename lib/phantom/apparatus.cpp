// SPDX-License-Identifier: GPL-3.0-or-later
#include "phantom/apparatus.h"

#include <algorithm>

namespace trephine::phantom {
namespace {

// Sheets of polycaprolactone and the blocks' plastic are about as dense as water; the couch is carbon fibre on foam.
constexpr double air = -1000, sheet_hu = 30, plate_core_hu = -455, plate_skin_hu = -60, cradle_hu = -60, foam_hu = -962,
                 rest_skin_hu = -700, block_hu = 140, rail_hu = 1500, marker_hu = 2800;
constexpr double board_hu = -40, board_mm = 18, board_nearer_mm = 8.6;  // than the couch: the head lies on it
constexpr double sheet_mm = 2.0, hole_mm = 2.1, lattice_mm = 6.4, lowest_mask_mm = -100;
constexpr double behind_mm = 4;          // behind this place the sheets go straight on
constexpr double narrowing = 0.0018;     // for each mm towards the blocks
constexpr double row_ratio = 0.8660254;  // of a triangular lattice

struct Layers {
  double width, hu = air, clearance = 1e3;
  Thing thing = Thing::none;
  void lay(double tissue, double f, Thing what, double slope = 1) {
    clearance = std::min(clearance, std::fabs(f) / slope);
    hu += (tissue - hu) * std::clamp(0.5 - f / width, 0.0, 1.0);
    if (f < 0) thing = what;
  }
};

double box(Vec3 p, Vec3 low, Vec3 high) {
  return std::max({low.x - p.x, p.x - high.x, low.y - p.y, p.y - high.y, low.z - p.z, p.z - high.z});
}

/// The mask's distance to the middle of the nearest hole, in mm along the sheet: the holes lie on a triangular lattice
/// over each face of a cube around the head.
double from_hole(Vec3 p) {
  const Vec3 d = p - Vec3{0, -5, 25};
  const double ax = std::fabs(d.x), ay = std::fabs(d.y), az = std::fabs(d.z);
  double u, v;
  if (az >= ax && az >= ay)
    u = 100 * std::atan2(d.x, az), v = 100 * std::atan2(d.y, az);
  else if (ay >= ax)
    u = 85 * std::atan2(d.x, ay), v = d.z;
  else
    u = d.y, v = d.z;
  double best = 1e3;
  const double row = std::floor(v / (lattice_mm * row_ratio));
  for (double r = row; r <= row + 1; r += 1) {
    const double shift = std::fmod(std::fabs(r), 2) == 1 ? 0.5 : 0.0;
    const double x = (u / lattice_mm - shift) - std::round(u / lattice_mm - shift);
    best = std::min(best, std::hypot(x * lattice_mm, v - r * lattice_mm * row_ratio));
  }
  return best;
}

void lay_mask(Layers& out, const Model& model, Vec3 p) {
  const double end = model.hard.couch_mm - (model.hard.is.clamps ? 1.0 : -40.0);
  const double bounds = std::max(lowest_mask_mm - p.z, p.y - end);
  if (bounds > 12) return void(out.clearance = std::min(out.clearance, bounds));
  Vec3 q = p;
  if (p.y > behind_mm) {
    q.y = behind_mm;
    q.x *= 1 + narrowing * (p.y - behind_mm);
  }
  const double lift = std::max(0.0, 0.7 + 1.2 * std::sin(q.x / 17 + model.phase[0]) * std::sin(q.z / 14 + q.y / 23));
  const double sheet = std::fabs(mask_envelope(model, q) - lift - 0.5 * sheet_mm) - 0.5 * sheet_mm;
  double f = std::max(sheet, bounds);
  out.clearance = std::min(out.clearance, std::max(0.0, f) / 1.3);
  if (f > out.width) return;
  if (p.y < end - 45)
    f = std::max(f, hole_mm - from_hole({q.x, p.y, p.z}));  // plates without holes where it is clamped
  out.lay(sheet_hu, f, Thing::mask);
  for (const Model::Ball& ball : model.hard.markers)
    if (model.hard.is.clamps)
      out.lay(marker_hu, sphere(PointD{p.x, p.y, p.z}, ball.centre, ball.radius), Thing::marker);
}

void lay_couch(Layers& out, const Model& model, Vec3 p) {
  const double top = model.hard.couch_mm;
  // The head rest is hollowed out, with a skin about the foam.
  const double hollow = top - 7 - std::min(38.0, p.x * p.x / 150);
  const double rest = std::max({hollow - p.y, p.y - top, std::fabs(p.x) - 82, std::fabs(p.z - 15) - 78});
  out.lay(rest_skin_hu, rest, Thing::head_rest, 1.5);
  out.lay(foam_hu, rest + 1.2, Thing::head_rest, 1.5);
  out.lay(plate_skin_hu, box(p, {-265, top, -1e3}, {265, top + 15, 1e3}), Thing::couch);
  out.lay(plate_core_hu, box(p, {-262, top + 1, -1e3}, {262, top + 12.5, 1e3}), Thing::couch);
  const double r = std::hypot(p.x, p.y - (top + 56 - 320));
  out.lay(cradle_hu, std::max(std::fabs(r - 320) - 1.3, top + 16 - p.y), Thing::couch);
  for (const double x : {70.0, 88.0}) {
    const double y = top + 56 - 320 + std::sqrt(320.0 * 320.0 - x * x);
    out.lay(rail_hu, std::hypot(p.x - x, p.y - y) - 1.4, Thing::couch);
  }
}

}  // namespace

double mask_envelope(const Model& model, Vec3 lps) {
  const auto base = model.base(PointD{lps.x, lps.y, lps.z}, true);
  double f = model.skin(base);
  if (f < -20 || f > 60) return f;
  const PointD& m = base.m;
  double bridge = capsule(m, {0, -92, 34}, {0, -113 - 8 * (model.nose - 1), -10}, 7, 5);
  bridge = smooth_union(bridge, capsule(m, {0, -113, -10}, {0, -95, -76}, 5, 12), 10);
  f = smooth_union(f, bridge, 26);
  return smooth_union(f, ellipsoid(m, {69, 8, 2}, {15, 26, 36}), 12);
}

ApparatusSample apparatus_at(const Model& model, Vec3 p, double width_mm) {
  Layers out{width_mm};
  const HardParams& is = model.hard.is;
  if (is.couch) lay_couch(out, model, p);
  if (is.clamps)
    for (const double side : {-1.0, 1.0}) {
      const Vec3 q{side * p.x, p.y, p.z};
      const double top = model.hard.couch_mm;
      out.lay(block_hu, box(q, {62, top - 13, -95}, {90, top, 130}), Thing::clamp);
    }
  if (is.board) {
    const double top = model.hard.couch_mm - board_nearer_mm;
    out.lay(board_hu, box(p, {-200, top, -1e3}, {200, top + board_mm, 1e3}), Thing::board);
  }
  if (is.mask) lay_mask(out, model, p);
  return {out.hu, out.clearance, out.thing};
}

}  // namespace trephine::phantom
