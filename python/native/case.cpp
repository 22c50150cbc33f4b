// SPDX-License-Identifier: GPL-3.0-or-later
// A case: what cases/load_case.h loads and checks, as arrays that are views of it.
#include "cases/load_hashed.h"
#include "native/binding.h"

namespace trephine::python {
namespace {

/// The volumes of a loaded case, which its arrays are views of.
struct Case {
  cases::LoadedCase loaded;
  std::string sha256;
  py::list surfaces;  ///< name, Mesh
};

// The points are moved to where they are in the patient, so that an array of them needs no origin beside it.
Mesh in_place(surface::TriMesh mesh) {
  for (Vec3& p : mesh.points_mm) p += mesh.origin_mm;
  mesh.origin_mm = {};
  return Mesh(std::move(mesh));
}

std::unique_ptr<Case> load(const std::string& folder, bool ct, bool compare_all) {
  auto made = std::make_unique<Case>();
  cases::HashedCase read = run_long([&](const Progress&) {
    return cases::load_hashed_case(folder, cases::LoadParts{ct, compare_all});
  });
  made->sha256 = std::move(read.sha256);
  made->loaded = std::move(read.loaded);
  for (std::size_t n = 0; n < made->loaded.surfaces.size(); ++n) {
    const cases::CaseAnatomy& anatomy = made->loaded.manifest.anatomies[n];
    if (anatomy.file.empty()) continue;
    made->surfaces.append(
        py::make_tuple(anatomy.name, std::make_shared<Mesh>(in_place(std::move(made->loaded.surfaces[n])))));
  }
  return made;
}

/// Voxels and where they lie; None where there are none.
template <class T>
py::object volume_of(const grid::Grid<T>& grid, const py::object& owner) {
  if (grid.voxels.empty()) return py::none();
  return py::make_tuple(view_of_voxels(grid, owner), place_of(grid));
}

}  // namespace

void bind_case(py::module_& m) {
  py::class_<Case>(m, "Case")
      .def_property_readonly("manifest", [](const Case& c) { return cases::to_json(c.loaded.manifest); })
      .def_readonly("sha256", &Case::sha256)
      .def_readonly("surfaces", &Case::surfaces)
      .def_property_readonly(
          "haptic",
          [](const py::object& self) { return volume_of(self.cast<const Case&>().loaded.haptic.voxels, self); })
      .def_property_readonly(
          "hardness",
          [](const py::object& self) { return volume_of(self.cast<const Case&>().loaded.haptic.hardness, self); })
      .def_property_readonly(
          "ct", [](const py::object& self) { return volume_of(self.cast<const Case&>().loaded.ct, self); });
  m.def("load_case", &load);
}

}  // namespace trephine::python
