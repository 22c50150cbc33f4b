// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/room.h"

#include <algorithm>
#include <cmath>

#include "base/pi.h"
#include "surface/bounds.h"

namespace trephine::scene {
namespace {

using Colour = std::array<float, 3>;
constexpr Colour cloth{0.15f, 0.42f, 0.40f}, pad{0.13f, 0.14f, 0.17f}, steel{0.55f, 0.57f, 0.60f};
// A table of usual size, and a person of usual size where the case says nothing of it.
constexpr double table_half_mm = 265, table_thick_mm = 50, body_mm = 700, hangs_mm = 260;
constexpr double shoulders_half_mm = 225, chest_mm = 215, neck_to_shoulders_mm = 150;
constexpr double tray_half_mm = 75, tray_length_mm = 260, tray_off_mm = 60, tool_apart_mm = 22;

// The room's own axes: across to the patient's left, along to the head, and up from the table. All of it is built in
// these, about a place on the table.
struct Axes {
  Vec3 origin, across{1, 0, 0}, along{0, 0, 1}, up;
  Vec3 place(double a, double l, double u) const { return origin + across * a + along * l + up * u; }
};

class Builder {
 public:
  explicit Builder(const Axes& axes) : axes_(axes) {}

  void box(double a0, double a1, double l0, double l1, double u0, double u1, Colour colour) {
    const double a[2] = {a0, a1}, l[2] = {l0, l1}, u[2] = {u0, u1};
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        Vec3 corner[4];
        for (int c = 0; c < 4; ++c) {
          int at[3];
          at[axis] = side;
          at[(axis + 1) % 3] = c == 1 || c == 2;
          at[(axis + 2) % 3] = c >= 2;
          corner[c] = axes_.place(a[at[0]], l[at[1]], u[at[2]]);
        }
        quad(corner[0], corner[1], corner[2], corner[3], axes_.place(0.5 * (a0 + a1), 0.5 * (l0 + l1), 0.5 * (u0 + u1)),
             colour);
      }
  }

  // A sheet over rows of places, smooth, seen from both sides.
  void sheet(const std::vector<std::vector<Vec3>>& rows, Colour colour) {
    const std::size_t columns = rows.front().size();
    // Outwards is up where the sheet lies over the middle.
    const std::size_t over = columns / 2, low = rows.size() / 2;
    const Vec3 from = rows[low][over], facing = cross(rows[low][over + 1] - from, rows[low + 1][over] - from);
    const double turned = dot(facing, axes_.up) > 0 ? 1 : -1;
    const auto first = std::uint32_t(out.vertices.size());
    for (std::size_t r = 0; r < rows.size(); ++r)
      for (std::size_t c = 0; c < columns; ++c) {
        const Vec3 along = rows[std::min(r + 1, rows.size() - 1)][c] - rows[r > 0 ? r - 1 : 0][c];
        const Vec3 across = rows[r][std::min(c + 1, columns - 1)] - rows[r][c > 0 ? c - 1 : 0];
        vertex(rows[r][c], normalized(cross(across, along)) * turned, colour);
      }
    for (std::size_t r = 0; r + 1 < rows.size(); ++r)
      for (std::size_t c = 0; c + 1 < columns; ++c) {
        const auto a = std::uint32_t(first + r * columns + c), b = a + 1, d = std::uint32_t(a + columns), e = d + 1;
        if (turned > 0)
          out.indices.insert(out.indices.end(), {a, b, e, a, e, d});
        else
          out.indices.insert(out.indices.end(), {a, e, b, a, d, e});
      }
  }

  void solid(const Solid& s, Vec3 place, Vec3 x, Vec3 y, Vec3 z) {
    const auto first = std::uint32_t(out.vertices.size());
    const auto turned = [&](const float* p) { return x * p[0] + y * p[1] + z * p[2]; };
    for (const SolidVertex& v : s.vertices)
      vertex(place + turned(v.position_mm), turned(v.normal), {v.colour_rgb[0], v.colour_rgb[1], v.colour_rgb[2]});
    for (const std::uint32_t i : s.indices) out.indices.push_back(first + i);
  }

  Solid out;

 private:
  void vertex(Vec3 p, Vec3 n, Colour c) {
    out.vertices.push_back(
        {{float(p.x), float(p.y), float(p.z)}, {float(n.x), float(n.y), float(n.z)}, {c[0], c[1], c[2]}});
  }
  void quad(Vec3 a, Vec3 b, Vec3 c, Vec3 d, Vec3 inside, Colour colour) {
    Vec3 n = normalized(cross(b - a, c - a));
    const bool turn = dot(n, a - inside) < 0;
    if (turn) n = -n;
    const auto first = std::uint32_t(out.vertices.size());
    for (const Vec3 p : {a, b, c, d}) vertex(p, n, colour);
    for (const std::uint32_t i : {0, 1, 2, 0, 2, 3}) out.indices.push_back(first + (turn ? (3 - i) % 4 : i));
  }
  const Axes& axes_;
};

double eased(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// The body from where the scan cuts it, under a drape that hangs over the table's sides. `end_mm` along the table, and
// `way` 1 or -1 from there; half its width, and its height over the table, at that end and farther on.
void body(Builder& b, const Axes& axes, double end_mm, double way, double half_mm, double high_mm, double far_half_mm,
          double far_high_mm) {
  std::vector<std::vector<Vec3>> rows;
  constexpr int columns = 33;
  for (int r = 0; r <= 18; ++r) {
    const double t = r == 0 ? 0 : body_mm * std::pow((r - 1) / 17.0, 1.4);
    const double share = eased(t / neck_to_shoulders_mm);
    const double half = half_mm + (far_half_mm - half_mm) * share, high = high_mm + (far_high_mm - high_mm) * share;
    const double at = end_mm + way * (t - drape_over_mm);
    std::vector<Vec3> row;
    for (int c = 0; c < columns; ++c) {
      const double phi = pi * (c - 4) / (columns - 9.0);  // over the body from one side to the other
      double a, u;
      if (c < 4 || c >= columns - 4) {  // from the body down to the table, over its edge, and down
        const int n = c < 4 ? 3 - c : c - (columns - 4);
        const double side = c < 4 ? 1 : -1, edge = std::max(table_half_mm, half) + 16;
        a = side * (n == 0 ? half + 4 + 0.2 * (edge - half) : n == 1 ? edge - 4 : edge);
        u = n <= 1 ? 3 : n == 2 ? -0.4 * table_thick_mm : -hangs_mm;
      } else {
        a = half * std::cos(phi);
        u = 3 + high * std::pow(std::max(0.0, std::sin(phi)), 0.75);
      }
      // Folds, wider at the hem: the cloth goes through nothing that it lies on.
      const double fold = (c == 0 || c == columns - 1 ? 14 : 2.5) * eased(t / 60);
      u += 0.4 * fold * std::sin(0.045 * t + 1.3 * c);
      a += fold * std::sin(0.06 * t + 0.5 * std::sin(0.02 * t)) * (c < 4 ? 1 : c >= columns - 4 ? -1 : 0);
      row.push_back(axes.place(a, at, r == 0 ? std::max(-hangs_mm, u - 12) : u));
    }
    rows.push_back(std::move(row));
  }
  b.sheet(rows, cloth);
}

}  // namespace

Room make_room(const RoomParams& p, Vec3 origin_mm) {
  const Vec3 low = p.patient_mm.min_mm, high = p.patient_mm.max_mm, middle = (low + high) / 2, half = (high - low) / 2;
  Axes axes;
  axes.up = -p.down;
  // The patient lies on the table's pad; a head is held above it, for the back is thicker.
  const double thick = 2 * half.y, below = half.y + (p.head ? 25 : 2);
  axes.origin = middle + p.down * below - origin_mm;
  Builder b(axes);
  const double top = half.z, bottom = -half.z;
  const double head_end = p.head ? bottom + 15 : top + body_mm;
  b.box(-table_half_mm, table_half_mm, bottom - body_mm, head_end, -table_thick_mm, 0, pad);
  for (const double side : {-1.0, 1.0})
    b.box(side * table_half_mm - 8, side * table_half_mm + 8, bottom - body_mm, head_end, -table_thick_mm - 14,
          -table_thick_mm + 4, steel);
  if (p.head) {
    // Two pads under the head, and the arm that bears them.
    for (const double side : {-1.0, 1.0})
      b.box(side * 45 - 22, side * 45 + 22, -0.45 * half.z, 0.25 * half.z, -12, 27, pad);
    b.box(-70, 70, -0.3 * half.z, 0.1 * half.z, -26, -12, steel);
    b.box(-16, 16, head_end, 0.1 * half.z, -40, -26, steel);
    body(b, axes, bottom, -1, 0.78 * half.x, 0.72 * thick + 25, shoulders_half_mm, chest_mm);
  } else {
    for (const double way : {-1.0, 1.0})
      body(b, axes, way * half.z, way, half.x + 10, thick + 8, half.x + 25, thick + 20);
  }
  // The tray, on a stand of its own, beside what is operated on.
  const double near = p.head ? half.x + tray_off_mm : std::max(half.x, table_half_mm) + tray_off_mm;
  const double from = p.tray_side * (near + tray_half_mm);
  const double tray_low = (p.head ? -0.2 * half.z : -0.5 * tray_length_mm), tray_up = 0.55 * thick;
  b.box(from - tray_half_mm, from + tray_half_mm, tray_low, tray_low + tray_length_mm, tray_up - 6, tray_up, steel);
  b.box(from - tray_half_mm + 5, from + tray_half_mm - 5, tray_low + 5, tray_low + tray_length_mm - 5, tray_up,
        tray_up + 1.5, cloth);
  const double room = 2 * (tray_half_mm - 12),
               apart = std::min(tool_apart_mm, room / std::max<double>(1, p.tools.size()));
  for (std::size_t n = 0; n < p.tools.size(); ++n) {
    const Solid tool = solid_of(p.tools[n]);
    float thickest = 0, longest = 0;
    for (const SolidVertex& v : tool.vertices) {
      thickest = std::max(thickest, std::hypot(v.position_mm[0], v.position_mm[1]));
      longest = std::max(longest, v.position_mm[2]);
    }
    const double a = from + apart * (double(n) - 0.5 * (double(p.tools.size()) - 1));
    const double l = tray_low + 0.5 * (tray_length_mm + std::min<double>(longest, tray_length_mm - 20));
    b.solid(tool, axes.place(a, l, tray_up + 1.5 + thickest), axes.across, axes.up, -axes.along);
  }
  Room out{std::move(b.out), p.patient_mm};
  for (const SolidVertex& v : out.solid.vertices)
    surface::include(out.bounds_mm, origin_mm + Vec3{v.position_mm[0], v.position_mm[1], v.position_mm[2]});
  return out;
}

}  // namespace trephine::scene
