// SPDX-License-Identifier: GPL-3.0-or-later
#include "itk/itk_child.h"

#include <filesystem>

#include "base/own_files.h"

namespace trephine::itk::itk_child {
namespace {

constexpr const char* build = TREPHINE_VERSION " 1";  // the number changes with the messages
constexpr const char* program_name = "trephine-itk";

}  // namespace

MessageWriter request() {
  MessageWriter w;
  w.text(build);
  return w;
}

MessageReader opened(const char* worker, std::string_view bytes) {
  MessageReader r(worker, bytes);
  if (r.text() != build)
    throw Error(ExitCode::internal, program_name, "", "is not of the same version as the program that called it");
  return r;
}

ChildResult run(const char* worker, const MessageWriter& request, const ChildLimits& limits, const Progress& progress) {
  const std::filesystem::path file = own_file({program_name});
  if (file.empty())
    throw Error(ExitCode::internal, program_name, "", "is missing: it must lie in the folder of the other programs");
  return run_child(worker, request.bytes(), limits, progress, {file});
}

void put(MessageWriter& to, const grid::Grid<float>& grid) {
  to.value(static_cast<const grid::Lattice&>(grid));
  to.array(grid.voxels);
}

grid::Grid<float> take_grid(MessageReader& from, const char* worker) {
  grid::Grid<float> grid;
  static_cast<grid::Lattice&>(grid) = from.value<grid::Lattice>();
  grid.voxels = from.array<float>();
  bool sound = is_finite(grid.origin_mm);
  for (int a = 0; a < 3; ++a) sound = sound && grid.size[a] > 0 && grid.size[a] <= 65535 && grid.spacing_mm[a] > 0;
  if (!sound || grid.count() != grid.voxels.size())
    throw Error(ExitCode::internal, "", worker, "a message of parent or child holds a damaged volume");
  return grid;
}

}  // namespace trephine::itk::itk_child
