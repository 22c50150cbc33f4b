// SPDX-License-Identifier: GPL-3.0-or-later
// VTK's readers of legacy and XML polygons, and of VRML.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <vtkActor.h>
#include <vtkActorCollection.h>
#include <vtkCellArray.h>
#include <vtkMapper.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataReader.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkTriangleFilter.h>
#include <vtkUnsignedCharArray.h>
#include <vtkVRMLImporter.h>
#include <vtkXMLPolyDataReader.h>

#include "base/error.h"
#include "base/file_descriptor.h"
#include "meshio/formats/formats_inside.h"

namespace trephine::meshio {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw Error(ExitCode::bad_input, "", "", what); }

ForeignSurface surface_of(vtkPolyData* data) {
  ForeignSurface s;
  const vtkIdType points = data->GetNumberOfPoints();
  s.points.resize(std::size_t(points));
  for (vtkIdType i = 0; i < points; ++i) data->GetPoint(i, &s.points[std::size_t(i)].x);
  // Offsets and ids come from the file, so those that do not fit mean that it is damaged.
  vtkCellArray* cells = data->GetPolys();
  vtkDataArray* ids = cells->GetConnectivityArray();
  vtkDataArray* offsets = cells->GetOffsetsArray();
  const vtkIdType count = cells->GetNumberOfCells(), id_count = ids->GetNumberOfValues();
  if (count > 0 && offsets->GetNumberOfValues() < count + 1) refuse("damaged: polygons without an end");
  bool plain = data->GetNumberOfStrips() == 0;
  for (vtkIdType i = 0; i < count; ++i) {
    const double from = offsets->GetComponent(i, 0), to = offsets->GetComponent(i + 1, 0);
    if (!(from >= 0 && to >= from && to <= double(id_count))) refuse("damaged: a polygon without an end");
    plain = plain && to - from == 3;
  }
  for (vtkIdType i = 0; i < id_count; ++i) {
    const double id = ids->GetComponent(i, 0);
    if (!(id >= 0 && id < double(points)))
      refuse("damaged: point index " + std::to_string(static_cast<long long>(id)) + " of " + std::to_string(points) +
             " points");
  }
  vtkNew<vtkTriangleFilter> triangulate;
  if (!plain) {
    triangulate->PassLinesOff();
    triangulate->PassVertsOff();
    triangulate->SetInputData(data);
    triangulate->Update();
    cells = triangulate->GetOutput()->GetPolys();
    if (triangulate->GetOutput()->GetNumberOfPoints() != points) refuse("its polygons cannot be cut into triangles");
  }
  s.triangles.reserve(std::size_t(cells->GetNumberOfCells()));
  vtkIdType size = 0;
  const vtkIdType* corner = nullptr;
  for (vtkIdType i = 0; i < cells->GetNumberOfCells(); ++i) {
    cells->GetCellAtId(i, size, corner);
    if (size == 3)
      s.triangles.push_back({std::uint32_t(corner[0]), std::uint32_t(corner[1]), std::uint32_t(corner[2])});
  }
  if (auto* uv = data->GetPointData()->GetTCoords()) s.texture_points = std::uint64_t(uv->GetNumberOfTuples());
  return s;
}

// The colour, where all points have the same one.
void take_point_colour(vtkPolyData* data, ForeignSurface& s) {
  auto* rgb = vtkUnsignedCharArray::SafeDownCast(data->GetPointData()->GetArray("RGB"));
  if (!rgb || rgb->GetNumberOfComponents() != 3 || rgb->GetNumberOfTuples() < 1) return;
  s.has_colour = true;
  for (vtkIdType i = 0; i < rgb->GetNumberOfValues(); ++i)
    s.has_colour = s.has_colour && rgb->GetValue(i) == rgb->GetValue(i % 3);
  for (int c = 0; c < 3; ++c) s.colour[std::size_t(c)] = rgb->GetValue(c) / 255.0;
}

// VTK's importer can only read files.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : fd_(::memfd_create("mesh", MFD_CLOEXEC)) {
    while (fd_.valid() && !bytes.empty()) {
      const ssize_t n = ::write(fd_.get(), bytes.data(), bytes.size());
      if (n <= 0) break;
      bytes.remove_prefix(std::size_t(n));
    }
    if (!fd_.valid() || !bytes.empty()) throw Error(ExitCode::internal, "", "", "no memory for a file");
  }
  std::string path() const { return "/proc/self/fd/" + std::to_string(fd_.get()); }

 private:
  FileDescriptor fd_;
};

std::vector<ForeignSurface> read_vrml(std::string_view bytes) {
  const MemoryFile file(bytes);
  // Without VTK's OpenGL module this window and renderer draw nothing; the importer only hangs its actors into them.
  vtkNew<vtkVRMLImporter> importer;
  auto window = vtkSmartPointer<vtkRenderWindow>::New();
  importer->SetFileName(file.path().c_str());
  importer->SetRenderWindow(window);
  importer->Read();
  vtkRenderer* renderer = importer->GetRenderer();
  if (!renderer) refuse("VTK cannot read it");
  std::vector<ForeignSurface> out;
  vtkActorCollection* actors = renderer->GetActors();
  actors->InitTraversal();
  while (vtkActor* actor = actors->GetNextActor()) {
    if (!actor->GetMapper()) continue;
    actor->GetMapper()->Update();
    auto* data = vtkPolyData::SafeDownCast(actor->GetMapper()->GetInput());
    if (!data) continue;
    ForeignSurface s = surface_of(data);
    s.has_colour = s.has_opacity = true;
    actor->GetProperty()->GetDiffuseColor(s.colour.data());
    s.opacity = actor->GetProperty()->GetOpacity();
    out.push_back(std::move(s));
  }
  return out;
}

}  // namespace

std::vector<ForeignSurface> read_with_vtk(const ForeignReader& reader, std::string_view bytes) {
  vtkObject::GlobalWarningDisplayOff();
  if (reader.reads("wrl")) return read_vrml(bytes);
  vtkSmartPointer<vtkPolyData> data;
  if (reader.reads("vtp")) {
    vtkNew<vtkXMLPolyDataReader> xml;
    xml->ReadFromInputStringOn();
    xml->SetInputString(std::string(bytes));
    xml->Update();
    if (xml->GetErrorCode() != 0) refuse("VTK cannot read it as XML polygons");
    data = xml->GetOutput();
  } else {
    if (bytes.size() >= std::size_t{1} << 31) refuse("legacy VTK files are read up to 2 GiB");
    vtkNew<vtkPolyDataReader> legacy;
    legacy->ReadFromInputStringOn();
    legacy->SetBinaryInputString(bytes.data(), int(bytes.size()));
    legacy->ReadAllScalarsOn();
    if (!legacy->IsFilePolyData()) refuse("VTK cannot read it as legacy polygons");
    legacy->Update();
    if (legacy->GetErrorCode() != 0) refuse("VTK cannot read it as legacy polygons");
    data = legacy->GetOutput();
  }
  ForeignSurface s = surface_of(data);
  take_point_colour(data, s);
  return {std::move(s)};
}

}  // namespace trephine::meshio
