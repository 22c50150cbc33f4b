// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <iostream>

#include "base/error.h"
#include "base/png.h"
#include "base/write_file.h"
#include "cli/argument.h"
#include "cli/command.h"
#include "commands/session_options.h"
#include "commands/settings.h"
#include "render/stage.h"
#include "scene/bone_dust.h"

namespace trephine::commands {
namespace {

struct PictureParams {
  int width = 1280, height = 720;
  double frames_per_s = 30, from_s = 0, to_s = 0;
  template <class V>
  static void describe(V& v) {
    using P = PictureParams;
    v.integer(&P::width, "width", Range{16, 7680}, "Width of a picture, in pixels.");
    v.integer(&P::height, "height", Range{16, 4320}, "Height of a picture, in pixels.");
    v.number(&P::frames_per_s, "frames_per_s", Range{0.01, 240}, "Pictures for each second of a recording.");
    v.number(&P::from_s, "from_s", Range{0, 1e6}, "Time of the recording at which the pictures begin.");
    v.number(&P::to_s, "to_s", Range{0, 1e6}, "Time at which they end; 0: the recording's end.");
  }
};

class Pictures {
 public:
  Pictures(const cli::ParsedCommand& parsed, const cases::LoadedCase& loaded,
           const grid::Grid<std::int16_t>* uncut = nullptr)
      : params_(parsed.params<PictureParams>()),
        out_(parsed.path("out")),
        stage_(loaded, parsed.params<scene::ViewParams>(), uncut),
        camera_(scene::camera_of(parsed.params<scene::ViewParams>(), loaded.manifest, stage_.scene())),
        target_(params_.width, params_.height) {
    make_output_folder(out_);
    std::cout << fmt::format("drawn by {}\n", stage_.driver().renderer);
    if (!stage_.surfaces_by().empty())
      std::cout << fmt::format("surfaces that are cut are made by {}\n", stage_.surfaces_by());
    tell_notes();
  }
  render::Stage& stage() { return stage_; }
  const PictureParams& params() const { return params_; }

  void write() {
    const auto begin = std::chrono::steady_clock::now();
    stage_.draw(camera_, params_.width, params_.height, [this](render::Eye) { target_.bind(); });
    const scene::Picture picture = target_.read();
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    write_file(out_ / fmt::format("frame-{:05}.png", ++count_), png_of(picture.width, picture.height, 3, picture.rgb));
  }
  void print() {
    tell_notes();
    std::cout << fmt::format("graphics memory: {:.0f} MB\n", 1e-6 * double(stage_.renderer().graphics_bytes()));
    std::cout << fmt::format("{} pictures of {} x {} in {}, {:.0f} ms each\n", count_, params_.width, params_.height,
                             out_.string(), 1000 * seconds_ / count_);
    if (count_ > 1)
      std::cout << fmt::format("a film of them: ffmpeg -framerate {:g} -i {}/frame-%05d.png film.mp4\n",
                               params_.frames_per_s, out_.string());
  }

 private:
  // There may be more of them after each picture.
  void tell_notes() {
    for (; told_notes_ < stage_.notes().size(); ++told_notes_)
      std::cout << texts::text_of(stage_.notes()[told_notes_], texts::Language::english) << "\n";
  }

  const PictureParams params_;
  std::filesystem::path out_;
  render::Stage stage_;
  std::size_t told_notes_ = 0;
  scene::OrbitCamera camera_;
  render::OffscreenPicture target_;
  int count_ = 0;
  double seconds_ = 0;
};

void render_recording(const cli::ParsedCommand& parsed) {
  const Progress progress({}, &cancel_requested());
  const std::vector<std::string> named = parsed.all("before");
  session::Playback playback(parsed.path("case"), parsed.path("recording"), {named.begin(), named.end()}, {true},
                             progress);
  Pictures pictures(parsed, playback.loaded(), playback.patient()->uncut.get());
  scene::DustWatch dust = scene::dust_watch_of(playback);
  std::string tool;  // in hand in the picture before
  const PictureParams& p = pictures.params();
  const double begin = std::max(p.from_s, playback.begin_s()),
               end = p.to_s > 0 ? std::min(p.to_s, playback.end_s()) : playback.end_s();
  if (!(begin <= end))
    throw Error(ExitCode::usage, "", "--from-s",
                fmt::format("the recording lasts from {:.3f} to {:.3f} s", playback.begin_s(), playback.end_s()));
  const auto count = std::int64_t((end - begin) * p.frames_per_s + 1e-9) + 1;
  for (std::int64_t n = 0; n < count; ++n) {
    progress.check();
    playback.go_to(begin + double(n) / p.frames_per_s);
    if (playback.tool_name() != tool) {
      tool = playback.tool_name();
      pictures.stage().set_tool(playback.tool());
    }
    pictures.stage().follow(playback.marks());
    std::size_t incisions = 0;
    for (const session::IncisionMark& mark : playback.incisions()) incisions += mark.time_s <= playback.time_s();
    pictures.stage().show_incisions(playback.incisions(), incisions);
    if (pictures.stage().view().dust) dust.go_to(playback.frames(), playback.frame_number() + 1);
    pictures.stage().show_dust(dust.dust());
    pictures.stage().show_frame(playback.frame());
    pictures.write();
  }
  pictures.print();
}

ExitCode run_render(const cli::ParsedCommand& given) {
  const cli::ParsedCommand parsed = with_settings(given);
  write_settings(parsed);
  if (parsed.params<scene::ViewParams>().stereo == scene::ViewParams::Stereo::quad_buffer)
    throw Error(ExitCode::usage, "", "--stereo",
                "quad_buffer is of a window; a picture has side_by_side or top_bottom");
  const render::OffscreenContext context;
  render::driver_facts();
  if (parsed.has("recording")) {
    render_recording(parsed);
    return ExitCode::ok;
  }
  const cases::LoadedCase loaded = cases::load_case(parsed.path("case"), {true});
  Pictures pictures(parsed, loaded);
  pictures.write();
  pictures.print();
  return ExitCode::ok;
}

}  // namespace

const cli::OwnCommand render_command([] {
  cli::Command c;
  c.name = "render";
  c.summary = "draws a case, or a recording of a session with it, as PNG pictures without a display";
  c.description =
      "Without a recording there is one picture of the case. With one, the recording is run again, and there is a "
      "picture for each step of its time, with the tool, the contact, the bone as it is drilled then, and the "
      "incisions. The pictures are frame-00001.png and so on. It needs OpenGL 4.3 through EGL; Mesa draws on the "
      "processor where there is no graphics card. Exit code 74 says that there is no OpenGL, 80 that the recording "
      "gives another volume when it is run again.";
  cli::Argument folder = cli::argument("case", cli::Argument::Kind::in_folder, "Folder of the case.");
  folder.positional = folder.required = true;
  cli::Argument recording =
      cli::argument("recording", cli::Argument::Kind::in_file, "A recording of a session with that case.");
  recording.positional = true;
  cli::Argument out = cli::argument("out", cli::Argument::Kind::out_folder, "Folder for the pictures.");
  out.required = true;
  c.arguments = {folder, recording, before_argument(), out};
  for (const cli::Argument& a : settings_arguments()) c.arguments.push_back(a);
  c.groups = {cli::ParameterGroup::of<PictureParams>("Pictures"), cli::ParameterGroup::of<scene::ViewParams>("View")};
  c.examples = {"trephine-sim render library/sample --out pictures",
                "trephine-sim render library/sample --out pictures --cut sagittal --opacity skin=0.3",
                "trephine-sim render library/sample hole.servo --out pictures --frames-per-s 25 --stereo side_by_side"};
  c.run = run_render;
  return c;
});

}  // namespace trephine::commands
