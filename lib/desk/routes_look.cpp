// SPDX-License-Identifier: GPL-3.0-or-later
// Looking: the voxels of an opened case.
#include <cmath>
#include <cstring>

#include "desk/desk.h"
#include "desk/json_reply.h"
#include "segmentation/grow.h"

namespace trephine::desk {
namespace {

Json json_of(Vec3 v) { return Json::array({v.x, v.y, v.z}); }

Json json_of(const grid::Lattice& l) {
  Json direction = Json::array();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) direction.push_back(l.direction.column[std::size_t(c)][r]);
  return {{"size", l.size},
          {"spacing_mm", json_of(l.spacing_mm)},
          {"origin_mm", json_of(l.origin_mm)},
          {"direction", direction}};
}

Vec3 vector_of(const Request& request, const std::string& name) {
  return {real_of(request, name + "_x"), real_of(request, name + "_y"), real_of(request, name + "_z")};
}

}  // namespace

Reply Desk::open(const Request& request) {
  const auto one = opened(request.value("case"), request.value("again") == "1");
  const OpenCase::Now now = one->now();
  Json out = {{"state", now.state == OpenCase::State::opening ? "opening"
                        : now.state == OpenCase::State::ready ? "ready"
                                                              : "failed"},
              {"doing", now.doing},
              {"fraction", now.fraction},
              {"fault", now.fault},
              {"fields", now.fields},
              {"warnings", now.warnings}};
  if (const auto scan = one->scan()) out["lattice"] = json_of(grid::lattice_of(*scan));
  return json_reply(out);
}

Reply Desk::slice(const Request& request) {
  const auto one = looked_at(request);
  return bytes_reply(slice_bytes(*one->scan(), number_of(request, "axis"), number_of(request, "index")));
}

Reply Desk::field(const Request& request) {
  const auto one = looked_at(request);
  const auto field = one->field(request.value("name"));
  if (!field) throw Error(ExitCode::no_input, "", "name", "the case has no such field");
  return bytes_reply(slice_bytes(*field, number_of(request, "axis"), number_of(request, "index")));
}

Reply Desk::plane(const Request& request) {
  const auto one = looked_at(request);
  return bytes_reply(plane_bytes(*one->scan(), vector_of(request, "corner"), vector_of(request, "right"),
                                 vector_of(request, "down"), number_of(request, "side")));
}

Reply Desk::grow(const Request& request) {
  const auto one = looked_at(request);
  segmentation::GrowRequest how;
  how.seed = {number_of(request, "i"), number_of(request, "j"), number_of(request, "k")};
  how.radius_mm = real_of(request, "radius_mm");
  how.lower_hu = real_of(request, "lower_hu");
  how.upper_hu = real_of(request, "upper_hu");
  const grid::Mask grown = segmentation::grow_in_ball(*one->scan(), how);
  const Vec3 at = grid::lattice_of(*one->scan()).to_index(grown.to_world_mm({0, 0, 0}));
  std::int32_t head[6] = {0, 0, 0, grown.size[0], grown.size[1], grown.size[2]};
  for (int a = 0; a < 3; ++a) head[a] = static_cast<std::int32_t>(std::lround(at[a]));
  std::string bytes(reinterpret_cast<const char*>(head), sizeof head);
  bytes.append(reinterpret_cast<const char*>(grown.voxels.data()), grown.voxels.size());
  return bytes_reply(std::move(bytes));
}

}  // namespace trephine::desk
