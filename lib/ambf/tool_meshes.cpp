// SPDX-License-Identifier: GPL-3.0-or-later
#include "ambf/tool_meshes.h"

#include <cmath>

#include "base/pi.h"
#include "base/text.h"
#include "meshio/export_format.h"

namespace trephine::ambf {
namespace {

constexpr int sides = 32, rings = 20;  // one ring of both balls is their widest
constexpr double shaft_mm = 60, shaft_ratio = 0.5;

// A profile about the x axis, from one end on the axis to the other.
surface::TriMesh turned(const std::vector<std::array<double, 2>>& profile) {
  surface::TriMesh m;
  const std::size_t inner = profile.size() - 2;
  m.points_mm.push_back({profile.front()[0], 0, 0});
  for (std::size_t n = 1; n <= inner; ++n)
    for (int s = 0; s < sides; ++s) {
      const double turn = 2 * pi * s / sides;
      m.points_mm.push_back({profile[n][0], profile[n][1] * std::cos(turn), profile[n][1] * std::sin(turn)});
    }
  m.points_mm.push_back({profile.back()[0], 0, 0});
  const auto at = [&](std::size_t ring, int s) { return std::uint32_t(1 + ring * sides + std::size_t(s % sides)); };
  const auto last = std::uint32_t(m.points_mm.size() - 1);
  for (int s = 0; s < sides; ++s) {
    m.triangles.push_back({0, at(0, s + 1), at(0, s)});
    for (std::size_t r = 0; r + 1 < inner; ++r) {
      m.triangles.push_back({at(r, s), at(r, s + 1), at(r + 1, s)});
      m.triangles.push_back({at(r, s + 1), at(r + 1, s + 1), at(r + 1, s)});
    }
    m.triangles.push_back({at(inner - 1, s), at(inner - 1, s + 1), last});
  }
  return m;
}

// The ball from -radius on, as far as the shaft begins.
std::vector<std::array<double, 2>> ball(double radius, double until_rad) {
  std::vector<std::array<double, 2>> profile;
  for (int r = 0; r <= rings; ++r) {
    const double turn = until_rad * r / rings;
    profile.push_back({-radius * std::cos(turn), r == 0 ? 0 : radius * std::sin(turn)});
  }
  return profile;
}

surface::TriMesh burr(double diameter_mm) {
  const double radius = diameter_mm / 2, thin = shaft_ratio * radius;
  auto profile = ball(radius, pi - std::asin(shaft_ratio));
  profile.push_back({shaft_mm, thin});
  profile.push_back({shaft_mm, 0});
  return turned(profile);
}

surface::TriMesh mark(double diameter_mm) {
  auto profile = ball(diameter_mm / 2, pi);
  profile.back()[1] = 0;
  return turned(profile);
}

}  // namespace

std::vector<meshio::ExportFile> tool_meshes(double mark_diameter_mm) {
  const meshio::ExportFormat& obj = meshio::export_format("obj");
  std::vector<meshio::ExportFile> files;
  const auto add = [&](const surface::TriMesh& mesh, const std::string& name, std::array<double, 3> rgb) {
    for (meshio::ExportFile& f : meshio::encode_surfaces(obj, {{&mesh, name, rgb, 1, false}}, name))
      files.push_back(std::move(f));
  };
  for (const int mm : burrs_mm) add(burr(mm), to_text(mm) + "mm", {0.53, 0.5, 0.51});
  add(mark(mark_diameter_mm), "mark", {0.2, 0.7, 0.3});
  return files;
}

}  // namespace trephine::ambf
