// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/child.h"
#include "base/parallel.h"
#include "native/binding.h"

PYBIND11_MODULE(_native, m) {
  namespace py = pybind11;
  using namespace trephine;
  m.attr("version") = TREPHINE_VERSION;
  python::bind_errors();
  python::bind_case(m);
  python::bind_meshing(m);
  python::bind_recording(m);
  python::bind_session(m);
  m.def("set_child_program", [](const std::string& file) { set_child_program(file); });
  m.def("set_thread_count", [](int count) {
    if (count < 0) python::refuse("the number of threads must be 0 or more");
    set_thread_count(count);
  });
  m.def("thread_count", &thread_count);
}
