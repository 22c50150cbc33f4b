// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/vtp_parse.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkXMLPolyDataReader.h>

#include <cctype>
#include <cmath>
#include <cstring>
#include <new>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "base/error.h"
#include "base/text.h"
#include "grid/length_unit.h"
#include "meshio/formats/formats_inside.h"

namespace trephine::meshio {
namespace {

constexpr const char* altered =
    "damaged, or its Points changed by a program that kept the array local_points_mm (then remove that)";

[[noreturn]] void damaged(const std::string& field, const std::string& what) {
  throw Error(ExitCode::bad_input, "", field, what);
}

// The count that the header gives at `at` ("NumberOfPoints="), or none where it gives no text.
std::optional<std::uint64_t> declared_count(std::string_view head, std::size_t at, const std::string& name,
                                            std::size_t file_size) {
  const auto blank = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  std::size_t from = at + name.size();
  while (from < head.size() && (blank(head[from]) || head[from] == '=')) ++from;
  if (from >= head.size() || (head[from] != '"' && head[from] != '\'')) return {};
  const std::size_t to = head.find(head[from], from + 1);
  std::string_view digits = head.substr(from + 1, to == std::string_view::npos ? 0 : to - from - 1);
  while (!digits.empty() && blank(digits.back())) digits.remove_suffix(1);
  while (!digits.empty() && blank(digits.front())) digits.remove_prefix(1);
  if (digits.empty()) return {};
  const auto count = parse_integer(digits);
  if (!count || *count < 0 || std::uint64_t(*count) / 100 > file_size)
    damaged(name,
            std::string(digits.substr(0, 30)) + " does not fit a file of " + std::to_string(file_size) + " bytes");
  return std::uint64_t(*count);
}

struct Declared {
  std::uint64_t points = 0, polys = 0;
};

// VTK allocates as much as the header's counts ask for before it finds that the data are missing, and then gives an
// empty result without an error. A point takes at least 12 bytes, which deflate reduces by a factor of 1030 at most. So
// no file holds 100 points in a byte.
Declared check_counts(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, bytes.find("<AppendedData"));
  Declared declared;
  for (const std::string name : {"NumberOfPoints", "NumberOfPolys", "NumberOfVerts", "NumberOfLines", "NumberOfStrips",
                                 "NumberOfTuples", "NumberOfComponents"})
    for (std::size_t at = head.find(name); at != std::string_view::npos; at = head.find(name, at + 1)) {
      const auto count = declared_count(head, at, name, bytes.size());
      if (count && name == "NumberOfPoints") declared.points = *count;
      if (count && name == "NumberOfPolys") declared.polys = *count;
    }
  return declared;
}

vtkSmartPointer<vtkPolyData> parse(std::string&& text) {
  // VTK prints several lines for a fault to stderr; this program says one line for each fault.
  vtkObject::GlobalWarningDisplayOff();
  try {
    vtkNew<vtkXMLPolyDataReader> reader;
    reader->ReadFromInputStringOn();
    reader->SetInputString(std::move(text));
    reader->Update();
    if (reader->GetErrorCode() != 0 || reader->GetNumberOfPieces() != 1)
      damaged("", "not a whole VTK XML PolyData file of one piece");
    return reader->GetOutput();
  } catch (const std::bad_alloc&) {
    damaged("", "damaged: asks for more memory than there is");
  } catch (const std::length_error&) {
    damaged("", "damaged: asks for more memory than there is");
  }
}

std::vector<Vec3> read_vectors(vtkDataArray* array, std::size_t count, const std::string& name) {
  if (array->GetNumberOfComponents() != 3 || std::size_t(array->GetNumberOfTuples()) != count)
    damaged(name, "must hold 3 values for each of the " + std::to_string(count) + " points");
  std::vector<Vec3> v(count);
  if (auto* d = vtkDoubleArray::SafeDownCast(array)) {
    if (count) std::memcpy(&v[0].x, d->GetPointer(0), count * sizeof(Vec3));
  } else {
    for (std::size_t i = 0; i < count; ++i) array->GetTuple(vtkIdType(i), &v[i].x);
  }
  return v;
}

std::string text_field(vtkFieldData* fields, const char* name) {
  auto* a = fields ? vtkStringArray::SafeDownCast(fields->GetAbstractArray(name)) : nullptr;
  return a && a->GetNumberOfValues() > 0 ? std::string(a->GetValue(0)) : std::string();
}

Vec3 origin_field(vtkFieldData* fields) {
  auto* a = fields ? vtkDoubleArray::SafeDownCast(fields->GetAbstractArray(vtp_origin_name)) : nullptr;
  if (!a) return {};
  if (a->GetNumberOfValues() != 3) damaged(vtp_origin_name, "must be 3 numbers");
  const Vec3 origin{a->GetValue(0), a->GetValue(1), a->GetValue(2)};
  if (!is_finite(origin)) damaged(vtp_origin_name, "is not finite");
  return origin;
}

void read_triangles(vtkPolyData* data, surface::TriMesh& mesh) {
  if (data->GetNumberOfVerts() + data->GetNumberOfLines() + data->GetNumberOfStrips() > 0)
    damaged("", "has vertices, lines or strips; only triangles are read");
  vtkCellArray* cells = data->GetPolys();
  const vtkIdType n = cells->GetNumberOfCells(), points = data->GetNumberOfPoints();
  // Offsets come from the file; before a cell is touched they must be 0, 3, 6, ... within the ids that are there.
  vtkDataArray* offsets = cells->GetOffsetsArray();
  vtkDataArray* ids = cells->GetConnectivityArray();
  if (n > 0 && (offsets->GetNumberOfValues() != n + 1 || ids->GetNumberOfValues() != 3 * n))
    damaged("Polys", "not every polygon is a triangle");
  mesh.triangles.resize(std::size_t(n));
  const auto copy = [&](const auto* o, const auto* p) {
    for (vtkIdType i = 0; i <= n; ++i)
      if (o[i] != 3 * i) damaged("Polys", "not every polygon is a triangle");
    for (vtkIdType i = 0; i < 3 * n; ++i) {
      if (p[i] < 0 || p[i] >= points)
        damaged("Polys", "point index " + std::to_string(p[i]) + " of " + std::to_string(points) + " points");
      mesh.triangles[std::size_t(i / 3)][std::size_t(i % 3)] = std::uint32_t(p[i]);
    }
  };
  if (n == 0) return;
  if (cells->IsStorage64Bit())
    copy(cells->GetOffsetsArray64()->GetPointer(0), cells->GetConnectivityArray64()->GetPointer(0));
  else
    copy(cells->GetOffsetsArray32()->GetPointer(0), cells->GetConnectivityArray32()->GetPointer(0));
}

void turn_to_lps(surface::TriMesh& mesh) {
  mesh.origin_mm = {-mesh.origin_mm.x, -mesh.origin_mm.y, mesh.origin_mm.z};
  const auto turn = [](auto& vectors) {
    for (Vec3& p : vectors) p = {-p.x, -p.y, p.z};
  };
  turn(mesh.points_mm);
  turn(mesh.normals);
}

void scale_to_mm(surface::TriMesh& mesh, const std::string& unit) {
  if (unit.empty()) return;
  const auto mm = grid::mm_per_unit(unit);
  if (!mm) damaged("UNIT", printable(unit).substr(0, 40) + " is no unit of length that is known");
  if (*mm == 1) return;
  mesh.origin_mm = mesh.origin_mm * *mm;
  for (Vec3& p : mesh.points_mm) p = p * *mm;
}

}  // namespace

surface::TriMesh parse_with_vtk(std::string&& bytes) {
  const Declared declared = check_counts(bytes);
  const vtkSmartPointer<vtkPolyData> data = parse(std::move(bytes));
  if (std::uint64_t(data->GetNumberOfPoints()) != declared.points ||
      std::uint64_t(data->GetNumberOfPolys()) != declared.polys)
    damaged("", "cut short: " + std::to_string(declared.points) + " points and " + std::to_string(declared.polys) +
                    " polygons are declared, " + std::to_string(data->GetNumberOfPoints()) + " and " +
                    std::to_string(data->GetNumberOfPolys()) + " are there");
  vtkFieldData* fields = data->GetFieldData();
  surface::TriMesh mesh;
  mesh.origin_mm = origin_field(fields);
  const auto count = std::size_t(data->GetNumberOfPoints());
  vtkPointData* arrays = data->GetPointData();
  if (vtkDataArray* local = arrays->GetArray(vtp_local_name)) {
    mesh.points_mm = read_vectors(local, count, vtp_local_name);
    std::vector<Vec3> world;
    if (count > 0) world = read_vectors(data->GetPoints()->GetData(), count, "Points");
    for (std::size_t i = 0; i < count; ++i)
      if (mesh.world_mm(i) != world[i]) damaged(vtp_local_name, altered);
  } else if (count > 0) {
    mesh.points_mm = read_vectors(data->GetPoints()->GetData(), count, "Points");
    if (mesh.origin_mm != Vec3{} || std::signbit(mesh.origin_mm.x) || std::signbit(mesh.origin_mm.y) ||
        std::signbit(mesh.origin_mm.z))
      for (Vec3& p : mesh.points_mm) p = p - mesh.origin_mm;
  }
  read_triangles(data, mesh);
  vtkDataArray* normals = arrays->GetNormals() ? arrays->GetNormals() : arrays->GetArray("Normals");
  if (normals) mesh.normals = read_vectors(normals, count, "Normals");

  scale_to_mm(mesh, text_field(fields, "UNIT"));
  const std::string space = text_field(fields, vtp_space_name);
  if (space.find("RAS") != std::string::npos)
    turn_to_lps(mesh);
  else if (!space.empty() && space.find("LPS") == std::string::npos)
    damaged(vtp_space_name, printable(space).substr(0, 40) + ", must be LPS or RAS");
  return mesh;
}

}  // namespace trephine::meshio
