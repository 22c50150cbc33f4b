// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/play.h"

#include <fmt/format.h>

#include <chrono>
#include <iostream>

#include "base/error.h"
#include "base/write_file.h"
#include "cases/case.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "commands/second_options.h"
#include "commands/session_options.h"
#include "commands/settings.h"
#include "haptics/haptic_state.h"
#include "lesson/approval.h"
#include "lessons/lesson_type.h"

namespace trephine::commands {
namespace {

constexpr const char* screen = "mouse";

struct PlayParams {
  double seconds = 0;
  int remote = -1, head_port = -1, record_server_port = 0, record_server_second_port = 0;
  bool remote_tells_all = false, questions = true;
  template <class V>
  static void describe(V& v) {
    using P = PlayParams;
    v.number(&P::seconds, "seconds", Range{0, 86400}, "End by itself after so long; 0: when the window is closed.");
    v.integer(&P::remote, "remote", Range{-1, 65535},
              "Port of the loopback interface on which lines of the remote are taken, of whoever sends the token that "
              "is printed with the port; 0: any port that is free; -1: none.");
    v.flag(&P::remote_tells_all, "remote_tells_all",
           "In a lesson, answer `state` with what the tip is in, what it touches and how deep it lies, which a trainee "
           "does not see: for a teacher's program and for tests.");
    v.flag(
        &P::questions, "questions",
        "In a lesson, ask what the rubric asks: the time-out before the first cut, what to do after a critical error, "
        "and what comes at the end.");
    v.integer(&P::record_server_port, "record_server_port", Range{0, 65535},
              "In a lesson, send poses and buttons to the `trephine-sim record-server` at this port of the loopback "
              "interface, which records and signs the lesson as well; 0: to none.");
    v.integer(&P::record_server_second_port, "record_server_second_port", Range{0, 65535},
              "The server's port for the other hand, where there is a second device.");
    v.integer(&P::head_port, "head_port", Range{-1, 65535},
              "Port of the loopback interface on which a tracker that sends the printed token says where the user's "
              "head is; 0: any port that is free; -1: none.");
  }
};

// Recording and report of a lesson: beside --record, or in --out under the first number that is free.
window::LessonPlay lesson_of(const cli::ParsedCommand& parsed) {
  window::LessonPlay l;
  l.module = parsed.text("lesson");
  l.language = parsed.params<window::WindowParams>().language;
  if (parsed.has("participant")) l.participant = parsed.text("participant");
  lesson::validate_token(l.participant, "--participant");
  l.task = parsed.text("task");
  l.questions = parsed.params<PlayParams>().questions;
  l.approved_sha256 = parsed.text("approved_sha256");
  for (const char* other : {"playback", "before", "shape"})
    if (parsed.has(other)) throw Error(ExitCode::usage, "", std::string("--lesson, --") + other, "do not go together");
  if (!parsed.has("rubric")) throw Error(ExitCode::usage, "", "--rubric", "is needed with --lesson");
  if (parsed.has("record") == parsed.has("out"))
    throw Error(ExitCode::usage, "", "--out", "or --record is needed with --lesson, and not both");
  l.rubric = parsed.path("rubric");
  l.recording = parsed.path("record");
  if (parsed.has("out")) {
    const std::filesystem::path out = parsed.path("out");
    make_output_folder(out);
    const std::filesystem::path manifest = parsed.path("case") / "case.json";
    const std::string token = with_file(manifest.string(), [&] {
      const std::vector<char> bytes = read_file(manifest, 1 << 26);
      return cases::parse_case_json({bytes.data(), bytes.size()}).case_token;
    });
    int n = 0;
    do l.recording = out / fmt::format("{}-{}-{:02}-{}.lesson", l.participant, l.module, ++n, token);
    while (std::filesystem::exists(l.recording));
  }
  const auto beside = [&](const char* extension) {
    return std::filesystem::path(l.recording).replace_extension(extension);
  };
  l.report = {beside(".json"), beside(".html"), l.recording.parent_path() / ("attempts-" + l.module + ".csv")};
  return l;
}

ExitCode run_play(const cli::ParsedCommand& given) {
  const cli::ParsedCommand parsed = with_settings(given);
  write_settings(parsed);
  const auto begun = std::chrono::steady_clock::now();
  const PlayParams& params = parsed.params<PlayParams>();
  window::PlayOptions o;
  o.session = session_options_of(parsed);
  if (!parsed.has("device") || parsed.text("device") == screen) o.session.device.name.clear();
  o.session.seconds = params.seconds > 0 ? params.seconds : 86400;
  o.session.second = second_options_of(parsed, o.session.device);
  if (!parsed.given.count("tool")) o.session.tool.tool = "burr";
  if (!parsed.given.count("drill")) o.session.drilling.drill = true;
  if (!o.session.servo.paced) throw Error(ExitCode::usage, "", "--no-paced", "a window keeps to the clock");
  o.playback = parsed.path("playback");
  const std::vector<std::string> named = parsed.all("before");
  o.before.assign(named.begin(), named.end());
  if (!o.playback.empty() && !o.session.record.empty())
    throw Error(ExitCode::usage, "", "--playback, --record", "a recording is shown or made, not both");
  if (parsed.has("lesson")) o.lesson = lesson_of(parsed);
  if (o.lesson && o.session.second) {
    const auto held = lessons::second_tool_of(lessons::lesson_type(o.lesson->module),
                                              parsed.given.count("second_tool") ? o.session.second->tool.tool : "");
    o.session.second->switch_only = !held;
    if (held) o.session.second->tool = *held;
  }
  if (o.session.second && !o.playback.empty())
    throw Error(ExitCode::usage, "", "--second-device", "a recording has the hands that it was made with");
  o.session.record_server_port = params.record_server_port;
  const bool placed = device::is_placed(o.session.device.name);
  if (params.record_server_port > 0 && placed)
    throw Error(ExitCode::usage, "", "--record-server-port",
                "and --device " + o.session.device.name +
                    " do not go together: the server knows nothing of the error with which a tracked tool lies, and "
                    "would judge rows that it does not bear");
  const bool two_to_server = params.record_server_port > 0 && o.session.second;
  if (two_to_server != (params.record_server_second_port > 0))
    throw Error(ExitCode::usage, "", "--record-server-second-port",
                two_to_server ? "is needed where --second-device holds a tool: the server takes each hand at a port"
                              : "needs --record-server-port and --second-device");
  if (two_to_server) o.session.second->record_server_port = params.record_server_second_port;
  if (params.record_server_port > 0 && !o.lesson)
    throw Error(ExitCode::usage, "", "--record-server-port", "is of a --lesson");
  for (const char* own : {"participant", "task", "rubric", "out", "approved_sha256"})
    if (parsed.has(own) && !o.lesson) throw Error(ExitCode::usage, "", std::string("--") + own, "is of a --lesson");
  if (o.session.target.target && (o.lesson || !o.playback.empty()))
    throw Error(ExitCode::usage, "", "--target",
                "is of a session without a lesson; a recording has the target that it was made with");
  o.ghost = parsed.path("ghost");
  if (parsed.has("screen")) {
    if (o.session.device.name.empty() || !o.playback.empty())
      throw Error(ExitCode::usage, "", "--screen", "says where a --device lies; the mouse and a playback need none");
    if (placed)
      throw Error(ExitCode::usage, "", "--screen, --device " + o.session.device.name,
                  "do not go together: the tool is in the print, and not before the screen");
    // The registration alone says where the tool is: another scale, place or a clutch would take it away from the hand.
    const device::WorkspaceParams& own = o.session.workspace;
    const device::WorkspaceParams none;
    const char* moved = own.workspace_axes != none.workspace_axes             ? "workspace_axes"
                        : own.workspace_scale != none.workspace_scale         ? "workspace_scale"
                        : own.workspace_offset_mm != none.workspace_offset_mm ? "workspace_offset_mm"
                        : own.clutch_button != none.clutch_button             ? "clutch_button"
                                                                              : nullptr;
    if (moved)
      throw Error(ExitCode::usage, "", std::string("--screen, ") + moved,
                  "do not go together, on the command line or in --settings: the registration says where the tool is");
    o.session.screen = device::read_screen_registration(parsed.path("screen"));
  }
  o.head_port = params.head_port;
  o.remote_tells_all = params.remote_tells_all;
  o.hand = parsed.params<window::ScreenHandParams>();
  o.view = parsed.params<scene::ViewParams>();
  const bool two_panes = o.view.stereo == scene::ViewParams::Stereo::side_by_side ||
                         o.view.stereo == scene::ViewParams::Stereo::top_bottom;
  if (o.lesson && two_panes && lessons::lesson_type(o.lesson->module).needs_pictures)
    throw Error(ExitCode::usage, "", "--stereo", "hides the fluoroscopic pictures that the lesson needs");
  if (parsed.has("shots")) {
    o.shots = parsed.path("shots");
    make_output_folder(o.shots);
  }
  const window::PlayOutcome r =
      window::play(o, parsed.params<window::WindowParams>(), params.remote, begun, cancel_requested(),
                   [](const std::string& line) { std::cout << line << "\n"
                                                           << std::flush; });
  std::cout << r.score;
  if (!r.score.empty()) std::cout << "report " << o.lesson->report.page.string() << "\n";
  std::cout << fmt::format(
      "{} pictures in {:.1f} s, {:.1f} ms each and {:.1f} ms of CPU (medians), {:.0f} ms the longest, {:.0f} MB of "
      "graphics memory\n",
      r.pictures, r.seconds, r.picture_ms, r.picture_cpu_ms, r.longest_ms, r.graphics_mb);
  Progress({}, &cancel_requested()).check();
  if (const std::uint32_t lasting = r.faults & ~haptics::haptic_fault::passing; lasting != 0)
    throw Error(ExitCode::io, "", "device", haptics::fault_names(lasting) + ": the force was zero from then on");
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand play_command([] {
  cli::Command c;
  c.name = "play";
  c.summary = "opens a window in which a case is seen, felt and cut";
  c.description =
      "The servo loop runs as `trephine-sim servo` runs it, and the window shows the patient, the tool, and bone as it "
      "is drilled. Mouse and keyboard hold the tool (docs/reference/window.md lists what they do), or --device does: " +
      devices_text() +
      ". With --playback a recording is shown instead, at any time and in both directions. --remote takes the same "
      "commands as lines on a socket. Tools drill where the case can be drilled; --no-drill keeps it whole. With "
      "--lesson a lesson is done (docs/explanation/lessons.md): its tools, "
      "pedal and commands, then its score, its report and a review; until then nothing is shown that a surgeon would "
      "not see. Exit code "
      "74 says that there is no display, no OpenGL 4.3, or that the driver lost its context; what was recorded until "
      "then is kept.";
  c.arguments = session_arguments(screen);
  for (const cli::Argument& a : second_arguments()) c.arguments.push_back(a);
  c.arguments.push_back(cli::argument("playback", cli::Argument::Kind::in_file, "A recording to be shown."));
  c.arguments.push_back(before_argument());
  c.arguments.push_back(cli::argument("screen", cli::Argument::Kind::in_file,
                                      "Where the device lies before the screen, as `trephine-sim register` wrote it: "
                                      "the tool is seen where the hand is, also when the view is turned."));
  cli::Argument lesson =
      cli::argument("lesson", cli::Argument::Kind::choice, "Do this lesson: its tools, steps, score and report.");
  lesson.choices = lessons::lesson_names();
  c.arguments.push_back(lesson);
  c.arguments.push_back(
      cli::argument("rubric", cli::Argument::Kind::in_file, "By what the lesson is judged, compiled (.json)."));
  c.arguments.push_back(
      cli::argument("task", cli::Argument::Kind::text,
                    "What is asked for in the lesson, as `right` or `pedicle_2_left`; by default the usual."));
  c.arguments.push_back(cli::argument("participant", cli::Argument::Kind::text,
                                      "Anonymous token of who does the lesson: a-z, 0-9, _ and -; never a name."));
  c.arguments.push_back(cli::argument("approved_sha256", cli::Argument::Kind::text,
                                      "SHA-256 of the case.json that was approved, as `exercise` gives it: the lesson "
                                      "is refused (80) where the case is another by now."));
  c.arguments.push_back(
      cli::argument("out", cli::Argument::Kind::out_folder,
                    "Folder of the lesson's recording, report and log; or --record FILE, and the report is "
                    "beside it."));
  c.arguments.push_back(cli::argument("ghost", cli::Argument::Kind::in_file,
                                      "A recording whose way is shown as green dots, such as an expert's."));
  c.arguments.push_back(
      cli::argument("shots", cli::Argument::Kind::out_folder,
                    "Folder for the pictures that F12 takes; the current folder where it is not given."));
  for (const cli::Argument& a : settings_arguments()) c.arguments.push_back(a);
  c.groups = {cli::ParameterGroup::of<PlayParams>("Parameters"),
              cli::ParameterGroup::of<window::WindowParams>("Window"),
              cli::ParameterGroup::of<scene::ViewParams>("View"),
              cli::ParameterGroup::of<window::ScreenHandParams>("Mouse and keyboard")};
  for (const auto& groups : {session_groups(), second_groups()})
    c.groups.insert(c.groups.end(), groups.begin(), groups.end());
  c.examples = {"trephine-sim play library/sample",
                "trephine-sim play library/sample --tool catheter --record way.servo",
                "trephine-sim play library/sample --playback hole.servo",
                "trephine-sim play library/sample --lesson ventriculostomy --rubric ventriculostomy.rubric.json "
                "--participant r-01 --out results",
                "trephine-sim play library/sample --device udp --stereo side_by_side"};
  c.run = run_play;
  return c;
});

}  // namespace trephine::commands
