// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "device/hand_path.h"
#include "modules/script_places.h"

namespace trephine {
namespace {

constexpr double air_mm = 60;      // above the skin, on ways around the head
constexpr double above_mm = 25;    // above a place, before and after
constexpr double before_mm = 40;   // outside of the hole, where a way into the head begins
constexpr double air_speed = 250;  // mm/s
constexpr double settle_s = 0.2;

class Planner {
 public:
  Planner(const ScriptScene& scene, const ScriptAim& aim) : scene_(scene), places_(scene, aim) {
    if (!scene.manifest.burr_holes.empty()) places_.hole_mm = scene.manifest.burr_holes[0].position_mm;
    const Vec3 top = scene.frame.upwards;
    at_ = scene.frame.centre_mm + top * (norm(places_.skin_towards(top) - scene.frame.centre_mm) + air_mm);
    axis_ = top;
    HandMove begin = move();
    begin.path_mm = {at_};
    moves_.push_back(begin);
  }

  void step(const std::string& name, const AnyParams& params) {
    if (name == "take") return take(params.as<TakeStep>());
    if (name == "trace") return trace(params.as<TraceStep>());
    if (name == "drill") return drill(params.as<DrillStep>());
    if (name == "insert") return insert(params.as<InsertStep>());
    if (name == "withdraw") return withdraw(params.as<WithdrawStep>());
    if (name == "wait") return wait(params.as<WaitStep>().seconds);
    if (name == "lose_device") return lose();
    for (int n = 1; n < belt_command::count; ++n)
      if (name == belt_command::names[n]) return command(n);
    throw Error(ExitCode::internal, "", name, "is a step that nobody plans");
  }

  std::vector<HandMove> moves() && { return std::move(moves_); }

 private:
  HandMove move() const {
    HandMove m;
    m.axis = axis_;
    m.tool = tool_;
    m.speed_mm_per_s = air_speed;
    return m;
  }
  void add(HandMove m) {
    if (!m.path_mm.empty()) at_ = m.path_mm.back();
    moves_.push_back(std::move(m));
  }

  // Around the head, and then to the place; the tool is drawn out of the head before.
  void go(Vec3 to, Vec3 axis) {
    if (inside_) withdraw(WithdrawStep());
    const Vec3 c = scene_.frame.centre_mm;
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

  void take(const TakeStep& s) {
    for (std::size_t n = 0; n < scene_.tools.size(); ++n)
      if (scene_.tools[n].name == s.tool) {
        tool_ = int(n);
        HandMove m = move();
        m.wait_s = 0.05;
        return add(m);
      }
    std::string known;
    for (const BeltToolParams& t : scene_.tools) known += (known.empty() ? "" : ", ") + t.name;
    throw Error(ExitCode::bad_input, "", "tool", s.tool + ": the lesson has " + known);
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

  void lift(Vec3 to) {
    HandMove m = move();
    m.path_mm = {to};
    m.speed_mm_per_s = 100;
    add(m);
  }

  void drill(const DrillStep& s) {
    const Vec3 site = places_.find(s.at);
    HandPathParams p;
    p.site = "there";
    p.hole_diameter_mm = s.hole_diameter_mm;
    p.layer_mm = s.layer_mm;
    p.past_mm = s.past_mm;
    p.approach_mm = above_mm;
    const double radius = 0.5 * scene_.tools[std::size_t(tool_)].tool_diameter_mm;
    const HandPath path = drill_path(scene_.contact, scene_.drilled, {{p.site, site}}, radius, p);
    go(path.points_mm.front(), path.axis);
    HandMove m = move();
    m.pedal = true;
    m.path_mm = path.points_mm;
    m.speed_mm_per_s = s.speed_mm_per_s;
    m.feed_force_n = s.feed_force_n;
    add(m);
    const Contact bone = scene_.contact.intersect(path.points_mm.front(), path.points_mm.front() - path.axis * 80,
                                                  TouchableFaces{scene_.drilled, 0});
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

  void withdraw(const WithdrawStep& s) {
    inside_ = false;
    HandMove m = move();
    m.path_mm = {at_ + axis_ * s.by_mm};
    m.speed_mm_per_s = s.speed_mm_per_s;
    add(m);
  }

  void wait(double seconds) {
    HandMove m = move();
    m.wait_s = seconds;
    add(m);
  }
  void command(int n) {
    HandMove m = move();
    m.command = n;
    m.wait_s = 0.1;
    add(m);
  }
  void lose() {
    HandMove m = move();
    m.lost = true;
    m.wait_s = 0.1;
    add(m);
  }

  const ScriptScene& scene_;
  ScriptPlaces places_;
  std::vector<HandMove> moves_;
  Vec3 at_, axis_;
  int tool_ = 0;
  bool inside_ = false;
};

}  // namespace

std::vector<HandMove> plan_moves(const LessonScript& script, const ScriptScene& scene, const ScriptAim& aim) {
  Planner planner(scene, aim);
  for (std::size_t n = 0; n < script.steps.size(); ++n) {
    const auto& [name, params] = script.steps[n];
    with_field("steps[" + std::to_string(n) + "]." + name, [&] {
      try {
        planner.step(name, params);
      } catch (const Error& e) {  // what the path says of a place is the script's fault
        if (e.code() == ExitCode::internal) throw;
        throw Error(ExitCode::bad_input, "", e.field(), e.what());
      }
    });
  }
  return std::move(planner).moves();
}

}  // namespace trephine
