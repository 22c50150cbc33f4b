// SPDX-License-Identifier: GPL-3.0-or-later
// VTK's writer of XML polygons.
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLPolyDataWriter.h>

#include <array>
#include <cstring>
#include <string>

#include "base/error.h"
#include "meshio/formats/formats_inside.h"
#include "meshio/vtp_parse.h"

namespace trephine::meshio {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double), "copied as three doubles");

vtkSmartPointer<vtkDoubleArray> vectors(const char* name, const std::vector<Vec3>& v) {
  auto a = vtkSmartPointer<vtkDoubleArray>::New();
  a->SetName(name);
  a->SetNumberOfComponents(3);
  a->SetNumberOfTuples(vtkIdType(v.size()));
  if (!v.empty()) std::memcpy(a->GetPointer(0), v.data(), v.size() * sizeof(Vec3));
  return a;
}

template <class IdArray>
vtkSmartPointer<vtkCellArray> cells_of(const surface::TriMesh& mesh) {
  const auto n = vtkIdType(mesh.triangles.size());
  vtkNew<IdArray> offsets, ids;
  offsets->SetNumberOfValues(n + 1);
  ids->SetNumberOfValues(3 * n);
  auto* o = offsets->GetPointer(0);
  using Id = std::remove_pointer_t<decltype(o)>;
  for (vtkIdType i = 0; i <= n; ++i) o[i] = Id(3 * i);
  auto* p = ids->GetPointer(0);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t i : t) *p++ = Id(i);
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->SetData(offsets, ids);
  return cells;
}

void add_text(vtkPolyData* data, const char* name, const std::string& text) {
  vtkNew<vtkStringArray> array;
  array->SetName(name);
  array->InsertNextValue(text);
  data->GetFieldData()->AddArray(array);
}

void add_extras(vtkPolyData* data, const VtpExtras& extras) {
  if (!extras.name.empty()) {
    add_text(data, "UNIT", "mm");
    add_text(data, "name", extras.name);
  }
  if (extras.point_rgb) {
    vtkNew<vtkUnsignedCharArray> rgb;
    rgb->SetName("RGB");
    rgb->SetNumberOfComponents(3);
    rgb->SetNumberOfTuples(data->GetNumberOfPoints());
    for (int c = 0; c < 3; ++c) rgb->FillTypedComponent(c, (*extras.point_rgb)[c]);
    data->GetPointData()->SetScalars(rgb);
  }
  if (!extras.texture.empty()) {
    vtkNew<vtkFloatArray> uv;
    uv->SetName("TextureCoordinates");
    uv->SetNumberOfComponents(2);
    uv->SetNumberOfTuples(vtkIdType(extras.texture.size()));
    for (std::size_t i = 0; i < extras.texture.size(); ++i)
      for (int c = 0; c < 2; ++c) uv->SetTypedComponent(vtkIdType(i), c, float(extras.texture[i][c]));
    data->GetPointData()->SetTCoords(uv);
  }
}

}  // namespace

std::string encode_with_vtk(const surface::TriMesh& mesh, const VtpExtras& extras) {
  vtkObject::GlobalWarningDisplayOff();
  std::vector<Vec3> world(mesh.points_mm.size());
  bool exact = true;
  for (std::size_t i = 0; i < world.size(); ++i) {
    world[i] = mesh.world_mm(i);
    const Vec3 back = world[i] - mesh.origin_mm;
    exact = exact && std::memcmp(&back, &mesh.points_mm[i], sizeof(Vec3)) == 0;
  }

  vtkNew<vtkPolyData> data;
  vtkNew<vtkPoints> points;
  points->SetData(vectors("Points", world));
  data->SetPoints(points);
  const bool narrow = 3 * mesh.triangles.size() < (std::size_t{1} << 31) && world.size() < (std::size_t{1} << 31);
  data->SetPolys(narrow ? cells_of<vtkTypeInt32Array>(mesh) : cells_of<vtkTypeInt64Array>(mesh));
  if (!mesh.normals.empty()) data->GetPointData()->SetNormals(vectors("Normals", mesh.normals));
  if (!exact) data->GetPointData()->AddArray(vectors(vtp_local_name, mesh.points_mm));
  add_text(data, vtp_space_name, "LPS");
  data->GetFieldData()->AddArray(vectors(vtp_origin_name, {mesh.origin_mm}));
  add_extras(data, extras);

  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(data);
  writer->WriteToOutputStringOn();
  writer->SetByteOrderToLittleEndian();
  writer->SetHeaderTypeToUInt64();
  if (narrow)
    writer->SetIdTypeToInt32();
  else
    writer->SetIdTypeToInt64();
  writer->SetDataModeToAppended();
  writer->EncodeAppendedDataOff();
  writer->SetCompressorTypeToNone();
  if (!writer->Write() || writer->GetErrorCode() != 0)
    throw Error(ExitCode::internal, "", "", "VTK could not write the surface");
  return writer->GetOutputString();
}

}  // namespace trephine::meshio
