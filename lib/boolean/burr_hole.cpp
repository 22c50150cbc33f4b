// SPDX-License-Identifier: GPL-3.0-or-later
#include "boolean/burr_hole.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/pi.h"
#include "base/refusal.h"
#include "boolean/burr_axis.h"
#include "boolean/cut_faces.h"
#include "boolean/outer_curve.h"

namespace trephine::boolean {
namespace {

// The thickness of the scalp and an unsteady hand; a position further away is more likely a mistake.
constexpr double far_position_mm = 15;

using namespace detail;
using Landmarks = std::map<std::string, Vec3>;

constexpr double farthest_nasion_mm = 10, on_cut_face_mm = 0.05, tangent_mm = 5, skull_depth_mm = 70, widest_gap_mm = 3;

[[noreturn]] void refuse(const std::string& what, const Remedy& remedy) { throw refusal("", what, remedy); }

[[noreturn]] void refuse(const std::string& what, ExitCode code) { throw Error(code, "", "", what); }

std::string text_of(Vec3 p) { return fmt::format("[{:.1f}, {:.1f}, {:.1f}]", p.x, p.y, p.z); }

double degrees(double radians) { return radians * 180 / pi; }

void check_request(const BurrHoleRequest& r) {
  const auto bounded = [](const char* name, double v, double low, double high) {
    if (!(v >= low && v <= high))
      refuse(fmt::format("{} must be from {} to {}, it is {}", name, low, high, v), ExitCode::bad_config);
  };
  bounded("diameter_mm", r.diameter_mm, 1, 60);
  bounded("along_mm", r.along_mm, 0, 300);
  bounded("lateral_mm", r.lateral_mm, 0, 150);
  if (!is_finite(r.position_mm)) refuse("position_mm is not finite", ExitCode::bad_config);
  if (r.toward_mm && !is_finite(*r.toward_mm)) refuse("toward_mm is not finite", ExitCode::bad_config);
  if (r.direction && !(std::fabs(norm(*r.direction) - 1) < 1e-3))
    refuse("direction must be of unit length", ExitCode::bad_config);
}

/// The head's own axes in the midsagittal plane.
struct Midline {
  Vec3 nasion, left, back, up, centre_mm;
  std::string source;
};

void require_landmarks(const Landmarks& marks) {
  std::vector<std::string> missing;
  if (!marks.count("nasion")) missing.push_back("nasion");
  if (!marks.count("inion") && !marks.count("vertex")) missing.push_back("inion");
  if (missing.empty()) return;
  std::string names, example;
  for (const auto& m : missing) {
    names += (names.empty() ? "" : " and ") + m + (m == "inion" ? " (or vertex)" : "");
    example += (example.empty() ? "" : ", ") + m + ": [x, y, z]";
  }
  refuse(fmt::format("Kocher's point needs {}, which {} not known", names, missing.size() > 1 ? "are" : "is"),
         {fmt::format("give in the case's configuration `landmarks: {{{}}}`, mm, LPS", example)});
}

Midline find_midline(const Landmarks& marks) {
  require_landmarks(marks);
  for (const auto& m : marks)
    if (!is_finite(m.second)) refuse("landmark " + m.first + " is not finite", ExitCode::bad_config);
  const auto find = [&](const char* name) {
    const auto found = marks.find(name);
    return found == marks.end() ? nullptr : &found->second;
  };
  Midline m;
  m.nasion = *find("nasion");
  const Vec3 *inion = find("inion"), *vertex = find("vertex");
  const Vec3 chord = (inion ? *inion : *vertex) - m.nasion;
  const char* other = inion ? "inion" : "vertex";
  if (!(norm(chord) > 50))
    refuse(fmt::format("nasion and {} lie {:.1f} mm apart: no head is that small", other, norm(chord)),
           ExitCode::bad_config);
  const Vec3 along = normalized(chord);
  const Vec3 *right = find("tragus_right"), *left = find("tragus_left");
  Vec3 across;
  if (left && right) {
    across = *left - *right;
    m.source = fmt::format("nasion, {} and tragi", other);
  } else if (inion && vertex) {
    across = cross(along, *vertex - m.nasion);
    m.source = "nasion, inion and vertex";
  } else {
    across = cross(along, Vec3{0, 0, 1});
    m.source = fmt::format("nasion, {} and the scan's superior axis", other);
  }
  const double before = norm(across);
  across = across - along * dot(across, along);
  if (!(norm(across) > 0.1 * before) || !(before > 0.02))
    refuse(fmt::format("nasion, {} and what else gives the midline lie in one line ({}): give tragus_left and "
                       "tragus_right",
                       other, m.source),
           ExitCode::bad_config);
  m.left = normalized(across);
  if (m.left.x < 0)
    refuse("tragus_left lies to the right of tragus_right (x runs to the patient's left): are they exchanged?",
           ExitCode::bad_config);
  if (inion) {
    m.back = along;
    m.up = cross(m.left, m.back);
    m.centre_mm = m.nasion + chord * 0.5;
  } else {
    // From nasion to vertex is backwards and upwards alike; the middle of the head lies below the chord.
    const Vec3 below = cross(along, m.left);
    m.back = normalized(along + below);
    m.up = cross(m.left, m.back);
    m.centre_mm = m.nasion + chord * 0.5 + below * (norm(chord) / 4);
  }
  return m;
}

/// The walk from the curve's start to `end`. Throws where it runs along a face that the scan's border cut; warns of
/// what it leaps over.
void check_walk(const OuterCurve& curve, Vec3 end, const std::vector<CutFace>& faces, const char* which,
                Warnings& warnings) {
  const Vec3 start = curve.points_mm[curve.start];
  double widest = 0;
  for (std::size_t i = curve.start; i < curve.points_mm.size() && norm(curve.points_mm[i] - start) <= norm(end - start);
       ++i) {
    const Vec3 p = curve.points_mm[i];
    if (i > curve.start) widest = std::max(widest, norm(p - curve.points_mm[i - 1]));
    for (const CutFace& face : faces)
      if (face.inside_mm(p) < on_cut_face_mm)
        refuse(fmt::format("the {} runs over the scan's edge at {}: that part of the head was not scanned", which,
                           text_of(p)),
               {"give the hole by `position_mm`, or take a series that holds the whole vault"});
  }
  if (widest > widest_gap_mm)
    warnings.push_back({"walk_leaps",
                        "the {walk} leaps over a gap or step of {gap_mm:.1f} mm in the surface",
                        {{"walk", which}, {"gap_mm", widest}}});
}

struct Entry {
  Vec3 point_mm, inwards;  ///< on the skin (or skull); about square to it
};

/// Along the midline, then to the side.
Entry kocher_point(const BurrHoleRequest& r, const Midline& m, const surface::TriMesh& surface,
                   const std::vector<CutFace>& faces, const char* surface_name,
                   Outcome<BurrHole, BurrHoleResult>& made) {
  const Vec3 front = normalized(m.nasion - m.centre_mm);
  const Vec3 onwards = normalized(m.up - front * dot(m.up, front));
  const OuterCurve midline =
      surface::without_ridges(outer_curve(surface, {m.centre_mm, front, onwards}), m.centre_mm, surface::brow_mm);
  const auto along = [&](const OuterCurve& curve, double length, const char* which) {
    const auto p = surface::point_along(curve, length);
    if (!p)
      refuse(fmt::format("the {} ends before {:.1f} mm along the {}", which, length, surface_name),
             {"lower `along_mm` or `lateral_mm`, or give the hole by `position_mm`"});
    return *p;
  };
  const Vec3 top = along(midline, r.along_mm, "midline");
  const double off = norm(midline.points_mm[midline.start] - m.nasion);
  if (off > farthest_nasion_mm)
    refuse(fmt::format("the nasion {} lies {:.1f} mm from the {}, at most {} mm", text_of(m.nasion), off, surface_name,
                       farthest_nasion_mm),
           {"give the right one in the case's configuration: `landmarks: {nasion: [x, y, z]}`, mm, LPS"});
  check_walk(midline, top, faces, "midline", made.warnings);
  const Vec3 behind = along(midline, r.along_mm + tangent_mm, "midline");
  const Vec3 ahead = along(midline, std::max(0.0, r.along_mm - tangent_mm), "midline");
  const Vec3 tangent = normalized(behind - ahead), outwards = cross(m.left, tangent);
  const Vec3 side = r.side == BurrHoleRequest::Side::left ? m.left : -m.left;
  const Vec3 middle = top - outwards * skull_depth_mm;
  const OuterCurve lateral = surface::without_ridges(outer_curve(surface, {middle, outwards, side, 5, 120}), middle, 0);
  const Vec3 point = along(lateral, r.lateral_mm, "arc to the side");
  check_walk(lateral, point, faces, "arc to the side", made.warnings);
  made.result.arcs = ArcFigures{m.source, surface_name, off, r.along_mm, r.lateral_mm};
  return {point, normalized(middle - point)};
}

/// The axis through the entry.
Vec3 direction_of(const BurrHoleRequest& r, const Entry& entry, const surface::TriMesh& skull) {
  const auto into_the_head = [&](Vec3 direction) {
    if (!(dot(direction, entry.inwards) > 0))
      refuse(fmt::format("the direction {} points out of the head", text_of(direction)),
             {"turn `direction` round, or leave it out"});
    return direction;
  };
  if (r.direction) return into_the_head(normalized(*r.direction));
  if (!r.toward_mm) return perpendicular_to_skull(skull, entry.point_mm, entry.inwards, r.diameter_mm / 2);
  const Vec3 way = *r.toward_mm - entry.point_mm;
  if (!(norm(way) > 1))
    refuse("toward_mm " + text_of(*r.toward_mm) + " lies at the entry itself",
           {"choose another `toward` or `target_mm`"});
  return into_the_head(normalized(way));
}

Outcome<BurrHole, BurrHoleResult> place(const BurrHoleRequest& request, const Landmarks& marks,
                                        const surface::TriMesh* skin, const surface::TriMesh& skull) {
  check_request(request);
  surface::check_mesh(skull);
  if (skull.triangles.empty())
    refuse("there is no skull: its surface is empty",
           {"lower `lower_hu` of its `segment`, or take a series with bone"});
  if (skin) surface::check_mesh(*skin);
  if (skin && skin->triangles.empty()) skin = nullptr;
  std::vector<CutFace> faces = cut_faces(skull);
  if (skin)
    for (const CutFace& face : cut_faces(*skin)) faces.push_back(face);

  Outcome<BurrHole, BurrHoleResult> made;
  Entry entry;
  if (request.at == BurrHoleRequest::At::kocher) {
    entry = kocher_point(request, find_midline(marks), skin ? *skin : skull, faces, skin ? "skin" : "skull", made);
  } else {
    const surface::Bounds b = surface::bounds_of(skull);
    entry = {request.position_mm, normalized((b.min_mm + b.max_mm) * 0.5 - request.position_mm)};
  }
  BurrHole& hole = made.value;
  hole.request = request;
  hole.direction = direction_of(request, entry, skull);
  const HoleSection section = hole_section(skull, skin, entry.point_mm, hole.direction, request.diameter_mm / 2);
  const auto on_axis = [&](double t) { return entry.point_mm + hole.direction * t; };
  hole.position_mm = on_axis(section.bone_enter_mm);
  hole.skin_mm = skin ? on_axis(section.skin_enter_mm) : hole.position_mm;
  hole.bone_thickness_mm = section.bone_leave_mm - section.bone_enter_mm;
  hole.cutter.kind = Cutter::Kind::cylinder;
  hole.cutter.name = request.name;
  hole.cutter.position_mm = hole.position_mm;
  hole.cutter.direction = hole.direction;
  hole.cutter.radius_mm = hole.cutter.end_radius_mm = request.diameter_mm / 2;
  hole.cutter.above_mm = section.bone_enter_mm - section.begin_mm;
  hole.cutter.depth_mm = section.end_mm - section.bone_enter_mm;
  check_within_scan(hole.cutter, section.bone_begin_mm - section.bone_enter_mm, faces);

  const Vec3 normal = perpendicular_to_skull(skull, hole.position_mm, hole.direction, request.diameter_mm / 2);
  made.result.bone_thickness_mm = hole.bone_thickness_mm;
  if (skin) made.result.soft_tissue_mm = section.bone_enter_mm - section.skin_enter_mm;
  made.result.axis_to_normal_deg = degrees(std::acos(std::clamp(dot(normal, hole.direction), -1.0, 1.0)));
  made.result.on_bone_ratio = section.on_bone_ratio;
  made.result.cutter_depth_mm = hole.cutter.depth_mm;
  return made;
}

}  // namespace

Outcome<BurrHole, BurrHoleResult> place_burr_hole(const BurrHoleRequest& asked, const Landmarks& landmarks_mm,
                                                  const surface::TriMesh* skin, const surface::TriMesh& skull) {
  BurrHoleRequest request = asked;
  if (request.name.empty()) request.name = "burr_hole_1";
  auto made = with_field("burr_holes." + request.name, [&] { return place(request, landmarks_mm, skin, skull); });
  const double moved_mm = norm(made.value.position_mm - request.position_mm);
  if (request.at == BurrHoleRequest::At::position && moved_mm > far_position_mm)
    made.warnings.push_back({"bone_far_from_position",
                             "the bone lies {moved_mm} mm from position_mm",
                             {{"moved_mm", to_text(ParameterValue(std::round(moved_mm)))}}});
  return made;
}

}  // namespace trephine::boolean
