// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/vtp.h"

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
#include <string_view>

#include "base/child.h"
#include "base/child_message.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/write_file.h"
#include "meshio/vtp_encode.h"
#include "meshio/vtp_parse.h"

namespace trephine::meshio {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double), "copied as three doubles");

// The last bytes of a file that this program wrote: a comment behind the root element with the checksum of every byte
// before it. VTK does not read that far, and a program that rewrites the file drops the comment.
constexpr std::string_view trailer_begin = "<!-- trephine sha256 ";
constexpr std::string_view trailer_end = " -->\n";
constexpr std::size_t trailer_size = trailer_begin.size() + 64 + trailer_end.size();

std::string trailer_of(std::string_view bytes) {
  return std::string(trailer_begin) + sha256_of_bytes(bytes) + std::string(trailer_end);
}

enum class Checksum { none, good, bad };

Checksum check_trailer(std::string_view bytes) {
  if (bytes.size() < trailer_size) return Checksum::none;
  const std::string_view trailer = bytes.substr(bytes.size() - trailer_size);
  if (trailer.substr(0, trailer_begin.size()) != trailer_begin) return Checksum::none;
  return trailer == trailer_of(bytes.substr(0, bytes.size() - trailer_size)) ? Checksum::good : Checksum::bad;
}

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

const ChildWorker parse_worker("vtp-parse", [](ChildRequest& request) {
  const surface::TriMesh mesh = parse_vtp(std::string(request.request()));
  const auto send = [&](const auto& array) {  // one after the other: there is a copy of one only
    MessageWriter out;
    out.array(array);
    request.write(out.bytes());
  };
  send(std::array<Vec3, 1>{mesh.origin_mm});
  send(mesh.points_mm);
  send(mesh.triangles);
  send(mesh.normals);
});

surface::TriMesh parse_in_child(std::string_view bytes) {
  ChildLimits limits;
  limits.memory_bytes = (std::uint64_t{1} << 30) + 16 * std::uint64_t(bytes.size());
  const ChildResult result = run_child("vtp-parse", bytes, limits);
  MessageReader in("vtp-parse", result.bytes());
  surface::TriMesh mesh;
  mesh.origin_mm = in.array<Vec3>().at(0);
  mesh.points_mm = in.array<Vec3>();
  mesh.triangles = in.array<std::array<std::uint32_t, 3>>();
  mesh.normals = in.array<Vec3>();
  return mesh;
}

bool ends_as_xml(std::string_view bytes) {
  const std::string_view tail = bytes.substr(bytes.size() < 4096 ? 0 : bytes.size() - 4096);
  return tail.find("</VTKFile>") != std::string_view::npos;
}

}  // namespace

std::string encode_vtp(const surface::TriMesh& mesh, const VtpExtras& extras) {
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
  std::string bytes = writer->GetOutputString();
  bytes += trailer_of(bytes);
  return bytes;
}

void write_vtp(const std::filesystem::path& file, const surface::TriMesh& mesh) {
  with_field("surface", [&] { surface::check_mesh(mesh); });
  write_file(file, with_file(file.string(), [&] { return encode_vtp(mesh); }));
}

surface::TriMesh read_vtp(const std::filesystem::path& file) {
  std::string bytes;
  {
    const std::vector<char> read = read_file(file);
    bytes.assign(read.begin(), read.end());
  }
  try {
    const Checksum checksum = check_trailer(bytes);
    if (checksum == Checksum::bad) throw Error(ExitCode::bad_input, "", "", "damaged: its checksum does not fit");
    if (checksum == Checksum::good) return parse_vtp(std::move(bytes));
    if (bytes.empty()) throw Error(ExitCode::bad_input, "", "", "the file is empty");
    if (!ends_as_xml(bytes)) throw Error(ExitCode::bad_input, "", "", "no VTK XML PolyData file, or cut short");
    return parse_in_child(bytes);
  } catch (Error& e) {
    e.in_file(file.string());
    throw;
  }
}

}  // namespace trephine::meshio
