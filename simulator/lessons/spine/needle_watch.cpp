// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine/needle_watch.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/error.h"

namespace trephine::lessons {
namespace {

constexpr double path_step_mm = 0.25;
constexpr double arm_step_deg = 5;

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

int spine_bone_of(const cases::CaseManifest& manifest) {
  if (pedicles_of(manifest).empty())
    throw Error(ExitCode::bad_input, "", "landmarks",
                "the lesson needs a pedicle: pedicle_1_left_entry and pedicle_1_left_target, or others of that form");
  for (const cases::CaseShape& shape : manifest.haptic.shapes)
    if (shape.name == "bone" && shape.material.front.touchable) return shape.number;
  throw Error(ExitCode::bad_input, "", "haptic.shapes", "the lesson needs bone that is felt");
}

bool ArmPose::take(int command) {
  namespace c = haptics::belt_command;
  if (command == c::view_ap)
    *this = {0, 0};
  else if (command == c::view_lateral)
    *this = {90, 0};
  else if (command == c::view_oblique)
    *this = {45, 0};
  else if (command == c::orbit_more)
    orbit_deg = std::min(180.0, orbit_deg + arm_step_deg);
  else if (command == c::orbit_less)
    orbit_deg = std::max(-180.0, orbit_deg - arm_step_deg);
  else if (command == c::tilt_more)
    tilt_deg = std::min(60.0, tilt_deg + arm_step_deg);
  else if (command == c::tilt_less)
    tilt_deg = std::max(-60.0, tilt_deg - arm_step_deg);
  else
    return false;
  return true;
}

const char* ArmPose::view() const {
  if (tilt_deg != 0) return "free";
  return orbit_deg == 0 ? "ap" : orbit_deg == 90 ? "lateral" : orbit_deg == 45 ? "oblique" : "free";
}

fluoro::CArmParams arm_of(const cases::CaseManifest& manifest, const ArmPose& pose) {
  const std::vector<CasePedicle> pedicles = pedicles_of(manifest);
  Vec3 middle;
  for (const CasePedicle& p : pedicles) middle += (p.entry_mm + p.target_mm) * (0.5 / double(pedicles.size()));
  fluoro::CArmParams arm;
  arm.view = fluoro::CArmParams::View::free;
  arm.orbit_deg = pose.orbit_deg;
  arm.tilt_deg = pose.tilt_deg;
  arm.centre_mm = {middle.x, middle.y, middle.z};
  arm.detector_mm = 230;  // an image intensifier of nine inches
  return arm;
}

double SpineNeedleFacts::exposure_s() const {
  double sum = 0;
  for (const FluoroShot& s : shots) sum += s.end_s - s.begin_s;
  return std::round(1e6 * sum) / 1e6;
}

const NeedlePoint& NeedlePass::deepest() const {
  return *std::max_element(path.begin(), path.end(),
                           [&](const NeedlePoint& a, const NeedlePoint& b) { return depth_mm(a) < depth_mm(b); });
}

int SpineNeedleFacts::empty_punctures() const {
  return int(std::count_if(punctures.begin(), punctures.end(), [&](const NeedlePass& p) {
    return std::none_of(passes.begin(), passes.end(), [&](const NeedlePass& in_bone) {
      return in_bone.begin_s >= p.begin_s && in_bone.begin_s <= p.end_s;
    });
  }));
}

std::optional<double> SpineNeedleFacts::blind_s() const {
  double since_s = 0;
  for (const NeedlePass& pass : passes) {
    const double half_mm = 0.5 * pass.depth_mm(pass.deepest());
    double half_s = pass.end_s;
    for (auto p = pass.path.rbegin(); p != pass.path.rend(); ++p)
      if (pass.depth_mm(*p) >= half_mm) half_s = p->time_s;
    if (std::none_of(shots.begin(), shots.end(),
                     [&](const FluoroShot& s) { return s.begin_s <= half_s && s.end_s >= since_s; }))
      return half_s;
    since_s = pass.begin_s;
  }
  return {};
}

SpineNeedle::SpineNeedle(const cases::CaseManifest& manifest) : bone_(spine_bone_of(manifest)) {}

void SpineNeedle::tick(const haptics::ServoFrame& f, const haptics::ToolBelt& belt, bool pedal) {
  const Vec3 tip = vec(f.proxy_mm), axis = vec(f.axis);
  const haptics::BeltToolParams& tool = belt.tools()[std::size_t(belt.in_hand())];
  const auto end_both = [&] { end(in_bone_, f.time_s, false), end(in_patient_, f.time_s, false); };
  if (belt.in_hand() != in_hand_) end_both();  // another tool is another pass
  in_hand_ = belt.in_hand();
  if (pedal && !exposing_) {
    facts_.shots.emplace_back();
    facts_.shots.back().begin_s = f.time_s - f.dt_s;
  }
  exposing_ = pedal;
  if (pedal) {
    FluoroShot& s = facts_.shots.back();
    s.end_s = f.time_s;
    s.arm = arm_;
    s.tip_mm = tip;
    s.axis = axis;
    s.needle_mm = tool.tool_diameter_mm;
    s.length_mm = tool.tool_length_mm;
  }
  if (f.inside == 0 && taken_away(f, belt, last_.tip_mm)) end_both();
  if (belt.paused()) return;
  const NeedlePoint now{f.time_s, tip, axis, f.inside};
  if (in_bone_.open || in_patient_.open || f.inside != 0) last_ = now;
  follow(in_bone_, f.inside == bone_, tool);
  follow(in_patient_, f.inside != 0, tool);
}

// By the last point.
void SpineNeedle::follow(Way& way, bool inside, const haptics::BeltToolParams& tool) {
  if (!way.open) {
    if (!inside) return;
    way.open = true;
    NeedlePass p;
    p.begin_s = last_.time_s;
    p.entry_mm = last_.tip_mm;
    p.axis = last_.axis;
    p.tool = tool.name;
    p.diameter_mm = tool.tool_diameter_mm;
    p.length_mm = tool.tool_length_mm;
    way.all.push_back(p);
  }
  NeedlePass& p = way.all.back();
  p.end_s = last_.time_s;
  if (p.path.empty() || p.path.back().inside != last_.inside ||
      norm(last_.tip_mm - p.path.back().tip_mm) >= path_step_mm)
    p.path.push_back(last_);
  // Beyond a wall it is out of the bone, and still in its way.
  if (!inside && p.depth_mm(last_) < -withdrawn_mm) end(way, last_.time_s, false);
}

void SpineNeedle::command(int command, const haptics::ServoFrame&, const haptics::ToolBelt&) { arm_.take(command); }

void SpineNeedle::end(Way& way, double time_s, bool in_place) {
  if (!way.open) return;
  way.open = false;
  NeedlePass& p = way.all.back();
  p.end_s = time_s;
  p.in_place = in_place;
  p.path.push_back(last_);
}

void SpineNeedle::close() {
  end(in_bone_, facts_.end_s, true);
  end(in_patient_, facts_.end_s, true);
  exposing_ = false;
}

}  // namespace trephine::lessons
