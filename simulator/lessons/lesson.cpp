// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/lesson.h"

#include <algorithm>
#include <cmath>

#include "base/vec3.h"

namespace trephine::lessons {

const char* name_of(LessonEnd end) {
  return end == LessonEnd::finished ? "finished" : end == LessonEnd::device_lost ? "device lost" : "not finished";
}

void Lesson::look_at_speed(const haptics::ServoFrame& f, const haptics::ToolBelt& belt) {
  const Vec3 tip{f.tip_mm[0], f.tip_mm[1], f.tip_mm[2]};
  // While a device is silent its hand goes on: what it does meanwhile is not done in the moment after it.
  const bool away =
      belt.paused() || (f.buttons & haptics::haptic_button::lifted) || (f.faults & haptics::haptic_fault::gap);
  if (away || belt.in_hand() != in_hand_) moments_.clear();
  in_hand_ = belt.in_hand();
  if (away) return;
  moments_.push_back({f.time_s, tip});
  while (moments_.size() > 2 && moments_[1].time_s <= f.time_s - insertion_window_s + 1e-9) moments_.pop_front();
  const double since_s = f.time_s - moments_.front().time_s;
  if (f.inside == 0 || since_s < insertion_window_s - 1e-9) return;
  const double forward = -dot(tip - moments_.front().tip_mm, Vec3{f.axis[0], f.axis[1], f.axis[2]}) / since_s;
  LessonFacts& facts = noted();
  if (forward <= facts.fastest_mm_per_s) return;
  facts.fastest_mm_per_s = forward;
  facts.fastest_s = f.time_s;
}

void Lesson::look_for_cut(const haptics::ServoFrame& f, const haptics::ToolBelt& belt, int command) {
  LessonFacts& facts = noted();
  if (facts.first_cut_s >= 0 || belt.paused()) return;
  bool cut = f.inside != 0 || (command == haptics::belt_command::incise && belt.has_mark());
  if (f.buttons & haptics::belt_button::pedal)
    for (int shape = 1; shape <= voxel::haptic_max_shapes; ++shape) cut = cut || belt.removed_units(shape) > 0;
  if (cut) facts.first_cut_s = f.time_s;
}

bool Lesson::taken_away(const haptics::ServoFrame& f, const haptics::ToolBelt& belt, Vec3 last_mm) {
  const Vec3 tip{f.proxy_mm[0], f.proxy_mm[1], f.proxy_mm[2]};
  return f.buttons & haptics::haptic_button::lifted || (belt.paused() && norm(tip - last_mm) > withdrawn_mm);
}

double LessonFacts::procedure_s() const { return std::round(1e6 * (end_s - begin_s - paused_s)) / 1e6; }

void Lesson::set_second(const haptics::RecordedSecondHand& held, std::uint64_t spared) {
  second_.emplace(held, spared);
  noted().second.emplace();
}

void Lesson::watch(const haptics::ServoFrame& f, const haptics::ToolBelt& belt, const haptics::ServoFrame* second,
                   const haptics::ToolBelt* second_belt) {
  LessonFacts& facts = noted();
  if (facts.end != LessonEnd::running) return;
  if (!begun_) {
    begun_ = true;
    facts.begin_s = f.time_s - f.dt_s;
    begin(f, belt);
  }
  facts.end_s = f.time_s;
  const int now = haptics::belt_button::command(f.buttons);
  const bool fresh = now != haptics::belt_button::command(buttons_);
  buttons_ = f.buttons;
  facts.most_force_n = std::max(facts.most_force_n, norm(Vec3{f.force_n[0], f.force_n[1], f.force_n[2]}));
  if (f.faults & ~haptics::haptic_fault::passing) {
    facts.end = LessonEnd::device_lost;
    return close();
  }
  if (const haptics::Drilling* drill = belt.drilling(); drill && drill->outcome().energy_j > 0) {
    facts.max_bone_c = drill->outcome().max_bone_c;
    facts.heat_dose_min = drill->outcome().heat_dose_min;
  }
  if (belt.paused()) {
    facts.pauses += !was_paused_;
    facts.paused_s += f.dt_s;
  }
  was_paused_ = belt.paused();
  look_at_speed(f, belt);
  look_for_cut(f, belt, fresh ? now : haptics::belt_command::none);
  const bool pedal = !belt.paused() && (f.buttons & haptics::belt_button::pedal);
  bool other = false;
  if (second_ && second) {
    other = !belt.paused() && second_->takes_xrays(*second);
    second_->look(*second, belt.paused(), second_belt && second_belt->idle(), *facts.second);
    const bool works = !belt.idle() && f.faults == 0 && !(f.buttons & haptics::haptic_button::lifted);
    if (pedal && works && haptics::tool_kind(belt.tools()[std::size_t(belt.in_hand())].tool).takes_up)
      SecondHandWatch::suck(f.time_s, f.dt_s, {f.proxy_mm[0], f.proxy_mm[1], f.proxy_mm[2]}, *facts.second);
  }
  tick(f, belt, pedal || other);
  if (!fresh) return;
  if (haptics::belt_command::is_answer(now)) {
    const GivenAnswer given{haptics::belt_command::question_of(now), haptics::belt_command::choice_of(now), f.time_s};
    if (std::none_of(facts.answers.begin(), facts.answers.end(),
                     [&](const GivenAnswer& a) { return a.question == given.question; }))
      facts.answers.push_back(given);
    return;
  }
  if (now != haptics::belt_command::finish) {
    facts.undone += now == haptics::belt_command::undo || now == haptics::belt_command::reset;
    if (!belt.paused()) command(now, f, belt);
    return;
  }
  facts.end = LessonEnd::finished;
  close();
}

}  // namespace trephine::lessons
