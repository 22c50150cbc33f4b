// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/pi.h"
#include "cases/case.h"
#include "cases/glb.h"
#include "cases/load_case.h"
#include "voxel/haptic_file.h"

/// Cases made in memory, nested balls with a bumpy surface, for tests and benchmarks of who loads them.
namespace case_samples {

using namespace trephine;

struct MemoryCase {
  cases::CaseManifest manifest;
  std::map<std::string, std::string> files;  ///< by name; case.json among them once seal() was called

  /// Writes case.json anew, with the size and SHA-256 of every file as it is now.
  void seal() {
    for (cases::CaseFile& f : manifest.files) {
      f.sha256 = sha256_of_bytes(files.at(f.name));
      f.bytes = files.at(f.name).size();
    }
    files["case.json"] = cases::to_json(manifest);
  }
  /// case.json with `from` replaced (the first time) and the checksum that belongs to it.
  void edit_json(const std::string& from, const std::string& to) {
    std::string& json = files["case.json"];
    const auto at = json.find(from);
    if (at == std::string::npos) throw Error(ExitCode::internal, "", from, "is not in case.json");
    json.replace(at, from.size(), to);
    json.resize(json.rfind(",\n \"checksum\""));
    json += ",\n \"checksum\": \"" + sha256_of_bytes(json) + "\"\n}\n";
  }
  std::size_t bytes() const {
    std::size_t n = 0;
    for (const auto& f : files) n += f.second.size();
    return n;
  }
  cases::CaseFileReader reader() const {
    return [this](const std::string& name, std::uint64_t) {
      const auto found = files.find(name);
      if (found == files.end()) throw Error(ExitCode::no_input, name, "", "not found");
      return std::vector<char>(found->second.begin(), found->second.end());
    };
  }
  void write(const std::filesystem::path& folder) const {
    for (const auto& [name, content] : files) {
      std::filesystem::create_directories((folder / name).parent_path());
      std::ofstream(folder / name, std::ios::binary) << content;
    }
  }
};

/// Of the ball's surface in that direction, as a share of its radius.
inline double bump(Vec3 unit) { return 1 + 0.04 * unit.x * unit.y + 0.03 * unit.z * unit.z; }

/// About 4 rings^2 triangles.
inline surface::TriMesh ball(double radius_mm, int rings) {
  const int segments = 2 * rings;
  surface::TriMesh m;
  const auto add = [&](double theta, double phi) {
    const Vec3 unit{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    m.points_mm.push_back(unit * (radius_mm * bump(unit)));
  };
  add(0, 0);
  for (int r = 1; r < rings; ++r)
    for (int s = 0; s < segments; ++s) add(pi * r / rings, 2 * pi * s / segments);
  add(pi, 0);
  const auto at = [&](int r, int s) { return std::uint32_t(1 + (r - 1) * segments + s % segments); };
  const auto last = std::uint32_t(m.points_mm.size() - 1);
  for (int s = 0; s < segments; ++s) {
    m.triangles.push_back({0, at(1, s), at(1, s + 1)});
    for (int r = 1; r + 1 < rings; ++r) {
      m.triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
      m.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
    }
    m.triangles.push_back({at(rings - 1, s), last, at(rings - 1, s + 1)});
  }
  return m;
}

struct Ball {
  std::string name;
  double radius_mm;
  int rings;
};

/// Balls from the outermost to the innermost as shapes 1, 2, ...; the lattice of n voxels a side covers them all.
inline voxel::HapticVolume haptic_of(const std::vector<Ball>& balls, Vec3 center_mm, int n) {
  voxel::HapticVolume v;
  const double side = 2.2 * balls[0].radius_mm / n;
  grid::Lattice lattice;
  lattice.size = {n, n, n};
  lattice.spacing_mm = {side, side, side};
  lattice.origin_mm = center_mm - Vec3{1, 1, 1} * (side * (n - 1) / 2.0);
  v.voxels = grid::Grid<std::int16_t>(lattice);
  v.hardness = grid::Mask(lattice);
  for (std::size_t b = 0; b < balls.size(); ++b) v.shapes.push_back(voxel::occupancy_shape(balls[b].name, int(b) + 1));
  parallel_for(0, n, 1, [&](std::int64_t k, std::int64_t) {
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec3 p = lattice.to_world_mm({double(i), double(j), double(k)}) - center_mm;
        const double r = norm(p) / bump(normalized(p));
        // The innermost ball that fills at least half of the voxel, or what the outermost fills of it; what the ball
        // within it fills of the rest is not its own.
        const auto share = [&](std::size_t b) {
          return b < balls.size() ? std::clamp(0.5 + (balls[b].radius_mm - r) / side, 0.0, 1.0) : 0.0;
        };
        for (std::size_t b = balls.size(); b-- > 0;) {
          if (share(b) < (b == 0 ? 0.002 : 0.5)) continue;
          const int occupancy = std::max(1, int(std::lround(255 * std::min(share(b), 1 - share(b + 1)))));
          v.voxels.at(i, j, int(k)) = std::int16_t(voxel::haptic_base_step * (int(b) + 1) + occupancy);
          v.hardness.at(i, j, int(k)) = std::uint8_t(40 * b);
          break;
        }
      }
  });
  return v;
}

inline MemoryCase make_case(const std::vector<Ball>& balls, int voxels) {
  MemoryCase c;
  cases::CaseManifest& m = c.manifest;
  m.case_token = "sample";
  m.center_mm = {1, -20, 300};
  m.program_version = "trephine 0.1.0";
  m.input_sha256 = sha256_of_bytes("input");
  m.parameters = {{"outer.decimate.max_deviation_mm", 0.2}};
  m.landmarks = {{"nasion", {1, -110, 300}, 1, "given"}};
  m.targets = {{"middle", {1, -20, 300}, 0.8, balls.back().name}};
  const auto add_file = [&](const std::string& stem, const std::string& extension, const std::string& bytes) {
    m.files.push_back(cases::describe_case_file(stem, extension, bytes));
    c.files[m.files.back().name] = bytes;
    return m.files.back().name;
  };
  for (const Ball& b : balls) {
    surface::TriMesh mesh = ball(b.radius_mm, b.rings);
    mesh.origin_mm = m.center_mm;
    cases::GlbParams params;
    params.center_mm = m.center_mm;
    params.name = b.name;
    cases::CaseAnatomy a;
    a.name = b.name;
    a.file = add_file("meshes/" + b.name, ".glb", cases::make_glb(mesh, params));
    a.triangles = mesh.triangles.size();
    a.points = mesh.points_mm.size();
    a.volume_ml = surface::volume_mm3(mesh) / 1000;
    a.area_cm2 = surface::area_mm2(mesh) / 100;
    a.deviation = {0.2, 0.1, 0.05};
    a.budget_asked_mm = 0.3;
    a.budget_used_mm = 0.2;
    m.anatomies.push_back(a);
  }
  const voxel::HapticVolume volume = haptic_of(balls, m.center_mm, voxels);
  m.haptic.file = add_file("haptic", ".nrrd", voxel::encode_haptic(volume));
  m.haptic.hardness_file = add_file("hardness", ".nrrd", voxel::encode_hardness(volume));
  m.haptic.size = volume.voxels.size;
  m.haptic.spacing_mm = volume.voxels.spacing_mm;
  for (const voxel::HapticShape& s : volume.shapes) {
    cases::CaseShape shape;
    shape.name = s.name;
    shape.number = s.number;
    shape.window_low = s.window_low;
    shape.window_high = s.window_high;
    shape.material.name = "tissue";
    shape.material.front = {true, 0.8, 0.001, 0.4, 0.3, 2};
    shape.material.back = {false, 0, 0, 0, 0, 0};
    shape.mismatch = {0.01, 0.05, 0.12, 0.2, 0, 50000};
    m.haptic.shapes.push_back(shape);
  }
  m.burr_holes = {{"entry", {1, -20, 390}, {0, 0, -1}, 14, {balls[0].name}, {{"bone_thickness_mm", 6.5}}}};
  c.seal();
  return c;
}

/// A case of every part, as small as it can be: about 16 KiB.
inline MemoryCase minimal_case() { return make_case({{"outer", 80, 7}, {"inner", 40, 4}}, 10); }

/// A closed plate between two corners, with n x n squares on its large sides.
inline surface::TriMesh plate(Vec3 low, Vec3 high, int n) {
  surface::TriMesh m;
  const auto at = [&](int side, int i, int j) { return std::uint32_t((side * (n + 1) + j) * (n + 1) + i); };
  for (int side = 0; side < 2; ++side)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i)
        m.points_mm.push_back(
            {low.x + (high.x - low.x) * i / n, low.y + (high.y - low.y) * j / n, side ? high.z : low.z});
  const auto square = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    m.triangles.push_back({a, b, c});
    m.triangles.push_back({a, c, d});
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      square(at(1, i, j), at(1, i + 1, j), at(1, i + 1, j + 1), at(1, i, j + 1));
      square(at(0, i, j), at(0, i, j + 1), at(0, i + 1, j + 1), at(0, i + 1, j));
    }
    square(at(0, i, 0), at(0, i + 1, 0), at(1, i + 1, 0), at(1, i, 0));
    square(at(0, i + 1, n), at(0, i, n), at(1, i, n), at(1, i + 1, n));
    square(at(0, 0, i + 1), at(0, 0, i), at(1, 0, i), at(1, 0, i + 1));
    square(at(0, n, i), at(0, n, i + 1), at(1, n, i + 1), at(1, n, i));
  }
  return m;
}

/// A ball of bone around one of brain, in voxels of 0.64 mm, with a place to drill on top.
inline MemoryCase drill_case() {
  MemoryCase c = make_case({{"skull", 14, 12}, {"brain", 8, 8}}, 48);
  cases::CaseShape& skull = c.manifest.haptic.shapes[0];
  skull.cuttable = true;
  skull.material.removal_energy_j_per_mm3 = 0.1;
  skull.material.front.pop_through_n = 0;
  c.manifest.landmarks.push_back({"kocher_right", {1, -20, 314}, 1, "given"});
  c.seal();
  return c;
}

/// The same with a plate of metal above the place to drill, 16 mm wide and 1 mm thick, which is touched as a mesh.
inline MemoryCase plate_case() {
  MemoryCase c = drill_case();
  cases::CaseManifest& m = c.manifest;
  surface::TriMesh mesh = plate({-8, -8, 15}, {8, 8, 16}, 40);
  mesh.origin_mm = m.center_mm;
  cases::GlbParams params;
  params.center_mm = m.center_mm;
  params.name = "plate";
  const std::string bytes = cases::make_glb(mesh, params);
  m.files.push_back(cases::describe_case_file("meshes/plate", ".glb", bytes));
  c.files[m.files.back().name] = bytes;
  cases::CaseAnatomy a;
  a.name = "plate";
  a.file = m.files.back().name;
  a.triangles = mesh.triangles.size();
  const cases::GlbMesh read = cases::read_glb(std::string_view(bytes));
  a.points = read.mesh.points_mm.size();
  a.volume_ml = surface::volume_mm3(mesh) / 1000;
  a.area_cm2 = surface::area_mm2(mesh) / 100;
  a.touched_as.emplace();
  a.touched_as->name = "metal";
  a.touched_as->front = {true, 1.5, 0, 0.2, 0.15, 0};
  a.touched_as->back.touchable = false;
  m.anatomies.push_back(a);
  c.seal();
  return c;
}

/// Scalp that an incision takes away, a skull that is drilled and shown from its voxels of 1.2 mm, and a brain.
inline MemoryCase play_case() {
  MemoryCase c = make_case({{"scalp", 40, 40}, {"skull", 35, 30}, {"brain", 28, 24}}, 72);
  cases::CaseManifest& m = c.manifest;
  cases::CaseShape &scalp = m.haptic.shapes[0], &skull = m.haptic.shapes[1];
  scalp.cuttable = skull.cuttable = true;
  skull.displayed = "haptic";
  skull.mismatch = {};
  skull.material.removal_energy_j_per_mm3 = 0.1;
  skull.material.front.pop_through_n = 0;
  skull.material.colour_rgb = {0.93, 0.89, 0.78};
  m.anatomies[0].colour_rgb = {0.87, 0.68, 0.56};
  m.anatomies[2].colour_rgb = {0.5, 0.3, 0.8};
  m.burr_holes.clear();
  m.landmarks.push_back({"kocher_right", {1, -20, 340.5}, 1, "given"});
  c.seal();
  return c;
}

/// Four anatomies, 210,000 triangles, 256^3 voxels.
inline MemoryCase full_size_case() {
  return make_case({{"skin", 100, 142}, {"skull", 92, 136}, {"brain", 80, 98}, {"ventricles", 30, 72}}, 256);
}

}  // namespace case_samples
