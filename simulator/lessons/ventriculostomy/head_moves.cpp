// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "device/hand_path.h"
#include "lessons/ventriculostomy/head_moves.h"
#include "lessons/ventriculostomy/script_places.h"

namespace trephine::lessons {
namespace {

constexpr double air_mm = 60;     // above the skin, on ways around the head
constexpr double above_mm = 25;   // above a place, before and after
constexpr double before_mm = 40;  // outside of the hole, where a way into the head begins
constexpr double settle_s = 0.2;

// Above the vault.
Vec3 begin_of(const ScriptPlaces& places, const HeadFrame& frame) {
  const Vec3 top = frame.upwards;
  return frame.centre_mm + top * (norm(places.skin_towards(top) - frame.centre_mm) + air_mm);
}

class HeadPlan : public MovePlan {
 public:
  HeadPlan(const ScriptScene& scene, const HeadFrame& frame, ScriptPlaces& places, bool misses)
      : MovePlan(scene, begin_of(places, frame), frame.upwards), frame_(frame), places_(places), misses_(misses) {
    if (!scene.manifest.burr_holes.empty()) places_.hole_mm = scene.manifest.burr_holes[0].position_mm;
  }

  void step(const std::string& name, const AnyParams& params) override {
    if (name == "trace") return trace(params.as<TraceStep>());
    if (name == "drill") return drill(params.as<DrillStep>());
    if (name == "insert") return insert(params.as<InsertStep>());
    MovePlan::step(name, params);
  }

 private:
  // Around the head, and then to the place; the tool is drawn out of the head before.
  void go(Vec3 to, Vec3 axis) {
    if (inside_) withdraw(WithdrawStep());
    const Vec3 c = frame_.centre_mm;
    HandMove m = move();
    m.axis = axis_ = axis;
    const double from_mm = norm(at_ - c), to_mm = norm(to - c);
    const std::vector<Vec3> ways = places_.directions_between(places_.direction_of(at_), places_.direction_of(to));
    for (std::size_t n = 0; n < ways.size(); ++n) {
      const double share = double(n) / double(std::max<std::size_t>(1, ways.size() - 1));
      m.path_mm.push_back(c + ways[n] * (from_mm + (to_mm - from_mm) * share));
    }
    m.path_mm.push_back(to);
    add(m);
  }

  void trace(const TraceStep& s) {
    const Vec3 from = places_.find(s.from), to = places_.find(s.to);
    const Vec3 begin = places_.direction_of(from), end = places_.direction_of(to);
    const Vec3 first = places_.skin_towards(begin);
    go(first + begin * above_mm, normalized(begin + end));
    HandMove m = move();
    m.path_mm = {first - begin * s.press_mm};
    m.speed_mm_per_s = 100;
    m.wait_s = settle_s;
    add(m);
    m.pedal = true;
    m.path_mm.clear();
    m.speed_mm_per_s = s.speed_mm_per_s;
    m.wait_s = 0.05;
    for (const Vec3& d : places_.directions_between(begin, end))
      m.path_mm.push_back(places_.skin_towards(d) - d * s.press_mm);
    add(m);
    const Vec3 last = places_.skin_towards(end);
    places_.mark_mm = last;
    lift(last + end * above_mm);
  }

  void lift(Vec3 to) { go_straight(to, 100); }

  void drill(const DrillStep& s) {
    Vec3 site = places_.find(s.at);
    // A hand that misses the place by much still begins at the skin, not in the air or within the head.
    if (misses_) site = places_.skin_towards(places_.direction_of(site));
    device::HandPathParams p;
    p.site = "there";
    p.hole_diameter_mm = s.hole_diameter_mm;
    p.layer_mm = s.layer_mm;
    p.past_mm = s.past_mm;
    p.approach_mm = above_mm;
    const double radius = 0.5 * haptics::own_tool(scene_.tools[std::size_t(tool_)]).tool_diameter_mm;
    const device::HandPath path = device::drill_path(scene_.contact, scene_.drilled, {{p.site, site}}, radius, p);
    go(path.points_mm.front(), path.axis);
    HandMove m = move();
    m.pedal = true;
    m.path_mm = path.points_mm;
    m.speed_mm_per_s = s.speed_mm_per_s;
    m.feed_force_n = s.feed_force_n;
    add(m);
    const contact::Contact bone = scene_.contact.intersect(
        path.points_mm.front(), path.points_mm.front() - path.axis * 80, contact::TouchableFaces{scene_.drilled, 0});
    places_.hole_mm = bone.hit ? bone.point_mm : site;
    lift(path.points_mm.front());
  }

  void insert(const InsertStep& s) {
    const Vec3 from = places_.find(s.from), to = places_.find(s.toward);
    const Vec3 out = normalized(from - to);
    if (out == Vec3{}) throw Error(ExitCode::bad_input, "", "toward", "is the place where it enters");
    go(from + out * before_mm, out);
    HandMove m = move();
    m.path_mm = {to + out * s.short_of_mm};
    m.speed_mm_per_s = s.speed_mm_per_s;
    m.wait_s = settle_s;
    add(m);
    inside_ = true;
  }

  const HeadFrame& frame_;
  ScriptPlaces& places_;
  const bool misses_;
};

}  // namespace

std::vector<HandMove> plan_head_moves(const LessonScript& script, const ScriptScene& scene, const ScriptAim& aim) {
  const HeadFrame frame = head_frame_of(scene.manifest);
  ScriptPlaces places(scene, frame, aim);
  HeadPlan plan(scene, frame, places, aim.aim_noise_mm > 0);
  return plan_steps(script, plan);
}

}  // namespace trephine::lessons
