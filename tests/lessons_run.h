// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Lessons done through the servo and scored, whatever the phantom and the module.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "case_samples.h"
#include "lessons/lesson_run.h"
#include "lessons/score_report.h"
#include "scratch_folder.h"

namespace lesson_cases {

using namespace trephine;

/// A lesson that was done: what was recorded, noted and scored.
template <class Facts>
struct Scored {
  haptics::Recording recording;
  Facts facts;
  lessons::LessonScore score;
  const lessons::ScoreRow& row(const std::string& name) const {
    for (const lessons::ScoreRow& r : score.rows)
      if (r.name == name) return r;
    throw std::runtime_error(name);
  }
  int points(const std::string& name) const { return row(name).score.value_or(0); }  // 0: not judged
  double measured(const std::string& row_name, const std::string& figure) const {
    for (const auto& [name, value] : row(row_name).measured)
      if (name == figure) return value;
    return std::nan("");
  }
  Vec3 last_tip() const {
    const haptics::ServoFrame& f = recording.frames.back();
    return {f.proxy_mm[0], f.proxy_mm[1], f.proxy_mm[2]};
  }
};

/// How the steps are done.
struct Doing {
  double rate_hz = 500;
  double noise_mm = 0;
  std::int64_t seed = 1;
  std::string task;  ///< what is asked for; empty: the usual
};

/// The case on disk, loaded once; each lesson begins with the volume as it was.
class LessonCase {
 public:
  explicit LessonCase(const case_samples::MemoryCase& c) {
    c.write(folder_.path());
    felt_ = std::make_unique<session::FeltCase>(folder_.path(), "");
    whole_ = felt_->loaded.haptic;
  }
  session::FeltCase& felt() { return *felt_; }
  const voxel::HapticVolume& whole() const { return whole_; }
  const std::filesystem::path& path() const { return folder_.path(); }
  /// What the lesson's module notes where the device is silent for 60 ticks from `at_s` on: the tool rests meanwhile
  /// where it was.
  template <class Facts>
  Facts facts_with_silence(haptics::Recording recording, double at_s) {
    const auto first = std::find_if(recording.frames.begin(), recording.frames.end(),
                                    [&](const haptics::ServoFrame& f) { return f.time_s >= at_s; });
    for (auto f = first; f < first + 60; ++f) {
      haptics::ServoFrame rests = first[-1];
      rests.tick = f->tick, rests.time_s = f->time_s, rests.dt_s = f->dt_s;
      rests.faults = haptics::haptic_fault::gap;
      rests.buttons &= haptics::belt_button::tool_mask << haptics::belt_button::tool_shift;
      *f = rests;
    }
    return facts_of<Facts>(recording);
  }

 protected:
  /// Does the steps through the servo.
  haptics::Recording record(const std::string& module, const std::string& steps, const Doing& doing) {
    felt_->loaded.haptic = whole_;
    lessons::LessonOptions o;
    o.script = lessons::parse_lesson_script("{\"module\": \"" + module + "\", \"steps\": [" + steps + "]}");
    o.servo.rate_hz = doing.rate_hz;
    o.task = doing.task;
    o.aim.seed = doing.seed;
    o.aim.aim_noise_mm = doing.noise_mm;
    o.most_s = 9000;
    const std::atomic<bool> stop{false};
    return lessons::run_lesson(*felt_, o, stop).recording;
  }
  /// What the lesson's module notes in a recording.
  template <class Facts>
  Facts facts_of(const haptics::Recording& recording) {
    felt_->loaded.haptic = whole_;
    return dynamic_cast<const Facts&>(*lessons::facts_of_recording(*felt_, "test", recording));
  }

 private:
  ScratchFolder folder_;
  std::unique_ptr<session::FeltCase> felt_;
  voxel::HapticVolume whole_;
};

/// Critical errors of a rubric, with their limits.
inline void lists(std::vector<lesson::CriticalRule>& rules, const std::vector<std::pair<const char*, double>>& errors) {
  for (const auto& [name, limit] : errors) rules.push_back({name, limit, lesson::RubricLimit::From::ours, "test"});
}
/// Whether that critical error happened.
inline bool failed_by(const lessons::LessonScore& score, const std::string& error) {
  for (const lessons::CriticalError& e : score.critical)
    if (e.rule.error == error) return true;
  return false;
}

/// Sets a limit of a rubric, as a test's own reading of a shipped one.
inline void is(lesson::RubricLimit& limit, double value) { limit = {value, lesson::RubricLimit::From::ours, "test"}; }
inline void are(lesson::FourLimits& l, double five, double four, double three, double two) {
  is(l.five, five), is(l.four, four), is(l.three, three), is(l.two, two);
}

}  // namespace lesson_cases
