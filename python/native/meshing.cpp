// SPDX-License-Identifier: GPL-3.0-or-later
// Stages on arrays: the functions that lib/stages calls, with their declared parameters and results.
#include <cmath>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "boolean/burr_hole.h"
#include "boolean/burr_hole_params.h"
#include "boolean/cut_surface.h"
#include "meshing/contour.h"
#include "meshing/decimate.h"
#include "meshing/normals.h"
#include "meshing/remesh.h"
#include "meshing/repair.h"
#include "meshing/smooth.h"
#include "meshing/validity.h"
#include "metrics/measure.h"
#include "native/binding.h"

namespace trephine::python {
namespace {

using MeshPointer = std::shared_ptr<Mesh>;

/// What Python gets of an outcome: the value, the result as JSON, and the warnings as lines.
template <class R>
py::tuple answer(const py::object& value, R result, const Warnings& warnings) {
  py::list lines;
  for (const Warning& w : warnings) lines.append(to_text(w));
  return py::make_tuple(value, json::json_of_value(std::move(result)), lines);
}
template <class R>
py::tuple answer(Outcome<surface::TriMesh, R> made) {
  return answer(py::cast(std::make_shared<Mesh>(std::move(made.value))), std::move(made.result), made.warnings);
}

// Stages keep float32's precision about the mesh's origin, so it must lie near.
surface::TriMesh near_origin(const Mesh& mesh) {
  surface::TriMesh near = mesh.mesh();
  meshing::centre_origin(near);
  return near;
}

const Mesh& with_triangles(const Mesh& mesh, const char* name) {
  if (mesh.mesh().triangles.empty()) throw Error(ExitCode::bad_input, "", name, "has no triangles");
  return mesh;
}

// To a command a surface that is not valid is a fault of the stage before; here it is what the caller handed in.
surface::TriMesh valid_near_origin(const Mesh& mesh, const char* name, const Progress& p) {
  surface::TriMesh near = near_origin(with_triangles(mesh, name));
  if (near.proven_valid()) return near;
  const meshing::Validity v = meshing::check_validity(near, p);
  if (!v.valid()) throw Error(ExitCode::bad_input, "", name, "is not valid: " + v.text() + "; repair() mends it");
  return near;
}

std::vector<std::array<std::uint32_t, 3>> triangles_from(const py::handle& value, std::size_t points) {
  if (!py::isinstance<py::array>(value)) refuse("triangles must be a numpy array");
  const auto given = py::reinterpret_borrow<py::array>(value);
  if (given.dtype().kind() != 'i' && given.dtype().kind() != 'u')
    refuse("triangles must be of whole numbers, not of " + std::string(py::str(given.dtype())));
  if (given.ndim() != 2 || given.shape(1) != 3)
    refuse("triangles must have the shape (n, 3), not " + std::string(py::str(given.attr("shape"))));
  const auto a = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>(given);
  std::vector<std::array<std::uint32_t, 3>> triangles(std::size_t(a.shape(0)));
  const std::int64_t* v = a.data();
  for (auto& t : triangles)
    for (std::uint32_t& index : t) {
      if (*v < 0 || std::uint64_t(*v) >= points)
        refuse("triangles: row " + std::to_string(&t - triangles.data()) + " names the point " + std::to_string(*v) +
               ", of " + std::to_string(points));
      index = std::uint32_t(*v++);
    }
  return triangles;
}

MeshPointer mesh_from(const py::object& points, const py::object& triangles) {
  surface::TriMesh mesh;
  std::vector<Vec3> places = points_from(points, "points_mm");
  if (places.size() > std::numeric_limits<std::uint32_t>::max()) refuse("points_mm has more rows than a mesh can hold");
  mesh.triangles = triangles_from(triangles, places.size());
  mesh.points_mm = std::move(places);
  return std::make_shared<Mesh>(std::move(mesh));
}

grid::Lattice lattice_from(const py::array& voxels, const py::tuple& place) {
  if (voxels.ndim() != 3) refuse("voxels must have three axes, [k, j, i]");
  grid::Lattice lattice;
  for (int axis = 0; axis < 3; ++axis) {
    const py::ssize_t size = voxels.shape(2 - axis);
    if (size < 1 || size > 65535)
      refuse("voxels: an axis of " + std::to_string(size) + " voxels; 1 to 65535 are possible");
    lattice.size[std::size_t(axis)] = int(size);
  }
  lattice.spacing_mm = vec3_from(place[0], "spacing_mm");
  lattice.origin_mm = vec3_from(place[1], "origin_mm");
  for (int axis = 0; axis < 3; ++axis)
    if (!(lattice.spacing_mm[axis] > 0)) refuse("spacing_mm must be above 0");
  const auto d = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(place[2]);
  if (!d) PyErr_Clear();
  if (!d || d.ndim() != 2 || d.shape(0) != 3 || d.shape(1) != 3) refuse("direction must be a matrix of 3 x 3");
  auto& columns = lattice.direction.column;
  for (int c = 0; c < 3; ++c) columns[std::size_t(c)] = {d.at(0, c), d.at(1, c), d.at(2, c)};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = a; b < 3; ++b)
      if (!(std::abs(dot(columns[a], columns[b]) - (a == b ? 1 : 0)) <= 1e-6))
        refuse("direction: its columns must have length 1 and be perpendicular to each other");
  return lattice;
}

template <class T>
grid::Grid<T> grid_from(const py::array& given, const grid::Lattice& lattice) {
  const auto a = py::array_t<T, py::array::c_style | py::array::forcecast>(given);
  grid::Grid<T> grid(lattice);
  std::memcpy(grid.voxels.data(), a.data(), grid.voxels.size() * sizeof(T));
  return grid;
}

bool has_type(const py::array& a, char kind, py::ssize_t bytes) {
  return a.dtype().kind() == kind && a.dtype().itemsize() == bytes;
}

py::tuple contour(const py::array& voxels, const py::tuple& place, bool field, const std::string& params_json) {
  const auto params = params_of<meshing::ContourParams>(params_json);
  const grid::Lattice lattice = lattice_from(voxels, place);
  const bool is_float = has_type(voxels, 'f', 4);
  if (!is_float && !(has_type(voxels, 'i', 2) && !field))
    refuse(std::string("voxels must be of float32") + (field ? "" : " or int16") + ", not " +
           std::string(py::str(voxels.dtype())));
  if (field) {
    const grid::Field given = grid_from<float>(voxels, lattice);
    return answer(run_long([&](const Progress& p) { return meshing::contour(given, params, p); }));
  }
  const grid::HuVolume given = is_float ? grid::HuVolume(grid_from<float>(voxels, lattice))
                                        : grid::HuVolume(grid_from<std::int16_t>(voxels, lattice));
  return answer(run_long([&](const Progress& p) { return meshing::contour(given, params, p); }));
}

enum class Takes { any, valid };

/// A stage that takes a surface and gives one.
template <Takes takes, class P, class R>
py::tuple on_mesh(Outcome<surface::TriMesh, R> (*function)(const surface::TriMesh&, const P&, const Progress&),
                  const Mesh& mesh, const std::string& params_json) {
  const auto params = params_of<P>(params_json);
  return answer(run_long([&](const Progress& p) {
    return function(
        takes == Takes::valid ? valid_near_origin(mesh, "mesh", p) : near_origin(with_triangles(mesh, "mesh")), params,
        p);
  }));
}

Outcome<surface::TriMesh, meshing::NormalsResult> with_normals(const surface::TriMesh& mesh,
                                                               const meshing::NormalsParams& params,
                                                               const Progress& p) {
  Outcome<surface::TriMesh, meshing::NormalsResult> made{mesh, {}, {}};
  made.result = meshing::compute_normals(made.value, params, p);
  return made;
}

py::tuple smooth(const Mesh& mesh, const MeshPointer& reference, const std::string& params_json) {
  const auto params = params_of<meshing::SmoothParams>(params_json);
  return answer(run_long([&](const Progress& p) {
    const surface::TriMesh beside =
        reference ? near_origin(with_triangles(*reference, "reference")) : surface::TriMesh();
    return meshing::smooth(valid_near_origin(mesh, "mesh", p), params, p, reference ? &beside : nullptr);
  }));
}

py::tuple cut(const Mesh& mesh, const std::string& cutters_json, const std::vector<MeshPointer>& solids,
              const std::string& params_json) {
  const auto params = params_of<boolean::CutSurfaceParams>(params_json);
  std::vector<boolean::Cutter> cutters = boolean::parse_cutters_json(cutters_json);
  if (cutters.empty()) refuse("cutters: nothing to cut away");
  std::size_t meshes = 0;
  for (const boolean::Cutter& c : cutters)
    if (c.kind == boolean::Cutter::Kind::mesh && (meshes == solids.size() || !solids[meshes++]))
      refuse("cutters: a cutter of kind mesh has no mesh");
  return answer(run_long([&](const Progress& p) {
    auto solid = solids.begin();
    for (boolean::Cutter& c : cutters)
      if (c.kind == boolean::Cutter::Kind::mesh)
        c.mesh = std::make_shared<surface::TriMesh>(valid_near_origin(**solid++, "cutters: a mesh", p));
    return boolean::cut_surface(valid_near_origin(mesh, "mesh", p), cutters, params, p);
  }));
}

py::tuple burr_hole(const Mesh& bone, const MeshPointer& over, const std::string& params_json) {
  auto params = params_of<boolean::BurrHoleParams>(params_json);
  boolean::check_request(params, ExitCode::bad_input);
  if (params.at != boolean::BurrHoleRequest::At::position)
    throw Error(ExitCode::bad_input, "", "at",
                "must be position: Kocher's point is measured and checked by `trephine burrhole`");
  if (!params.avoid.empty()) throw Error(ExitCode::bad_input, "", "avoid", "is looked at by `trephine burrhole` alone");
  const boolean::BurrHoleRequest request = boolean::request_of(params, {}, ExitCode::bad_input);
  auto made = run_long([&](const Progress&) {
    const surface::TriMesh skin = over ? near_origin(with_triangles(*over, "over")) : surface::TriMesh();
    auto hole =
        boolean::place_burr_hole(request, {}, over ? &skin : nullptr, near_origin(with_triangles(bone, "bone")));
    boolean::check_cutter(hole.value.cutter, ExitCode::bad_input);
    return hole;
  });
  return answer(py::cast(boolean::cutters_json({made.value.cutter})), made.result, made.warnings);
}

py::tuple measure(const Mesh& mesh, const MeshPointer& reference, const std::string& params_json) {
  const auto params = params_of<metrics::MeasureParams>(params_json);
  const auto made = run_long([&](const Progress& p) {
    metrics::MeasureReference to;
    const surface::TriMesh beside = reference ? near_origin(*reference) : surface::TriMesh();
    if (reference) to = metrics::MeshReference{&beside};
    return metrics::measure_surface(near_origin(mesh), to, params, p);
  });
  return answer(py::none(), made.result, made.warnings);
}

// Of the points as they are, not about another origin.
py::tuple check(const Mesh& mesh) {
  const meshing::Validity v = run_long([&](const Progress& p) { return meshing::check_validity(mesh.mesh(), p); });
  return py::make_tuple(v.valid(), v.text());
}

py::object normals_of(const py::object& self) {
  const surface::TriMesh& mesh = self.cast<Mesh&>().mesh();
  if (mesh.normals.empty()) return py::none();
  return view_of_points(mesh.normals, self);
}

}  // namespace

void bind_meshing(py::module_& m) {
  py::class_<Mesh, MeshPointer>(m, "Mesh")
      .def(py::init(&mesh_from))
      .def_property_readonly("points_mm",
                             [](const py::object& self) { return view_of_points(self.cast<Mesh&>().world_mm(), self); })
      .def_property_readonly("triangles",
                             [](const py::object& self) {
                               const auto& triangles = self.cast<const Mesh&>().mesh().triangles;
                               return view_of(reinterpret_cast<const std::uint32_t*>(triangles.data()),
                                              {py::ssize_t(triangles.size()), 3}, self);
                             })
      .def_property_readonly("normals", &normals_of)
      .def_property_readonly("volume_mm3", [](const Mesh& mesh) { return surface::volume_mm3(mesh.mesh()); })
      .def_property_readonly("area_mm2", [](const Mesh& mesh) { return surface::area_mm2(mesh.mesh()); });
  using Text = const std::string&;
  m.def("contour", &contour);
  m.def("decimate", [](const Mesh& mesh, Text p) { return on_mesh<Takes::valid>(&meshing::decimate, mesh, p); });
  m.def("repair", [](const Mesh& mesh, Text p) { return on_mesh<Takes::any>(&meshing::repair, mesh, p); });
  m.def("remesh", [](const Mesh& mesh, Text p) { return on_mesh<Takes::valid>(&meshing::remesh, mesh, p); });
  m.def("normals", [](const Mesh& mesh, Text p) { return on_mesh<Takes::any>(&with_normals, mesh, p); });
  m.def("smooth", &smooth);
  m.def("cut", &cut);
  m.def("burr_hole", &burr_hole);
  m.def("measure", &measure);
  m.def("check", &check);
}

}  // namespace trephine::python
