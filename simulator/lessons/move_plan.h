// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "lessons/scripted_hand.h"

namespace trephine::lessons {

/// How a hand errs: each place is missed by a normal distance along each axis.
class AimMiss {
 public:
  explicit AimMiss(const ScriptAim& aim);
  Vec3 operator()(Vec3 place_mm);

 private:
  ScriptAim aim_;
  std::uint64_t random_;
};

/// The case's target, burr hole or landmark of that name; nothing, and all names in `known`, where it has none.
std::optional<Vec3> find_case_place(const cases::CaseManifest& manifest, const std::string& name, std::string& known);

/// The movements of a script, step by step, of which every lesson has some: take, withdraw, wait, commands, and the
/// loss of the device. A module's planner derives from it.
class MovePlan {
 public:
  virtual ~MovePlan() = default;
  /// Adds what the step asks for. Throws Error 65.
  virtual void step(const std::string& name, const AnyParams& params);
  std::vector<HandMove> moves() && { return std::move(moves_); }

 protected:
  /// The hand begins there, with the first tool.
  MovePlan(const ScriptScene& scene, Vec3 at_mm, Vec3 axis);
  HandMove move() const;  ///< that stays, with tool and axis as they are
  void add(HandMove m);
  void go_straight(Vec3 to, double speed_mm_per_s);
  void withdraw(const WithdrawStep& s);

  const ScriptScene& scene_;
  std::vector<HandMove> moves_;
  Vec3 at_, axis_;
  int tool_ = 0;
  bool inside_ = false;  ///< the tool is in the patient, and is drawn back before it goes elsewhere

 private:
  void take(const TakeStep& s);
  void answer(const AnswerStep& s);
};

/// Lets the plan do the steps of the script. Throws Error 65, naming the step.
std::vector<HandMove> plan_steps(const LessonScript& script, MovePlan& plan);

}  // namespace trephine::lessons
