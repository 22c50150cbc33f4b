// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>

#include "base/error.h"
#include "base/gnuplot.h"
#include "base/log.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "session/recording_text.h"

namespace trephine::commands {
namespace {

std::string terminal_for(const std::filesystem::path& file) {
  if (file.extension() == ".svg") return gnuplot_svg(session::recording_plot_width, session::recording_plot_height);
  if (file.extension() == ".png") return gnuplot_png(session::recording_plot_width, session::recording_plot_height);
  throw Error(ExitCode::usage, file.string(), "--plot", "must end in .svg or .png");
}

ExitCode run_export_recording(const cli::ParsedCommand& parsed) {
  if (!parsed.has("csv") && !parsed.has("json") && !parsed.has("plot"))
    throw Error(ExitCode::usage, "", "--csv, --json, --plot", "one of them must be given");
  const std::string terminal = parsed.has("plot") ? terminal_for(parsed.path("plot")) : "";
  const haptics::Recording recording = haptics::read_recording(parsed.path("recording"));
  if (recording.seal == haptics::Seal::broken)
    log_warning(parsed.text("recording") + ": the seal is broken: the recording was changed after it was written");
  const session::RecordingTextParams& params = parsed.params<session::RecordingTextParams>();
  const auto written = [&](const char* option, const auto& write) {
    if (!parsed.has(option)) return;
    FileWriter out(parsed.path(option));
    write(recording, params, out);
    out.commit();
  };
  written("csv", session::write_recording_csv);
  written("json", session::write_recording_json);
  if (parsed.has("plot"))
    write_file(parsed.path("plot"), gnuplot_picture(terminal, session::recording_plot(recording)));
  const std::uint64_t missing = haptics::missing_frames(recording.frames);
  if (!parsed.quiet)
    std::cout << fmt::format("{} frames, {}{}\n", recording.frames.size(), haptics::name_of(recording.seal),
                             missing > 0 ? fmt::format(", {} are missing", missing) : "");
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand export_recording_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "export-recording";
  c.summary = "writes a recorded session as CSV, as plain JSON, or as a picture of force, position and events";
  c.description =
      "Writes a recording for programs that do not know its form: each tick's pose, force, contact, buttons and "
      "events, in millimetres (LPS), newtons and seconds, with nothing rounded. The places at which surfaces hold the "
      "tool (held_at, held_mm) are in the recording alone, which docs/reference/recordings.md specifies. "
      "examples/python_reader/read_recording.py reads the JSON and the recording itself. A recording whose seal is "
      "broken is written with a warning, and the JSON says "
      "so. "
      "--plot draws force, position and events over time by gnuplot.";
  c.arguments = {cli::positional_argument("recording", Kind::in_file, "A recording of `servo`, `lesson` or `play`."),
                 cli::argument("csv", Kind::out_file, "Write the frames to this file (.csv)."),
                 cli::argument("json", Kind::out_file, "Write header and frames to this file (.json)."),
                 cli::argument("plot", Kind::out_file, "Draw the picture to this file (.svg or .png).")};
  c.groups = {cli::ParameterGroup::of<session::RecordingTextParams>("Parameters")};
  c.examples = {"trephine-sim export-recording one.lesson --csv one.csv --every-count 10",
                "trephine-sim export-recording one.lesson --json one.recording.json --plot one.svg"};
  c.run = run_export_recording;
  return c;
});

}  // namespace trephine::commands
