// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/error.h"
#include "base/progress.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "commands/second_options.h"
#include "commands/session_options.h"

namespace trephine::commands {
namespace {

using Json = nlohmann::ordered_json;

struct RunParams {
  double seconds = 10;
  template <class V>
  static void describe(V& v) {
    v.number(&RunParams::seconds, "seconds", Range{0.001, 86400}, "How long the session runs, in seconds.");
  }
};

Json times_of(const haptics::Histogram& h) {
  const auto us = [](double ns) { return std::round(ns) / 1000; };
  return {{"mean_us", us(h.mean_ns())},
          {"p50_us", us(h.quantile_ns(0.5))},
          {"p99_us", us(h.quantile_ns(0.99))},
          {"p99_9_us", us(h.quantile_ns(0.999))},
          {"max_us", us(h.max_ns())}};
}

// By the shapes of the case that were touched.
std::map<std::string, double> max_forces(const session::SessionResult& r) {
  std::map<std::string, double> out;
  for (const auto& [number, name] : r.shapes)
    if (const double force = r.drilled->most_force_n[std::size_t(number)]; force > 0) out[name] = force;
  return out;
}

Json drilled_json(const session::SessionResult& r) {
  const haptics::DrillingOutcome& d = *r.drilled;
  Json j = {{"seconds", d.drilled_s},
            {"stalled_s", d.stalled_s},
            {"energy_j", d.energy_j},
            {"incisions", d.incisions},
            {"undone", d.undone},
            {"resets", d.resets},
            {"cutting_s", d.cutting_s},
            {"force_felt_n", d.cutting_s > 0 ? Json(d.cutting_n_s / d.cutting_s) : Json()},
            {"feed_mm_per_s", d.cutting_s > 0 ? Json(d.advanced_mm / d.cutting_s) : Json()},
            {"late_mm3", r.outcome->late_mm3},
            {"max_bone_c", d.max_bone_c},
            {"above_47_c_s", d.above_harm_s},
            {"heat_dose_min", d.heat_dose_min},
            {"removed_mm3", r.outcome->removed_mm3},
            {"most_force_n", max_forces(r)},
            {"breached", d.breached},
            {"volume_sha256", r.outcome->volume_sha256}};
  if (d.breached) {
    j["breach_time_s"] = d.breach_time_s;
    j["breach_mm"] = {d.breach_mm.x, d.breach_mm.y, d.breach_mm.z};
  }
  return j;
}

Json json_of(const session::SessionResult& r) {
  const haptics::ServoStatistics& s = r.statistics;
  Json counts = Json::object();
  for (const auto& [name, count] : r.device_counts) counts[name] = count;
  Json events = Json::object();
  for (int n = 0; n < haptics::haptic_event::count; ++n) events[haptics::haptic_event::names[n]] = s.events[n];
  Json out = {{"case", r.header.case_token},
              {"shape", r.header.felt_shape},
              {"tool", r.header.tool.tool},
              {"walk", haptics::choice_name(r.header.contact, "walk")},
              {"surface", haptics::choice_name(r.header.contact, "surface")},
              {"rate_hz", r.header.rate_hz},
              {"device", r.header.device},
              {"device_counts", counts},
              {"fifo", r.grant.fifo},
              {"memory_locked", r.grant.locked},
              {"ticks", s.ticks},
              {"overruns", s.overruns},
              {"jumps", r.jumps},
              {"gaps", r.gaps},
              {"frames_lost", r.frames_lost},
              {"faults", s.faults},
              {"fault_names", haptics::fault_names(s.faults)},
              {"touching_ratio", s.ticks > 0 ? double(s.touching) / double(s.ticks) : 0},
              {"events", events},
              {"most_force_n", s.most_force_n},
              {"most_force_step_n", s.most_force_step_n},
              {"cpu_mean_us", std::round(1000 * r.cpu_us_a_tick()) / 1000},
              {"tick", times_of(s.busy)},
              {"late", times_of(s.late)}};
  if (r.drilled) out["drilled"] = drilled_json(r);
  if (r.second) {
    Json seen = Json::object();
    for (const auto& [name, count] : r.second->device_counts) seen[name] = count;
    out["second"] = {{"device", r.header.second->device},
                     {"tool", r.header.second->tool.name},
                     {"device_counts", seen},
                     {"jumps", r.second->jumps},
                     {"gaps", r.second->gaps},
                     {"faults", r.second->faults},
                     {"fault_names", haptics::fault_names(r.second->faults)},
                     {"touching_ratio", s.ticks > 0 ? double(r.second->touching) / double(s.ticks) : 0},
                     {"most_force_n", r.second->most_force_n}};
  }
  return out;
}

std::string grant_text(const haptics::ServoParams& params, const haptics::RealtimeGrant& g) {
  if (!params.paced) return "as fast as it goes, in the device's own time";
  if (!params.realtime) return "normal scheduling, no promise of lateness";
  return fmt::format("{}, {}", g.fifo ? "SCHED_FIFO" : "no SCHED_FIFO (" + g.fifo_fault + "): no promise of lateness",
                     g.locked ? "memory locked" : "memory not locked (" + g.lock_fault + ")");
}

void print_start(const session::Session& session, const haptics::ServoParams& params,
                 const haptics::RealtimeGrant& grant) {
  const haptics::RecordingHeader& is = session.header();
  std::cout << fmt::format("servo at {:g} Hz on {}: {}\n", is.rate_hz, is.device, grant_text(params, grant));
  if (session.tool_points() > 0)
    std::cout << fmt::format("tool {}: {} points, {:g} mm in diameter, {:g} mm long\n", is.tool.tool,
                             session.tool_points(), is.tool.tool_diameter_mm, is.tool.tool_length_mm);
  if (is.second) std::cout << fmt::format("second hand: {} on {}\n", is.second->tool.name, is.second->device);
  std::cout << std::flush;
}

// Until the loop's end: says a fault when it happens, and writes what is recorded.
void follow(session::Session& session) {
  std::uint32_t told[2] = {0, 0};
  while (session.running()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::uint32_t now[2] = {session.faults(), session.second_faults()};
    for (int hand = 0; hand < 2; ++hand) {
      if (now[hand] == told[hand]) continue;
      told[hand] = now[hand];
      const bool lasts = now[hand] & ~haptics::haptic_fault::passing;
      std::cout << fmt::format("{}fault after {:.2f} s: {}; the force {}\n",
                               hand == 0 ? "" : "second hand: ", session.time_s(), haptics::fault_names(now[hand]),
                               lasts ? "stays zero" : "is zero until the device is back")
                << std::flush;
    }
    session.write_frames();
  }
}

void print_times(const char* what, const haptics::Histogram& h) {
  std::cout << fmt::format("{:<10} mean {:.2f}, p50 {:.2f}, p99 {:.2f}, p99.9 {:.2f}, max {:.2f} us\n", what,
                           h.mean_ns() / 1e3, h.quantile_ns(0.5) / 1e3, h.quantile_ns(0.99) / 1e3,
                           h.quantile_ns(0.999) / 1e3, h.max_ns() / 1e3);
}

void print_drilled(const session::SessionResult& r) {
  const haptics::DrillingOutcome& d = *r.drilled;
  std::string removed;
  for (const auto& [name, mm3] : r.outcome->removed_mm3)
    removed += fmt::format("{}{} {:.1f} mm3", removed.empty() ? "" : ", ", name, mm3);
  std::cout << fmt::format("drilled for {:.2f} s, {:.1f} J, stalled {:.2f} s, {} incisions; removed {}\n", d.drilled_s,
                           d.energy_j, d.stalled_s, d.incisions, removed.empty() ? "nothing" : removed);
  if (d.undone + d.resets > 0)
    std::cout << fmt::format("{} strokes or incisions taken back, and {} times all\n", d.undone, d.resets);
  if (d.late_units > 0)
    std::cout << fmt::format("{:.2f} mm3 of that removed late, from behind the tool\n", r.outcome->late_mm3);
  if (d.energy_j > 0)
    std::cout << fmt::format("bone at most {:.1f} degrees, {:.1f} s above {:g}; as {:.2g} minutes at 43\n",
                             d.max_bone_c, d.above_harm_s, drill::BoneHeat::harm_c, d.heat_dose_min);
  if (d.breached)
    std::cout << fmt::format("through at {:.3f} s, at {:.2f}, {:.2f}, {:.2f} mm\n", d.breach_time_s, d.breach_mm.x,
                             d.breach_mm.y, d.breach_mm.z);
  std::string forces;
  for (const auto& [name, force] : max_forces(r))
    forces += fmt::format("{}{} {:.2f} N", forces.empty() ? "" : ", ", name, force);
  if (d.cutting_s > 0)
    std::cout << fmt::format("while it cut: {:.2f} N felt, {:.2f} mm/s along its axis\n", d.cutting_n_s / d.cutting_s,
                             d.advanced_mm / d.cutting_s);
  std::cout << "largest force while touching: " << (forces.empty() ? "none" : forces) << "\n";
}

void print_result(const session::SessionResult& r, bool paced) {
  const haptics::ServoStatistics& s = r.statistics;
  const double touching = s.ticks > 0 ? 100.0 * double(s.touching) / double(s.ticks) : 0;
  std::cout << fmt::format("{} ticks, {} overruns, in contact {:.1f} %, faults {}\n", s.ticks, s.overruns, touching,
                           s.faults == 0 ? "none" : haptics::fault_names(s.faults));
  if (r.jumps + r.gaps > 0)
    std::cout << fmt::format("{} jumps of the device and {} gaps, in which the force was zero\n", r.jumps, r.gaps);
  std::string events, counts;
  for (int n = 0; n < haptics::haptic_event::count; ++n)
    events += fmt::format("{} {} {}", events.empty() ? "" : ",", haptics::haptic_event::names[n], s.events[n]);
  std::cout << "events:" << events << "\n";
  std::cout << fmt::format("force at most {:.3f} N, {:.4f} N from tick to tick\n", s.most_force_n, s.most_force_step_n);
  std::cout << fmt::format("CPU time   mean {:.2f} us a tick{}\n", r.cpu_us_a_tick(), paced ? ", with its sleep" : "");
  print_times("tick time", s.busy);
  if (paced) print_times("woken late", s.late);
  if (r.drilled) print_drilled(r);
  if (r.second)
    std::cout << fmt::format("second hand: in contact {:.1f} %, force at most {:.3f} N, {} jumps, {} gaps, faults {}\n",
                             s.ticks > 0 ? 100.0 * double(r.second->touching) / double(s.ticks) : 0,
                             r.second->most_force_n, r.second->jumps, r.second->gaps,
                             r.second->faults == 0 ? "none" : haptics::fault_names(r.second->faults));
  if (r.frames_lost > 0) std::cout << fmt::format("{} frames were not recorded: the disk is too slow\n", r.frames_lost);
  for (const auto& [name, count] : r.device_counts)
    counts += fmt::format("{} {} {}", counts.empty() ? "" : ",", count, name);
  if (!counts.empty()) std::cout << r.header.device << ":" << counts << "\n";
}

void refuse_one_file_twice(const cli::ParsedCommand& parsed) {
  if (parsed.has("record") && parsed.has("json") &&
      std::filesystem::weakly_canonical(parsed.path("record")) ==
          std::filesystem::weakly_canonical(parsed.path("json")))
    throw Error(ExitCode::usage, parsed.text("json"), "--record, --json", "are the same file");
}

ExitCode run_servo(const cli::ParsedCommand& parsed) {
  refuse_one_file_twice(parsed);
  session::SessionOptions options = session_options_of(parsed);
  options.seconds = parsed.params<RunParams>().seconds;
  options.second = second_options_of(parsed, options.device);
  session::Session session(options, cancel_requested(), [](const texts::Note& note) {
    std::cout << texts::text_of(note, texts::Language::english) << "\n" << std::flush;
  });
  print_start(session, options.servo, session.start());
  follow(session);
  const session::SessionResult result = session.finish();
  print_result(result, options.servo.paced);
  nlohmann::ordered_json json = json_of(result);
  // Whether the machine wakes anything in time is not the servo's doing: the two are told side by side.
  if (options.servo.paced && options.servo.realtime && !cancel_requested()) {
    const haptics::Histogram bare = haptics::bare_loop_lateness(options.servo.rate_hz, 1, true);
    print_times("bare sleep", bare);
    json["bare_sleep"] = times_of(bare);
  }
  if (parsed.has("json")) write_file(parsed.path("json"), json.dump(1) + "\n");
  Progress({}, &cancel_requested()).check();
  if (const std::uint32_t faults = result.statistics.faults & ~haptics::haptic_fault::passing; faults != 0)
    throw Error(ExitCode::io, "", "device", haptics::fault_names(faults) + ": the force was zero from then on");
  if (const std::uint32_t faults = session::lasting_second_faults(result); faults != 0)
    throw Error(ExitCode::io, "", "second device", haptics::fault_names(faults) + ": its force was zero from then on");
  return ExitCode::ok;
}

std::vector<cli::Argument> servo_arguments() {
  std::vector<cli::Argument> all = session_arguments(device::DeviceChoice().name), second = second_arguments();
  all.insert(all.end(), second.begin(), second.end());
  all.push_back(cli::argument("json", cli::Argument::Kind::out_file, "Write the statistics to this file."));
  return all;
}

std::vector<cli::ParameterGroup> servo_groups() {
  std::vector<cli::ParameterGroup> all = session_groups(), second = second_groups();
  all.insert(all.begin(), cli::ParameterGroup::of<RunParams>("Parameters"));
  all.insert(all.end(), second.begin(), second.end());
  return all;
}

std::vector<std::string> servo_examples() {
  std::vector<std::string> all = {
      "trephine-sim servo library/sample --seconds 5",
      "trephine-sim servo library/sample --shape skull --device hand --seconds 5 --record skull.servo",
      "trephine-sim servo library/sample --tool burr --seconds 5",
      "trephine-sim servo library/sample --tool ball --tool-diameter-mm 7 --drill --no-paced --seconds 60 --record "
      "hole.servo",
      "trephine-sim servo library/sample --device trajectory --trajectory path.txt --second-device udp --second-port "
      "20518 --second-tool suction --seconds 10 --record both.servo"};
  for (const device::DeviceType& type : device::device_types())
    if (!type.example.empty()) all.push_back("trephine-sim servo library/sample " + type.example);
  return all;
}

}  // namespace

const cli::OwnCommand servo_command([] {
  cli::Command c;
  c.name = "servo";
  c.summary = "runs the haptic loop on a case, without a window, and prints its statistics";
  c.description =
      "A thread of its own reads the device, moves the tool's proxy through the case's haptic volume and sends the "
      "force, 1000 times a second or more. The device is " +
      devices_text() +
      ". docs/explanation/contact-and-force.md describes contact and forces, docs/reference/recordings.md the "
      "recording, which `trephine-sim replay` reads. Ctrl-C ends the session: what was recorded and counted until then "
      "is written, and the exit code is 130. A fault (a lost "
      "device, a pose that is no number) is reported when it happens, and the exit code is 74.\n\n"
      "It says at the start what the system grants: SCHED_FIFO and locked memory need CAP_SYS_NICE and CAP_IPC_LOCK, "
      "or limits (ulimit -r, -l) that allow them.";
  c.arguments = servo_arguments();
  c.groups = servo_groups();
  c.examples = servo_examples();
  c.run = run_servo;
  return c;
});

}  // namespace trephine::commands
