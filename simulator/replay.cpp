// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "commands.h"
#include "felt_case.h"
#include "haptics/recording.h"

namespace trephine {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const ForceFigures& f) {
  return {{"frames", f.frames},
          {"touching", f.touching},
          {"anomaly_ratio", f.anomaly_ratio},
          {"zero_force_ratio", f.zero_force_ratio},
          {"most_step_n", f.most_step_n},
          {"sigma_n_per_s", f.sigma_n_per_s},
          {"mean_force_n", f.mean_force_n},
          {"most_force_n", f.most_force_n},
          {"mean_lag_mm", f.mean_lag_mm},
          {"most_lag_mm", f.most_lag_mm}};
}

void print(const char* what, const ForceFigures& f) {
  std::cout << fmt::format(
      "{}: anomaly coefficient {:.6f}, zero force {:.6f}, largest step {:.4f} N, sigma {:.3f} N/s, force {:.3f} N "
      "(at most {:.3f}), lag {:.3f} mm (at most {:.3f})\n",
      what, f.anomaly_ratio, f.zero_force_ratio, f.most_step_n, f.sigma_n_per_s, f.mean_force_n, f.most_force_n,
      f.mean_lag_mm, f.most_lag_mm);
}

ExitCode run_replay(const ParsedCommand& parsed) {
  const Recording recording = read_recording(parsed.path("recording"));
  const RecordingHeader& h = recording.header;
  FeltCase felt(parsed.path("case"), h.felt_shape);
  if (felt.header().haptic_sha256 != h.haptic_sha256)
    throw Error(ExitCode::bad_input, parsed.text("recording"), "haptic_sha256",
                "the recording is of another haptic volume (case " + h.case_token + ")");
  ContactParams contact_params = h.contact;
  const ContactParams& asked = parsed.params<ContactParams>();
  if (parsed.given.count("walk")) contact_params.walk = asked.walk;
  if (parsed.given.count("surface")) contact_params.surface = asked.surface;
  if (parsed.given.count("step_ratio")) contact_params.step_ratio = asked.step_ratio;
  const bool other = contact_params.walk != h.contact.walk || contact_params.surface != h.contact.surface ||
                     contact_params.step_ratio != h.contact.step_ratio;

  const ContactVolume contact(felt.loaded.haptic, contact_params);
  Proxy proxy(contact, felt.feels, h.force, h.shaft, make_tool(h.tool));
  const std::vector<ServoFrame> replayed = replay_frames(recording.frames, proxy);
  std::size_t different = 0, first = 0;
  for (std::size_t n = 0; n < replayed.size(); ++n)
    if (!same_frame(replayed[n], recording.frames[n]) && different++ == 0) first = n;

  std::cout << fmt::format("{} frames at {:g} Hz of device {}, tool {}, case {}\n", replayed.size(), h.rate_hz,
                           h.device, tool_name(h.tool), h.case_token);
  const ForceFigures was = force_figures(recording.frames), is = force_figures(replayed);
  print("recorded", was);
  if (other) print("replayed", is);
  if (parsed.has("json")) {
    Json j = {{"frames", replayed.size()}, {"different", different}, {"recorded", json_of(was)}};
    j["replayed"] = json_of(is);
    write_file(parsed.path("json"), j.dump(1) + "\n");
  }
  if (other) return ExitCode::ok;
  if (different > 0)
    throw Error(ExitCode::quality, parsed.text("recording"), "frames",
                fmt::format("{} of {} differ when replayed, the first is {}", different, replayed.size(), first));
  std::cout << "replayed bit for bit\n";
  return ExitCode::ok;
}

}  // namespace

Command replay_command() {
  Command c;
  c.name = "replay";
  c.summary = "runs a recorded session again, and compares it bit for bit or with another contact method";
  c.description =
      "The recorded poses go through the case's haptic volume once more, with the recording's own parameters; exit "
      "code "
      "80 where any bit of any frame is another. With another walk or surface the two are compared by the figures of "
      "their forces instead: the dissertation's force anomaly coefficient, and what it leaves out.";
  Argument folder = argument("case", Argument::Kind::in_folder, "Folder of the case.");
  folder.positional = folder.required = true;
  Argument recording = argument("recording", Argument::Kind::in_file, "What `trephine-sim servo --record` wrote.");
  recording.positional = recording.required = true;
  Argument json = argument("json", Argument::Kind::out_file, "Writes the figures to this file.");
  c.arguments = {folder, recording, json};
  c.groups = {ParameterGroup::of<ContactParams>("Contact, where it is to be another than recorded")};
  c.examples = {"trephine-sim replay library/sample skull.servo",
                "trephine-sim replay library/sample skull.servo --surface nearest --walk stepped"};
  c.run = run_replay;
  return c;
}

}  // namespace trephine
