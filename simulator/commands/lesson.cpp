// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <optional>

#include "base/error.h"
#include "base/progress.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "device/trajectory_device.h"
#include "lesson/approval.h"
#include "lessons/lesson_run.h"
#include "lessons/score_recording.h"

namespace trephine::commands {
namespace {

struct LessonParams {
  std::string module, participant = "anonymous", task, second_tool;
  double most_s = 1800, rate_hz = 1000;
  template <class V>
  static void describe(V& v) {
    using P = LessonParams;
    v.word(&P::module, "module", lessons::lesson_names(), "Which lesson; by default the script's.");
    v.text(&P::participant, "participant", "Anonymous token of who does it: a-z, 0-9, _ and -; never a name.");
    v.text(&P::task, "task",
           "What is asked for, as `right` or `pedicle_2_left`; by default the script's, else the usual.");
    v.text(&P::second_tool, "second_tool",
           "What the other hand holds, as `suction`; by default the first that the lesson has for it.");
    v.number(&P::most_s, "most_s", Range{0.001, 86400}, "The longest that the lesson may take; then it is cut off.");
    v.number(&P::rate_hz, "rate_hz", Range{50, 20000}, "Ticks in each second.");
  }
};

void write_recording(const std::filesystem::path& file, const haptics::Recording& recording) {
  haptics::RecordingWriter writer(file, recording.header);
  writer.add(recording.frames, recording.second);
  writer.finish(recording.header.outcome);
}

ExitCode run_lesson_command(const cli::ParsedCommand& parsed) {
  const LessonParams& p = parsed.params<LessonParams>();
  lessons::LessonOptions o;
  o.participant = p.participant;
  o.task = p.task;
  o.most_s = p.most_s;
  o.servo.rate_hz = p.rate_hz;
  lesson::validate_token(o.participant, "--participant");
  o.script = lessons::read_lesson_script(parsed.path("script"));
  if (!p.module.empty() && o.script.module != p.module)
    throw Error(ExitCode::usage, parsed.text("script"), "module", o.script.module + ", but --module is " + p.module);
  std::optional<lesson::CompiledRubric> rubric;
  if (parsed.has("rubric")) o.rubric = &rubric.emplace(lessons::read_rubric_file(parsed.path("rubric")));
  o.hand = parsed.params<device::HandParams>();
  o.aim = parsed.params<lessons::ScriptAim>();
  o.contact = parsed.params<contact::ContactParams>();
  o.force = parsed.params<haptics::ForceParams>();
  std::unique_ptr<device::Device> second;
  if (parsed.has("second_trajectory")) {
    second = std::make_unique<device::Trajectory>(device::read_trajectory(parsed.path("second_trajectory")));
    const auto held = lessons::second_tool_of(lessons::lesson_type(o.script.module), p.second_tool);
    o.second = haptics::RecordedSecondHand{"trajectory", !held, o.force, {}, held.value_or(haptics::BeltToolParams())};
    o.second_device = second.get();
  } else if (!p.second_tool.empty()) {
    throw Error(ExitCode::usage, "", "--second-tool", "needs --second-trajectory");
  }
  session::FeltCase felt(parsed.path("case"), "");
  const lessons::LessonResult r =
      with_file(parsed.text("script"), [&] { return lessons::run_lesson(felt, o, cancel_requested()); });
  write_recording(parsed.path("record"), r.recording);

  if (const std::string& task = r.recording.header.task; !task.empty())
    std::cout << "task " << task << ": "
              << lessons::task_of(lessons::lesson_type(o.script.module), felt.loaded.manifest, task).aim << "\n";
  const haptics::ServoStatistics& s = r.statistics;
  std::cout << fmt::format("{} in case {}: {} ticks, {:.1f} s, done in {:.1f} s\n", o.script.module,
                           r.recording.header.case_token, s.ticks, double(s.ticks) / p.rate_hz, r.wall_s);
  std::cout << fmt::format("force at most {:.2f} N, {:.4f} N from tick to tick\n", s.most_force_n, s.most_force_step_n);
  if (r.recording.header.outcome)
    for (const auto& [name, mm3] : r.recording.header.outcome->removed_mm3)
      std::cout << fmt::format("removed {} {:.1f} mm3\n", name, mm3);
  if (s.faults != 0)
    std::cout << "faults: " << haptics::fault_names(s.faults) << "; what was done until then is recorded\n";
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand lesson_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "lesson";
  c.summary = "does a lesson in a case by a script, through the haptic loop, and records it";
  c.description =
      "A simulated hand does what a script says (docs/how-to/lesson-by-script.md), such as to mark the skin, cut it, "
      "drill and pass a "
      "catheter, with all forces and all tissue of the case, as fast as it goes. Every tick is recorded, with the tool "
      "in hand, the pedal and the commands, so `trephine-sim replay` runs it again bit for bit, and `trephine-sim "
      "score` judges it.";
  cli::Argument folder = cli::argument("case", Kind::in_folder, "Folder of the case.");
  folder.positional = folder.required = true;
  cli::Argument script = cli::argument("script", Kind::in_file, "What the hand does (.json).");
  cli::Argument record = cli::argument("record", Kind::out_file, "Write the recording to this file.");
  script.required = record.required = true;
  c.arguments = {
      folder, script, record,
      cli::argument("rubric", Kind::in_file,
                    "The compiled rubric (.json) by which it will be judged: the recording names it, and the "
                    "script can answer its questions."),
      cli::argument("second_trajectory", Kind::in_file,
                    "How the other hand moves, in lessons that have a use for it: lines as of `servo --device "
                    "trajectory`, of which bit 1 of the buttons is its switch.")};
  c.groups = {cli::ParameterGroup::of<LessonParams>("Parameters"),
              cli::ParameterGroup::of<lessons::ScriptAim>("How well it aims"),
              cli::ParameterGroup::of<device::HandParams>("Simulated hand"),
              cli::ParameterGroup::of<contact::ContactParams>("Contact"),
              cli::ParameterGroup::of<haptics::ForceParams>("Force")};
  c.examples = {
      "trephine-sim lesson library/sample --script examples/lessons/ventriculostomy.json --record one.lesson"};
  c.run = run_lesson_command;
  return c;
});

}  // namespace trephine::commands
