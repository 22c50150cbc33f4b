// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <iostream>

#include "base/error.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "commands/session_options.h"
#include "commands/settings.h"
#include "session/session.h"
#include "session/touch_marks.h"

namespace trephine::commands {
namespace {

struct SheetParams {
  enum class Mirror { none, left_right, up_down };
  Mirror mirror = Mirror::none;
  template <class V>
  static void describe(V& v) {
    v.choice(&SheetParams::mirror, "mirror",
             {{"none", Mirror::none}, {"left_right", Mirror::left_right}, {"up_down", Mirror::up_down}},
             "Mirror the sheet of marks, as `play --mirror` mirrors its window.");
  }
};

ExitCode run_register(const cli::ParsedCommand& given) {
  const cli::ParsedCommand parsed = with_settings(given);
  const session::RegisterParams& params = parsed.params<session::RegisterParams>();
  if (!(params.screen_width_mm > 0) || !(params.screen_height_mm > 0))
    throw Error(ExitCode::usage, "", "--screen-width-mm, --screen-height-mm", "are needed: measure the picture");
  if (!parsed.has("sheet") && !parsed.has("out"))
    throw Error(ExitCode::usage, "", "--out, --sheet", "one of them says what is to be done");
  if (parsed.has("sheet")) {
    const SheetParams::Mirror mirror = parsed.params<SheetParams>().mirror;
    write_file(parsed.path("sheet"),
               session::marks_sheet(params, mirror == SheetParams::Mirror::left_right ? "scaleX(-1)"
                                            : mirror == SheetParams::Mirror::up_down  ? "scaleY(-1)"
                                                                                      : ""));
    std::cout << fmt::format("open {} in a browser, on the whole screen\n", parsed.text("sheet"));
  }
  if (!parsed.has("out")) return ExitCode::ok;
  const session::SessionOptions o = session_options_of(parsed);
  const auto say = [](const std::string& line) { std::cout << line << "\n" << std::flush; };
  session::Patient patient(o.case_folder, o.shape, o.contact);
  const device::DeviceScene scene = touched_scene(patient, params.in_real_time, say);
  const std::unique_ptr<device::Device> device = device::make_device(o.device, scene);
  const device::ScreenRegistration r = session::register_screen(*device, params, cancel_requested(), say);
  write_file(parsed.path("out"), device::to_json(r));
  say(fmt::format("{} marks, RMS {:.2f} mm, the worst {:.2f} mm; a mm of the device is {:.3f} mm before the screen",
                  r.marks_count, r.rms_mm, r.worst_mm, r.scale));
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand register_command([] {
  cli::Command c;
  c.name = "register";
  c.summary = "finds where a device lies before the screen of a mirror workbench";
  c.description =
      "Marks on the screen are touched with the device one after the other, as they are seen (in the mirror), each "
      "with button 1 held. The rigid transform that meets them best is written to --out, for `trephine-sim play "
      "--screen`; how far the marks are missed is printed, and a registration that misses one by more than "
      "--largest-residual-mm is refused (80). --sheet writes a page with the marks, to be shown on the whole screen.";
  c.arguments = measuring_arguments();
  c.arguments.push_back(
      cli::argument("out", cli::Argument::Kind::out_file, "Register the device, and write the result to this file."));
  c.arguments.push_back(
      cli::argument("sheet", cli::Argument::Kind::out_file, "Write a page (.html) that shows the marks."));
  c.groups = session_groups();
  c.groups.insert(c.groups.begin(), {cli::ParameterGroup::of<session::RegisterParams>("Registration"),
                                     cli::ParameterGroup::of<SheetParams>("The sheet of marks")});
  c.examples = {"trephine-sim register library/sample --screen-width-mm 520 --screen-height-mm 325 --sheet marks.html",
                "trephine-sim register library/sample --device udp --screen-width-mm 520 --screen-height-mm 325 "
                "--out bench.json"};
  c.run = run_register;
  return c;
});

}  // namespace trephine::commands
