// SPDX-License-Identifier: GPL-3.0-or-later
// Foreign surfaces: what other programs write is read, what is damaged is refused by name, and this process survives.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/write_file.h"
#include "meshing/validity.h"
#include "meshio/export_format.h"
#include "meshio/read_mesh.h"
#include "meshio_shapes.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;

constexpr Vec3 place{-93, 41, 712};

surface::TriMesh read(const fs::path& file, double max_s = 0) {
  meshio::ReadMeshLimits limits;
  limits.max_s = max_s;
  return meshio::read_mesh_file(file, limits).value;
}

fs::path write_as(const ScratchFolder& scratch, const char* format, const surface::TriMesh& mesh,
                  bool texture = false) {
  const auto files =
      meshio::encode_surfaces(meshio::export_format(format), {{&mesh, "ball", {0.5, 0.5, 0.5}, 1, texture}}, "ball");
  meshio::write_export(scratch.path(), files);
  return scratch.path() / files.back().name;
}

void expect_same_surface(const surface::TriMesh& got, const surface::TriMesh& want) {
  const meshing::Validity v = meshing::check_validity(got);
  EXPECT_TRUE(v.valid()) << v.text();
  EXPECT_EQ(got.triangles.size(), want.triangles.size());
  EXPECT_EQ(got.points_mm.size(), want.points_mm.size());
  EXPECT_NEAR(surface::volume_mm3(got), surface::volume_mm3(want), 1e-5 * surface::volume_mm3(want));
  const surface::Bounds a = surface::bounds_of(got), b = surface::bounds_of(want);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(a.min_mm[c], b.min_mm[c], 1e-3);
    EXPECT_NEAR(a.max_mm[c], b.max_mm[c], 1e-3);
  }
}

constexpr const char* readable[] = {"stl", "ply", "obj", "vtp", "vtk", "glb"};

TEST(ReadMesh, WhatWeWriteAlsoWhereVerticesAreDoubled) {
  const ScratchFolder scratch;
  const surface::TriMesh mesh = bumpy_ball(24, 13, place);
  for (const char* f : readable)
    for (const bool texture : {false, true}) {
      SCOPED_TRACE(f);
      expect_same_surface(read(write_as(scratch, f, mesh, texture)), mesh);
    }
}

TEST(ReadMesh, RasIsTurned) {
  const ScratchFolder scratch;
  const surface::TriMesh mesh = bumpy_ball(12, 7, place);
  surface::TriMesh ras = mesh;
  ras.origin_mm = {-place.x, -place.y, place.z};
  for (Vec3& p : ras.points_mm) p = {-p.x, -p.y, p.z};
  for (const char* f : {"stl", "ply", "obj", "vtk"}) {
    SCOPED_TRACE(f);
    const fs::path file = write_as(scratch, f, ras);
    const std::vector<char> bytes = read_file(file);
    std::string text(bytes.begin(), bytes.end());
    text.replace(text.find("SPACE=LPS"), 9, "SPACE=RAS");
    write_file(file, text);
    expect_same_surface(read(file), mesh);
  }
}

TEST(ReadMesh, FilesOfOtherPrograms) {
  const ScratchFolder scratch;
  // Text STL; quads and a group a face in OBJ, without a material; text PLY of quads; a legacy VTK strip and a quad.
  std::string stl = "solid cube\n", obj = "# a cube\n", ply;
  const double c[8][3] = {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}, {0, 0, 4}, {2, 0, 4}, {2, 3, 4}, {0, 3, 4}};
  const int quads[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  std::string vtk = "# vtk DataFile Version 3.0\na cube\nASCII\nDATASET POLYDATA\nPOINTS 8 float\n";
  ply =
      "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 6\nproperty list uchar int vertex_indices\nend_header\n";
  const auto text = [](const double* p) {
    return std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
  };
  for (const auto& p : c) {
    obj += "v " + text(p);
    ply += text(p);
    vtk += text(p);
  }
  vtk += "POLYGONS 6 30\n";
  int n = 0;
  for (const auto& q : quads) {
    for (const int last : {2, 3})
      stl += " facet normal 0 0 0\n  outer loop\n   vertex " + text(c[q[0]]) + "   vertex " + text(c[q[last - 1]]) +
             "   vertex " + text(c[q[last]]) + "  endloop\n endfacet\n";
    obj += "g face" + std::to_string(n++) + "\nf";
    ply += "4";
    vtk += "4";
    for (const int i : q) {
      obj += " " + std::to_string(i + 1);
      ply += " " + std::to_string(i);
      vtk += " " + std::to_string(i);
    }
    obj += "\n";
    ply += "\n";
    vtk += "\n";
  }
  stl += "endsolid cube\n";
  for (const auto& [name, bytes] :
       {std::pair{"cube.stl", stl}, {"cube.obj", obj}, {"cube.ply", ply}, {"CUBE.VTK", vtk}}) {
    SCOPED_TRACE(name);
    const surface::TriMesh cube = read(scratch.write(name, bytes));
    EXPECT_EQ(cube.points_mm.size(), 8u);
    EXPECT_EQ(cube.triangles.size(), 12u);
    EXPECT_NEAR(surface::volume_mm3(cube), 24, 1e-9);
    EXPECT_TRUE(meshing::check_validity(cube).valid());
  }
}

TEST(ReadMesh, FaultsAreNamed) {
  const ScratchFolder scratch;
  std::string line;
  EXPECT_EQ(code_of([&] { read(scratch.path() / "none.stl"); }), ExitCode::no_input);
  EXPECT_EQ(code_of([&] { read(scratch.write("a.dxf", "x")); }, &line), ExitCode::usage);
  EXPECT_NE(line.find(".stl .ply"), std::string::npos) << line;
  for (const char* name : {"e.stl", "e.ply", "e.obj", "e.vtp", "e.vtk", "e.glb"})
    for (const std::string bytes : {"", "x", "hello world, this is no mesh at all\n", "\0\0\0\0"}) {
      const fs::path file = scratch.write(name, bytes);
      EXPECT_EQ(code_of([&] { read(file); }, &line), ExitCode::bad_input) << name << " '" << bytes << "'";
      EXPECT_NE(line.find(file.string()), std::string::npos) << line;
    }
  meshio::ReadMeshLimits small;
  small.max_bytes = 100;
  for (const char* f : readable) {
    const surface::TriMesh mesh = bumpy_ball(12, 7, place);
    const fs::path file = write_as(scratch, f, mesh);
    EXPECT_EQ(code_of([&] { meshio::read_mesh_file(file, small); }), ExitCode::bad_input) << f;
  }
}

// A file's bits flipped and bytes cut; the same mutations each time. Refused with 65 naming the file, or read as some
// mesh whose indices and points are sound. Returns how many were refused.
int mutate(const char* format, int count, double max_s) {
  const ScratchFolder scratch;
  surface::TriMesh mesh = bumpy_ball(8, 5, place);
  const std::vector<char> bytes = read_file(write_as(scratch, format, mesh));
  std::uint64_t state = 88172645463325252ull;
  const auto random = [&](std::size_t below) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return std::size_t(state % below);
  };
  int refused = 0;
  for (int i = 0; i < count; ++i) {
    std::string bad(bytes.begin(), bytes.end());
    if (i % 4 == 0) {
      bad.resize(random(bad.size()));
    } else {
      const std::size_t where = i % 4 == 1 ? std::min<std::size_t>(bad.size(), 400) : bad.size();
      for (int n = 0; n < 1 + i % 3; ++n) bad[random(where)] ^= char(1 << random(8));
    }
    const fs::path file = scratch.write("bad." + std::string(format), bad);
    std::string line;
    const ExitCode code = code_of([&] { surface::check_mesh(read(file, max_s)); }, &line);
    EXPECT_TRUE(code == ExitCode::ok || code == ExitCode::bad_input) << line;
    if (code == ExitCode::ok) continue;
    EXPECT_NE(line.find(file.string()), std::string::npos) << line;
    ++refused;
  }
  return refused;
}

TEST(ReadMesh, MutatedFilesNeverKillUs) {
  for (const char* f : readable) EXPECT_GT(mutate(f, 24, 2), 0) << f;
}

TEST(LongReadMesh, ManyMutatedFilesNeverKillUs) {
  for (const char* f : readable) {
    const int refused = mutate(f, 300, 5);
    std::printf("%s: %d of 300 refused\n", f, refused);
    EXPECT_GT(refused, 0);
  }
}

TEST(ReadMesh, OthersBadMeshes) {
  const char* data = std::getenv("TREPHINE_DATA");
  const fs::path root =
      fs::path(data ? data : std::string(std::getenv("HOME")) + "/.cache/trephine-data") / "bad_meshes";
  if (!fs::exists(root)) GTEST_SKIP() << root << " is not there";
  int whole = 0, refused = 0;
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    std::string line;
    surface::TriMesh mesh;
    const ExitCode code = code_of([&] { mesh = read(file, 5); }, &line);
    if (code == ExitCode::usage) continue;  // OFF, 3DS and others
    EXPECT_TRUE(code == ExitCode::ok || code == ExitCode::bad_input) << line;
    if (code == ExitCode::ok) {
      EXPECT_NO_THROW(surface::check_mesh(mesh)) << file;
    }
    ++(code == ExitCode::ok ? whole : refused);
  }
  std::printf("%d read, %d refused\n", whole, refused);
  EXPECT_GT(whole, 20);
  EXPECT_GT(refused, 3);
}

}  // namespace
}  // namespace trephine
