// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/move_plan.h"

#include <algorithm>

#include "base/error.h"
#include "base/joined.h"
#include "base/splitmix64.h"
#include "base/text.h"

namespace trephine::lessons {
namespace {

constexpr double air_speed = 250;  // mm/s

}  // namespace

AimMiss::AimMiss(const ScriptAim& aim)
    : aim_(aim), random_(splitmix64_mixed(std::uint64_t(aim.seed) + splitmix64_step)) {}

// A miss by the sum of twelve uniform numbers, which is normal enough.
Vec3 AimMiss::operator()(Vec3 p) {
  if (!(aim_.aim_noise_mm > 0)) return p;
  for (int a = 0; a < 3; ++a) {
    double sum = -6;
    for (int n = 0; n < 12; ++n) sum += unit_of_bits(splitmix64_mixed(random_ += splitmix64_step));
    p[a] += aim_.aim_noise_mm * sum;
  }
  return p;
}

std::optional<Vec3> find_case_place(const cases::CaseManifest& manifest, const std::string& name, std::string& known) {
  for (const cases::CaseTarget& t : manifest.targets)
    if (t.name == name) return t.position_mm;
  for (const cases::CaseBurrHole& b : manifest.burr_holes)
    if (b.name == name) return b.position_mm;
  for (const cases::CaseLandmark& l : manifest.landmarks) {
    if (l.name == name) return l.position_mm;
    known += (known.empty() ? "" : ", ") + l.name;
  }
  return {};
}

MovePlan::MovePlan(const ScriptScene& scene, Vec3 at_mm, Vec3 axis) : scene_(scene), at_(at_mm), axis_(axis) {
  HandMove begin = move();
  begin.path_mm = {at_};
  moves_.push_back(begin);
}

HandMove MovePlan::move() const {
  HandMove m;
  m.axis = axis_;
  m.tool = tool_;
  m.speed_mm_per_s = air_speed;
  return m;
}

void MovePlan::add(HandMove m) {
  if (!m.path_mm.empty()) at_ = m.path_mm.back();
  moves_.push_back(std::move(m));
}

void MovePlan::go_straight(Vec3 to, double speed_mm_per_s) {
  HandMove m = move();
  m.path_mm = {to};
  m.speed_mm_per_s = speed_mm_per_s;
  add(m);
}

void MovePlan::withdraw(const WithdrawStep& s) {
  inside_ = false;
  go_straight(at_ + axis_ * s.by_mm, s.speed_mm_per_s);
}

void MovePlan::take(const TakeStep& s) {
  for (std::size_t n = 0; n < scene_.tools.size(); ++n) {
    if (scene_.tools[n].name != s.tool) continue;
    tool_ = int(n);
    HandMove m = move();
    m.wait_s = 0.05;
    return add(m);
  }
  throw Error(ExitCode::bad_input, "", "tool",
              s.tool + ": the lesson has " + joined(scene_.tools, ", ", &haptics::BeltToolParams::name));
}

void MovePlan::answer(const AnswerStep& s) {
  const auto named = [](const std::vector<std::string>& names) {
    const std::string all = joined(names);
    return all.empty() ? std::string("none") : all;
  };
  std::vector<std::string> known;
  for (std::size_t n = 0; n < scene_.questions.size(); ++n) {
    const OfferedQuestion& q = scene_.questions[n];
    known.push_back(q.question);
    if (q.question != s.question) continue;
    const auto at = std::find(q.choices.begin(), q.choices.end(), s.choice.empty() ? q.right : s.choice);
    if (at == q.choices.end())
      throw Error(ExitCode::bad_input, "", "choice", printable(s.choice) + ": the question offers " + named(q.choices));
    HandMove m = move();
    m.command = haptics::belt_command::answer(int(n), int(at - q.choices.begin()));
    m.wait_s = 0.1;
    return add(m);
  }
  throw Error(ExitCode::bad_input, "", "question", printable(s.question) + ": the rubric has " + named(known));
}

void MovePlan::step(const std::string& name, const AnyParams& params) {
  if (name == "take") return take(params.as<TakeStep>());
  if (name == "withdraw") return withdraw(params.as<WithdrawStep>());
  if (name == "answer") return answer(params.as<AnswerStep>());
  HandMove m = move();
  m.wait_s = 0.1;
  if (name == "wait") {
    m.wait_s = params.as<WaitStep>().seconds;
    return add(m);
  }
  if (name == "lose_device") {
    m.lost = true;
    return add(m);
  }
  for (m.command = 1; m.command < haptics::belt_command::count; ++m.command)
    if (name == haptics::belt_command::names[m.command]) return add(m);
  throw Error(ExitCode::internal, "", name, "is a step that nobody plans");
}

std::vector<HandMove> plan_steps(const LessonScript& script, MovePlan& plan) {
  for (std::size_t n = 0; n < script.steps.size(); ++n) {
    const std::string& name = script.steps[n].first;
    with_field("steps[" + std::to_string(n) + "]." + name, [&] {
      try {
        plan.step(name, script.steps[n].second);
      } catch (const Error& e) {  // what the path says of a place is the script's fault
        if (e.code() == ExitCode::internal) throw;
        throw Error(ExitCode::bad_input, "", e.field(), e.what());
      }
    });
  }
  return std::move(plan).moves();
}

}  // namespace trephine::lessons
