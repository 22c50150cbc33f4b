// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>

#include "base/text.h"
#include "tetra/tetra_mesh.h"

namespace trephine::tetra {
namespace {

constexpr int vtk_triangle = 5, vtk_tetra = 10, gmsh_triangle = 2, gmsh_tetra = 4;

void append(std::string& out, Vec3 p) { out += to_text(p.x) + ' ' + to_text(p.y) + ' ' + to_text(p.z) + '\n'; }

template <class Corners>
void append_corners(std::string& out, const Corners& corners, std::uint32_t first) {
  for (const std::uint32_t c : corners) out += ' ' + std::to_string(c + first);
  out += '\n';
}

void begin_array(std::string& out, const char* type, const char* name, const char* more = "") {
  out += std::string("<DataArray type=\"") + type + "\" Name=\"" + name + "\"" + more + " format=\"ascii\">\n";
}
constexpr const char* end_array = "</DataArray>\n";

}  // namespace

std::string encode_vtu(const TetraMesh& mesh) {
  const std::size_t cells = mesh.tetrahedra.size() + mesh.borders.size();
  std::string out =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<!-- trephine SPACE=LPS UNIT=mm -->\n<UnstructuredGrid>\n<FieldData>\n";
  // A number for each region, by its name: texts are not read by all.
  for (std::size_t r = 1; r <= mesh.regions.size(); ++r) {
    begin_array(out, "Int64", mesh.regions[r - 1].c_str(), " NumberOfTuples=\"1\"");
    out += std::to_string(r) + '\n' + end_array;
  }
  out += "</FieldData>\n<Piece NumberOfPoints=\"" + std::to_string(mesh.points_mm.size()) + "\" NumberOfCells=\"" +
         std::to_string(cells) + "\">\n<CellData Scalars=\"region\">\n";
  begin_array(out, "UInt8", "region");
  for (const std::uint8_t r : mesh.region_of) out += std::to_string(r) + '\n';
  for (const auto& b : mesh.between) out += std::to_string(b[0]) + '\n';
  out += end_array;
  begin_array(out, "UInt8", "beyond");
  for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) out += "0\n";
  for (const auto& b : mesh.between) out += std::to_string(b[1]) + '\n';
  out += std::string(end_array) + "</CellData>\n<Points>\n";
  begin_array(out, "Float64", "Points", " NumberOfComponents=\"3\"");
  for (const Vec3 p : mesh.points_mm) append(out, p);
  out += std::string(end_array) + "</Points>\n<Cells>\n";
  begin_array(out, "Int64", "connectivity");
  for (const auto& t : mesh.tetrahedra) append_corners(out, t, 0);
  for (const auto& t : mesh.borders) append_corners(out, t, 0);
  out += end_array;
  begin_array(out, "Int64", "offsets");
  for (std::size_t n = 0; n < cells; ++n)
    out +=
        std::to_string(n < mesh.tetrahedra.size() ? 4 * (n + 1)
                                                  : 4 * mesh.tetrahedra.size() + 3 * (n + 1 - mesh.tetrahedra.size())) +
        '\n';
  out += end_array;
  begin_array(out, "UInt8", "types");
  for (std::size_t n = 0; n < cells; ++n)
    out += std::to_string(n < mesh.tetrahedra.size() ? vtk_tetra : vtk_triangle) + '\n';
  return out + end_array + "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

std::string encode_msh(const TetraMesh& mesh) {
  const auto name_of = [&](std::uint8_t region) {
    return region == 0 ? std::string("outside") : mesh.regions[region - 1u];
  };
  std::map<std::array<std::uint8_t, 2>, int> surfaces;  // each pair that meets, numbered after the volumes
  for (const auto& b : mesh.between) surfaces.emplace(b, 0);
  int number = int(mesh.regions.size());
  for (auto& s : surfaces) s.second = ++number;
  std::string out =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Comments\ntrephine SPACE=LPS UNIT=mm\n$EndComments\n"
      "$PhysicalNames\n" +
      std::to_string(number) + "\n";
  for (const auto& s : surfaces)
    out += "2 " + std::to_string(s.second) + " \"" + name_of(s.first[0]) + "|" + name_of(s.first[1]) + "\"\n";
  for (std::size_t r = 1; r <= mesh.regions.size(); ++r)
    out += "3 " + std::to_string(r) + " \"" + mesh.regions[r - 1] + "\"\n";
  out += "$EndPhysicalNames\n$Nodes\n" + std::to_string(mesh.points_mm.size()) + "\n";
  for (std::size_t n = 0; n < mesh.points_mm.size(); ++n) {
    out += std::to_string(n + 1) + ' ';
    append(out, mesh.points_mm[n]);
  }
  out += "$EndNodes\n$Elements\n" + std::to_string(mesh.borders.size() + mesh.tetrahedra.size()) + "\n";
  std::size_t element = 0;
  const auto cell = [&](int type, int physical, const auto& corners) {
    const std::string tag = std::to_string(physical);
    out += std::to_string(++element) + ' ' + std::to_string(type) + " 2 " + tag + ' ' + tag;
    append_corners(out, corners, 1);
  };
  for (std::size_t n = 0; n < mesh.borders.size(); ++n)
    cell(gmsh_triangle, surfaces.at(mesh.between[n]), mesh.borders[n]);
  for (std::size_t n = 0; n < mesh.tetrahedra.size(); ++n) cell(gmsh_tetra, mesh.region_of[n], mesh.tetrahedra[n]);
  return out + "$EndElements\n";
}

}  // namespace trephine::tetra
