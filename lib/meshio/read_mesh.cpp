// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/read_mesh.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>

#include "base/error.h"
#include "base/write_file.h"
#include "cases/glb.h"
#include "meshing/validity.h"
#include "meshio/foreign.h"
#include "meshio/vtp.h"

namespace trephine::meshio {
namespace {

constexpr ForeignReader readers[] = {{ForeignProgram::assimp, "stl"}, {ForeignProgram::assimp, "ply"},
                                     {ForeignProgram::assimp, "obj"}, {ForeignProgram::vtk, "vtp"},
                                     {ForeignProgram::vtk, "vtk"},    {ForeignProgram::assimp, "glb"}};

const ForeignReader& reader_for(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
  std::string known;
  for (const ForeignReader& reader : readers) {
    if (extension == std::string(".") + reader.extension) return reader;
    known += std::string(known.empty() ? "." : " .") + reader.extension;
  }
  throw Error(ExitCode::usage, file.string(), "", "no surface file known by its extension: " + known);
}

// What Slicer says in STL's header, PLY's and OBJ's comments and legacy VTK's title.
bool says_ras(const ForeignReader& reader, std::string_view bytes) {
  std::string_view head = bytes.substr(0, reader.reads("stl") ? 80 : 4096);
  if (reader.reads("ply")) head = head.substr(0, head.find("end_header"));
  if (reader.reads("vtk")) head = head.substr(0, head.find("DATASET"));
  if (reader.reads("obj")) head = head.substr(0, head.find("\nv "));
  return head.find("SPACE=RAS") != std::string_view::npos;
}

surface::TriMesh joined(std::vector<ForeignSurface>&& surfaces) {
  surface::TriMesh mesh;
  for (ForeignSurface& s : surfaces) {
    const std::size_t base = mesh.points_mm.size();
    if (base + s.points.size() > 0xffffffffu) throw Error(ExitCode::bad_input, "", "", "too many points");
    mesh.points_mm.insert(mesh.points_mm.end(), s.points.begin(), s.points.end());
    for (const auto& t : s.triangles)
      mesh.triangles.push_back({std::uint32_t(base + t[0]), std::uint32_t(base + t[1]), std::uint32_t(base + t[2])});
    s = {};
  }
  return mesh;
}

// Sorts the points, so that of equal points the first one is kept. Returns how many were removed.
std::size_t merge_points(surface::TriMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.points_mm.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = std::uint32_t(i);
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 p = mesh.points_mm[a], q = mesh.points_mm[b];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    if (p.z != q.z) return p.z < q.z;
    return a < b;
  };
  std::sort(order.begin(), order.end(), less);
  std::vector<std::uint32_t> kept(order.size());
  std::size_t merged = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && mesh.points_mm[order[i]] == mesh.points_mm[order[i - 1]];
    kept[order[i]] = same ? kept[order[i - 1]] : order[i];
    merged += same;
  }
  for (auto& t : mesh.triangles)
    for (std::uint32_t& p : t) p = kept[p];
  return merged;
}

std::size_t drop_sideless(surface::TriMesh& mesh) {
  const std::size_t before = mesh.triangles.size();
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(),
                                      [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }),
                       mesh.triangles.end());
  return before - mesh.triangles.size();
}

std::optional<surface::TriMesh> own_glb(std::string_view bytes) {
  try {
    return cases::read_glb(bytes).mesh;
  } catch (const Error& e) {
    if (e.code() != ExitCode::bad_input) throw;
    return {};
  }
}

// The reader of PLY takes time with the square of the properties.
void check_ply_header(std::string_view bytes) {
  constexpr std::size_t max_properties = 1000, max_bytes = 1 << 20;
  const std::size_t end = bytes.find("end_header");
  const std::string_view head = bytes.substr(0, std::min(end, max_bytes));
  std::size_t properties = 0;
  for (std::size_t at = 0; (at = head.find("property", at)) != std::string_view::npos; at += 8) ++properties;
  if (properties > max_properties)
    throw Error(ExitCode::bad_input, "", "property",
                std::to_string(properties) + (end > max_bytes ? " or more" : "") + ", at most " +
                    std::to_string(max_properties) + " of a PLY file are read");
}

surface::TriMesh foreign_mesh(const ForeignReader& reader, std::string_view bytes, const ReadMeshLimits& limits,
                              const Progress& progress) {
  ChildLimits child = foreign_limits(bytes.size());
  if (reader.reads("ply")) check_ply_header(bytes);
  if (limits.max_s > 0) child.cpu_s = child.wall_s = limits.max_s;
  surface::TriMesh mesh;
  try {
    mesh = joined(read_foreign(reader, bytes, "", child, progress));
  } catch (const Error& e) {
    // The child process died, and only the bytes can be the cause.
    if (e.code() != ExitCode::internal) throw;
    throw Error(ExitCode::bad_input, "", "", std::string("damaged, or too much for its reader: ") + e.what());
  }
  if (reader.reads("glb"))
    for (Vec3& p : mesh.points_mm) p = {1000 * p.x, -1000 * p.z, 1000 * p.y};
  if (says_ras(reader, bytes))
    for (Vec3& p : mesh.points_mm) p = {-p.x, -p.y, p.z};
  return mesh;
}

}  // namespace

Outcome<surface::TriMesh, ReadMeshResult> read_mesh_file(const std::filesystem::path& file,
                                                         const ReadMeshLimits& limits, const Progress& progress) {
  return with_file(file.string(), [&]() -> Outcome<surface::TriMesh, ReadMeshResult> {
    const ForeignReader& reader = reader_for(file);
    surface::TriMesh mesh;
    bool ours = false;
    if (reader.reads("vtp")) {
      std::error_code unknown;
      if (const auto size = std::filesystem::file_size(file, unknown); !unknown && size > limits.max_bytes)
        throw Error(ExitCode::bad_input, "", "", "has more than " + std::to_string(limits.max_bytes) + " bytes");
      try {
        mesh = read_vtp(file);
      } catch (const Error& e) {
        if (e.code() != ExitCode::internal) throw;
        throw Error(ExitCode::bad_input, "", "", std::string("damaged, or too much for its reader: ") + e.what());
      }
    } else {
      const std::vector<char> read = read_file(file, limits.max_bytes);
      const std::string_view bytes(read.data(), read.size());
      if (bytes.empty()) throw Error(ExitCode::bad_input, "", "", "the file is empty");
      std::optional<surface::TriMesh> own;
      if (reader.reads("glb")) own = own_glb(bytes);
      ours = own.has_value();
      mesh = ours ? std::move(*own) : foreign_mesh(reader, bytes, limits, progress);
    }
    std::size_t merged = 0, dropped = 0;
    if (!ours && !surface::topology_of(mesh).closed()) {
      merged = merge_points(mesh);
      if (merged > 0) mesh.normals.clear();  // of a point's several sides
    }
    if (!ours) dropped = drop_sideless(mesh);
    if (mesh.triangles.empty()) throw Error(ExitCode::bad_input, "", "", "holds no triangle");
    surface::drop_unused_points(mesh);
    if (!ours && !reader.reads("vtp")) meshing::centre_origin(mesh);
    surface::check_mesh(mesh);
    const ReadMeshResult result{mesh.triangles.size(), merged, dropped, surface::topology_of(mesh).closed()};
    return {std::move(mesh), result, {}};
  });
}

}  // namespace trephine::meshio
