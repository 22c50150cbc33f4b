// SPDX-License-Identifier: GPL-3.0-or-later
// trephine-tetra: fills surfaces with tetrahedra by CGAL's Mesh_3. It only works as a bounded child of the other
// programs.
#include <cstdio>

#include "base/child.h"
#include "base/exit_code.h"

int main(int argc, char** argv) {
  trephine::run_child_if_asked(argc, argv);
  std::fputs("trephine-tetra: is started by trephine where it fills surfaces, and does nothing by itself\n", stderr);
  return static_cast<int>(trephine::ExitCode::usage);
}
