// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/theatre.h"

#include <algorithm>
#include <cmath>

#include "scene/room.h"
#include "scene/tool_solid.h"

namespace trephine::window {
namespace {

constexpr double beats_per_s = 1.2;

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

// From an artery it comes in beats.
std::optional<std::array<float, 3>> inside_rgb(lesson::Fluid fluid, double time_s) {
  switch (fluid) {
    case lesson::Fluid::none:
      break;
    case lesson::Fluid::venous_blood:
      return scene::venous_rgb;
    case lesson::Fluid::arterial_blood:
      return std::fmod(time_s * beats_per_s, 1.0) < 0.4 ? scene::arterial_beat_rgb : scene::arterial_rgb;
    case lesson::Fluid::csf:
      return scene::csf_rgb;
    case lesson::Fluid::air:
      return scene::air_rgb;
  }
  return {};
}

}  // namespace

Theatre::ToolLook Theatre::look() const {
  return {lesson_.tool().name, lesson_.verdict(), inside_rgb(lesson_.tool_flow().fluid, lesson_.facts().end_s)};
}

void Theatre::show(CaseView& view) {
  show_tool(view);
  show_room(view);
  show_field(view);
}

void Theatre::follow(const std::vector<haptics::ServoFrame>& frames, CaseView& view) {
  const std::string tool = shown_.tool;
  if (!(look() == shown_)) show_tool(view);
  if (tool != shown_.tool) show_room(view);
  const LessonController::ToolFlow flow = lesson_.tool_flow();
  if (flow.ml_per_s)
    for (const haptics::ServoFrame& f : frames) run_ml_ += *flow.ml_per_s * f.dt_s;
  else if (flow.fluid == lesson::Fluid::csf) {
    const Vec3 down = lesson_.field(view.middle_mm()).down;
    for (const haptics::ServoFrame& f : frames) drain_.step(-tail_mm_ * dot(normalized(vec(f.axis)), down), f.dt_s);
  }
  show_field(view);
}

std::vector<scene::Bleeding> Theatre::bleedings() const {
  std::vector<scene::Bleeding> all;
  for (const lessons::Flow& flow : lesson_.flows())
    if (const auto& wound = flow.seen.wound;
        wound && flow.fluid != lesson::Fluid::air && flow.fluid != lesson::Fluid::csf)
      all.push_back({wound->source_mm, wound->mouth_mm, wound->width_mm, flow.ml_per_min, flow.begin_s, flow.end_s});
  return all;
}

void Theatre::show_tool(CaseView& view) {
  constexpr std::array<float, 3> green{0.10f, 0.75f, 0.35f}, red{0.90f, 0.15f, 0.10f};
  shown_ = look();
  std::optional<std::array<float, 3>> colour;
  if (shown_.verdict != 0) colour = shown_.verdict > 0 ? green : red;
  const haptics::ToolParams tool = haptics::own_tool(lesson_.tool());
  tail_mm_ = scene::tail_mm(tool);
  view.stage().set_tool(tool, colour, shown_.inside_rgb);
}

void Theatre::show_room(CaseView& view) const {
  // What is not in the hand lies on the tray, on the right of who looks.
  const lessons::LessonField field = lesson_.field(view.middle_mm());
  scene::RoomParams room;
  room.down = field.down;
  room.head = lesson_.of_head();
  room.tray_side = field.down.y > 0 && !room.head ? 1 : -1;
  for (const haptics::BeltToolParams& t : lesson_.tools())
    if (t.name != lesson_.tool().name) room.tools.push_back(haptics::own_tool(t));
  room.patient_mm = view.stage().scene().bounds;
  view.stage().state.room = std::make_shared<scene::Room>(scene::make_room(room, view.stage().scene().centre_mm));
}

void Theatre::show_field(CaseView& view) {
  const lessons::LessonField field = lesson_.field(view.middle_mm());
  if (field.open_mm > 0 && !lesson_.has_arm()) view.open_field_mm = field.centre_mm;
  view.stands_from = norm(field.from) > 0 ? std::optional<Vec3>(field.from) : std::nullopt;
  scene::SceneState& state = view.stage().state;
  state.theatre = scene::TheatreField{field.centre_mm, field.open_mm, field.lamp_mm};
  state.drops.clear();
  const haptics::ToolParams tool = haptics::own_tool(lesson_.tool());
  using Look = haptics::ToolKind::Look;
  const Look look = haptics::tool_kind(tool.tool).look;
  const LessonController::ToolFlow flow = lesson_.tool_flow();
  // What is hollow and open drips; a syringe is filled.
  if ((look != Look::tube && look != Look::cross_handle) || flow.fluid == lesson::Fluid::air) return;
  const auto rgb = inside_rgb(flow.fluid, 0);
  if (!rgb) return;
  const haptics::ServoFrame& f = view.frame();
  const scene::Tube tube{vec(f.proxy_mm), normalized(vec(f.axis)), field.down, 0.5 * tool.tool_diameter_mm, tail_mm_};
  state.drops = flow.ml_per_s ? scene::drops_of(tube, run_ml_, *flow.ml_per_s, *rgb)
                              : scene::drops_of(tube, drain_.drained_ml(),
                                                drain_.ml_per_s(-tube.to_mm * dot(tube.axis, tube.down)), *rgb);
}

}  // namespace trephine::window
