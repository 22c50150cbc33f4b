// SPDX-License-Identifier: GPL-3.0-or-later
// What a user does, and the remote's protocol, which does the same by words.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <sstream>

#include "base/error.h"
#include "window/player.h"

namespace trephine {
namespace {

constexpr double above_surface_mm = 2;  // where a tool is put that goes to a surface
constexpr double most_mm = 1e5, most_ahead_mm = 8;
constexpr const char* not_now = "not now: the lesson waits for its device, or has ended";

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

std::string Player::take_tool(const std::string& name) {
  if (playback_) return "a recording is shown";
  if (desk_) return session_ ? desk_->take(name) : not_now;
  ToolParams next;
  next.tool = name;
  try {
    tool_kind(name);
    make_tool(own_tool(next));
  } catch (const Error& e) {
    return e.what();
  }
  end_session();
  goal_.buttons = 0;
  tool_name_ = name;
  options_.session.tool = next;
  begin_session();
  return "";
}

std::string Player::set_view(const std::string& preset) {
  for (const auto& [name, value] : view_presets())
    if (name == preset) {
      ViewParams v = stage_->view();
      v.view = value;
      camera = camera_of(v, patient_->felt.loaded.manifest, stage_->scene());
      return "";
    }
  return preset + ": there is no such view";
}

std::string Player::set_opacity(const std::string& anatomy, double opacity) {
  if (const std::string why = barred(); !why.empty()) return why;
  const int n = stage_->scene().find(anatomy);
  if (n < 0) return anatomy + ": the case shows none of that name";
  if (!(opacity >= 0 && opacity <= 1)) return "an opacity is a number from 0 to 1";
  stage_->state.opacity[std::size_t(n)] = opacity;
  return "";
}

std::string Player::cut(const std::string& how) {
  if (const std::string why = barred(); !why.empty()) return why;
  const Vec3 tip = vec(frame_.proxy_mm);
  if (how == "none")
    stage_->state.cut.reset();
  else if (how == "tool")
    stage_->state.cut = CutPlane{tip, normalized(vec(frame_.axis))};
  else if (how == "axial")
    stage_->state.cut = CutPlane{tip, {0, 0, 1}};
  else if (how == "coronal")
    stage_->state.cut = CutPlane{tip, {0, -1, 0}};
  else if (how == "sagittal")
    stage_->state.cut = CutPlane{tip, {1, 0, 0}};
  else
    return how + ": a cut is none, tool, axial, coronal or sagittal";
  return "";
}

void Player::move_cut(double mm) {
  if (stage_->state.cut) stage_->state.cut->point_mm += normalized(stage_->state.cut->normal) * mm;
}

void Player::set_pedal(bool down) {
  pedal_ = down;
  if (desk_) {
    if (session_) desk_->set_pedal(down);
    return;
  }
  if (tool_kind(options_.session.tool.tool).cut == ToolKind::Cut::incision) {  // it has no motor: it cuts where it is
    if (down) incise();
    return;
  }
  goal_.buttons = down ? goal_.buttons | Drilling::pedal : goal_.buttons & ~Drilling::pedal;
  aim();
}

std::string Player::incise() {
  if (desk_) return lesson_command("incise");
  goal_.buttons |= Drilling::mark;
  aim();
  return "";
}

void Player::move_tool(Vec3 by_mm) {
  const Vec3 next = goal_.tip_mm + by_mm;
  if (!is_finite(next) || norm(next) > most_mm) return;
  goal_.tip_mm = next;
  aim();
}

void Player::advance_tool(double mm) {
  const Vec3 ahead = -normalized(vec(frame_.axis));
  const double behind = dot(goal_.tip_mm - vec(frame_.tip_mm), ahead);
  if (mm > 0 ? behind < most_ahead_mm : behind > -most_ahead_mm) move_tool(ahead * mm);
}

void Player::place_tool(Vec3 tip_mm, const std::optional<Vec3>& axis) {
  if (!is_finite(tip_mm) || !(norm(tip_mm) <= most_mm)) return;
  goal_.tip_mm = tip_mm;
  if (axis && is_finite(*axis) && norm(*axis) > 1e-3) goal_.axis = normalized(*axis);
  ++goal_.lifts;
  aim();
}

void Player::turn_tool(double right_rad, double up_rad) {
  const Vec3 axis = goal_.axis + camera.right() * std::tan(right_rad) + camera.up * std::tan(up_rad);
  if (norm(axis) > 1e-3) goal_.axis = normalized(axis);
  aim();
}

void Player::aim_at_viewer() {
  goal_.axis = camera.toward;
  aim();
}

std::string Player::aim_at_target() {
  if (const std::string why = barred(); !why.empty()) return why;
  const CaseTarget* nearest = nullptr;
  for (const CaseTarget& t : patient_->felt.loaded.manifest.targets)
    if (!nearest || norm(t.position_mm - goal_.tip_mm) < norm(nearest->position_mm - goal_.tip_mm)) nearest = &t;
  if (!nearest) return "the case has no target";
  if (norm(goal_.tip_mm - nearest->position_mm) > 1) goal_.axis = normalized(goal_.tip_mm - nearest->position_mm);
  aim();
  return "";
}

std::string Player::to_surface(double x, double y, int width, int height) {
  const Contact c = seen(x, y, width, height);
  if (!c.hit) return "nothing is there";
  const Vec3 normal = norm(c.normal) > 0 ? normalized(c.normal) : camera.toward;
  place_tool(c.point_mm + normal * above_surface_mm, normal);
  return "";
}

void Player::pause(bool on) {
  if (desk_ && !playback_)
    lesson_command(on ? "pause" : "resume");
  else
    paused_ = on;
}
void Player::go_to(double time_s) {
  if (playback_) playback_->go_to(time_s);
}

std::string Player::set_places(bool shown) {
  if (const std::string why = barred(); !why.empty()) return why;
  stage_->state.markers = shown ? places_of(patient_->felt.loaded.manifest) : std::vector<Marker>();
  return "";
}

std::string Player::set_ct_slices(bool shown) {
  if (const std::string why = barred(); !why.empty()) return why;
  stage_->state.ct_planes.clear();
  if (shown)
    for (int axis = 0; axis < 3; ++axis) stage_->state.ct_planes.push_back({axis, vec(frame_.proxy_mm)});
  return "";
}

std::string Player::set_insets(bool shown) {
  if (const std::string why = barred(); !why.empty()) return why;
  stage_->state.insets = shown;
  return "";
}

void Player::set_trace(bool on) {
  tracing_ = on;
  if (!on) return;
  stage_->state.trace_mm.clear();
  trace_mm_ = 0;
  trace_apart_mm_ = 1;
}

std::string Player::under(double x, double y, int width, int height) const {
  const Contact c = seen(x, y, width, height);
  if (!c.hit) return "";
  return fmt::format("{}, {:.1f} {:.1f} {:.1f} mm", shape_name(c.shape), c.point_mm.x, c.point_mm.y, c.point_mm.z);
}

std::string Player::command(const std::string& line) {
  std::istringstream words(line);
  std::string verb;
  words >> verb;
  const auto word = [&] {
    std::string w;
    words >> w;
    return w;
  };
  const auto number = [&] {
    double v = 0;
    if (!(words >> v) || !std::isfinite(v)) throw Error(ExitCode::usage, "", verb, "a number is missing");
    return v;
  };
  const auto point = [&] {
    const double x = number(), y = number();
    return Vec3{x, y, number()};
  };
  const auto on = [&] {
    const std::string w = word();
    if (w != "on" && w != "off") throw Error(ExitCode::usage, "", verb, "must be on or off");
    return w == "on";
  };
  std::string fault;
  try {
    if (verb == "tool")
      fault = take_tool(word());
    else if (verb == "view")
      fault = set_view(word());
    else if (verb == "opacity") {
      const std::string name = word();
      fault = set_opacity(name, number());
    } else if (verb == "show")
      fault = set_opacity(word(), 1);
    else if (verb == "hide")
      fault = set_opacity(word(), 0);
    else if (verb == "cut")
      fault = cut(word());
    else if (verb == "move_cut")
      move_cut(number());
    else if (verb == "pedal")
      set_pedal(on());
    else if (verb == "incise")
      fault = incise();
    else if (verb == "erase" || verb == "aspirate" || verb == "finish" || verb == "next" || verb == "back")
      fault = lesson_command(verb);
    else if (verb == "lesson")
      return lesson_state();
    else if (verb == "arm")
      fault = move_arm(word());
    else if (verb == "xray")
      return xray_state();
    else if (verb == "move")
      move_tool(point());
    else if (verb == "place") {
      const Vec3 tip = point();
      words >> std::ws;
      place_tool(tip, words.eof() ? std::nullopt : std::optional<Vec3>(point()));
    } else if (verb == "aim")
      fault = aim_at_target();
    else if (verb == "places")
      fault = set_places(on());
    else if (verb == "slices")
      fault = set_ct_slices(on());
    else if (verb == "insets")
      fault = set_insets(on());
    else if (verb == "head") {
      const Vec3 head = point();
      if (is_finite(head) && norm(head) <= most_mm) head_mm = head;
    } else if (verb == "trace")
      set_trace(on());
    else if (verb == "orbit") {
      const double right = number() * M_PI / 180;
      camera.orbit(right, number() * M_PI / 180);
    } else if (verb == "zoom") {
      const double factor = number();
      if (!(factor > 0)) throw Error(ExitCode::usage, "", verb, "the factor must be above 0");
      camera.zoom(factor);
    } else if (verb == "pause")
      pause(on());
    else if (verb == "go_to")
      go_to(number());
    else if (verb == "shot")
      ask_shot();
    else if (verb == "quit")
      quit();
    else if (verb == "state")
      return fmt::format(
          "time {:.3f} tool {} tip {:.3f} {:.3f} {:.3f} in {} touching {} force {:.3f} depth {:.2f} faults {} "
          "incisions {} "
          "servo_hz {:.0f} tool_at {:.3f} {:.3f} {:.3f}",
          frame_.time_s, tool_name_, frame_.proxy_mm[0], frame_.proxy_mm[1], frame_.proxy_mm[2],
          frame_.inside ? shape_name(frame_.inside) : "none", frame_.touched ? shape_name(frame_.touched) : "none",
          norm(vec(frame_.force_n)), depth_mm_, frame_.faults,
          live() ? incisions_.size() : playback_->incisions().size(), servo_hz_, frame_.tip_mm[0], frame_.tip_mm[1],
          frame_.tip_mm[2]);
    else
      fault = verb + ": no such command";
  } catch (const Error& e) {
    return "error: " + (e.field().empty() ? "" : e.field() + ": ") + e.what();
  }
  return fault.empty() ? "ok" : "error: " + fault;
}

}  // namespace trephine
