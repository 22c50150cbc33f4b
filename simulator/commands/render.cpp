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
#include "dataset/recording_data.h"
#include "dataset/shown_recording.h"
#include "render/stage.h"

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

/// Where the camera stands, where that is no preset of the view.
struct CameraParams {
  std::array<double, 3> eye_mm{0, 0, 0}, target_mm{0, 0, 0}, up{0, 0, 1};
  template <class V>
  static void describe(V& v) {
    using P = CameraParams;
    v.numbers(&P::eye_mm, "eye_mm", Range{-1e5, 1e5},
              "Where the camera stands, LPS. Where it is also target_mm, it stands where --view says.");
    v.numbers(&P::target_mm, "target_mm", Range{-1e5, 1e5}, "What it looks at, LPS.");
    v.numbers(&P::up, "up", Range{-1, 1}, "A direction, LPS, that is upwards in the picture.");
  }
  bool given() const { return eye_mm != target_mm; }
  std::string fault() const {
    const Vec3 toward = of(eye_mm) - of(target_mm);
    if (!given() || norm(cross(of(up), toward)) > 1e-6 * norm(toward)) return "";
    return "up: must not be 0, nor lie along the line of sight";
  }
  void place(scene::OrbitCamera& camera) const {
    camera.target_mm = of(target_mm);
    camera.distance_mm = norm(of(eye_mm) - of(target_mm));
    camera.toward = normalized(of(eye_mm) - of(target_mm));
    camera.up = normalized(cross(camera.toward, cross(of(up), camera.toward)));
  }

 private:
  static Vec3 of(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }
};

struct DataParams {
  double baseline_mm = 0;
  template <class V>
  static void describe(V& v) {
    using P = DataParams;
    v.number(&P::baseline_mm, "baseline_mm", Range{0, 200},
             "Two pictures of cameras so far apart, left and right of the one that sees depth and labels; 0: one.");
  }
};

scene::OrbitCamera camera_of(const cli::ParsedCommand& parsed, const render::Stage& stage) {
  scene::OrbitCamera camera =
      scene::camera_of(parsed.params<scene::ViewParams>(), stage.loaded().manifest, stage.scene());
  if (const auto& own = parsed.params<CameraParams>(); own.given()) own.place(camera);
  return camera;
}

// The times of the recording that are seen. Throws Error 64 where it has none of them.
std::vector<double> times_of(const PictureParams& p, const session::Playback& playback) {
  const double begin = std::max(p.from_s, playback.begin_s()),
               end = p.to_s > 0 ? std::min(p.to_s, playback.end_s()) : playback.end_s();
  if (!(begin <= end))
    throw Error(ExitCode::usage, "", "--from-s",
                fmt::format("the recording lasts from {:.3f} to {:.3f} s", playback.begin_s(), playback.end_s()));
  std::vector<double> times(std::size_t((end - begin) * p.frames_per_s + 1e-9) + 1);
  for (std::size_t n = 0; n < times.size(); ++n) times[n] = begin + double(n) / p.frames_per_s;
  return times;
}

session::Playback playback_of(const cli::ParsedCommand& parsed, const Progress& progress) {
  const std::vector<std::string> named = parsed.all("before");
  return session::Playback(parsed.path("case"), parsed.path("recording"), {named.begin(), named.end()}, {true},
                           progress);
}

class Pictures {
 public:
  Pictures(const cli::ParsedCommand& parsed, const cases::LoadedCase& loaded,
           const grid::Grid<std::int16_t>* uncut = nullptr)
      : params_(parsed.params<PictureParams>()),
        out_(parsed.path("out")),
        stage_(loaded, parsed.params<scene::ViewParams>(), uncut),
        camera_(camera_of(parsed, stage_)),
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
  session::Playback playback = playback_of(parsed, progress);
  Pictures pictures(parsed, playback.loaded(), playback.patient()->uncut.get());
  dataset::ShownRecording shown(playback, pictures.stage());
  for (const double time_s : times_of(pictures.params(), playback)) {
    progress.check();
    shown.go_to(time_s);
    pictures.write();
  }
  pictures.print();
}

void write_data(const cli::ParsedCommand& parsed) {
  scene::ViewParams view = parsed.params<scene::ViewParams>();
  const auto alone = [](bool fits, const char* flag, const char* why) {
    if (!fits) throw Error(ExitCode::usage, "", flag, std::string("is not for --hdf5: ") + why);
  };
  if (!parsed.has("recording"))
    throw Error(ExitCode::usage, "", "--hdf5", "is of a recording, which must be given after the case");
  alone(view.stereo == scene::ViewParams::Stereo::none, "--stereo", "--baseline-mm gives a picture for each eye");
  alone(view.cut == scene::ViewParams::Cut::none, "--cut", "depth and labels are of whole surfaces");
  alone(view.cast == scene::ViewParams::Cast::none, "--cast", "rays through a volume see no one depth");
  alone(!view.insets, "--insets", "they would hide what is seen");
  view.places = false;
  const Progress progress({}, &cancel_requested());
  session::Playback playback = playback_of(parsed, progress.part(0, 0.2));
  playback.require_same_frames(parsed.path("recording"));
  render::Stage stage(playback.loaded(), view, playback.patient()->uncut.get());
  const auto& p = parsed.params<PictureParams>();
  const dataset::RecordingDataOptions options{p.width, p.height, times_of(p, playback),
                                              parsed.params<DataParams>().baseline_mm};
  const dataset::RecordingDataResult made = dataset::write_recording_data(
      playback, stage, camera_of(parsed, stage), options, parsed.path("hdf5"), progress.part(0.2, 1));
  std::cout << fmt::format("drawn by {}\n", stage.driver().renderer);
  for (const texts::Note& note : stage.notes()) std::cout << texts::text_of(note, texts::Language::english) << "\n";
  std::cout << fmt::format("{} frames of {} x {}, {} voxels removed, {:.1f} MB in {}\n", made.frames, p.width, p.height,
                           made.voxels_removed, 1e-6 * double(made.bytes), parsed.text("hdf5"));
}

ExitCode run_render(const cli::ParsedCommand& given) {
  const cli::ParsedCommand parsed = with_settings(given);
  write_settings(parsed);
  if (parsed.params<scene::ViewParams>().stereo == scene::ViewParams::Stereo::quad_buffer)
    throw Error(ExitCode::usage, "", "--stereo",
                "quad_buffer is of a window; a picture has side_by_side or top_bottom");
  if (!parsed.has("out") && !parsed.has("hdf5"))
    throw Error(ExitCode::usage, "", "--out, --hdf5", "one of them must be given");
  const render::OffscreenContext context;
  render::driver_facts();
  if (parsed.has("hdf5")) write_data(parsed);
  if (!parsed.has("out")) return ExitCode::ok;
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
      "gives another volume, or with --hdf5 any other bit, when it is run again.\n\n"
      "--hdf5 writes a recording as data for those who learn from it, in the layout of volumetric_drilling's recorder: "
      "colour, depth and labels from any camera, the poses of tool and camera, intrinsics and extrinsics, and the "
      "voxels that were removed.";
  cli::Argument folder = cli::argument("case", cli::Argument::Kind::in_folder, "Folder of the case.");
  folder.positional = folder.required = true;
  cli::Argument recording =
      cli::argument("recording", cli::Argument::Kind::in_file, "A recording of a session with that case.");
  recording.positional = true;
  cli::Argument out = cli::argument("out", cli::Argument::Kind::out_folder, "Folder for the pictures.");
  const cli::Argument data = cli::argument("hdf5", cli::Argument::Kind::out_file,
                                           "Write pictures, depth, labels and poses of the recording to this file.");
  c.arguments = {folder, recording, before_argument(), out, data};
  for (const cli::Argument& a : settings_arguments()) c.arguments.push_back(a);
  c.groups = {cli::ParameterGroup::of<PictureParams>("Pictures"), cli::ParameterGroup::of<CameraParams>("Camera"),
              cli::ParameterGroup::of<DataParams>("Data"), cli::ParameterGroup::of<scene::ViewParams>("View")};
  c.examples = {"trephine-sim render library/sample --out pictures",
                "trephine-sim render library/sample --out pictures --cut sagittal --opacity skin=0.3",
                "trephine-sim render library/sample hole.servo --out pictures --frames-per-s 25 --stereo side_by_side",
                "trephine-sim render library/sample hole.servo --hdf5 hole.hdf5 --width 640 --height 480"};
  c.run = run_render;
  return c;
});

}  // namespace trephine::commands
