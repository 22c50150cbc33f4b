// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/lesson_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/progress.h"
#include "base/refusal.h"
#include "lesson/approval.h"
#include "lessons/decisions.h"
#include "lessons/hand_limits.h"
#include "session/second_hand.h"

namespace trephine::lessons {
namespace {

constexpr std::uint64_t ticks_at_once = 4096;
constexpr double max_rate_hz = 20000;  // of `servo`, `lesson` and `play`

haptics::RecordingHeader header_of(const session::FeltCase& felt, const LessonOptions& o) {
  haptics::RecordingHeader h = felt.header();
  h.device = "script";
  h.rate_hz = o.servo.rate_hz;
  h.contact = o.contact;
  h.force = o.force;
  h.shaft = o.shaft;
  h.drilling = o.drilling;
  h.law = o.law;
  h.second = o.second;
  h.knows_across = o.second_device && o.second_device->knows_across();
  session::set_lesson(h, lesson_type(o.script.module).tools(), o.script.module, o.participant,
                      felt.loaded.manifest.haptic);
  h.task =
      task_or_usual(lesson_type(o.script.module), felt.loaded.manifest, o.task.empty() ? o.script.task : o.task).name;
  if (o.script.answers() && !o.rubric)
    throw Error(ExitCode::usage, "", "--rubric", "is needed where the script answers questions: it has them");
  if (o.rubric) {
    if (o.rubric->module != o.script.module)
      throw Error(ExitCode::usage, "", "--rubric",
                  "is of " + o.rubric->module + ", and the lesson is " + o.script.module);
    h.rubric_sha256 = o.rubric->sha256;
  }
  return h;
}

/// A frame is followed, not felt anew, so what it says must be possible.
void require_followable(const haptics::ServoFrame& f, const std::string& file) {
  const auto finite = [](const double* p) { return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]); };
  const auto is_shape = [](std::int32_t n) { return n >= 0 && n <= voxel::haptic_max_shapes; };
  const auto is_touched = [](std::int32_t n) { return n >= 0 && n <= touch::max_shape; };
  if (!finite(f.tip_mm) || !finite(f.axis) || !finite(f.proxy_mm) || !finite(f.force_n) || !std::isfinite(f.time_s) ||
      !(f.dt_s > 0 && f.dt_s < 1e6) || !is_touched(f.touched) || !is_shape(f.inside))
    throw Error(ExitCode::bad_input, file, "frames", "tick " + std::to_string(f.tick) + " holds what no session makes");
}

const Remedy not_as_recorded{
    "do the `lesson` anew, or judge it as it stands with --trust-recording, which its report then says"};

[[noreturn]] void differs(const std::string& file, const char* field, const std::string& what) {
  throw refusal(field, what, not_as_recorded).in_file(file);
}

/// The servo makes a step of whole periods, and a time of steps: both to the bit.
void require_times(const haptics::Recording& r, const std::string& file) {
  const double rate = r.header.rate_hz;
  if (!(rate <= max_rate_hz))
    differs(file, "rate_hz", fmt::format("{:g}, a session has at most {:g}", rate, max_rate_hz));
  double time_s = 0;
  for (const haptics::ServoFrame& f : r.frames) {
    time_s += f.dt_s;
    const double periods = std::round(f.dt_s * rate);
    if (f.time_s != time_s || !(periods >= 1) || f.dt_s != periods / rate)
      differs(file, "frames", fmt::format("the time of tick {} is not the sum of its steps", f.tick));
  }
}

bool same_outcome(const haptics::RecordedCutting& a, const haptics::RecordedCutting& b) {
  return a.removed_mm3 == b.removed_mm3 && a.breached == b.breached && a.breach_time_s == b.breach_time_s &&
         a.breach_mm == b.breach_mm;
}

}  // namespace

LessonResult run_lesson(session::FeltCase& felt, const LessonOptions& o, const std::atomic<bool>& stop) {
  lesson::validate_token(o.participant, "--participant");
  const cases::CaseManifest& manifest = felt.loaded.manifest;
  const LessonType& module = lesson_type(o.script.module);
  module.require(manifest);  // refused here rather than by the scorer
  LessonResult result;
  haptics::RecordingHeader& header = result.recording.header;
  header = header_of(felt, o);
  std::vector<OfferedQuestion> questions;
  if (o.script.answers()) questions = questions_for(*o.rubric->common, module, manifest, header.task, o.participant);
  header.asked = as_asked(questions);
  contact::ContactVolume contact(felt.loaded.haptic, o.contact);
  const std::unique_ptr<haptics::Drilling> drilling = felt.drilling_of(header, contact);
  haptics::ToolBelt belt({contact, felt.beside(o.shaft)}, felt.feels, o.force, o.shaft, header.tools, drilling.get());
  ScriptedHand hand(o.hand, module.plan(o.script,
                                        {manifest, contact, header.tools, haptics::drilled_shapes(manifest.haptic),
                                         std::move(questions)},
                                        o.aim));
  haptics::FrameQueue queue(2 * ticks_at_once);
  haptics::ServoParams params = o.servo;
  params.paced = params.realtime = false;
  haptics::Servo servo(belt, hand, params, &queue);
  std::unique_ptr<session::SecondHand> second;
  if (header.second) {
    second = std::make_unique<session::SecondHand>(touch::FeltSpace(contact, felt.beside({})), felt.feels, header,
                                                   drilling.get(), o.second_device);
    servo.set_other(second.get());
  }
  const auto begin = std::chrono::steady_clock::now();
  const auto most = std::uint64_t(std::max(1.0, std::round(o.most_s * o.servo.rate_hz)));
  while (!hand.done() && servo.statistics().ticks < most) {
    Progress({}, &stop).check();
    servo.run(std::min(ticks_at_once, most - servo.statistics().ticks), hand.done());
    session::drain(queue, second != nullptr, result.recording.frames, result.recording.second);
  }
  if (drilling) header.outcome = haptics::outcome_of(felt.loaded.haptic, drilling->outcome());
  result.statistics = servo.statistics();
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

std::shared_ptr<const LessonFacts> facts_of_recording(session::FeltCase& felt, const std::string& file,
                                                      const haptics::Recording& recording, Answers answers) {
  const haptics::RecordingHeader& h = recording.header;
  if (h.lesson.empty()) throw Error(ExitCode::bad_input, file, "lesson", "is missing: this is no lesson's recording");
  const LessonType& module = *with_file(file, [&] { return &lesson_type(h.lesson); });
  if (const std::uint64_t missing = haptics::missing_frames(recording.frames); missing > 0 || recording.frames.empty())
    throw Error(ExitCode::bad_input, file, "frames",
                recording.frames.empty() ? "there are none"
                                         : std::to_string(missing) + " were not recorded: it cannot be judged");
  if (h.tools.empty()) throw Error(ExitCode::bad_input, file, "lesson.tools", "there are none");
  if (!h.task.empty()) with_file(file, [&] { task_of(module, felt.loaded.manifest, h.task); });
  for (const haptics::ServoFrame& f : recording.frames) require_followable(f, file);
  const bool replayed = answers == Answers::replayed;
  if (replayed) require_times(recording, file);
  const voxel::HapticVolume before = voxel::copy_without_hardness(felt.loaded.haptic);
  contact::ContactVolume contact(felt.loaded.haptic, h.contact);
  session::Rerun rerun(felt, contact, file, h);
  haptics::ToolBelt& belt = *rerun.belt();
  const std::unique_ptr<Lesson> lesson = module.begin(felt.loaded.manifest, before, felt.loaded.haptic);
  lesson->set_task(h.task);
  if (h.second) lesson->set_second(*h.second, spared_shapes(module.second, felt.loaded.manifest.haptic));
  for (const haptics::ServoFrame& f : recording.second) require_followable(f, file);
  HandLimits limits(contact), second_limits(contact, "second hand: ");
  std::vector<haptics::ServoFrame> answered;
  for (std::size_t n = 0; n < recording.frames.size(); ++n) {
    const haptics::ServoFrame& f = recording.frames[n];
    const haptics::ServoFrame* second = h.second ? &recording.second[n] : nullptr;
    if (replayed) {
      answered.clear();
      const haptics::ServoFrame again = rerun.run({f}, second, answered).front();
      if (!haptics::same_frame(again, f) || (second && !haptics::same_frame(answered.front(), *second)))
        differs(file, "frames",
                fmt::format("does not replay bit for bit, tick {} of {} is the first that differs", f.tick,
                            recording.frames.size()));
    } else {
      rerun.follow(f, second);
    }
    with_file(file, [&] {
      limits.look(f, belt);
      if (rerun.second_belt()) second_limits.look(*second, *rerun.second_belt());
    });
    lesson->watch(f, belt, second, rerun.second_belt());
  }
  lesson->close();
  if (h.outcome && rerun.drilling() && haptics::volume_digest(felt.loaded.haptic) != h.outcome->volume_sha256)
    throw refusal("volume_sha256", "the volume differs when the session is followed",
                  {"follow it with the version of the program that recorded it, or do the `lesson` anew"})
        .in_file(file);
  if (replayed && rerun.drilling() && h.outcome &&
      !same_outcome(haptics::outcome_of(felt.loaded.haptic, rerun.drilling()->outcome()), *h.outcome))
    differs(file, "outcome", "is another when the session is replayed");
  return lesson->copy_of_facts();
}

}  // namespace trephine::lessons
