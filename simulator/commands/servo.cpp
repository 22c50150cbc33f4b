// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <time.h>

#include <chrono>
#include <cmath>
#include <future>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/error.h"
#include "base/progress.h"
#include "base/text.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "commands/commands.h"
#include "device/hand_path.h"
#include "device/simulated_hand.h"
#include "device/trajectory.h"
#include "device/udp_device.h"
#include "haptics/recording.h"
#include "haptics/servo.h"
#include "session/felt_case.h"

namespace trephine {
namespace {

using Json = nlohmann::ordered_json;

struct RunParams {
  double seconds = 10;
  template <class V>
  static void describe(V& v) {
    v.number(&RunParams::seconds, "seconds", Range{0.001, 86400}, "How long it runs.");
  }
};

// Until somebody holds the tool.
std::unique_ptr<Device> listen(const ParsedCommand& parsed) {
  const ServoParams& servo = parsed.params<ServoParams>();
  if (!servo.paced) throw Error(ExitCode::usage, "", "--no-paced", "a device that is there keeps to the clock");
  auto device = std::make_unique<UdpDevice>(parsed.params<UdpParams>(), servo.realtime);
  std::cout << "waiting for a device on " << device->endpoint() << "\n" << std::flush;
  device->wait(Progress({}, &cancel_requested()));
  return device;
}

std::unique_ptr<Device> make_device(const ParsedCommand& parsed, const ContactVolume& contact,
                                    const TouchableFaces& faces) {
  if (parsed.text("device") == "trajectory") {
    if (!parsed.has("trajectory"))
      throw Error(ExitCode::usage, "", "--trajectory", "is needed with --device trajectory");
    return std::make_unique<Trajectory>(read_trajectory(parsed.path("trajectory")));
  }
  if (parsed.has("trajectory")) throw Error(ExitCode::usage, "", "--trajectory", "needs --device trajectory");
  if (parsed.text("device") == "udp") return listen(parsed);
  HandPath path = path_over(contact, faces, parsed.params<HandPathParams>());
  auto hand = std::make_unique<SimulatedHand>(parsed.params<HandParams>(), std::move(path.points_mm), path.loop_from);
  const auto& from = parsed.params<HandPathParams>().from;
  hand->axis = normalized(Vec3{from[0], from[1], from[2]});
  return hand;
}

Json times_of(const Histogram& h) {
  const auto us = [](double ns) { return std::round(ns) / 1000; };
  return {{"mean_us", us(h.mean_ns())},
          {"p50_us", us(h.quantile_ns(0.5))},
          {"p99_us", us(h.quantile_ns(0.99))},
          {"p99_9_us", us(h.quantile_ns(0.999))},
          {"max_us", us(h.max_ns())}};
}

/// What a session was, beside its statistics.
struct Session {
  RecordingHeader is;
  RealtimeGrant grant;
  double cpu_s = 0;  ///< of the servo thread, its sleeps' system calls included
  std::uint64_t frames_lost = 0;
  double cpu_us(const ServoStatistics& s) const { return s.ticks > 0 ? 1e6 * cpu_s / double(s.ticks) : 0; }
};

Json json_of(const ServoStatistics& s, const Session& session, const Device& device) {
  Json counts = Json::object();
  for (const auto& [name, count] : device.counts()) counts[name] = count;
  Json events = Json::object();
  for (int n = 0; n < haptic_event::count; ++n) events[haptic_event::names[n]] = s.events[n];
  return {{"case", session.is.case_token},
          {"shape", session.is.felt_shape},
          {"tool", session.is.tool.tool},
          {"walk", choice_name(session.is.contact, "walk")},
          {"surface", choice_name(session.is.contact, "surface")},
          {"rate_hz", session.is.rate_hz},
          {"device", device.name()},
          {"device_counts", counts},
          {"fifo", session.grant.fifo},
          {"memory_locked", session.grant.locked},
          {"ticks", s.ticks},
          {"overruns", s.overruns},
          {"frames_lost", session.frames_lost},
          {"faults", s.faults},
          {"fault_names", fault_names(s.faults)},
          {"touching_ratio", s.ticks > 0 ? double(s.touching) / double(s.ticks) : 0},
          {"events", events},
          {"most_force_n", s.most_force_n},
          {"most_force_step_n", s.most_force_step_n},
          {"cpu_mean_us", std::round(1000 * session.cpu_us(s)) / 1000},
          {"tick", times_of(s.busy)},
          {"late", times_of(s.late)}};
}

void print_times(const char* what, const Histogram& h) {
  std::cout << fmt::format("{:<10} mean {:.2f}, p50 {:.2f}, p99 {:.2f}, p99.9 {:.2f}, max {:.2f} us\n", what,
                           h.mean_ns() / 1e3, h.quantile_ns(0.5) / 1e3, h.quantile_ns(0.99) / 1e3,
                           h.quantile_ns(0.999) / 1e3, h.max_ns() / 1e3);
}

void print_statistics(const ServoStatistics& s, const Session& session, bool paced) {
  const double touching = s.ticks > 0 ? 100.0 * double(s.touching) / double(s.ticks) : 0;
  std::cout << fmt::format("{} ticks, {} overruns, in contact {:.1f} %, faults {}\n", s.ticks, s.overruns, touching,
                           s.faults == 0 ? "none" : fault_names(s.faults));
  std::string events;
  for (int n = 0; n < haptic_event::count; ++n)
    events += fmt::format("{} {} {}", events.empty() ? "" : ",", haptic_event::names[n], s.events[n]);
  std::cout << "events:" << events << "\n";
  std::cout << fmt::format("force at most {:.3f} N, {:.4f} N from tick to tick\n", s.most_force_n, s.most_force_step_n);
  std::cout << fmt::format("CPU time   mean {:.2f} us a tick{}\n", session.cpu_us(s), paced ? ", with its sleep" : "");
  print_times("tick time", s.busy);
  if (paced) print_times("woken late", s.late);
  if (session.frames_lost > 0)
    std::cout << fmt::format("{} frames were not recorded: the disk is too slow\n", session.frames_lost);
}

std::string grant_text(const ServoParams& params, const RealtimeGrant& g) {
  if (!params.paced) return "as fast as it goes, in the device's own time";
  if (!params.realtime) return "normal scheduling, no promise of lateness";
  return fmt::format("{}, {}", g.fifo ? "SCHED_FIFO" : "no SCHED_FIFO (" + g.fifo_fault + "): no promise of lateness",
                     g.locked ? "memory locked" : "memory not locked (" + g.lock_fault + ")");
}

double thread_cpu_s() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

ExitCode run_servo(const ParsedCommand& parsed) {
  if (parsed.has("record") && parsed.has("json") &&
      std::filesystem::weakly_canonical(parsed.path("record")) ==
          std::filesystem::weakly_canonical(parsed.path("json")))
    throw Error(ExitCode::usage, parsed.text("json"), "--record, --json", "are the same file");
  ServoParams params = parsed.params<ServoParams>();
  FeltCase felt(parsed.path("case"), parsed.text("shape"));
  const ContactVolume contact(felt.loaded.haptic, parsed.params<ContactParams>());
  const std::unique_ptr<Device> device = make_device(parsed, contact, touchable_of(felt.feels));
  const ToolParams tool = own_tool(parsed.params<ToolParams>());
  Proxy proxy(contact, felt.feels, parsed.params<ForceParams>(), parsed.params<ShaftParams>(), make_tool(tool));

  Session session;
  session.is = felt.header();
  session.is.device = device->name();
  session.is.rate_hz = params.rate_hz;
  session.is.contact = parsed.params<ContactParams>();
  session.is.force = parsed.params<ForceParams>();
  session.is.shaft = parsed.params<ShaftParams>();
  session.is.tool = tool;
  std::unique_ptr<RecordingWriter> recording;
  if (parsed.has("record")) recording = std::make_unique<RecordingWriter>(parsed.path("record"), session.is);
  // What the servo does not sleep for it must not outrun: without a clock every frame fits.
  const double ticks = std::max(1.0, std::round(parsed.params<RunParams>().seconds * params.rate_hz));
  if (!params.paced && ticks > 2e7) throw Error(ExitCode::usage, "", "--seconds", "is too long without --paced");
  FrameQueue queue(!recording ? 64 : params.paced ? std::size_t(1) << 16 : std::size_t(ticks));
  Servo servo(proxy, *device, params, recording ? &queue : nullptr);

  std::promise<RealtimeGrant> granted;
  std::atomic<bool> done{false};
  std::thread thread([&] {
    granted.set_value(params.paced && params.realtime ? claim_realtime() : RealtimeGrant{});
    const double before_s = thread_cpu_s();
    servo.run(std::uint64_t(ticks), cancel_requested());
    session.cpu_s = thread_cpu_s() - before_s;
    done = true;
  });
  session.grant = granted.get_future().get();
  std::vector<ServoFrame> frames;
  std::exception_ptr fault;
  std::uint32_t told = 0;
  try {
    std::cout << fmt::format("servo at {:g} Hz on {}: {}\n", params.rate_hz, device->name(),
                             grant_text(params, session.grant));
    if (proxy.tool_body())
      std::cout << fmt::format("tool {}: {} points, {:g} mm in diameter, {:g} mm long\n", tool.tool,
                               proxy.tool_body()->count(), tool.tool_diameter_mm, tool.tool_length_mm);
    std::cout << std::flush;
    while (!done) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      if (const std::uint32_t faults = servo.faults(); faults != told) {
        told = faults;
        std::cout << fmt::format("fault after {:.2f} s: {}; the force stays zero\n",
                                 double(servo.ticks_done()) / params.rate_hz, fault_names(faults))
                  << std::flush;
      }
      if (!recording || !params.paced) continue;
      frames.clear();
      queue.drain(frames);
      recording->add(frames);
    }
  } catch (...) {
    fault = std::current_exception();
  }
  thread.join();
  if (fault) std::rethrow_exception(fault);
  // A session that was stopped is a shorter one: what was recorded is kept.
  if (recording) {
    frames.clear();
    queue.drain(frames);
    recording->add(frames);
    recording->finish();
  }
  session.frames_lost = queue.dropped();
  print_statistics(servo.statistics(), session, params.paced);
  std::string counts;
  for (const auto& [name, count] : device->counts())
    counts += fmt::format("{} {} {}", counts.empty() ? "" : ",", count, name);
  if (!counts.empty()) std::cout << device->name() << ":" << counts << "\n";
  if (parsed.has("json")) write_file(parsed.path("json"), json_of(servo.statistics(), session, *device).dump(1) + "\n");
  Progress({}, &cancel_requested()).check();
  if (const std::uint32_t faults = servo.statistics().faults; faults != 0)
    throw Error(ExitCode::io, "", "device", fault_names(faults) + ": the force was zero from then on");
  return ExitCode::ok;
}

}  // namespace

Command servo_command() {
  Command c;
  c.name = "servo";
  c.summary = "runs the haptic loop on a case, without a window, and prints its statistics";
  c.description =
      "A thread of its own reads the device, moves the tool's proxy through the case's haptic volume and sends the "
      "force, 1000 times a second or more. The device is a simulated hand, which presses on the first surface that it "
      "meets and moves over it in a circle, a trajectory from a file, or one that sends its poses by UDP. "
      "docs/haptics.md describes contact, forces, and the recording, which `trephine-sim replay` reads. Ctrl-C ends "
      "the "
      "session: what was recorded and counted until then is written, and the exit code is 130. A fault (a lost device, "
      "a pose that is no number) is said when it happens, and the exit code is 74.\n\n"
      "It says at the start what the system grants: SCHED_FIFO and locked memory need CAP_SYS_NICE and CAP_IPC_LOCK, "
      "or limits (ulimit -r, -l) that allow them.";
  Argument folder = argument("case", Argument::Kind::in_folder, "Folder of the case.");
  folder.positional = folder.required = true;
  Argument device = argument("device", Argument::Kind::choice, "Who holds the tool; hand where it is not given.");
  device.choices = {"hand", "trajectory", "udp"};
  Argument trajectory =
      argument("trajectory", Argument::Kind::in_file,
               "Lines of time_s x_mm y_mm z_mm [ax ay az [buttons]], LPS; the axis points from the tip to the tail.");
  Argument shape =
      argument("shape", Argument::Kind::text, "The one shape that is felt; all of the case where it is not given.");
  Argument record = argument("record", Argument::Kind::out_file, "Writes every tick to this file.");
  Argument json = argument("json", Argument::Kind::out_file, "Writes the statistics to this file.");
  c.arguments = {folder, device, trajectory, shape, record, json};
  c.groups = {ParameterGroup::of<RunParams>("Parameters"),      ParameterGroup::of<ServoParams>("Servo loop"),
              ParameterGroup::of<ContactParams>("Contact"),     ParameterGroup::of<ForceParams>("Force"),
              ParameterGroup::of<ToolParams>("Tool"),           ParameterGroup::of<ShaftParams>("Its shaft"),
              ParameterGroup::of<HandParams>("Simulated hand"), ParameterGroup::of<HandPathParams>("The hand's task"),
              ParameterGroup::of<UdpParams>("Device by UDP")};
  c.examples = {"trephine-sim servo library/sample --seconds 5",
                "trephine-sim servo library/sample --shape skull --device hand --seconds 5 --record skull.servo",
                "trephine-sim servo library/sample --tool burr --seconds 5",
                "trephine-sim servo library/sample --device trajectory --trajectory path.txt --seconds 2",
                "trephine-sim servo library/sample --device udp --port 20517 --seconds 60"};
  c.run = run_servo;
  return c;
}

}  // namespace trephine
