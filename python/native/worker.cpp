// SPDX-License-Identifier: GPL-3.0-or-later
// trephine-worker: the bounded child of the Python package. It does what base/child.h asks of it, and nothing else.
#include <cstdio>

#include "base/child.h"
#include "base/exit_code.h"
#include "boolean/corefine.h"
#include "meshing/remesh.h"
#include "meshing/repair.h"

namespace {
// The workers are registered where these are defined, and the linker takes what is used. Volatile, or the compiler sees
// that nobody reads it.
template <class F>
void link(F* function) {
  [[maybe_unused]] static F* volatile linked;
  linked = function;
}
}  // namespace

int main(int argc, char** argv) {
  using namespace trephine;
  link(&boolean::corefine_difference);
  link(&meshing::repair);
  link(&meshing::remesh);
  run_child_if_asked(argc, argv);
  std::fputs("trephine-worker is started by the Python package trephine, and does nothing by itself\n", stderr);
  return static_cast<int>(ExitCode::usage);
}
