// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/subclavian/chest_moves.h"

#include "base/error.h"
#include "lessons/subclavian/chest_frame.h"

namespace trephine::lessons {
namespace {

constexpr double before_mm = 40;  // outside of the skin, where a way into it begins
constexpr double air_mm = 150;    // in front of the notch, where the hand begins
constexpr double air_speed = 250, settle_s = 0.2;
constexpr double beyond_mm = 600;  // from where the skin is looked for
constexpr Vec3 forwards{0, -1, 0};

class ChestPlan : public MovePlan {
 public:
  ChestPlan(const ScriptScene& scene, const ChestFrame& frame, const ScriptAim& aim)
      : MovePlan(scene, frame.notch_mm + forwards * air_mm, forwards), frame_(frame), missed_(aim) {}

  void step(const std::string& name, const AnyParams& params) override {
    if (name != "puncture") return MovePlan::step(name, params);
    const PunctureStep& s = params.as<PunctureStep>();
    const Vec3 from = place(s.from), to = place(s.toward), out = normalized(from - to);
    if (out == Vec3{}) throw Error(ExitCode::bad_input, "", "toward", "is the place where it enters");
    if (inside_) withdraw(WithdrawStep());
    go_straight({at_.x, from.y - air_mm, at_.z}, air_speed);  // clear of the chest first
    axis_ = out;
    go_straight(from + out * before_mm, air_speed);
    HandMove m = move();
    m.path_mm = {to + out * s.short_of_mm};
    m.speed_mm_per_s = s.speed_mm_per_s;
    m.wait_s = settle_s;
    add(m);
    inside_ = true;
  }

 private:
  Vec3 named(const std::string& name) const {
    if (name == "notch") return frame_.notch_mm;
    for (int side = 0; side < 2; ++side)
      if (name == (side == 0 ? "vein_right" : "vein_left") && frame_.has_vein[side]) return frame_.vein_mm[side];
    std::string known = "notch, vein_right, vein_left";
    if (const auto place = find_case_place(scene_.manifest, name, known)) return *place;
    throw Error(ExitCode::bad_input, "", "at", name + ": the case has " + known);
  }
  Vec3 place(const ChestPlace& p) {
    Vec3 at = missed_(named(p.at) + Vec3{p.offset_mm[0], p.offset_mm[1], p.offset_mm[2]});
    if (!p.on_skin) return at;
    const contact::Contact skin = scene_.contact.intersect(at + forwards * beyond_mm, at);
    if (!skin.hit) throw Error(ExitCode::bad_input, "", "on_skin", "no skin is felt in front of " + p.at);
    return skin.point_mm;
  }
  const ChestFrame& frame_;
  AimMiss missed_;
};

}  // namespace

std::vector<HandMove> plan_chest_moves(const LessonScript& script, const ScriptScene& scene, const ScriptAim& aim) {
  const ChestFrame frame = chest_frame_of(scene.contact.volume(), chest_shapes_of(scene.manifest));
  ChestPlan plan(scene, frame, aim);
  return plan_steps(script, plan);
}

}  // namespace trephine::lessons
