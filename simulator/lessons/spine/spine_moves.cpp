// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/spine/spine_moves.h"

#include "base/error.h"
#include "lessons/spine/needle_watch.h"

namespace trephine::lessons {
namespace {

constexpr double behind_mm = 160;  // of a pedicle's entry: outside of any back
constexpr double settle_s = 0.4;

Vec3 begin_of(const cases::CaseManifest& manifest) {
  Vec3 middle;
  const std::vector<CasePedicle> all = pedicles_of(manifest);
  for (const CasePedicle& p : all) middle += p.entry_mm / double(all.size());
  return middle + Vec3{0, behind_mm, 0};
}

class SpinePlan : public MovePlan {
 public:
  SpinePlan(const ScriptScene& scene, const ScriptAim& aim)
      : MovePlan(scene, begin_of(scene.manifest), {0, 1, 0}), missed_(aim) {}

  void step(const std::string& name, const AnyParams& params) override {
    if (name == "shoot") return shoot(params.as<ShootStep>());
    if (name == "needle") return needle(params.as<NeedleStep>());
    if (name == "push") return push(params.as<PushStep>());
    if (name == "insert") return insert(params.as<InsertStep>());
    MovePlan::step(name, params);
  }

 private:
  void shoot(const ShootStep& s) {
    HandMove m = move();
    m.pedal = m.on_time = true;
    m.wait_s = s.seconds;
    add(m);
    m.pedal = false;  // so that the next one is another
    m.wait_s = 0.05;
    add(m);
  }

  void needle(const NeedleStep& s) {
    std::string known;
    for (const CasePedicle& p : pedicles_of(scene_.manifest)) {
      known += (known.empty() ? "" : ", ") + p.name;
      if (p.name != s.pedicle) continue;
      const Vec3 up = p.up(), outer = p.outer();
      const Vec3 entry = missed_(p.entry_mm + outer * s.entry_aside_mm + up * s.entry_up_mm);
      const Vec3 target = missed_(p.target_mm + outer * s.target_aside_mm + up * s.target_up_mm);
      return along(entry, target, s.short_of_mm, s.speed_mm_per_s);
    }
    throw Error(ExitCode::bad_input, "", "pedicle", s.pedicle + ": the case has " + known);
  }

  void push(const PushStep& s) {
    go_straight(at_ - axis_ * s.by_mm, s.speed_mm_per_s);
    settle();
  }

  void insert(const InsertStep& s) { along(place(s.from), place(s.toward), s.short_of_mm, s.speed_mm_per_s); }

  Vec3 place(const ScriptPlace& p) {
    if (p.along_mm != 0 || p.right_mm != 0)
      throw Error(ExitCode::bad_input, "", "at", "along_mm and right_mm are of a head; say offset_mm");
    std::string known;
    const std::optional<Vec3> found = find_case_place(scene_.manifest, p.at, known);
    if (!found) throw Error(ExitCode::bad_input, "", "at", p.at + ": the case has no such place, but " + known);
    return missed_(*found + Vec3{p.offset_mm[0], p.offset_mm[1], p.offset_mm[2]});
  }

  // Drawn out, over the back, and then straight in.
  void along(Vec3 entry, Vec3 target, double short_of_mm, double speed_mm_per_s) {
    const Vec3 out = normalized(entry - target);
    if (out == Vec3{}) throw Error(ExitCode::bad_input, "", "toward", "is the place where it enters");
    if (inside_) withdraw(WithdrawStep{behind_mm, 60});
    axis_ = out;
    go_straight(entry + out * behind_mm, 250);
    go_straight(target + out * short_of_mm, speed_mm_per_s);
    settle();
    inside_ = true;
  }

  void settle() {
    HandMove m = move();
    m.wait_s = settle_s;
    add(m);
  }

  AimMiss missed_;
};

}  // namespace

std::vector<HandMove> plan_spine_moves(const LessonScript& script, const ScriptScene& scene, const ScriptAim& aim) {
  SpinePlan plan(scene, aim);
  return plan_steps(script, plan);
}

}  // namespace trephine::lessons
