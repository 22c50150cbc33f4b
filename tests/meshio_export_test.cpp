// SPDX-License-Identifier: GPL-3.0-or-later
// Every format is written, read back by other programs, and compared; what is wrong is not published.
#include <gtest/gtest.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkOBJReader.h>
#include <vtkPLYReader.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSTLReader.h>
#include <vtkStringArray.h>

#include <cerrno>
#include <clocale>
#include <filesystem>
#include <sstream>

#include "base/pi.h"
#include "base/write_file.h"
#include "meshing/validity.h"
#include "meshio/export_format.h"
#include "meshio/texture.h"
#include "meshio_shapes.h"
#include "scratch_folder.h"

namespace trephine {
namespace {

namespace fs = std::filesystem;

constexpr Vec3 far_off{-93, 41, 712};
const std::array<double, 3> bone{0.93, 0.6, 0.2};

meshio::ExportSurface skull_of(const surface::TriMesh& mesh, bool texture = false) {
  return {&mesh, "skull", bone, 0.5, texture};
}

std::vector<meshio::ExportFile> encode(const std::string& format, const meshio::ExportSurface& s) {
  return meshio::encode_surfaces(meshio::export_format(format), {s}, "skull");
}

meshio::ExportCheck verify(const std::string& format, const meshio::ExportSurface& s,
                           const std::vector<meshio::ExportFile>& files) {
  return meshio::verify_export(meshio::export_format(format), {s}, files);
}

std::vector<std::string> all_names() {
  std::vector<std::string> names;
  for (const meshio::ExportFormat& f : meshio::format_types()) names.emplace_back(f.name);
  return names;
}

class EveryFormat : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Export, EveryFormat, testing::ValuesIn(all_names()),
                         [](const auto& info) { return info.param; });

TEST_P(EveryFormat, IsReadBackByAnotherProgram) {
  for (const bool texture : {false, true}) {
    const surface::TriMesh mesh = bumpy_ball(24, 13, far_off, 80, texture);
    const meshio::ExportCheck check =
        verify(GetParam(), skull_of(mesh, texture), encode(GetParam(), skull_of(mesh, texture)));
    EXPECT_EQ(check.triangles, mesh.triangles.size());
    EXPECT_LT(check.largest_difference_mm, 5e-4);
    EXPECT_FALSE(check.read_by.empty());
    const surface::Bounds b = surface::bounds_of(mesh);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(check.bounds_mm.min_mm[c], b.min_mm[c], 5e-4);
      EXPECT_NEAR(check.bounds_mm.max_mm[c], b.max_mm[c], 5e-4);
    }
  }
}

// The comparison finds a point off by 0.01 mm, a triangle less, another colour, another name, and lost bytes.
TEST_P(EveryFormat, WhatDiffersIsFound) {
  const std::string format = GetParam();
  const surface::TriMesh mesh = bumpy_ball(12, 7, far_off);
  const auto found = [&](const meshio::ExportSurface& other) {
    return code_of([&] { verify(format, skull_of(mesh), encode(format, other)); });
  };
  EXPECT_EQ(found(skull_of(mesh)), ExitCode::ok);
  surface::TriMesh moved = mesh;
  moved.points_mm[17].y += 0.01;
  EXPECT_EQ(found(skull_of(moved)), ExitCode::quality);
  surface::TriMesh turned = mesh;  // the same box and triangles, mirrored and turned inside out
  for (Vec3& p : turned.points_mm) p.x = -p.x;
  for (auto& t : turned.triangles) std::swap(t[0], t[1]);
  EXPECT_EQ(found(skull_of(turned)), ExitCode::quality);
  const surface::TriMesh fewer = bumpy_ball(12, 6, far_off);
  EXPECT_EQ(found(skull_of(fewer)), ExitCode::quality);
  meshio::ExportSurface green = skull_of(mesh);
  green.colour_rgb = {0.2, 0.9, 0.2};
  EXPECT_EQ(found(green), meshio::export_format(format).read_back.colour ? ExitCode::quality : ExitCode::ok);

  auto files = encode(format, skull_of(mesh));
  files.back().bytes.resize(files.back().bytes.size() / 2);
  const ExitCode half = code_of([&] { verify(format, skull_of(mesh), files); });
  EXPECT_TRUE(half == ExitCode::quality || half == ExitCode::internal) << "VTK's reader may die of it";
}

TEST_P(EveryFormat, SameBytesWhateverTheLocale) {
  const surface::TriMesh mesh = bumpy_ball(12, 7, far_off, 80, false);
  const auto plain = encode(GetParam(), skull_of(mesh, true));
  const char* names[] = {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"};
  for (const char* name : names) {
    const bool there = std::setlocale(LC_ALL, name) != nullptr;
    const auto again = encode(GetParam(), skull_of(mesh, true));
    std::setlocale(LC_ALL, "C");
    if (!there) continue;
    ASSERT_EQ(again.size(), plain.size());
    for (std::size_t i = 0; i < plain.size(); ++i) EXPECT_EQ(again[i].bytes, plain[i].bytes) << name;
  }
}

TEST_P(EveryFormat, SaysWhereItLies) {
  const surface::TriMesh mesh = bumpy_ball(8, 5, {});
  const std::string bytes = encode(GetParam(), skull_of(mesh)).back().bytes;
  if (GetParam() == "glb") {
    EXPECT_NE(bytes.find("\"frame\":\"LPS\""), std::string::npos);
    EXPECT_NE(bytes.find("\"unit\":\"mm\""), std::string::npos);
    return;
  }
  if (GetParam() == "vtp") {
    EXPECT_NE(bytes.find("Name=\"SPACE\""), std::string::npos);
    EXPECT_NE(bytes.find("Name=\"UNIT\""), std::string::npos);
    return;
  }
  if (GetParam() == "3mf") {  // its text is deflated: program.export reads it
    EXPECT_NE(bytes.find("3D/3dmodel.model"), std::string::npos);
    return;
  }
  EXPECT_LT(bytes.find("SPACE=LPS"), 100u);
  EXPECT_LT(bytes.find("UNIT=mm"), 120u);
}

TEST_P(EveryFormat, SurfacesThatAreNoneAreRefused) {
  const std::string format = GetParam();
  surface::TriMesh mesh;
  EXPECT_EQ(code_of([&] { encode(format, skull_of(mesh)); }), ExitCode::quality) << "no triangle";
  mesh = bumpy_ball(12, 7, {});
  mesh.triangles.pop_back();
  std::string line;
  EXPECT_EQ(code_of([&] { encode(format, skull_of(mesh)); }, &line), ExitCode::quality) << "a hole";
  EXPECT_NE(line.find("skull"), std::string::npos) << line;
  mesh = bumpy_ball(12, 7, {});
  mesh.points_mm[3].x = std::nan("");
  EXPECT_EQ(code_of([&] { encode(format, skull_of(mesh)); }), ExitCode::bad_input) << "NaN";
  mesh = bumpy_ball(12, 7, {});
  mesh.triangles[2][1] = 10000;
  EXPECT_EQ(code_of([&] { encode(format, skull_of(mesh)); }), ExitCode::bad_input) << "index";
}

// 100 km from the origin float32 knows steps of 8 mm: a ball of 4 mm collapses in world coordinates.
TEST_P(EveryFormat, RoundingThatBreaksTheSurfaceIsRefused) {
  const surface::TriMesh mesh = bumpy_ball(12, 7, {1e8, 0, 0}, 4);
  const bool world32 = meshio::export_format(GetParam()).precision == meshio::Precision::float32_world;
  std::string line;
  EXPECT_EQ(code_of([&] { encode(GetParam(), skull_of(mesh)); }, &line), world32 ? ExitCode::quality : ExitCode::ok)
      << line;
}

int no_space_at = 0, writes = 0;
long failing_write(int fd, const void* data, std::size_t size) {
  if (++writes >= no_space_at) {
    errno = ENOSPC;
    return -1;
  }
  return ::write(fd, data, size);
}

TEST_P(EveryFormat, AFullDiskLeavesNoFile) {
  const surface::TriMesh mesh = bumpy_ball(12, 7, {});
  const auto files = encode(GetParam(), skull_of(mesh));
  for (int at = 1; at <= int(files.size()); ++at) {
    const ScratchFolder scratch;
    const FileCalls real = file_calls();
    no_space_at = at;
    writes = 0;
    file_calls().write = failing_write;
    const ExitCode code = code_of([&] { meshio::write_export(scratch.path(), files); });
    file_calls() = real;
    EXPECT_EQ(code, ExitCode::io);
    EXPECT_TRUE(fs::is_empty(scratch.path()));
  }
  auto device = files.back();
  device.name = "full";
  EXPECT_EQ(code_of([&] { meshio::write_export("/dev", {device}); }), ExitCode::io);

  const ScratchFolder scratch;
  meshio::write_export(scratch.path(), files);
  for (const meshio::ExportFile& f : files) {
    const std::vector<char> read = read_file(scratch.path() / f.name);
    EXPECT_EQ(std::string(read.begin(), read.end()), f.bytes);
  }
}

TEST_P(EveryFormat, SeveralSurfacesWhereItHoldsThem) {
  const surface::TriMesh a = bumpy_ball(12, 7, {}), b = bumpy_ball(10, 6, {100, 20, 3});
  const std::vector<meshio::ExportSurface> both = {{&a, "left-1", {1, 0, 0}, 1, true},
                                                   {&b, "2nd.part", {0, 0.5, 1}, 0.25, false}};
  if (!meshio::export_format(GetParam()).several) {
    EXPECT_EQ(code_of([&] { meshio::encode_surfaces(meshio::export_format(GetParam()), both, "all"); }),
              ExitCode::internal);
    return;
  }
  const auto files = meshio::encode_surfaces(meshio::export_format(GetParam()), both, "all");
  EXPECT_EQ(meshio::verify_export(meshio::export_format(GetParam()), both, files).triangles,
            a.triangles.size() + b.triangles.size());
  const std::vector<meshio::ExportSurface> swapped = {both[1], both[0]};
  EXPECT_EQ(code_of([&] { meshio::verify_export(meshio::export_format(GetParam()), swapped, files); }),
            ExitCode::quality);
}

// A third opinion: readers that the library does not use. What 3D Slicer asks them for is there.
template <class Reader>
vtkPolyData* read_with(Reader& reader, const fs::path& file) {
  reader.SetFileName(file.c_str());
  reader.Update();
  return reader.GetOutput();
}

void expect_same(vtkPolyData* data, const surface::TriMesh& mesh) {
  ASSERT_EQ(std::size_t(data->GetNumberOfPolys()), mesh.triangles.size());
  const surface::Bounds b = surface::bounds_of(mesh);
  double got[6];
  data->GetBounds(got);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(got[2 * c], b.min_mm[c], 1e-4);
    EXPECT_NEAR(got[2 * c + 1], b.max_mm[c], 1e-4);
  }
}

// A scene of VRML or X3D is lit by what stands in it, and texture coordinates place a picture.
TEST(Export, VrmlAndX3dHoldLightsAndThePictureOfTheirTexture) {
  const auto count = [](const std::string& text, const std::string& word) {
    int n = 0;
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += word.size()) ++n;
    return n;
  };
  for (const char* format : {"wrl", "x3d"})
    for (const bool texture : {false, true}) {
      SCOPED_TRACE(std::string(format) + (texture ? " with a texture" : ""));
      const surface::TriMesh mesh = bumpy_ball(24, 13, far_off, 80, texture);
      const std::string text = encode(format, skull_of(mesh, texture)).back().bytes;
      EXPECT_EQ(count(text, "DirectionalLight"), 2);
      EXPECT_EQ(count(text, "NavigationInfo"), 1);
      EXPECT_EQ(count(text, "TextureCoordinate"), texture);
      EXPECT_EQ(count(text, "PixelTexture"), texture);
      EXPECT_EQ(count(text, "TextureTransform"), texture);
      const std::size_t at = text.find("32 32 1");
      ASSERT_EQ(at != std::string::npos, texture);
      if (!texture) continue;
      std::istringstream image(text.substr(at + 7));
      int pixels = 0, least = 255, most = 0;
      for (std::string word; image >> word && word.rfind("0x", 0) == 0; ++pixels) {
        const int grey = std::stoi(word.substr(2, 2), nullptr, 16);
        least = std::min(least, grey);
        most = std::max(most, grey);
      }
      EXPECT_EQ(pixels, 32 * 32);
      EXPECT_GE(least, 200) << "it dims the colour a little";
      EXPECT_GT(most - least, 40) << "and is seen";
    }
}

TEST(Export, VtkReadsStl) {
  const ScratchFolder scratch;
  const surface::TriMesh mesh = bumpy_ball(24, 13, far_off);
  meshio::write_export(scratch.path(), encode("stl", skull_of(mesh)));
  vtkNew<vtkSTLReader> reader;
  vtkPolyData* data = read_with(*reader, scratch.path() / "skull.stl");
  expect_same(data, mesh);
  EXPECT_EQ(std::size_t(data->GetNumberOfPoints()), mesh.points_mm.size()) << "its merging closes the mesh";
  EXPECT_NE(std::string(reader->GetHeader()).find("SPACE=LPS"), std::string::npos);
}

TEST(Export, VtkReadsPly) {
  const ScratchFolder scratch;
  const surface::TriMesh mesh = bumpy_ball(24, 13, far_off);
  meshio::write_export(scratch.path(), encode("ply", skull_of(mesh, true)));
  vtkNew<vtkPLYReader> reader;
  vtkPolyData* data = read_with(*reader, scratch.path() / "skull.ply");
  expect_same(data, mesh);
  ASSERT_NE(data->GetPointData()->GetScalars(), nullptr);
  EXPECT_EQ(data->GetPointData()->GetScalars()->GetComponent(5, 0), std::lround(255 * bone[0]));
  EXPECT_EQ(data->GetPointData()->GetScalars()->GetComponent(5, 2), std::lround(255 * bone[2]));
  EXPECT_NE(data->GetPointData()->GetNormals(), nullptr);
  ASSERT_NE(data->GetPointData()->GetTCoords(), nullptr);
  bool says = false;
  for (vtkIdType i = 0; i < reader->GetComments()->GetNumberOfValues(); ++i)
    says = says || reader->GetComments()->GetValue(i).find("SPACE=LPS") != std::string::npos;
  EXPECT_TRUE(says);
}

TEST(Export, VtkReadsObj) {
  const ScratchFolder scratch;
  const surface::TriMesh mesh = bumpy_ball(24, 13, far_off);
  meshio::write_export(scratch.path(), encode("obj", skull_of(mesh, true)));
  vtkNew<vtkOBJReader> reader;
  vtkPolyData* data = read_with(*reader, scratch.path() / "skull.obj");
  expect_same(data, mesh);
  EXPECT_NE(data->GetPointData()->GetNormals(), nullptr);
  EXPECT_NE(data->GetPointData()->GetTCoords(), nullptr);
  EXPECT_NE(std::string(reader->GetComment()).find("SPACE=LPS"), std::string::npos);
}

// Every triangle that does not touch the axis is as wide in u as it is seen from the axis, none runs backwards across
// the seam, the front is in the middle and the patient's left to the right of it.
TEST(Texture, SeamAndPoles) {
  const surface::TriMesh mesh = bumpy_ball(36, 18, far_off);
  const meshio::TextureMap map = meshio::spherical_texture(mesh);
  ASSERT_EQ(map.triangles.size(), mesh.triangles.size());
  int across = 0;
  for (std::size_t t = 0; t < map.triangles.size(); ++t) {
    double low = 1e9, high = -1e9;
    for (int c = 0; c < 3; ++c) {
      const meshio::TexturePoint& p = map.points[map.triangles[t][c]];
      EXPECT_EQ(p.point, mesh.triangles[t][c]);
      EXPECT_TRUE(p.u >= 0 && p.u < 2 && p.v >= 0 && p.v <= 1);
      low = std::min(low, p.u);
      high = std::max(high, p.u);
      const Vec3 d = mesh.points_mm[p.point];
      const double turn = 2 * pi * p.u;
      if (std::hypot(d.x, d.y) > 10) {  // about the centroid, which lies near the ball's middle
        EXPECT_NEAR(-std::sin(turn), d.x / std::hypot(d.x, d.y), 0.06);
        EXPECT_NEAR(std::cos(turn), d.y / std::hypot(d.x, d.y), 0.06);
      }
    }
    EXPECT_LT(high - low, 0.1);
    across += high > 1;
  }
  EXPECT_EQ(across, 2 * 17) << "one strip of triangles from pole to pole";
  // Doubled: a column of points behind, and each pole once a triangle.
  EXPECT_GT(map.points.size(), mesh.points_mm.size() + 17);
  EXPECT_LT(map.points.size(), mesh.points_mm.size() + 17 + 2 * 36 + 3);
}

TEST(Texture, CornersOnTheAxisAndAroundIt) {
  // An octahedron with its tips on the axis, and a flat one whose lid goes round it.
  surface::TriMesh m;
  m.points_mm = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  m.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}};
  for (const auto& t : meshio::spherical_texture(m).triangles) EXPECT_LT(t[0], 20u);
  const meshio::TextureMap map = meshio::spherical_texture(m);
  for (const auto& t : map.triangles) {
    const double a = map.points[t[0]].u, b = map.points[t[1]].u, pole = map.points[t[2]].u;
    EXPECT_NEAR(std::abs(a - b), 0.25, 1e-6);
    EXPECT_NEAR(pole, (a + b) / 2, 1e-6);
    const double v = map.points[t[2]].v;
    EXPECT_TRUE(v == 0 || v == 1);
  }
  surface::TriMesh lid;
  lid.points_mm = {{1, 0, 1}, {-0.5, 0.8, 1}, {-0.5, -0.8, 1}, {0, 0, -1}};
  lid.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  for (const auto& t : meshio::spherical_texture(lid).triangles) {
    const meshio::TextureMap around = meshio::spherical_texture(lid);
    const double u[] = {around.points[t[0]].u, around.points[t[1]].u, around.points[t[2]].u};
    EXPECT_LT(*std::max_element(u, u + 3) - *std::min_element(u, u + 3), 0.7);
  }
}

TEST(Export, TheMeshInMemoryIsNotTouched) {
  const surface::TriMesh mesh = bumpy_ball(12, 7, far_off), before = mesh;
  for (const std::string& f : all_names()) encode(f, skull_of(mesh, true));
  EXPECT_EQ(mesh.triangles, before.triangles);
  EXPECT_TRUE(mesh.points_mm == before.points_mm);
  EXPECT_TRUE(mesh.normals == before.normals);
}

}  // namespace
}  // namespace trephine
