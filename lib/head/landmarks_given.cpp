// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/text.h"
#include "head/landmarks_parts.h"
#include "mask/box_about.h"

namespace trephine::head {
namespace {

constexpr double max_outside_mm = 30;  ///< of the skin: what a scan cut off there may still be marked
constexpr double max_below_mm = 8;     ///< the skin, of a landmark that lies on it
constexpr double max_off_bone_mm = 8;  ///< of the bregma
constexpr double max_beside_mm = 20;   ///< the ventricles, of a foramen of Monro
constexpr double max_across_mm = 10;   ///< of the midsagittal plane

/// Calls f(distance from p in mm, whether it is of the shape) for every voxel within `reach_mm` of p along each axis,
/// until it says true.
template <class F>
void for_voxels(const grid::Field& shape, Vec3 p, double reach_mm, F&& f) {
  mask::for_box_about(shape, p, reach_mm, [&](int i, int j, int k, double mm) { return f(mm, shape.at(i, j, k) > 0); });
}

bool is_near(const grid::Field& shape, Vec3 p, double most_mm) {
  bool near = false;
  for_voxels(shape, p, most_mm, [&](double mm, bool inside) { return near = inside && mm <= most_mm; });
  return near;
}

/// Nothing but skin within so much of it; where the field ends it may lie on the surface.
bool is_deep(const grid::Field& skin, Vec3 p, double most_mm) {
  const Vec3 c = skin.to_index(p);
  for (int a = 0; a < 3; ++a)
    if (std::min(c[a], skin.size[a] - 1 - c[a]) * skin.spacing_mm[a] < most_mm) return false;
  bool bare = false;
  for_voxels(skin, p, most_mm, [&](double mm, bool inside) { return bare = !inside && mm <= most_mm; });
  return !bare;
}

bool begins_with(const std::string& name, const char* part) { return name.rfind(part, 0) == 0; }
bool is_on_skin(const std::string& name) {
  return name == "nasion" || name == "inion" || name == "vertex" || begins_with(name, "tragus") ||
         begins_with(name, "kocher");
}
bool is_known(const std::string& name) {
  const std::vector<std::string>& known = findable_landmarks();
  return std::find(known.begin(), known.end(), name) != known.end();
}

/// "tragus_left" of "left_tragus", or what is spelt nearly so.
std::string meant(const std::string& name) {
  const auto words = [](const std::string& s) {
    std::multiset<std::string> all;
    for (std::size_t at = 0, end; at <= s.size(); at = end + 1) {
      end = std::min(s.find('_', at), s.size());
      all.insert(s.substr(at, end - at));
    }
    return all;
  };
  for (const std::string& known : findable_landmarks())
    if (words(known) == words(name)) return known;
  return nearest_name(name, findable_landmarks());
}

/// How far it may lie from where it is found: nasion, ear and foramen are places, vertex and inion are what is highest
/// and what juts out.
double max_off_mm(const std::string& name) {
  return name == "vertex" ? 20 : name == "inion" ? 15 : begins_with(name, "tragus") ? 10 : 8;
}

}  // namespace

Error landmark_fault(const std::string& name, const std::string& what) {
  return Error(ExitCode::bad_input, "", name, what).finds_fault_with({name});
}

Warnings check_given(const std::vector<cases::CaseLandmark>& given, const grid::Field& skin, const grid::Field& skull,
                     const grid::Field* ventricles) {
  Warnings warnings;
  std::set<std::string> names;
  for (const cases::CaseLandmark& l : given) {
    if (!is_finite(l.position_mm)) throw landmark_fault(l.name, "is not finite");
    if (!names.insert(l.name).second) throw landmark_fault(l.name, "is given twice");
    if (!is_near(skin, l.position_mm, max_outside_mm)) {
      double mm = 1e300;
      for_voxels(skin, l.position_mm, 1e9, [&](double d, bool inside) {
        if (inside) mm = std::min(mm, d);
        return false;
      });
      const Vec3 p = l.position_mm;
      throw landmark_fault(
          l.name, fmt::format("({:.1f}, {:.1f}, {:.1f}) mm, lies {:.0f} mm outside of the skin, at most {:.0f}{}", p.x,
                              p.y, p.z, mm, max_outside_mm,
                              is_near(skin, {-p.x, -p.y, p.z}, max_outside_mm)
                                  ? ": with x and y negated it would not, RAS was taken for LPS or the reverse"
                                  : ": is it of another scan?"));
    }
    const auto lies_off = [&](const char* id, double most_mm, const char* what) {
      warnings.push_back({id, what, {{"landmark", l.name}, {"most_mm", most_mm}}});
    };
    if (is_on_skin(l.name) && is_deep(skin, l.position_mm, max_below_mm))
      lies_off("given_below_skin", max_below_mm, "{landmark} as given lies more than {most_mm:.0f} mm below the skin");
    if (l.name == "bregma" && !is_near(skull, l.position_mm, max_off_bone_mm))
      lies_off("given_off_bone", max_off_bone_mm, "{landmark} as given lies more than {most_mm:.0f} mm from the bone");
    if (ventricles && begins_with(l.name, "monro") && !is_near(*ventricles, l.position_mm, max_beside_mm))
      lies_off("given_beside_ventricles", max_beside_mm,
               "{landmark} as given lies more than {most_mm:.0f} mm from the ventricles");
    if (is_known(l.name)) continue;
    const std::string near = meant(l.name);
    if (near.empty())
      warnings.push_back({"unknown_landmark",
                          "{landmark} is none of the landmarks that are looked for: it is kept as it is",
                          {{"landmark", printable(l.name)}}});
    else
      warnings.push_back({"unknown_landmark",
                          "{landmark} is none of the landmarks that are looked for, did you mean {near}?",
                          {{"landmark", printable(l.name)}, {"near", near}}});
  }
  return warnings;
}

void check_sides(const std::vector<cases::CaseLandmark>& given, const MidsagittalPlane& plane) {
  for (const cases::CaseLandmark& l : given) {
    const std::size_t at = l.name.find('_');
    const std::string side = at == std::string::npos ? "" : l.name.substr(at + 1);
    // A foramen may have been shifted across.
    if (!is_known(l.name) || begins_with(l.name, "monro") || (side != "left" && side != "right")) continue;
    const double left_mm = dot(l.position_mm - plane.point_mm, plane.normal);
    if ((side == "left" ? -left_mm : left_mm) > max_across_mm)
      throw landmark_fault(
          l.name, fmt::format("lies {:.0f} mm to the {} of the midsagittal plane (x runs to the patient's left): are "
                              "left and right exchanged?",
                              std::abs(left_mm), left_mm > 0 ? "left" : "right"));
  }
}

std::optional<Warning> doubt_given(const cases::CaseLandmark& given, const std::optional<FoundPoint>& found) {
  const double off_mm = found ? norm(given.position_mm - found->position_mm) : 0;
  if (!found || !(found->confidence > 0.5) || !(off_mm > max_off_mm(given.name))) return std::nullopt;
  const Vec3 p = found->position_mm;
  return Warning{
      "given_far_from_found",
      "{landmark} as given lies {off_mm:.0f} mm from where it would be found, ({x_mm:.0f}, {y_mm:.0f}, {z_mm:.0f}) mm",
      {{"landmark", given.name}, {"off_mm", off_mm}, {"x_mm", p.x}, {"y_mm", p.y}, {"z_mm", p.z}}};
}

std::optional<MidsagittalPlane> plane_of_given(const std::vector<cases::CaseLandmark>& all) {
  const auto given = [&](const char* name) -> const Vec3* {
    for (const cases::CaseLandmark& l : all)
      if (l.name == name) return &l.position_mm;
    return nullptr;
  };
  const Vec3 *nasion = given("nasion"), *inion = given("inion"), *vertex = given("vertex");
  const Vec3 *left = given("tragus_left"), *right = given("tragus_right");
  const Vec3* other = inion ? inion : vertex;
  if (!nasion || !other) return {};
  const Vec3 along = normalized(*other - *nasion);
  Vec3 across;
  if (left && right)
    across = *left - *right;
  else if (inion && vertex)
    across = cross(along, *vertex - *nasion);
  else
    return {};
  const double before = norm(across);
  if (left && right && before < 60)
    throw Error(ExitCode::bad_input, "", "tragus_left, tragus_right",
                fmt::format("are {:.0f} mm apart, of a head at least 60", before));
  across = across - along * dot(across, along);
  if (!(norm(*other - *nasion) > 50) || !(norm(across) > 0.1 * before) || !(before > 0.02))
    throw Error(ExitCode::bad_input, "", "landmarks", "nasion, inion and tragi as given span no head");
  across = normalized(across);
  if (across.x < 0)
    throw Error(ExitCode::bad_input, "", "tragus_left",
                "lies to the right of tragus_right (x runs to the patient's left): are they exchanged?");
  return MidsagittalPlane{(*nasion + *other) * 0.5, across, 1};
}

HeadLandmarks merged(const HeadLandmarks& found, const std::vector<cases::CaseLandmark>& given) {
  HeadLandmarks out = found;
  for (const cases::CaseLandmark& g : given) {
    const auto same = std::find_if(out.landmarks.begin(), out.landmarks.end(),
                                   [&](const cases::CaseLandmark& l) { return l.name == g.name; });
    if (same != out.landmarks.end())
      *same = g;
    else
      out.landmarks.push_back(g);
  }
  return out;
}

}  // namespace trephine::head
