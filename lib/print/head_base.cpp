// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/refusal.h"
#include "mask/filters.h"
#include "picture/stroke.h"
#include "print/head_parts.h"

namespace trephine::print {
namespace {

constexpr double margin_mm = 12;                          ///< of the plate around the bone
constexpr double widest_pour_mm = 16, least_pour_mm = 6;  ///< radius of the hole through which gel is poured
constexpr double ledge_mm = 4;                            ///< on which its lid rests
constexpr double stroke_mm = 0.7, groove_mm = 0.8;        ///< half the width of an engraved line, and its depth
constexpr double letter_mm = 10, line_ratio = 1.6;        ///< height of a capital; from line to line
constexpr std::size_t letters_a_line = 16;

struct Pour {
  Vec3 at_mm;
  double radius_mm = 0;
};

Pour pour_hole(const HeadPlan& plan, const VentriclesPart* ventricles) {
  Pour best;
  for (int j = 0; j < plan.flat.size[1]; ++j)
    for (int i = 0; i < plan.flat.size[0]; ++i) {
      if (!plan.ring_inside.get(i, j, 0)) continue;
      const Vec3 p = plan.flat.to_world_mm({double(i), double(j), 0});
      double room = -plan.rim_bone.at(i, j, 0) - plan.params.gap_mm - plan.params.wall_mm - 2;
      if (ventricles)
        room = std::min(room,
                        norm(p - ventricles->stem_mm) - ventricles->collar_radius_mm - ledge_mm - plan.params.wall_mm);
      room = std::min(room, widest_pour_mm);
      if (room > best.radius_mm) best = {p, room};
    }
  if (best.radius_mm < least_pour_mm)
    throw refusal("base", "within the ring of bone there is no room for a hole to pour gel through",
                  {"set another height of the cut (`cut_above_mm`), or leave the ventricles out (`ventricles`: none)"});
  return best;
}

using Strokes = std::vector<std::pair<Vec3, Vec3>>;

// Lines of the token on the plate's lower face, to be read from below with the front of the head upwards: there left
// and right are exchanged.
Strokes strokes_of(const std::string& token, Vec3 middle) {
  std::vector<std::string> lines;
  for (std::size_t n = 0; n < token.size(); n += letters_a_line) lines.push_back(token.substr(n, letters_a_line));
  Strokes all;
  double y = middle.y - 0.5 * letter_mm * line_ratio * double(lines.size() - 1) - 0.5 * letter_mm;
  for (const std::string& line : lines) {
    double width = 0;
    for (const char c : line) width += picture::detail::glyph_of(static_cast<unsigned char>(c)).advance;
    double x = -0.5 * width;
    for (const char c : line) {
      const picture::detail::Glyph& glyph = picture::detail::glyph_of(static_cast<unsigned char>(c));
      for (const picture::detail::Polyline& l : glyph.lines)
        for (std::size_t n = 0; n + 1 < l.points.size(); ++n) {
          const auto place = [&](const std::array<double, 2>& p) {
            return Vec3{middle.x + letter_mm * (x + p[0]), y + letter_mm * p[1], 0};
          };
          all.emplace_back(place(l.points[n]), place(l.points[n + 1]));
        }
      x += glyph.advance;
    }
    y += letter_mm * line_ratio;
  }
  return all;
}

double off_segment_mm(double x, double y, const std::pair<Vec3, Vec3>& s) {
  const Vec3 d = s.second - s.first, p{x - s.first.x, y - s.first.y, 0};
  const double t = std::clamp(dot(p, d) / std::max(1e-9, dot(d, d)), 0.0, 1.0);
  return norm(p - d * t);
}

// Where letters meet neither the pouring hole nor the stem's.
Vec3 free_place(const HeadPlan& plan, const Pour& pour, const VentriclesPart* ventricles) {
  const Vec3 middle = plan.ring_filled.centre_mm();
  Vec3 best{middle.x, middle.y, 0};
  double farthest = -1;
  for (double y = -50; y <= 50; y += 10) {
    const Vec3 p{middle.x, middle.y + y, 0};
    double off = norm(p - pour.at_mm) - pour.radius_mm;
    if (ventricles) off = std::min(off, norm(p - ventricles->stem_mm));
    if (off > farthest) farthest = off, best = p;
  }
  return best;
}

}  // namespace

BaseParts base_parts(const HeadPlan& plan, const VentriclesPart* ventricles, const std::string& token,
                     const Progress& progress) {
  const double gap = plan.params.gap_mm, plate = plan.plate_mm(), voxel = plan.bone.spacing_mm.x;
  const double rim_thick = plan.thick_mm();
  const Pour pour = pour_hole(plan, ventricles);
  const grid::Grid<float> off_ring = mask::distance_mm(plan.ring_filled),
                          off_inside = mask::distance_mm(plan.ring_inside);
  surface::Bounds box;
  box.min_mm = plan.flat.to_world_mm({0, 0, 0});
  box.max_mm = plan.flat.to_world_mm({double(plan.flat.size[0] - 1), double(plan.flat.size[1] - 1), 0});
  box.min_mm.z = -plate - 3;
  box.max_mm.z = plan.rim_mm() + 3;
  BaseParts made{{"base", {0.55, 0.58, 0.62}, Solid(lattice_over(box, voxel))},
                 {"lid", {0.75, 0.45, 0.3}, {}},
                 -plate + groove_mm};
  const double counter = pour.radius_mm + ledge_mm;
  change(made.base.solid, [&](Vec3 p, double) {
    const Vec3 on{p.x, p.y, 0};
    const Vec3 cell = plan.flat.to_index(on);
    const double ring = grid::sampled(off_ring, cell, grid::value_beyond(1e3));
    double solid = std::min({margin_mm - ring, -p.z, p.z + plate});
    const double clear = -at(plan.rim_bone, on);
    const double within = 1.2 * voxel - grid::sampled(off_inside, cell, grid::value_beyond(1e3));
    solid = std::max(solid, std::min({clear - gap, gap + rim_thick - clear, within, p.z + plate, plan.rim_mm() - p.z}));
    const double off = norm(on - pour.at_mm);
    solid = std::min(solid, std::max(off - pour.radius_mm, p.z - plan.rim_mm()));
    solid = std::min(solid, std::max(off - counter, p.z + plate - plan.thick_mm() - gap));
    if (ventricles) solid = std::min(solid, norm(on - ventricles->stem_mm) - ventricles->stem_radius_mm - gap);
    return solid;
  });
  made.base.solid = one_piece(plan, made.base.solid, made.base.name, progress.part(0, 0.7));

  surface::Bounds lid_box{pour.at_mm - Vec3{counter + 3, counter + 3, plate + 3},
                          pour.at_mm + Vec3{counter + 3, counter + 3, 3}};
  made.lid.solid = Solid(lattice_over(lid_box, voxel));
  change(made.lid.solid, [&](Vec3 p, double) {
    const double off = norm(Vec3{p.x, p.y, 0} - pour.at_mm);
    const double lower = std::min({counter - gap - off, p.z + plate, plan.thick_mm() - plate - p.z});
    const double upper = std::min({pour.radius_mm - gap - off, p.z + plate, -p.z});
    return std::max(lower, upper);
  });
  made.lid.solid = one_piece(plan, made.lid.solid, made.lid.name, progress.part(0.7, 0.8));

  const Strokes strokes = strokes_of(token, free_place(plan, pour, ventricles));
  change(made.base.solid, [&](Vec3 p, double solid) {
    if (p.z > -plate + 3) return solid;
    double off = 1e3;
    for (const auto& s : strokes) off = std::min(off, off_segment_mm(p.x, p.y, s));
    return std::min(solid, -std::min(stroke_mm - off, -plate + groove_mm - p.z));
  });
  return made;
}

}  // namespace trephine::print
