// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/foreign.h"

#include "base/child_message.h"
#include "base/error.h"
#include "meshio/formats.h"

namespace trephine::meshio {
namespace {

constexpr const char* worker_name = "mesh-read";

void pack(const ForeignSurface& s, MessageWriter& out) {
  out.text(s.name);
  out.value(std::uint8_t(s.has_colour));
  out.value(std::uint8_t(s.has_opacity));
  out.value(s.colour);
  out.value(s.opacity);
  out.value(s.texture_points);
  out.array(s.points);
  out.array(s.triangles);
}

ForeignSurface unpacked(MessageReader& in) {
  ForeignSurface s;
  s.name = in.text();
  s.has_colour = in.value<std::uint8_t>() != 0;
  s.has_opacity = in.value<std::uint8_t>() != 0;
  s.colour = in.value<std::array<double, 3>>();
  s.opacity = in.value<double>();
  s.texture_points = in.value<std::uint64_t>();
  s.points = in.array<Vec3>();
  s.triangles = in.array<std::array<std::uint32_t, 3>>();
  return s;
}

void check(const ForeignSurface& s) {
  for (const Vec3 p : s.points)
    if (!is_finite(p)) throw Error(ExitCode::bad_input, "", "", "damaged: a point is not finite");
  for (const auto& t : s.triangles)
    for (const std::uint32_t i : t)
      if (i >= s.points.size())
        throw Error(ExitCode::bad_input, "", "",
                    "damaged: point index " + std::to_string(i) + " of " + std::to_string(s.points.size()) + " points");
}

const ChildWorker worker(worker_name, [](ChildRequest& request) {
  MessageReader in(worker_name, request.request());
  const auto reader = in.value<ForeignReader>();
  const std::string_view bytes = in.text(), companion = in.text();
  std::vector<ForeignSurface> surfaces;
  try {
    if (reader.program == ForeignProgram::vtk)
      formats().read_with_vtk(&reader, bytes, &surfaces);
    else
      formats().read_with_assimp(&reader, bytes, companion, &surfaces);
  } catch (const std::exception& e) {
    // Whatever a reader throws, the bytes are at fault; this includes std::bad_alloc for a hostile count.
    if (const auto* known = dynamic_cast<const Error*>(&e)) throw *known;
    throw Error(ExitCode::bad_input, "", "", std::string("damaged: the reader gave up: ") + e.what());
  }
  for (const ForeignSurface& s : surfaces) {
    check(s);
    MessageWriter out;
    pack(s, out);
    request.write(out.bytes());
  }
});

}  // namespace

std::vector<ForeignSurface> read_foreign(const ForeignReader& reader, std::string_view bytes,
                                         std::string_view companion, const ChildLimits& limits,
                                         const Progress& progress) {
  MessageWriter request;
  request.reserve(bytes.size() + companion.size() + 32);
  request.value(reader);
  request.text(bytes);
  request.text(companion);
  const ChildResult result = run_child(worker_name, request.bytes(), limits, progress);
  std::vector<ForeignSurface> surfaces;
  for (MessageReader in(worker_name, result.bytes()); !in.empty();) {
    surfaces.push_back(unpacked(in));
    check(surfaces.back());
  }
  return surfaces;
}

ChildLimits foreign_limits(std::size_t bytes) {
  ChildLimits limits;
  // In assimp, text becomes a structure of some hundred bytes for each corner.
  limits.memory_bytes = (std::uint64_t{2} << 30) + 64 * std::uint64_t(bytes);
  limits.cpu_s = 20 + double(bytes) / 1e6;
  limits.wall_s = 3 * limits.cpu_s;
  return limits;
}

}  // namespace trephine::meshio
