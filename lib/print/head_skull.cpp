// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/pi.h"
#include "base/refusal.h"
#include "print/head_parts.h"

namespace trephine::print {
namespace {

constexpr double rim_width_mm = 4;            ///< of an insert, to each side of its cylinder
constexpr double deep_mm = 22, high_mm = 12;  ///< of an insert's cylinder along its axis, from the bone's outside
constexpr double post_length_mm = 3;          ///< between bone and sphere
constexpr double sunk_mm = 1.5;               ///< of a post in the bone
constexpr double mark_clear_mm = 4;           ///< between a mark and what else there is
constexpr std::size_t least_marks = 5;
/// Azimuth from the left to the front, and elevation above the middle, degrees: no turn or mirror image of them is
/// alike.
constexpr double mark_places[][2] = {{8, -6},   {-40, 14}, {-140, 2}, {-96, 34},
                                     {172, 18}, {118, -4}, {38, 30},  {-70, -8}};
constexpr double tries_deg[] = {0, 10, -10, 20, -20};

double outer_radius_mm(const InsertPlan& insert) { return insert.radius_mm + rim_width_mm; }

Solid around(const HeadPlan& plan, const InsertPlan& insert) {
  const double reach = std::max(outer_radius_mm(insert) + 3, std::max(deep_mm, high_mm) + 3);
  surface::Bounds box{insert.place.at_mm - Vec3{reach, reach, reach}, insert.place.at_mm + Vec3{reach, reach, reach}};
  return Solid(lattice_over(box, plan.bone.spacing_mm.x));
}

double post_radius_mm(const HeadPlan& plan) { return std::max(2.5, plan.thick_mm() / 2); }

}  // namespace

std::vector<InsertPlan> plan_inserts(const HeadPlan& plan) {
  std::vector<InsertPlan> all;
  const Inserts wanted = plan.params.inserts;
  for (const char* side : {"right", "left"}) {
    const bool left = side[0] == 'l';
    if (wanted == Inserts::none || (wanted == Inserts::right && left) || (wanted == Inserts::left && !left)) continue;
    const Vec3 skin =
        plan.frame.to_print(landmark_of(plan.loaded.manifest, std::string("kocher_") + side, "an insert of the print"));
    InsertPlan insert;
    insert.name = std::string("insert-") + side;
    insert.radius_mm = plan.params.insert_mm / 2;
    const auto place = outer_place(plan, skin - plan.middle_mm);
    if (!place)
      throw Error(ExitCode::bad_input, "case.json", "landmarks",
                  std::string("`kocher_") + side + "` has no bone under it for an insert; leave it out (`inserts`)");
    insert.place = *place;
    if (insert.place.at_mm.z < outer_radius_mm(insert) + plan.params.wall_mm)
      throw refusal(insert.name, "the insert would reach below the cut", {"set a smaller `insert_mm`"});
    all.push_back(insert);
  }
  if (all.size() == 2 && norm(all[0].place.at_mm - all[1].place.at_mm) <
                             outer_radius_mm(all[0]) + outer_radius_mm(all[1]) + plan.params.wall_mm)
    throw refusal("insert_mm", "the two inserts would touch each other", {"set a smaller `insert_mm`"});
  return all;
}

PartSolid insert_part(const HeadPlan& plan, const InsertPlan& insert, const Progress& progress) {
  const double gap = plan.params.gap_mm, thick = plan.thick_mm();
  PartSolid part{insert.name, {0.97, 0.86, 0.6}, around(plan, insert)};
  change(part.solid, [&](Vec3 p, double) {
    const double off = insert.off_axis_mm(p), along = insert.along_mm(p), d = at(plan.bone, p);
    const double within = std::min({insert.radius_mm - off, along + deep_mm, high_mm - along});
    double solid = std::min(d, within);
    // The rim: on the outside, where the way out of the bone leads along the axis.
    if (-d <= thick + gap + 1 && dot(slope(plan.bone, p, 0.6), insert.place.out) < 0) {
      const double above = std::min(-d - gap, thick + gap + d);
      const double on = std::min(off - (insert.radius_mm - rim_width_mm), outer_radius_mm(insert) - off);
      solid = std::max(solid, std::min(above, on));
      solid = std::max(solid, std::min({thick + gap + d, off - (insert.radius_mm - rim_width_mm), within}));
    }
    return solid;
  });
  part.solid = one_piece(plan, part.solid, part.name, progress);
  return part;
}

std::vector<PrintMark> plan_marks(const HeadPlan& plan, const std::vector<InsertPlan>& inserts) {
  std::vector<PrintMark> marks;
  const double radius = plan.params.mark_mm / 2;
  for (const auto& place : mark_places)
    for (const double turn : tries_deg) {
      const double azimuth = (place[0] + turn) * pi / 180, up = place[1] * pi / 180;
      const auto found =
          outer_place(plan, {std::cos(up) * std::cos(azimuth), -std::cos(up) * std::sin(azimuth), std::sin(up)});
      if (!found) continue;
      const Vec3 middle = found->at_mm + found->out * (radius + post_length_mm);
      if (middle.z < radius + 2 || at(plan.bone, middle) > -radius - 1) continue;
      if (std::any_of(inserts.begin(), inserts.end(), [&](const InsertPlan& i) {
            return norm(middle - i.place.at_mm) < outer_radius_mm(i) + radius + mark_clear_mm;
          }))
        continue;
      if (std::any_of(marks.begin(), marks.end(),
                      [&](const PrintMark& m) { return norm(m.at_mm - middle) < 4 * radius; }))
        continue;
      PrintMark mark;
      mark.number = std::int64_t(marks.size()) + 1;
      mark.at_mm = middle;
      mark.case_mm = plan.frame.to_case(middle);
      mark.post = plan.frame.to_case.matrix * -found->out;
      mark.diameter_mm = plan.params.mark_mm;
      marks.push_back(mark);
      break;
    }
  if (marks.size() < least_marks)
    throw refusal("marks",
                  "the skull has room for " + std::to_string(marks.size()) + " marks, and " +
                      std::to_string(least_marks) + " are needed",
                  {"set a smaller `insert_mm` or `mark_mm`, or a lower cut (`cut_above_mm`)"});
  return marks;
}

PartSolid skull_part(const HeadPlan& plan, const std::vector<InsertPlan>& inserts, const std::vector<PrintMark>& marks,
                     const Progress& progress) {
  const double gap = plan.params.gap_mm, post = post_radius_mm(plan);
  std::array<double, 3> colour{0.93, 0.89, 0.78};
  if (const cases::CaseAnatomy* a = plan.loaded.manifest.find_anatomy("skull")) colour = a->colour_rgb;
  PartSolid part{"skull", colour, Solid(plan.bone)};
  change(part.solid, [&](Vec3 p, double bone) {
    double solid = std::min(bone, p.z - gap);
    for (const InsertPlan& i : inserts) {
      const double along = i.along_mm(p);
      const double hole =
          std::min({i.radius_mm + gap - i.off_axis_mm(p), along + deep_mm + gap, high_mm + gap - along});
      solid = std::min(solid, -hole);
    }
    for (const PrintMark& m : marks) {
      const Vec3 way = plan.frame.to_print.matrix * m.post, d = p - m.at_mm;
      const double r = norm(d);
      if (r > 0.5 * m.diameter_mm + post_length_mm + sunk_mm + 4) continue;
      const double t = std::clamp(dot(d, way), 0.0, 0.5 * m.diameter_mm + post_length_mm + sunk_mm);
      solid = std::max({solid, 0.5 * m.diameter_mm - r, post - norm(d - way * t)});
    }
    return solid;
  });
  part.solid = one_piece(plan, part.solid, part.name, progress);
  change(part.solid, [&](Vec3 p, double d) {  // as wide as they are said to be, whatever the raster took off
    for (const PrintMark& m : marks) d = std::max(d, 0.5 * m.diameter_mm - norm(p - m.at_mm));
    return d;
  });
  keep_largest(part.solid);
  return part;
}

}  // namespace trephine::print
