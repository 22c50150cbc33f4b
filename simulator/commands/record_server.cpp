// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>
#include <thread>

#include "base/error.h"
#include "base/hash.h"
#include "base/log.h"
#include "base/progress.h"
#include "base/refusal.h"
#include "base/signature.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "commands/session_options.h"
#include "device/udp_device.h"
#include "lesson/approval.h"
#include "lessons/decisions.h"
#include "lessons/score_recording.h"
#include "lessons/signature.h"

namespace trephine::commands {
namespace {

namespace fs = std::filesystem;

struct RecordServerParams {
  std::string module = "ventriculostomy", participant, task, second_tool;
  int port = 0, second_port = -1;
  double wait_s = 0, most_s = 7200;
  bool questions = true;
  template <class V>
  static void describe(V& v) {
    using P = RecordServerParams;
    v.word(&P::module, "module", lessons::lesson_names(), "Which lesson.");
    v.text(&P::participant, "participant", "Anonymous token of who does it: a-z, 0-9, _ and -; never a name.");
    v.text(&P::task, "task", "What is asked for, as `right` or `pedicle_2_left`; by default the usual.");
    v.integer(&P::port, "port", Range{0, 65535},
              "Port of the loopback interface on which poses are taken; 0: any port that is free, which is printed.");
    v.integer(&P::second_port, "second_port", Range{-1, 65535},
              "The same for the other hand's poses; -1: the lesson is done with one hand.");
    v.text(&P::second_tool, "second_tool",
           "What the other hand holds; by default the first that the lesson has for it.");
    v.number(&P::wait_s, "wait_s", Range{0, 86400}, "How long to wait for the first pose; 0: until stopped.");
    v.number(&P::most_s, "most_s", Range{1, 86400}, "The longest that the lesson may take; then it is cut off.");
    v.flag(&P::questions, "questions", "Expect answers to what the rubric asks.");
  }
};

// Until the lesson was finished, the device was lost, or the time is over. `seen` takes all frames of the first hand,
// `of_second` those of the other one.
void follow(session::Session& session, std::atomic<bool>& stop, Sha256& seen, Sha256& of_second) {
  std::uint32_t buttons = 0;
  while (session.running()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    for (const haptics::ServoFrame& f : session.take_frames()) {
      seen.bytes(&f, sizeof f);
      if (haptics::belt_command::new_of(f.buttons, buttons) == haptics::belt_command::finish) stop = true;
      if (f.faults & ~haptics::haptic_fault::passing) stop = true;
      buttons = f.buttons;
    }
    for (const haptics::ServoFrame& f : session.second_frames()) of_second.bytes(&f, sizeof f);
    if (cancel_requested()) stop = true;
  }
}

ExitCode run_record_server(const cli::ParsedCommand& parsed) {
  const RecordServerParams& p = parsed.params<RecordServerParams>();
  lesson::validate_token(p.participant, "--participant");
  const lesson::CompiledRubric rubric = lessons::read_rubric_file(parsed.path("rubric"));
  if (rubric.module != p.module)
    throw Error(ExitCode::usage, parsed.text("rubric"), "module", rubric.module + ", but --module is " + p.module);
  const fs::path record = parsed.path("record"), key = parsed.path("key");
  const auto beside = [&](const char* extension) { return fs::path(record).replace_extension(extension); };
  for (const fs::path& file : {record, beside(".json"), beside(".html"), lessons::signature_file(record)}) {
    if (fs::exists(file)) throw Error(ExitCode::cannot_create, file.string(), "", "is there already");
  }
  if (const fs::path end = record.extension(); end == ".json" || end == ".html" || end == ".sig")
    throw Error(ExitCode::usage, record.string(), "--record",
                "ends as a file that is written beside it; end it in .lesson");
  signature_of_bytes("", key);  // a key that cannot sign is refused before the lesson

  const auto patient =
      std::make_shared<session::Patient>(parsed.path("case"), "", parsed.params<contact::ContactParams>());
  const cases::CaseManifest& manifest = patient->felt.loaded.manifest;
  const lessons::LessonType& type = lessons::lesson_type(p.module);
  with_file((parsed.path("case") / "case.json").string(), [&] { type.require(manifest); });
  session::SessionOptions o;
  o.case_folder = parsed.path("case");
  o.device.name = "udp";
  o.servo = parsed.params<haptics::ServoParams>();
  o.contact = parsed.params<contact::ContactParams>();
  o.force = parsed.params<haptics::ForceParams>();
  if (!o.servo.paced) throw Error(ExitCode::usage, "", "--no-paced", "poses are taken at the clock's pace");
  o.tools = type.tools();
  o.lesson = p.module;
  o.participant = p.participant;
  o.task = lessons::task_or_usual(type, manifest, p.task).name;
  o.rubric_sha256 = rubric.sha256;
  if (p.questions)
    o.asked = lessons::as_asked(lessons::questions_for(*rubric.common, type, manifest, o.task, p.participant));
  o.record = record;
  o.watched = true;
  const auto listening_at = [&](int port, const device::DeviceScene& scene) {
    device::UdpParams udp;
    udp.port = port;
    udp.wait_s = p.wait_s;
    auto device = std::make_unique<device::UdpDevice>(udp, scene.realtime, device::UdpDevice::monotonic_ns,
                                                      session::lesson_number(patient->felt.case_sha256, o));
    scene.say({texts::NoteId::waiting_for_device, {device->endpoint()}});
    return device;
  };
  std::unique_ptr<device::UdpDevice> of_other_hand;  // listens before the first is waited for
  o.own_device = [&](const device::DeviceScene& scene) {
    auto device = listening_at(p.port, scene);
    if (o.second) of_other_hand = listening_at(p.second_port, scene);
    device->wait(Progress({}, &cancel_requested()));
    return device;
  };
  if (p.second_port >= 0) {
    const auto held = lessons::second_tool_of(type, p.second_tool);
    session::SecondOptions& second = o.second.emplace();
    second.device.name = "udp";
    second.force = o.force;
    second.switch_only = !held;
    if (held) second.tool = *held;
    second.own_device = [&](const device::DeviceScene&) {
      of_other_hand->wait(Progress({}, &cancel_requested()));
      return std::move(of_other_hand);
    };
  } else if (!p.second_tool.empty()) {
    throw Error(ExitCode::usage, "", "--second-tool", "needs --second-port");
  }
  o.seconds = p.most_s;
  std::atomic<bool> stop{false};
  session::SessionResult result;
  Sha256 seen, of_second;
  {
    session::Session session(
        o, stop,
        [](const texts::Note& note) {
          std::cout << texts::text_of(note, texts::Language::english) << "\n" << std::flush;
        },
        patient);
    session.start();
    if (const auto approval = lesson::read_approval(parsed.path("case"));
        !approval || approval->case_sha256 != patient->felt.case_sha256)
      log_warning(parsed.text("case") +
                  ": is not approved, so that a signature of the lesson says nothing of the case: look at it, and run "
                  "`trephine library approve`");
    follow(session, stop, seen, of_second);
    result = session.finish();
    for (const haptics::ServoFrame& f : session.last_frames()) seen.bytes(&f, sizeof f);
    for (const haptics::ServoFrame& f : session.second_frames()) of_second.bytes(&f, sizeof f);
  }
  if (const std::uint32_t faults = session::lasting_second_faults(result); faults != 0)
    log_warning("second hand: " + haptics::fault_names(faults) +
                ": its force was zero from then on, and nothing of it counts");
  if (result.frames_lost > 0)
    throw Error(ExitCode::io, record.string(), "",
                "the disk was too slow for all ticks: not signed, do the lesson again");
  // What is signed is read from the disk, where another file may lie by now.
  const haptics::Recording read = haptics::read_recording(record);
  Sha256 there, second_there;
  for (const haptics::ServoFrame& f : read.frames) there.bytes(&f, sizeof f);
  for (const haptics::ServoFrame& f : read.second) second_there.bytes(&f, sizeof f);
  if (there.hex() != seen.hex() || second_there.hex() != of_second.hex() || read.header.participant != o.participant ||
      read.header.task != o.task || read.header.rubric_sha256 != o.rubric_sha256 ||
      read.header.case_sha256 != result.header.case_sha256)
    throw refusal("", "is not what was recorded, so that it was not signed",
                  {"give --record a folder where nobody else can write, and do the `lesson` again"})
        .in_file(record.string());
  lessons::sign_recording(read, record, key);
  std::cout << lessons::signature_file(record).string() << "\n";
  lessons::ScoredLesson scored = lessons::score_recording(record, o.case_folder, rubric);
  lessons::write_report(scored, o.case_folder, {beside(".json"), beside(".html"), {}});
  std::cout << lessons::score_text(scored.head, *scored.facts, scored.score);
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand record_server_command([] {
  using Kind = cli::Argument::Kind;
  cli::Command c;
  c.name = "record-server";
  c.summary = "records a lesson at a teacher's station, and signs what it recorded itself";
  c.description =
      "Runs by a user whose private key the trainee cannot read. It takes poses and buttons from the loopback "
      "interface "
      "at the clock's pace, as `trephine-sim play --record-server-port` sends them, runs the haptic loop itself, and "
      "when "
      "the lesson is finished signs its own recording, and judges it. It never signs frames that it is given. So the "
      "signature says that these poses came in at that pace, in this case, by this program; it does not say whose hand "
      "it was, nor that no program sent them (docs/explanation/lessons.md).";
  c.arguments = {cli::positional_argument("case", Kind::in_folder, "Folder of the case."),
                 cli::required_argument("rubric", Kind::in_file, "The compiled rubric (.json)."),
                 cli::required_argument("record", Kind::out_file,
                                        "Write the recording to this file, and signature and report beside it."),
                 cli::required_argument("key", Kind::in_file, "The teacher's private key (PEM).")};
  c.groups = {cli::ParameterGroup::of<RecordServerParams>("Parameters"),
              cli::ParameterGroup::of<haptics::ServoParams>("Servo loop"),
              cli::ParameterGroup::of<contact::ContactParams>("Contact"),
              cli::ParameterGroup::of<haptics::ForceParams>("Force")};
  c.examples = {
      "trephine-sim record-server library/sample --rubric ventriculostomy.rubric.json --participant r-01 --record "
      "/srv/lessons/r-01.lesson --key teacher.key --port 20600"};
  c.run = run_record_server;
  return c;
});

}  // namespace trephine::commands
