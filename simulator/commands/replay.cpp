// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.h"
#include "base/refusal.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "commands/session_options.h"
#include "haptics/recording.h"
#include "session/force_changes.h"
#include "session/force_figures.h"
#include "session/moving_target.h"
#include "session/playback.h"
#include "sound/drill_sound.h"

namespace trephine::commands {
namespace {

const Remedy not_this_program{
    "replay it with the version of the program that recorded it (its header says which), or record it anew with "
    "`servo`"};

using Json = nlohmann::ordered_json;

Json json_of(const session::ForceFigures& f) {
  return {{"frames", f.frames},
          {"touching", f.touching},
          {"anomaly_ratio", f.anomaly_ratio},
          {"zero_force_ratio", f.zero_force_ratio},
          {"most_step_n", f.max_step_n},
          {"sigma_n_per_s", f.sigma_n_per_s},
          {"mean_force_n", f.mean_force_n},
          {"most_force_n", f.most_force_n},
          {"mean_lag_mm", f.mean_lag_mm},
          {"most_lag_mm", f.max_lag_mm}};
}

Json json_of(const session::ForceChanges& c) {
  Json above = Json::object();
  for (std::size_t n = 0; n < c.above.size(); ++n)
    above[fmt::format("{:g}", session::ForceChanges::limits_n_per_ms[n])] = c.above[n];
  return {{"ticks", c.ticks},
          {"above_n_per_ms", above},
          {"named", c.named},
          {"most_n_per_ms", c.max_n_per_ms},
          {"turns", c.turns}};
}

void print(const char* what, const session::ForceChanges& c) {
  std::string above;
  for (std::size_t n = 0; n < c.above.size(); ++n)
    above += fmt::format("{} {} above {:g}", n == 0 ? "" : ",", c.above[n], session::ForceChanges::limits_n_per_ms[n]);
  std::cout << fmt::format("changes of the force in N/ms, {}: of {}{}; {} of them in a named event, at most {:.3f}\n",
                           what, c.ticks, above, c.named, c.max_n_per_ms);
}

void print(const char* what, const session::ForceFigures& f) {
  if (f.frames == 0) {
    std::cout << what << ": no contact to judge forces by\n";
    return;
  }
  std::cout << fmt::format(
      "{}: in contact {:.1f} %, anomaly coefficient {:.6f}, zero force {:.6f}, largest step {:.4f} N, sigma {:.3f} "
      "N/s, force {:.3f} N (at most {:.3f}), lag {:.3f} mm (at most {:.3f})\n",
      what, 100.0 * double(f.touching) / double(f.frames), f.anomaly_ratio, f.zero_force_ratio, f.max_step_n,
      f.sigma_n_per_s, f.mean_force_n, f.most_force_n, f.mean_lag_mm, f.max_lag_mm);
}

Json json_of(const session::TargetFigures& f) {
  return {{"seconds", f.seconds},
          {"touching_ratio", f.touching_ratio},
          {"mean_off_mm", f.mean_off_mm},
          {"p95_off_mm", f.p95_off_mm},
          {"most_off_mm", f.most_off_mm},
          {"mean_behind_mm", f.mean_behind_mm},
          {"mean_behind_s", f.mean_behind_s},
          {"p95_behind_mm", f.p95_behind_mm}};
}

constexpr double longest_sound_s = 3600;

// The replayed frames, and what is heard of the drill in each.
std::vector<haptics::ServoFrame> run_heard(session::Rerun& rerun, const haptics::Recording& recording,
                                           std::vector<haptics::ServoFrame>& second,
                                           std::vector<sound::DrillHeard>& heard) {
  std::vector<haptics::ServoFrame> out;
  for (std::size_t n = 0; n < recording.frames.size(); ++n) {
    const haptics::ServoFrame& f = recording.frames[n];
    out.push_back(rerun.run({f}, recording.second.data() + (recording.second.empty() ? 0 : n), second).front());
    const haptics::Drilling::Heard h = rerun.drilling()->heard();
    heard.push_back({f.dt_s, h.runs, h.stalled, h.load_ratio, h.energy_j_per_mm3, h.flutes});
  }
  return out;
}

void require_sound(const cli::ParsedCommand& parsed, const haptics::Recording& r) {
  if (!r.header.drilling.drill)
    throw Error(ExitCode::usage, parsed.text("recording"), "--sound", "no tool of the recording drills");
  if (!r.frames.empty() && r.frames.back().time_s - r.frames.front().time_s > longest_sound_s)
    throw Error(ExitCode::usage, parsed.text("recording"), "--sound",
                fmt::format("the recording is longer than {:g} s", longest_sound_s));
  for (const haptics::ServoFrame& f : r.frames)
    if (!(f.dt_s > 0 && f.dt_s <= longest_sound_s))
      throw Error(ExitCode::bad_input, parsed.text("recording"), "dt_s", fmt::format("of tick {} is no step", f.tick));
}

void write_sound(const cli::ParsedCommand& parsed, const haptics::RecordingHeader& h,
                 const std::vector<sound::DrillHeard>& heard) {
  const sound::SoundParams& params = parsed.params<sound::SoundParams>();
  const std::vector<float> samples = sound::sound_of(heard, {h.drilling.spindle_rpm}, params);
  write_file(parsed.path("sound"), sound::wav_bytes(samples, params.sound_hz));
  std::cout << fmt::format("sound of {:.2f} s at {:g} Hz\n", double(samples.size()) / params.sound_hz, params.sound_hz);
}

ExitCode run_replay(const cli::ParsedCommand& parsed) {
  const haptics::Recording recording = haptics::read_recording(parsed.path("recording"));
  haptics::require_seal(recording, parsed.path("recording"));
  const haptics::RecordingHeader& h = recording.header;
  contact::ContactParams contact_params = h.contact;
  const contact::ContactParams& asked = parsed.params<contact::ContactParams>();
  if (parsed.given.count("walk")) contact_params.walk = asked.walk;
  if (parsed.given.count("surface")) contact_params.surface = asked.surface;
  if (parsed.given.count("step_ratio")) contact_params.step_ratio = asked.step_ratio;
  const bool other = contact_params.walk != h.contact.walk || contact_params.surface != h.contact.surface ||
                     contact_params.step_ratio != h.contact.step_ratio;

  const std::vector<std::string> named = parsed.all("before");
  const std::shared_ptr<session::Patient> patient = session::patient_again(
      parsed.path("case"), parsed.path("recording"), h, contact_params, {named.begin(), named.end()});
  session::FeltCase& felt = patient->felt;
  contact::ContactVolume& contact = patient->contact;
  session::Rerun rerun(felt, contact, parsed.text("recording"), h);
  const haptics::Drilling* drilling = rerun.drilling();
  std::optional<session::TargetFigures> followed;
  if (const auto target = session::target_of(h, *patient)) {
    session::TargetWatch watch(target);
    for (const haptics::ServoFrame& f : recording.frames) watch.look(f);
    followed = watch.figures();
  }
  std::vector<sound::DrillHeard> heard;
  if (parsed.has("sound")) require_sound(parsed, recording);
  std::vector<haptics::ServoFrame> second;  // the other hand's, where there were two
  const std::vector<haptics::ServoFrame> replayed = parsed.has("sound")
                                                        ? run_heard(rerun, recording, second, heard)
                                                        : rerun.run(recording.frames, recording.second.data(), second);
  std::size_t different = 0, first = 0;
  for (std::size_t n = 0; n < replayed.size(); ++n) {
    const bool same = haptics::same_frame(replayed[n], recording.frames[n]) &&
                      (second.empty() || haptics::same_frame(second[n], recording.second[n]));
    if (!same && different++ == 0) first = n;
  }

  std::cout << fmt::format("{} frames at {:g} Hz of device {}, {}, case {}\n", replayed.size(), h.rate_hz, h.device,
                           h.lesson.empty() ? "tool " + h.tool.tool : "tools of the lesson " + h.lesson, h.case_token);
  const std::uint64_t missing = haptics::missing_frames(recording.frames);
  if (missing > 0) std::cout << fmt::format("{} frames are missing: they were not recorded\n", missing);
  if (recording.seal == haptics::Seal::absent) std::cout << "not sealed: made into a pipe or by an older program\n";
  const session::ForceWindow window = session::force_window(recording.frames);
  const session::ForceFigures was = session::force_figures(recording.frames, window),
                              is = session::force_figures(replayed, window);
  print("recorded", was);
  if (h.second) {
    std::cout << fmt::format("second hand: {} on {}\n", h.second->tool.name, h.second->device);
    print("second hand", session::force_figures(second, session::force_window(second)));
  }
  if (other) print("replayed", is);
  const session::ForceChanges all = session::force_changes(recording.frames, false),
                              drilled = session::force_changes(recording.frames, true);
  if (followed)
    std::cout << "target " << (followed->seconds > 0 ? session::target_text(*followed) : "that never set off") << "\n";
  print("all ticks", all);
  if (drilled.ticks > 0) print("while drilling", drilled);
  if (parsed.has("json")) {
    Json j = {{"frames", replayed.size()}, {"missing", missing}, {"different", different}, {"recorded", json_of(was)}};
    j["replayed"] = json_of(is);
    j["force_changes"] = {{"all", json_of(all)}, {"drilling", json_of(drilled)}};
    if (followed) j["target"] = json_of(*followed);
    write_file(parsed.path("json"), j.dump(1) + "\n");
  }
  if (parsed.has("sound")) write_sound(parsed, h, heard);
  if (other) return ExitCode::ok;
  if (different > 0)
    throw refusal("frames",
                  fmt::format("{} of {} differ when replayed, the first is {}", different, replayed.size(), first),
                  not_this_program)
        .in_file(parsed.text("recording"));
  if (h.outcome && drilling) {
    const haptics::RecordedCutting again = haptics::outcome_of(felt.loaded.haptic, drilling->outcome());
    if (again.volume_sha256 != h.outcome->volume_sha256)
      throw refusal("volume_sha256", "the volume differs when replayed", not_this_program)
          .in_file(parsed.text("recording"));
    std::cout << "the drilled volume is the same\n";
  }
  std::cout << "replayed bit for bit\n";
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand replay_command([] {
  cli::Command c;
  c.name = "replay";
  c.summary = "runs a recorded session again, and compares it bit for bit or with another contact method";
  c.description =
      "Runs the recorded poses through the case's haptic volume again, with the recording's own parameters. Exit code "
      "80 says that some bit of the proxy's answers differs. With another walk or surface, the two runs are compared "
      "by figures of their forces instead: the force anomaly coefficient [Rizzi, chapter 4], and figures for what it "
      "leaves out.";
  cli::Argument folder = cli::argument("case", cli::Argument::Kind::in_folder, "Folder of the case.");
  folder.positional = folder.required = true;
  cli::Argument recording =
      cli::argument("recording", cli::Argument::Kind::in_file, "The file that `trephine-sim servo --record` wrote.");
  recording.positional = recording.required = true;
  cli::Argument json = cli::argument("json", cli::Argument::Kind::out_file, "Write the figures to this file.");
  cli::Argument wav =
      cli::argument("sound", cli::Argument::Kind::out_file, "Write what is heard of the drill to this file (.wav).");
  c.arguments = {folder, recording, before_argument(), json, wav};
  c.groups = {cli::ParameterGroup::of<contact::ContactParams>("Contact, where it is to be another than recorded"),
              cli::ParameterGroup::of<sound::SoundParams>("Sound")};
  c.examples = {"trephine-sim replay library/sample skull.servo",
                "trephine-sim replay library/sample skull.servo --surface nearest --walk stepped",
                "trephine-sim replay library/sample hole.servo --sound hole.wav"};
  c.run = run_replay;
  return c;
});

}  // namespace trephine::commands
