// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "commands/session_options.h"
#include "commands/settings.h"
#include "session/calibration.h"
#include "session/session.h"

namespace trephine::commands {
namespace {

using Json = nlohmann::ordered_json;

// The stiffest face of the case that can be touched.
double stiffest(const session::FeltCase& felt) {
  double most = 0;
  for (const haptics::ShapeFeel& f : felt.feels)
    for (const cases::CaseFace* face : {&f.front, &f.back})
      if (face->touchable) most = std::max(most, face->stiffness_n_per_mm);
  return most;
}

Json list_of(Vec3 v) { return {v.x, v.y, v.z}; }

// A latency below half a tick is that of the ticks.
constexpr double least_delay_ms = 0.5;

// The device's middle is put to the case's; its workspace is not made larger or smaller. A delay is set where the
// damping is known that it is measured against, for without it no session starts.
Json settings_of(const session::Calibration& c, const session::SessionOptions& o, double damping_n_s_per_mm,
                 Vec3 centre_mm) {
  const Vec3 middle = (c.workspace.min_mm + c.workspace.max_mm) / 2;
  Json settings = {{"rate_hz", o.servo.rate_hz},
                   {"workspace_axes", o.workspace.workspace_axes},
                   {"workspace_scale", 1},
                   {"workspace_offset_mm", list_of(centre_mm - device::workspace_axes(o.workspace) * middle)}};
  if (c.latency_ms >= least_delay_ms && damping_n_s_per_mm > 0) {
    settings["device_delay_ms"] = std::round(10 * c.latency_ms) / 10;
    settings["device_own_damping_n_s_per_mm"] = damping_n_s_per_mm;
  }
  return settings;
}

ExitCode run_calibrate(const cli::ParsedCommand& given) {
  const cli::ParsedCommand parsed = with_settings(given);
  const session::SessionOptions o = session_options_of(parsed);
  const session::CalibrationParams& params = parsed.params<session::CalibrationParams>();
  const auto say = [](const std::string& line) { std::cout << line << "\n" << std::flush; };
  session::Patient patient(o.case_folder, o.shape, o.contact);
  const device::DeviceScene scene = touched_scene(patient, params.in_real_time, say);
  const std::unique_ptr<device::Device> device = device::make_device(o.device, scene);
  const session::Calibration c = session::calibrate(*device, params, cancel_requested(), say);
  const double case_n_per_mm = stiffest(patient.felt) * o.workspace.workspace_scale;  // as the hand meets it
  const Vec3 size = c.workspace.max_mm - c.workspace.min_mm;
  std::cout << fmt::format("poses {:.0f} a second, 99 of 100 within {:.1f} ms\n", c.poses_hz, c.gap_p99_ms);
  std::cout << (c.latency_ms >= 0 ? fmt::format("latency {:.2f} ms from a force to its motion\n", c.latency_ms)
                                  : std::string("latency not measured: the pulses did not move it\n"));
  const double own = o.port.device_own_damping_n_s_per_mm, damping = own > 0 ? own : device->damping_n_s_per_mm();
  if (c.latency_ms >= least_delay_ms && damping == 0)
    std::cout << "the damping of the device is not known: with --device-own-damping-n-s-per-mm, --write-settings also "
                 "writes the latency, by which play softens what it must\n";
  std::cout << fmt::format("workspace {:.1f} x {:.1f} x {:.1f} mm\n", size.x, size.y, size.z);
  if (c.unpressed_n_per_mm > 0)
    std::cout << fmt::format("the wall of {:.2f} N/mm was not pressed: it and stiffer ones were not measured\n",
                             c.unpressed_n_per_mm);
  if (c.stable_n_per_mm < 0 && c.unpressed_n_per_mm < 0)
    std::cout << fmt::format("no wall was stable, not even one of {:g} N/mm\n", params.first_stiffness_n_per_mm);
  else if (c.stable_n_per_mm > 0)
    std::cout << fmt::format("stable up to {:.2f} N/mm{}; the case's stiffest face has {:g} N/mm{}\n",
                             c.stable_n_per_mm,
                             c.unstable_n_per_mm > 0 ? fmt::format(", unstable at {:.2f}", c.unstable_n_per_mm) : "",
                             case_n_per_mm, case_n_per_mm > c.stable_n_per_mm ? ": it will tremble there" : "");
  if (parsed.has("json")) {
    const Json j = {{"device", o.device.name},
                    {"poses_hz", c.poses_hz},
                    {"gap_p99_ms", c.gap_p99_ms},
                    {"latency_ms", c.latency_ms >= 0 ? Json(c.latency_ms) : Json()},
                    {"workspace_mm", {list_of(c.workspace.min_mm), list_of(c.workspace.max_mm)}},
                    {"stable_n_per_mm", c.stable_n_per_mm > 0 ? Json(c.stable_n_per_mm) : Json()},
                    {"unstable_n_per_mm", c.unstable_n_per_mm > 0 ? Json(c.unstable_n_per_mm) : Json()},
                    {"unpressed_n_per_mm", c.unpressed_n_per_mm > 0 ? Json(c.unpressed_n_per_mm) : Json()},
                    {"case_n_per_mm", case_n_per_mm}};
    write_file(parsed.path("json"), j.dump(1) + "\n");
  }
  if (parsed.has("write_settings"))
    write_file(parsed.path("write_settings"),
               settings_of(c, o, damping, patient.felt.loaded.manifest.center_mm).dump(1) + "\n");
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand calibrate_command([] {
  cli::Command c;
  c.name = "calibrate";
  c.summary = "measures a device: rate, latency, workspace, and the stiffest wall on which it stays calm";
  c.description =
      "It tells the hand what to do, and sends forces of its own: pulses of --pulse-n, and walls that press with "
      "--wall-most-n at most. A wall counts as stable where it was pressed, gave the hand no energy on the whole, and "
      "the device was at rest at its end. The result is compared with the case's stiffest face. --write-settings "
      "writes a file for "
      "`trephine-sim play --settings`, which puts the middle of the device's workspace to the middle of the case.";
  c.arguments = measuring_arguments();
  c.arguments.push_back(cli::argument("json", cli::Argument::Kind::out_file, "Write what was measured to this file."));
  c.arguments.push_back(
      cli::argument("write_settings", cli::Argument::Kind::out_file, "Write settings for play to this file."));
  c.groups = session_groups();
  c.groups.insert(c.groups.begin(), cli::ParameterGroup::of<session::CalibrationParams>("Calibration"));
  c.examples = {"trephine-sim calibrate library/sample --device udp --write-settings device.json",
                "trephine-sim calibrate library/sample --no-in-real-time"};
  c.run = run_calibrate;
  return c;
});

}  // namespace trephine::commands
