// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/tool_solid.h"

#include <algorithm>
#include <cmath>

#include "base/pi.h"

namespace trephine::scene {
namespace {

using Colour = std::array<float, 3>;
using Tip = haptics::ToolParams::Tip;
constexpr Colour steel{0.78f, 0.80f, 0.83f}, dark_steel{0.45f, 0.47f, 0.51f}, grip{0.16f, 0.24f, 0.36f},
    silicone{0.93f, 0.93f, 0.88f}, ink{0.05f, 0.06f, 0.10f}, blue{0.16f, 0.30f, 0.75f}, glass{0.80f, 0.86f, 0.90f},
    titanium{0.62f, 0.55f, 0.70f};
constexpr double tube_beyond_mm = 60;  // of a tube, behind what is felt

// A place on the outline, from the tip to the tail. Where two have the same place and other normals, there is an edge.
struct Station {
  double z, r;
  Colour colour;
};

class Turned {
 public:
  explicit Turned(int sides) : sides_(sides) {}

  // A part of the outline that is smooth along it; the next part begins with an edge.
  void part(const std::vector<Station>& s, bool smooth) {
    if (smooth) {
      add(s, 0, s.size());
      return;
    }
    for (std::size_t n = 0; n + 1 < s.size(); ++n) add(s, n, n + 2);
  }
  Solid take() { return std::move(out_); }

 private:
  void add(const std::vector<Station>& s, std::size_t begin, std::size_t end) {
    const auto first = std::uint32_t(out_.vertices.size());
    for (std::size_t n = begin; n < end; ++n) {
      const Station &before = s[n > begin ? n - 1 : n], &after = s[n + 1 < end ? n + 1 : n];
      const double dz = after.z - before.z, dr = after.r - before.r, length = std::max(1e-9, std::hypot(dz, dr));
      for (int k = 0; k <= sides_; ++k) {
        const double a = 2 * pi * (k % sides_) / sides_, c = std::cos(a), d = std::sin(a);
        out_.vertices.push_back({{float(s[n].r * c), float(s[n].r * d), float(s[n].z)},
                                 {float(dz / length * c), float(dz / length * d), float(-dr / length)},
                                 {s[n].colour[0], s[n].colour[1], s[n].colour[2]}});
      }
    }
    const auto ring = std::uint32_t(sides_ + 1);
    for (std::uint32_t n = 0; n + 1 < end - begin; ++n)
      for (std::uint32_t k = 0; k < std::uint32_t(sides_); ++k) {
        const std::uint32_t a = first + n * ring + k, b = a + 1, c = a + ring, d = c + 1;
        out_.indices.insert(out_.indices.end(), {a, b, d, a, d, c});
      }
  }
  int sides_;
  Solid out_;
};

std::vector<Station> arc(double centre_z, double radius, double from_rad, double to_rad, int steps, Colour colour) {
  std::vector<Station> s;
  for (int n = 0; n <= steps; ++n) {
    const double a = from_rad + (to_rad - from_rad) * n / steps;
    s.push_back({centre_z - radius * std::cos(a), std::max(0.0, radius * std::sin(a)), colour});
  }
  return s;
}

// The shaft from z on: in one colour, or with a ring at each cm.
void shaft(Turned& t, double z, double end, double r, Colour colour, bool marks) {
  if (!marks) {
    t.part({{z, r, colour}, {end, r, colour}}, true);
    return;
  }
  for (int cm = 1; cm * 10 < end; ++cm) {
    const double half = cm % 10 == 0 ? 1.2 : cm % 5 == 0 ? 0.8 : 0.35;
    if (cm * 10 - half <= z) continue;
    t.part({{z, r, colour}, {cm * 10 - half, r, colour}}, true);
    t.part({{cm * 10 - half, r, ink}, {std::min(end, cm * 10 + half), r, ink}}, true);
    z = cm * 10 + half;
  }
  if (z < end) t.part({{z, r, colour}, {end, r, colour}}, true);
}

void handle(Turned& t, double z, double neck_r, double length, double r) {
  t.part({{z, neck_r, dark_steel}, {z + 2, r * 0.6, dark_steel}, {z + 10, r, grip}, {z + length, r, grip}}, false);
  auto end = arc(z + length, r, pi / 2, pi, 6, grip);
  t.part(end, true);
}

// A felt tip, a cap's seat and a thick barrel.
Solid pen() {
  Turned t(24);
  t.part({{0, 0, blue}, {2.5, 0.9, blue}, {4, 1, blue}}, false);
  t.part({{4, 2.2, silicone}, {14, 4, silicone}, {16, 4, silicone}}, false);
  t.part({{16, 5, blue}, {110, 5, blue}}, true);
  t.part({{110, 5, blue}, {110, 0, blue}}, true);
  return t.take();
}

// A blade on a flat handle: turned, and then pressed flat.
Solid scalpel() {
  Turned t(32);
  t.part({{0, 0, steel}, {7, 2.6, steel}, {12, 3, steel}, {26, 3, steel}, {32, 2, steel}}, false);
  t.part({{32, 2, dark_steel}, {40, 4, dark_steel}, {130, 4, dark_steel}, {135, 0, dark_steel}}, false);
  Solid s = t.take();
  for (SolidVertex& v : s.vertices) {
    const float flat = v.position_mm[2] <= 32 ? 0.12f : 0.4f;
    v.position_mm[1] *= flat;
    v.normal[1] /= flat;
    const float size = std::sqrt(v.normal[0] * v.normal[0] + v.normal[1] * v.normal[1] + v.normal[2] * v.normal[2]);
    for (float& n : v.normal) n /= size;
  }
  return s;
}

// Behind a needle: a cone that locks, a barrel of 5 ml with its contents, and the plunger drawn out.
void syringe(Turned& t, double z, double neck, const std::optional<Colour>& inside_rgb) {
  constexpr double barrel = 6.5;
  const Colour inside = inside_rgb.value_or(glass);
  t.part({{z, neck, blue}, {z + 1, 2.6, blue}, {z + 9, 2.6, blue}, {z + 10, 2.1, glass}, {z + 16, 2.1, glass}}, false);
  t.part({{z + 16, 2.1, glass}, {z + 18, barrel, glass}}, false);
  t.part({{z + 18, barrel, inside}, {z + 46, barrel, inside}}, true);
  t.part({{z + 46, barrel, ink}, {z + 50, barrel, ink}}, true);
  t.part({{z + 50, barrel, glass}, {z + 76, barrel, glass}}, true);
  t.part({{z + 76, barrel, glass}, {z + 76, 11, glass}, {z + 78, 11, glass}, {z + 78, 3, glass}}, false);
  t.part({{z + 78, 3, glass}, {z + 100, 3, glass}, {z + 100, 8, glass}, {z + 102, 8, glass}, {z + 102, 0, glass}},
         false);
}

// Across the needle's end, so that a palm can press and turn it.
void cross_handle(Turned& t, Solid& out, double z, double neck) {
  t.part({{z, neck, dark_steel}, {z + 2, 4, grip}, {z + 16, 5, grip}, {z + 16, 0, grip}}, false);
  Turned bar(24);
  bar.part(arc(-38, 7, 0, pi / 2, 6, grip), true);
  bar.part({{-38, 7, grip}, {-12, 5.5, grip}, {12, 5.5, grip}, {38, 7, grip}}, true);
  bar.part(arc(38, 7, pi / 2, pi, 6, grip), true);
  const Solid across = bar.take();
  const auto first = std::uint32_t(out.vertices.size());
  for (SolidVertex v : across.vertices) {  // its own z becomes the tool's x
    const auto turn = [](float* p) { std::swap(p[0], p[2]), std::swap(p[1], p[2]); };
    turn(v.position_mm);
    turn(v.normal);
    v.position_mm[2] += float(z + 18);
    out.vertices.push_back(v);
  }
  for (const std::uint32_t n : across.indices) out.indices.push_back(first + n);
}

// A thread of 3 mm from the cone on; then the head that takes a rod, and the driver in it.
void screw(Turned& t, double z, double end, double r) {
  const double core = 0.74 * r, pitch = 3;
  for (; z + pitch <= end; z += pitch)
    t.part({{z, core, titanium}, {z + 0.8, r, titanium}, {z + 1.3, r, titanium}, {z + pitch, core, titanium}}, false);
  t.part({{z, core, titanium}, {end, core, titanium}}, true);
  const double head = std::max(5.5, 1.6 * r);
  t.part({{end, core, titanium}, {end + 1.5, head, titanium}, {end + 12, head, titanium}, {end + 12, 3, titanium}},
         false);
  t.part({{end + 12, 3, steel}, {end + 80, 3, steel}}, true);
  handle(t, end + 80, 3, 90, 10);
}

void append(Solid& to, const Solid& part) {
  const auto first = std::uint32_t(to.vertices.size());
  to.vertices.insert(to.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const std::uint32_t n : part.indices) to.indices.push_back(first + n);
}

}  // namespace

double tail_mm(const haptics::ToolParams& tool) {
  double far = 0;
  for (const SolidVertex& v : solid_of(tool).vertices) far = std::max(far, double(v.position_mm[2]));
  return far;
}

Solid solid_of(const haptics::ToolParams& tool, const std::optional<Colour>& inside_rgb) {
  const double r = 0.5 * tool.tool_diameter_mm, length = tool.tool_length_mm;
  const haptics::ToolKind& kind = haptics::tool_kind(tool.tool);
  if (kind.look == haptics::ToolKind::Look::pen) return pen();
  if (kind.look == haptics::ToolKind::Look::blade) return scalpel();
  if (!(length > 0) || !(r > 0)) {  // a point: a stylus whose very tip is felt
    Turned t(24);
    t.part({{0, 0, steel}, {6, 1, steel}, {40, 1, steel}}, false);
    handle(t, 40, 1, 70, 3.5);
    return t.take();
  }
  const bool tube = kind.look == haptics::ToolKind::Look::tube, ball = !kind.has_neck || tool.tool_tip == Tip::ball;
  const Colour colour = tube ? silicone : steel;
  Turned t(32);
  double z = 0, neck = r;
  if (ball) {
    neck = 0.5 * r;
    // To where the neck leaves the ball.
    const double last = pi - std::asin(std::min(1.0, neck / r));
    t.part(arc(r, r, 0, last, 20, dark_steel), true);
    z = r - r * std::cos(last);
  } else if (tool.tool_tip == Tip::cone) {
    z = 4 * r;
    t.part({{0, 0, colour}, {z, r, colour}}, true);
  } else if (tool.tool_tip == Tip::round) {
    z = r;
    t.part(arc(r, r, 0, pi / 2, 10, colour), true);
  } else {
    t.part({{0, 0, dark_steel}, {0, r, dark_steel}}, true);
  }
  const double end = std::max({length, z + 1, ball ? 35.0 : 0.0});
  if (kind.look == haptics::ToolKind::Look::screw)
    screw(t, z, end, neck);
  else
    shaft(t, z, end, neck, colour, tube);
  using Look = haptics::ToolKind::Look;
  Solid across;
  if (tube) {  // the rest of it, up to its whole length; its end is flat
    shaft(t, end, end + tube_beyond_mm, neck, colour, false);
    t.part({{end + tube_beyond_mm, neck, colour}, {end + tube_beyond_mm, 0, colour}}, true);
  } else if (kind.look == Look::syringe) {
    syringe(t, end, neck, inside_rgb);
  } else if (kind.look == Look::cross_handle) {
    cross_handle(t, across, end, neck);
  } else if (kind.look != Look::screw) {
    const bool motor = ball || kind.rotates();
    handle(t, end, neck, motor ? 90 : 40, motor ? 4.5 : 4);
  }
  Solid whole = t.take();
  append(whole, across);
  return whole;
}

Solid ball_solid(double radius_mm, std::array<float, 3> colour_rgb, int rings) {
  Turned t(2 * rings);
  t.part(arc(0, radius_mm, 0, pi, rings, colour_rgb), true);
  return t.take();
}

}  // namespace trephine::scene
