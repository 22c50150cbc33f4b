// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the sources of the Python module share. Structs cross the border as JSON of their declarations
// (json/declared_json.h), so that each value is declared once; numbers cross it as arrays.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "grid/grid.h"
#include "json/declared_json.h"
#include "surface/trimesh.h"

namespace trephine::python {
namespace py = pybind11;

/// What the library throws becomes exceptions of trephine._errors.
void bind_errors();
void bind_case(py::module_& m);
void bind_meshing(py::module_& m);
void bind_session(py::module_& m);
void bind_recording(py::module_& m);

/// Throws ValueError with that line.
[[noreturn]] void refuse(const std::string& what);

/// The parameters that a caller gave by name. Throws Error 65 naming the one that is unknown or out of its range.
template <class P>
P params_of(const std::string& json) {
  P params;
  json::read_declared_json(json, parameters_of<P>(), &params);
  return params;
}

/// A view that cannot be written to, and keeps its owner alive.
template <class T>
py::array view_of(const T* data, std::vector<py::ssize_t> shape, py::handle owner) {
  py::array view(py::dtype::of<T>(), std::move(shape), data, owner);
  view.attr("flags").attr("writeable") = false;
  return view;
}
py::array view_of_points(const std::vector<Vec3>& points, py::handle owner);
/// An array of its own.
py::array array_of(Vec3 v);

/// Three finite numbers. `name` is that of the argument, for messages.
Vec3 vec3_from(const py::handle& value, const char* name);
/// Rows of three finite numbers; float64 or float32.
std::vector<Vec3> points_from(const py::handle& value, const char* name);

/// Where voxels lie, as a tuple: spacing_mm, origin_mm, direction (columns are the axes).
py::tuple place_of(const grid::Lattice& lattice);
/// A volume's voxels, indexed [k, j, i].
template <class T>
py::array view_of_voxels(const grid::Grid<T>& grid, py::handle owner) {
  return view_of(grid.voxels.data(), {grid.size[2], grid.size[1], grid.size[0]}, owner);
}

/// A surface that Python holds. It never changes, so that views of it stay good.
class Mesh {
 public:
  explicit Mesh(surface::TriMesh mesh) : mesh_(std::move(mesh)) {}
  const surface::TriMesh& mesh() const { return mesh_; }
  /// World, LPS, mm: the mesh's own points where its origin is 0, else computed once.
  const std::vector<Vec3>& world_mm();

 private:
  const surface::TriMesh mesh_;
  std::vector<Vec3> world_mm_;
};

/// Runs a long function without Python's lock, in a thread of its own, while this one looks for Ctrl-C.
template <class F>
auto run_long(F&& function) {
  std::atomic<bool> stop{false};
  std::optional<py::error_already_set> interrupt;
  auto made = [&] {
    const py::gil_scoped_release unlocked;
    auto future = std::async(std::launch::async, [&] { return function(Progress({}, &stop)); });
    while (future.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) {
      const py::gil_scoped_acquire locked;
      if (interrupt || PyErr_CheckSignals() == 0) continue;
      interrupt.emplace();
      stop = true;
    }
    return future;
  }();
  if (interrupt) {
    made.wait();
    throw py::error_already_set(*interrupt);
  }
  return made.get();
}

}  // namespace trephine::python
