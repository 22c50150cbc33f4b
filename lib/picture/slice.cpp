// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/slice.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "picture/stroke.h"
#include "surface/bounds.h"
#include "surface/plane_cut.h"

namespace trephine::picture {
namespace {

constexpr Rgb outside{0.03, 0.05, 0.11}, ink{0.93, 0.95, 0.97}, halo{0, 0, 0};

struct PlaneAxes {
  int normal;
  Vec3 right, down;
  const char *name, *letter;  // of the plane, and of the coordinate along its normal
  const char *at_left, *at_right, *at_top, *at_bottom;
};

const PlaneAxes& axes_of(SlicePlane plane) {
  static const PlaneAxes axial{2, {1, 0, 0}, {0, 1, 0}, "axial", "z", "R", "L", "A", "P"};
  static const PlaneAxes coronal{1, {1, 0, 0}, {0, 0, -1}, "coronal", "y", "R", "L", "S", "I"};
  static const PlaneAxes sagittal{0, {0, 1, 0}, {0, 0, -1}, "sagittal", "x", "A", "P", "S", "I"};
  return plane == SlicePlane::axial ? axial : plane == SlicePlane::coronal ? coronal : sagittal;
}

// Interpolates trilinearly. Up to half a voxel beyond the outermost centres, their values hold. Returns false outside.
template <class T>
bool sample(const grid::Grid<T>& g, Vec3 index, double& hu) {
  int low[3], high[3];
  double t[3];
  for (int a = 0; a < 3; ++a) {
    if (!(index[a] >= -0.5 && index[a] <= g.size[a] - 0.5)) return false;
    const double v = std::clamp(index[a], 0.0, g.size[a] - 1.0);
    low[a] = static_cast<int>(v);
    high[a] = std::min(low[a] + 1, g.size[a] - 1);
    t[a] = v - low[a];
  }
  const auto line = [&](int j, int k) { return g.at(low[0], j, k) * (1 - t[0]) + g.at(high[0], j, k) * t[0]; };
  const auto face = [&](int k) { return line(low[1], k) * (1 - t[1]) + line(high[1], k) * t[1]; };
  hu = face(low[2]) * (1 - t[2]) + face(high[2]) * t[2];
  return true;
}

template <class T>
void draw_volume(const grid::Grid<T>& g, const SliceGeometry& geometry, const SliceParams& p, Image& image) {
  const double low = p.window_center_hu - p.window_width_hu / 2;
  const auto index = [&](double x, double y) { return g.to_index(geometry.to_world_mm(x, y)); };
  const Vec3 first = index(0.5, 0.5), right = index(1.5, 0.5) - first, down = index(0.5, 1.5) - first;
  parallel_for(0, image.height, 16, [&](std::int64_t from, std::int64_t to) {
    for (int y = static_cast<int>(from); y < to; ++y)
      for (int x = 0; x < image.width; ++x) {
        double hu = 0;
        if (!sample(g, first + right * x + down * y, hu)) continue;
        const double v = std::clamp((hu - low) / p.window_width_hu, 0.0, 1.0) * 255;
        std::fill_n(image.at(x, y), 3, static_cast<std::uint8_t>(v + 0.5));
      }
  });
}

struct Segment {
  double x0, y0, x1, y1;  // pixels
};

std::vector<Segment> cut(const surface::TriMesh& mesh, const SliceGeometry& g, int normal, double position) {
  std::vector<Segment> out;
  const double k = 1 / g.mm_per_px;
  Vec3 point, axis;
  point[normal] = position;
  axis[normal] = 1;
  for (const auto& [from, to] : surface::plane_cut(mesh, point, axis)) {
    const Vec3 a = from - g.corner_mm, b = to - g.corner_mm;
    out.push_back({dot(a, g.right) * k, dot(a, g.down) * k, dot(b, g.right) * k, dot(b, g.down) * k});
  }
  return out;
}

// The lines where the field crosses 0 between pixels, by marching squares. Outside of its lattice, and on the picture's
// border, nothing counts as inside: so every line is closed, and what it encloses can be filled.
std::vector<Segment> cut(const grid::Field& field, const SliceGeometry& g) {
  const std::size_t row = std::size_t(g.width) + 1;
  std::vector<float> values(row * (std::size_t(g.height) + 1));
  parallel_for(0, g.height + 1, 16, [&](std::int64_t from, std::int64_t to) {
    for (std::int64_t y = from; y < to; ++y)
      for (int x = 0; x <= g.width; ++x) {
        double v = -1;
        const bool at_border = x == 0 || x == g.width || y == 0 || y == g.height;
        if (at_border || !sample(field, field.to_index(g.to_world_mm(x, double(y))), v)) v = -1;
        values[std::size_t(y) * row + std::size_t(x)] = float(v);
      }
  });
  std::vector<Segment> out;
  for (int y = 0; y < g.height; ++y)
    for (int x = 0; x < g.width; ++x) {
      const float* at = &values[std::size_t(y) * row + std::size_t(x)];
      const float corner[4] = {at[0], at[1], at[row + 1], at[row]};
      const double px[4] = {x + 0.0, x + 1.0, x + 1.0, x + 0.0}, py[4] = {y + 0.0, y + 0.0, y + 1.0, y + 1.0};
      double ends[4][2];
      int found = 0;
      for (int e = 0; e < 4; ++e) {
        const int f = (e + 1) % 4;
        if ((corner[e] > 0) == (corner[f] > 0)) continue;
        const double t = double(corner[e]) / (double(corner[e]) - corner[f]);
        ends[found][0] = px[e] + (px[f] - px[e]) * t;
        ends[found][1] = py[e] + (py[f] - py[e]) * t;
        ++found;
      }
      for (int e = 0; e + 1 < found; e += 2) out.push_back({ends[e][0], ends[e][1], ends[e + 1][0], ends[e + 1][1]});
    }
  return out;
}

// The inside of the lines by the even-odd rule, one row at a time. Pixels that a line crosses are covered in part.
void fill(Image& image, const std::vector<Segment>& segments, Rgb colour, double opacity) {
  constexpr int sub_rows = 4;
  std::vector<std::vector<double>> crossings(std::size_t(image.height) * sub_rows);
  for (const auto& s : segments) {
    const double y0 = s.y0 * sub_rows - 0.5, y1 = s.y1 * sub_rows - 0.5;
    const int first = static_cast<int>(std::ceil(std::clamp(std::min(y0, y1), -1.0, 1e6)));
    const int last = static_cast<int>(std::ceil(std::clamp(std::max(y0, y1), -1.0, 1e6)));
    for (int r = std::max(0, first); r < std::min<int>(last, static_cast<int>(crossings.size())); ++r)
      crossings[r].push_back(s.x0 + (s.x1 - s.x0) * (r - y0) / (y1 - y0));
  }
  std::vector<double> cover(image.width);
  for (int y = 0; y < image.height; ++y) {
    std::fill(cover.begin(), cover.end(), 0.0);
    for (int r = y * sub_rows; r < (y + 1) * sub_rows; ++r) {
      auto& xs = crossings[r];
      std::sort(xs.begin(), xs.end());
      for (std::size_t i = 0; i + 1 < xs.size(); i += 2) {
        const double a = std::clamp(xs[i], 0.0, double(image.width)),
                     b = std::clamp(xs[i + 1], 0.0, double(image.width));
        for (int x = static_cast<int>(a); x < std::min(image.width, static_cast<int>(std::ceil(b))); ++x)
          cover[x] += (std::min(b, x + 1.0) - std::max(a, double(x))) / sub_rows;
      }
    }
    for (int x = 0; x < image.width; ++x)
      if (cover[x] > 0) detail::blend_pixel(image.at(x, y), colour, std::min(1.0, cover[x]) * opacity);
  }
}

constexpr double legend_step = 1.75;  ///< of its lines, in the text's heights

// Beside the picture, so that it covers nothing of it. Images without names stay as they are.
void add_legend(Image& image, const std::vector<OverlayShape>& shapes, double text_px) {
  int width = 0, lines = 0;
  for (const OverlayShape& s : shapes)
    if (!s.name.empty()) width = std::max(width, text_width(s.name, text_px)), ++lines;
  if (lines == 0) return;
  const int strip = static_cast<int>(std::ceil(width + text_px * 3.6));
  const int height = std::max(image.height, static_cast<int>(std::ceil(text_px * (1 + legend_step * lines))));
  Image wider(image.width + strip, height, outside);
  for (int y = 0; y < image.height; ++y) std::copy_n(image.at(0, y), 3 * image.width, wider.at(0, y));
  double y = text_px;
  for (const OverlayShape& s : shapes) {
    if (s.name.empty()) continue;
    detail::fill_rectangle(wider, image.width + text_px, y, image.width + text_px * 2, y + text_px, s.colour_rgb, 1);
    draw_text(wider, image.width + text_px * 2.6, y, s.name, text_px, ink, halo);
    y += text_px * legend_step;
  }
  image = std::move(wider);
}

std::string rounded_text(double v) { return to_text(std::round(v * 10) / 10 + 0.0); }

void draw_marks(Image& image, const SliceGeometry& g, const SliceParams& p, const std::vector<OverlayShape>& shapes) {
  const double text_px = std::clamp(std::max(image.width, image.height) * 0.019, 7.0, 24.0);
  const PlaneAxes& a = axes_of(p.plane);
  detail::draw_edge_letters(image, a.at_left, a.at_right, a.at_top, a.at_bottom, text_px * 1.25, ink, halo);
  const double needed = text_px * (p.note.empty() ? 5 : 7);
  if (needed > image.height / 2) {  // too low: below it then
    Image taller(image.width, image.height + static_cast<int>(std::ceil(needed)), outside);
    std::copy(image.rgb.begin(), image.rgb.end(), taller.rgb.begin());
    image = std::move(taller);
  }
  detail::draw_scale_bar(image, g.mm_per_px, image.width * 0.25, text_px * 0.9, ink, halo);
  const std::string place = std::string(a.name) + "  " + a.letter + " = " + rounded_text(p.position_mm) + " mm";
  const std::string window = "C " + rounded_text(p.window_center_hu) + "  W " + rounded_text(p.window_width_hu) + " HU";
  const double small = text_px * 0.9, last = image.height - text_px - small;
  draw_text(image, text_px, last - small * 3.6, p.note, small, ink, halo);
  draw_text(image, text_px, last - small * 1.8, place, small, ink, halo);
  draw_text(image, text_px, last, window, small, ink, halo);
  add_legend(image, shapes, text_px);
}

}  // namespace

std::array<double, 2> slice_range_mm(const grid::Lattice& volume, SlicePlane plane) {
  const surface::Bounds b = surface::bounds_of(volume, 0.5);
  const int n = axes_of(plane).normal;
  return {b.min_mm[n], b.max_mm[n]};
}

SliceGeometry slice_geometry(const grid::Lattice& volume, const SliceParams& params) {
  const PlaneAxes& axes = axes_of(params.plane);
  const surface::Bounds b = surface::bounds_of(volume, 0.5);
  const int n = axes.normal;
  if (!(params.position_mm >= b.min_mm[n] && params.position_mm <= b.max_mm[n]))
    throw Error(ExitCode::bad_input, "", "position_mm",
                to_text(params.position_mm) + ", the volume reaches from " + to_text(b.min_mm[n]) + " to " +
                    to_text(b.max_mm[n]) + " mm");
  if (params.longer_side_px < 1 || params.longer_side_px > 16384 || !(params.window_width_hu > 0))
    throw Error(ExitCode::internal, "", "picture", "size or window is out of range");
  SliceGeometry g;
  g.right = axes.right;
  g.down = axes.down;
  const auto reach = [&](Vec3 d, double& low, double& high) {
    const double p = dot(d, b.min_mm), q = dot(d, b.max_mm);
    low = std::min(p, q);
    high = std::max(p, q);
  };
  double x0, x1, y0, y1;
  reach(g.right, x0, x1);
  reach(g.down, y0, y1);
  g.mm_per_px = std::max(x1 - x0, y1 - y0) / params.longer_side_px;
  const auto pixels = [&](double length) { return std::max(1, static_cast<int>(std::lround(length / g.mm_per_px))); };
  g.width = pixels(x1 - x0);
  g.height = pixels(y1 - y0);
  g.corner_mm = g.right * x0 + g.down * y0;
  g.corner_mm[n] = params.position_mm;
  return g;
}

Image slice_overlay(const grid::HuVolume& volume, const SliceParams& params, const std::vector<OverlayShape>& shapes) {
  const SliceGeometry g = slice_geometry(grid::lattice_of(volume), params);
  Image image(g.width, g.height, outside);
  std::visit([&](const auto& grid) { draw_volume(grid, g, params, image); }, volume);
  std::vector<std::vector<Segment>> cuts;
  for (const auto& s : shapes) {
    if (!s.mesh == !s.field) throw Error(ExitCode::internal, "", "picture", "a shape is null, or two");
    if (s.field) {
      cuts.push_back(cut(*s.field, g));
      continue;
    }
    surface::check_mesh(*s.mesh);
    cuts.push_back(cut(*s.mesh, g, axes_of(params.plane).normal, params.position_mm));
  }
  if (params.fill_opacity > 0)
    for (std::size_t i = 0; i < shapes.size(); ++i) fill(image, cuts[i], shapes[i].colour_rgb, params.fill_opacity);
  detail::StrokeMask mask(image.width, image.height);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    mask.clear();
    for (const auto& s : cuts[i]) mask.add_segment(s.x0, s.y0, s.x1, s.y1, params.line_width_px);
    mask.blend(image, shapes[i].colour_rgb);
  }
  if (params.marks) draw_marks(image, g, params, shapes);
  return image;
}

}  // namespace trephine::picture
