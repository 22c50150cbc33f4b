// SPDX-License-Identifier: GPL-3.0-or-later
// Looking: the voxels of an opened case.
#include "base/progress.h"
#include "desk/desk_state.h"
#include "desk/json_reply.h"
#include "desk/patches.h"
#include "mask/between_slices.h"
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

Reply open_case(DeskState& desk, const Request& request) {
  const std::string again = request.value("again");
  const auto one = desk.cases.open(request.value("case"), again == "1"        ? OpenCases::How::anew
                                                          : again == "behind" ? OpenCases::How::behind
                                                                              : OpenCases::How::as_it_is);
  const OpenCase::Now now = one->now();
  Json out = {{"state", now.state == OpenCase::State::opening ? "opening"
                        : now.state == OpenCase::State::ready ? "ready"
                                                              : "failed"},
              {"doing", now.doing},
              {"fraction", now.fraction},
              {"fault", now.fault},
              {"fields", now.fields},
              {"warnings", now.warnings}};
  out["landmarks"] = Json::array();
  for (const cases::CaseLandmark& l : now.landmarks)
    out["landmarks"].push_back({{"name", l.name},
                                {"position_mm", Json::array({l.position_mm.x, l.position_mm.y, l.position_mm.z})},
                                {"confidence", l.confidence},
                                {"source", l.source}});
  if (const auto scan = one->scan()) out["lattice"] = json_of(grid::lattice_of(*scan));
  return json_reply(out);
}

Reply slice(DeskState& desk, const Request& request) {
  const auto one = desk.cases.looked_at(request.value("case"));
  return bytes_reply(slice_bytes(*one->scan(), number_of(request, "axis"), number_of(request, "index")));
}

Reply field(DeskState& desk, const Request& request) {
  const auto one = desk.cases.looked_at(request.value("case"));
  const std::string name = request.value("name");
  const auto field = name == "~tried"  ? desk.trials.of(request.value("case"))->field()
                     : name == "~edit" ? desk.live.field(request.value("case"))
                                       : one->field(name);
  // A page that has just let go of an edit may still ask for it.
  if (!field && name == "~edit") return bytes_reply(std::string(4 * sizeof(std::int32_t), '\0'));
  if (!field) throw Error(ExitCode::no_input, "", "name", "the case has no such field");
  return bytes_reply(slice_bytes(*field, number_of(request, "axis"), number_of(request, "index")));
}

Reply plane(DeskState& desk, const Request& request) {
  const auto one = desk.cases.looked_at(request.value("case"));
  return bytes_reply(plane_bytes(*one->scan(), vector_of(request, "corner"), vector_of(request, "right"),
                                 vector_of(request, "down"), number_of(request, "side")));
}

Reply grow(DeskState& desk, const Request& request) {
  const auto one = desk.cases.looked_at(request.value("case"));
  segmentation::GrowRequest how;
  how.seed = {number_of(request, "i"), number_of(request, "j"), number_of(request, "k")};
  how.radius_mm = real_of(request, "radius_mm");
  how.lower_hu = real_of(request, "lower_hu");
  how.upper_hu = real_of(request, "upper_hu");
  const grid::Mask grown = segmentation::grow_in_ball(*one->scan(), how);
  return bytes_reply(encode_painted(grown, grid::lattice_of(*one->scan())));
}

// The slices between those that were painted.
Reply between(DeskState& desk, const Request& request) {
  const auto one = desk.cases.looked_at(request.value("case"));
  const Progress progress({}, &cancel_requested());
  grid::Mask voxels = decode_painted(request.body, grid::lattice_of(*one->scan()));
  const auto value = static_cast<std::uint8_t>(number_of(request, "value") == removed_byte ? removed_byte : added_byte);
  voxels = mask::between_slices(voxels, value, number_of(request, "axis"), progress);
  return bytes_reply(encode_painted(voxels, grid::lattice_of(*one->scan())));
}

}  // namespace

Routes look_routes() {
  return {
      {"api/open", {"GET", open_case}}, {"api/slice", {"GET", slice}}, {"api/field", {"GET", field}},
      {"api/plane", {"GET", plane}},    {"api/grow", {"GET", grow}},   {"api/between", {"POST", between}},
  };
}

}  // namespace trephine::desk
