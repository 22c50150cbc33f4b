// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "consistency/anatomy_gate.h"
#include "picture/slice.h"

namespace trephine::consistency {
namespace {

constexpr picture::Rgb marked{1, 1, 1}, dark{0, 0, 0};

/// A cross with a gap in its middle, so that the place itself stays seen.
void draw_cross(picture::Image& image, double x, double y) {
  const auto dot = [&](int px, int py, picture::Rgb colour) {
    if (px < 0 || py < 0 || px >= image.width || py >= image.height) return;
    for (int c = 0; c < 3; ++c) image.at(px, py)[c] = std::uint8_t(std::lround(colour[c] * 255));
  };
  const int cx = int(std::floor(x)), cy = int(std::floor(y));
  for (const int wide : {2, 0})
    for (int away = 6; away <= 22; ++away)
      for (int side = -1; side <= 1; side += 2)
        for (int w = -wide; w <= wide + (wide ? 0 : 1); ++w) {
          dot(cx + side * away, cy + w, wide ? dark : marked);
          dot(cx + w, cy + side * away, wide ? dark : marked);
        }
}

picture::Image view(const grid::HuVolume& volume, const std::vector<picture::OverlayShape>& shapes,
                    picture::SlicePlane plane, Vec3 place) {
  picture::SliceParams p;
  p.plane = plane;
  const int normal = picture::axis_of(plane);
  const auto range = picture::slice_range_mm(grid::lattice_of(volume), plane);
  p.position_mm = std::clamp(place[normal], range[0] + 1e-6, range[1] - 1e-6);
  p.longer_side_px = 640;
  p.window_center_hu = 40;
  p.window_width_hu = 300;
  p.fill_opacity = 0.05;
  picture::Image image = picture::slice_overlay(volume, p, shapes);
  const picture::SliceGeometry g = picture::slice_geometry(grid::lattice_of(volume), p);
  const Vec3 q = place - g.corner_mm;
  draw_cross(image, dot(q, g.right) / g.mm_per_px, dot(q, g.down) / g.mm_per_px);
  return image;
}

}  // namespace

std::string anatomy_picture(const grid::HuVolume& volume, const head::HeadFields& fields, const AnatomyFault& fault) {
  std::vector<picture::OverlayShape> shapes;
  const auto add = [&](const grid::Field* field, const char* name, picture::Rgb colour) {
    if (field) shapes.push_back({nullptr, colour, name, field});
  };
  add(fields.skin, "skin", {1, 0.65, 0.35});
  add(fields.skull, "skull", {1, 1, 0.4});
  add(fields.brain, "brain", {1, 0.35, 0.45});
  add(fields.ventricles, "ventricles", {0.3, 0.65, 1});
  return picture::encode_png(
      picture::contact_sheet({view(volume, shapes, picture::SlicePlane::axial, fault.place_mm),
                              view(volume, shapes, picture::SlicePlane::coronal, fault.place_mm),
                              view(volume, shapes, picture::SlicePlane::sagittal, fault.place_mm)},
                             3));
}

}  // namespace trephine::consistency
