// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/second_hand.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "base/joined.h"
#include "haptics/suction.h"
#include "lessons/consequences.h"
#include "lessons/lesson_type.h"

namespace trephine::lessons {
namespace {

constexpr double same_place_mm = 2;

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

bool is_blood(lesson::Fluid fluid) {
  return fluid == lesson::Fluid::venous_blood || fluid == lesson::Fluid::arterial_blood;
}

std::string name_of_shape(const cases::CaseHaptic& haptic, int number) {
  for (const cases::CaseShape& s : haptic.shapes)
    if (s.number == number) return s.name;
  return "";
}

}  // namespace

SecondHandWatch::SecondHandWatch(const haptics::RecordedSecondHand& held, std::uint64_t spared)
    : held_(held), spared_(spared), takes_up_(!held.switch_only && haptics::tool_kind(held.tool.tool).takes_up) {}

bool SecondHandWatch::takes_xrays(const haptics::ServoFrame& f) const {
  return held_.switch_only && f.faults == 0 && (f.buttons & haptics::belt_button::pedal);
}

void SecondHandWatch::look(const haptics::ServoFrame& f, bool paused, bool idle, SecondHandFacts& facts) {
  if (paused) return;
  if (!held_.switch_only) facts.tool = held_.tool.name;
  facts.most_may_n = held_.force.max_force_n;
  if ((f.faults & ~haptics::haptic_fault::passing) != 0 && facts.lost_s < 0) facts.lost_s = f.time_s;
  if (f.faults != 0) return;
  const bool down = f.buttons & haptics::belt_button::pedal;
  facts.switch_s += down ? f.dt_s : 0;
  if (held_.switch_only || idle || (f.buttons & haptics::haptic_button::lifted)) return;
  const auto spared = [&](int shape) { return shape > 0 && shape < 64 && (spared_ >> shape & 1); };
  if (const double force = norm(vec(f.force_n)); spared(f.touched) && force > facts.most_force_n) {
    facts.most_force_n = force;
    facts.most_force_s = f.time_s;
    facts.pressed = f.touched;
  }
  if (spared(f.inside) && facts.entered_s < 0) {
    facts.entered_s = f.time_s;
    facts.entered = f.inside;
  }
  if (down && takes_up_) suck(f.time_s, f.dt_s, vec(f.proxy_mm), facts);
}

void SecondHandWatch::suck(double time_s, double dt_s, Vec3 tip_mm, SecondHandFacts& facts) {
  // Two hands may suck at once, in two places.
  for (auto s = facts.suctions.rbegin(); s != facts.suctions.rend() && s - facts.suctions.rbegin() < 2; ++s)
    if (s->end_s < time_s && time_s - dt_s <= s->end_s + 0.5 * dt_s && norm(s->tip_mm - tip_mm) < same_place_mm) {
      s->end_s = time_s;
      return;
    }
  facts.suctions.push_back({time_s - dt_s, time_s, tip_mm});
}

std::uint64_t spared_shapes(const SecondUse& use, const cases::CaseHaptic& haptic) {
  std::uint64_t all = 0;
  for (const cases::CaseShape& s : haptic.shapes)
    if (std::count(use.spares.begin(), use.spares.end(), s.name) > 0) all |= std::uint64_t{1} << s.number;
  return all;
}

std::optional<haptics::BeltToolParams> second_tool_of(const LessonType& type, const std::string& asked) {
  const std::vector<std::string>& kinds = type.second.tools;
  const auto refuse = [&](const std::string& flag, const std::string& why) {
    throw Error(ExitCode::usage, "", flag, "the lesson " + type.name + " " + why);
  };
  if (kinds.empty()) {
    if (!type.second_takes_xrays) refuse("--second-device", "has no use for a second hand");
    if (!asked.empty())
      refuse("--second-tool",
             "has no use for " + asked + " in the other hand: the second device's switch takes X-rays; leave it out");
    return std::nullopt;
  }
  const std::string kind = asked.empty() ? kinds.front() : asked;
  for (const haptics::BeltToolParams& t : type.tools())
    if (t.tool == kind && std::count(kinds.begin(), kinds.end(), kind) > 0) return t;
  refuse("--second-tool", "has no use for " + kind + " in the other hand, but for " + joined(kinds, " or "));
  return std::nullopt;
}

BloodLeft blood_left(const LessonScore& score, const LessonFacts& facts) {
  BloodLeft out;
  if (!facts.second) return out;
  for (const Flow& flow : flows_of(score)) {
    if (!is_blood(flow.fluid) || !flow.seen.wound || !(flow.begin_s < facts.end_s)) continue;
    out.bled = true;
    // Piece by piece between the moments at which something changes.
    std::vector<double> moments = {flow.begin_s, std::min(flow.end_s, facts.end_s), facts.end_s};
    std::vector<const SuctionSpell*> near;
    for (const SuctionSpell& s : facts.second->suctions) {
      const double off_mm =
          std::min(norm(s.tip_mm - flow.seen.wound->mouth_mm), norm(s.tip_mm - flow.seen.wound->source_mm));
      if (off_mm >= haptics::takes_within_mm || s.end_s <= flow.begin_s) continue;
      near.push_back(&s);
      moments.push_back(std::max(s.begin_s, flow.begin_s));
      moments.push_back(std::min(s.end_s, facts.end_s));
    }
    std::sort(moments.begin(), moments.end());
    double ml = 0;
    for (std::size_t n = 1; n < moments.size(); ++n) {
      const double span_s = moments[n] - moments[n - 1], middle_s = 0.5 * (moments[n] + moments[n - 1]);
      const bool sucks = std::any_of(near.begin(), near.end(), [&](const SuctionSpell* s) {
        return s->begin_s <= middle_s && middle_s < s->end_s;
      });
      if (!(span_s > 0)) continue;
      ml += (flow.runs(middle_s) ? flow.ml_per_min / 60 : 0) * span_s;
      if (!sucks) continue;
      ml = std::max(0.0, ml - haptics::taken_ml_per_s * span_s);
      out.suction_s += span_s;
    }
    out.left_ml += ml;
  }
  return out;
}

void judge_second_hand(LessonScore& score, const LessonFacts& facts, const lesson::LessonRubric& rubric,
                       const cases::CaseHaptic& haptic) {
  if (!facts.second || facts.second->tool.empty() || !rubric.second_hand) return;
  const SecondHandFacts& f = *facts.second;
  const lesson::SecondHandRubric& limits = *rubric.second_hand;
  ScoreRow row;
  row.name = "second_hand";
  row.title = "The other hand";
  row.beside = true;
  row.decided_s = f.most_force_n > 0 ? f.most_force_s : facts.end_s;
  row.score = limits.force_n.score(f.most_force_n);
  row.why = f.most_force_n > 0
                ? texts::Phrase("it pressed on {} with up to {} N",
                                {name_of_shape(haptic, f.pressed), fmt::format("{:.2f}", f.most_force_n)})
                : texts::Phrase("it spared what it must spare");
  row.measured = {{"second_force_n", f.most_force_n}};
  const auto add = [&](const char* of, const lesson::FourLimits& four) {
    row.limits.insert(row.limits.end(), {{std::string("five_") + of, four.five},
                                         {std::string("four_") + of, four.four},
                                         {std::string("three_") + of, four.three},
                                         {std::string("two_") + of, four.two}});
  };
  add("n", limits.force_n);
  if (const BloodLeft blood = blood_left(score, facts); blood.bled) {
    row.measured.insert(row.measured.end(), {{"blood_left_ml", blood.left_ml}, {"suction_s", blood.suction_s}});
    add("ml", limits.blood_left_ml);
    lower(row, limits.blood_left_ml.score(blood.left_ml), "blood was left where it bled", facts.end_s);
  }
  if (f.entered_s >= 0) lower(row, 1, {"its tip was in {}", {name_of_shape(haptic, f.entered)}}, f.entered_s);
  // What its forces could not show speaks for nobody. What it did wrong counts.
  const bool is_bounded = f.most_may_n < limits.force_n.two.limit;
  if ((f.lost_s >= 0 || is_bounded) && row.score.value_or(1) > 1) {
    row.score = {};
    row.why = f.lost_s >= 0
                  ? texts::Phrase("its device was lost after {} s", {fmt::format("{:.1f}", f.lost_s)})
                  : texts::Phrase("its device gives at most {} N, which is too little to show how hard it pressed",
                                  {fmt::format("{:.2f}", f.most_may_n)});
  }
  score.rows.push_back(std::move(row));
}

}  // namespace trephine::lessons
