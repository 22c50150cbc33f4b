// SPDX-License-Identifier: GPL-3.0-or-later
#include "native/binding.h"

#include <cmath>

#include "base/error.h"

namespace trephine::python {
namespace {

// As it is written in an error's line: `(3, 4)`.
std::string shape_text(const py::array& a) { return py::str(a.attr("shape")); }

bool is_real(const py::array& a) {
  const py::dtype type = a.dtype();
  return type.kind() == 'f' && (type.itemsize() == 8 || type.itemsize() == 4);
}

}  // namespace

void refuse(const std::string& what) { throw py::value_error(what); }

void bind_errors() {
  // The classes are Python's own, and live as long as the process.
  static const py::object make = py::module_::import("trephine._errors").attr("make");
  make.inc_ref();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Error& e) {
      const py::object error = make(int(e.code()), e.line("trephine"), e.file(), e.field());
      PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
    } catch (const Cancelled&) {
      PyErr_SetNone(PyExc_KeyboardInterrupt);
    }
  });
}

py::array view_of_points(const std::vector<Vec3>& points, py::handle owner) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return view_of(reinterpret_cast<const double*>(points.data()), {py::ssize_t(points.size()), 3}, owner);
}

py::array array_of(Vec3 v) { return py::array_t<double>(3, &v.x); }

Vec3 vec3_from(const py::handle& value, const char* name) {
  const auto a = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
  if (!a) {
    PyErr_Clear();
    refuse(std::string(name) + " must be three numbers");
  }
  if (a.ndim() != 1 || a.shape(0) != 3)
    refuse(std::string(name) + " must be three numbers, not of shape " + shape_text(a));
  const double* v = a.data();
  if (!std::isfinite(v[0]) || !std::isfinite(v[1]) || !std::isfinite(v[2]))
    refuse(std::string(name) + " holds a value that is not finite");
  return {v[0], v[1], v[2]};
}

std::vector<Vec3> points_from(const py::handle& value, const char* name) {
  if (!py::isinstance<py::array>(value)) refuse(std::string(name) + " must be a numpy array");
  const auto given = py::reinterpret_borrow<py::array>(value);
  if (!is_real(given))
    refuse(std::string(name) + " must be of float64 or float32, not " + std::string(py::str(given.dtype())));
  if (given.ndim() != 2 || given.shape(1) != 3)
    refuse(std::string(name) + " must have the shape (n, 3), not " + shape_text(given));
  const auto a = py::array_t<double, py::array::c_style | py::array::forcecast>(given);
  std::vector<Vec3> points(std::size_t(a.shape(0)));
  const double* v = a.data();
  for (std::size_t n = 0; n < points.size(); ++n, v += 3) {
    if (!std::isfinite(v[0]) || !std::isfinite(v[1]) || !std::isfinite(v[2]))
      refuse(std::string(name) + " holds a value that is not finite, in row " + std::to_string(n));
    points[n] = {v[0], v[1], v[2]};
  }
  return points;
}

py::tuple place_of(const grid::Lattice& lattice) {
  py::array_t<double> direction({3, 3});
  auto d = direction.mutable_unchecked<2>();
  for (int column = 0; column < 3; ++column) {
    const Vec3 axis = lattice.direction * Vec3{column == 0 ? 1. : 0., column == 1 ? 1. : 0., column == 2 ? 1. : 0.};
    d(0, column) = axis.x;
    d(1, column) = axis.y;
    d(2, column) = axis.z;
  }
  return py::make_tuple(array_of(lattice.spacing_mm), array_of(lattice.origin_mm), direction);
}

const std::vector<Vec3>& Mesh::world_mm() {
  if (mesh_.origin_mm == Vec3{}) return mesh_.points_mm;
  if (world_mm_.size() != mesh_.points_mm.size()) {
    world_mm_.reserve(mesh_.points_mm.size());
    for (std::size_t i = 0; i < mesh_.points_mm.size(); ++i) world_mm_.push_back(mesh_.world_mm(i));
  }
  return world_mm_;
}

}  // namespace trephine::python
