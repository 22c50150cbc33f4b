// SPDX-License-Identifier: GPL-3.0-or-later
#include "dataset/recording_data.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "dataset/data_file.h"
#include "dataset/pose.h"
#include "dataset/shown_recording.h"
#include "dataset/voxel_events.h"
#include "haptics/tool.h"

namespace trephine::dataset {
namespace {

using Sides = std::vector<std::uint64_t>;
using Bgr = std::array<std::uint8_t, 3>;

constexpr const char* drill = "mastoidectomy_drill";  // the tool, whatever it is, by their name
constexpr Bgr tool_bgr{80, 80, 80};
constexpr std::size_t most_surfaces = 254;  // beside the background and the tool

constexpr const char* readme =
    "All position information is in meters unless specified otherwise. \n"
    "Quaternion is a list in the order of [qx, qy, qz, qw]. \n"
    "Poses are defined to be T_world_obj. \n"
    "Depth in CV convention (corrected by extrinsic, T_cv_ambf). \n"
    "The world is the patient: DICOM LPS (x to the left, y to the back, z upwards). \n"
    "Depth is along the line of sight, in meters; 0 where nothing is seen. \n"
    "The middle of pixel (u, v), counted from 0 at the upper left, lies at u and v of camera_intrinsic. \n"
    "data/label has the number of what is seen: metadata/label_names and metadata/label_bgr are listed by it. \n"
    "voxel_to_world takes the numbers of a voxel (i, j, k, 1) to its middle. \n"
    "Times are seconds since the recording's begin. \n";

// The columns are the camera's axes as AMBF has them: backwards, to the right, upwards.
constexpr std::int64_t cv_from_ambf[16] = {0, 1, 0, 0, 0, 0, -1, 0, -1, 0, 0, 0, 0, 0, 0, 1};

void append(std::vector<double>& to, const std::array<double, 7>& pose) {
  to.insert(to.end(), pose.begin(), pose.end());
}
Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

std::uint8_t byte_of(double share) { return std::uint8_t(std::lround(255 * std::clamp(share, 0.0, 1.0))); }

// The colour of each label, no two alike: one that is taken gets a little more of blue.
std::vector<Bgr> label_colours(const scene::SceneData& scene) {
  std::vector<Bgr> all{{0, 0, 0}, tool_bgr};
  for (const scene::SceneSurface& s : scene.surfaces) {
    Bgr c{byte_of(s.colour_rgb[2]), byte_of(s.colour_rgb[1]), byte_of(s.colour_rgb[0])};
    while (std::find(all.begin(), all.end(), c) != all.end()) ++c[0];
    all.push_back(c);
  }
  std::rotate(all.begin() + 1, all.begin() + 2, all.end());  // the tool is the last
  return all;
}

// From the tip to the tail, as volumetric_drilling's drill points along its x.
std::array<double, 7> tool_pose(const haptics::ServoFrame& f) {
  const Vec3 said = vec(f.axis);
  const Vec3 axis = is_finite(said) && norm(said) > 0 ? normalized(said) : Vec3{0, 0, 1};  // of a device that was lost
  const Mat3 frame = haptics::frame_of(axis, haptics::usable_across(vec(f.across), axis));
  return pose_of(vec(f.proxy_mm), {{axis, frame.column[0], frame.column[1]}});
}

void write_metadata(DataFile& file, const session::Playback& playback, const scene::EyeView& eye,
                    const RecordingDataOptions& o, const std::vector<Bgr>& colours,
                    const std::vector<std::string>& names) {
  file.group("metadata");
  const double fx = o.width / (eye.right_edge - eye.left), fy = o.height / (eye.top - eye.bottom);
  file.numbers("metadata/camera_intrinsic", {fx, 0, -eye.left * fx - 0.5, 0, fy, eye.top * fy - 0.5, 0, 0, 1}, {3, 3});
  file.whole_numbers("metadata/camera_extrinsic", {std::begin(cv_from_ambf), std::end(cv_from_ambf)}, {4, 4});
  file.text("metadata/README", readme);
  if (o.baseline_mm > 0) file.numbers("metadata/baseline", {o.baseline_mm / 1000}, {});
  const grid::Lattice& lattice = playback.loaded().haptic.voxels;
  file.numbers("metadata/voxel_volume", {lattice.voxel_volume_mm3()}, {});
  file.attribute("metadata/voxel_volume", "units", "mm^3, millimeters cubed");
  std::vector<double> to_world(16, 0);
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c)
      to_world[4 * r + c] = lattice.direction.column[c][int(r)] * lattice.spacing_mm[int(c)] / 1000;
    to_world[4 * r + 3] = lattice.origin_mm[int(r)] / 1000;
  }
  to_world[15] = 1;
  file.numbers("metadata/voxel_to_world", to_world, {4, 4});
  file.texts("metadata/label_names", names);
  std::vector<std::uint8_t> flat;
  for (const Bgr& c : colours) flat.insert(flat.end(), c.begin(), c.end());
  file.bytes("metadata/label_bgr", flat, {colours.size(), 3});
  const haptics::RecordingHeader& h = playback.header();
  file.text("metadata/case", h.case_token);
  file.text("metadata/case_sha256", h.case_sha256);
  file.text("metadata/recording_sha256", playback.recording().sha256);
  if (h.outcome) file.text("metadata/volume_sha256", h.outcome->volume_sha256);
}

void write_voxels(DataFile& file, const session::Playback& playback, const VoxelEvents& events,
                  const std::string& group) {
  file.group(group);
  if (events.voxels.empty()) return;  // as their recorder does
  std::vector<double> at, colour;
  for (const VoxelEvents::Voxel& v : events.voxels) {
    std::array<double, 3> rgb{0.8, 0.8, 0.8};
    for (const voxel::HapticShape& s : playback.loaded().haptic.shapes)
      if (s.number == v.shape)
        if (const cases::CaseAnatomy* a = playback.loaded().manifest.find_anatomy(s.name)) rgb = a->colour_rgb;
    const double step = double(v.step);
    at.insert(at.end(), {step, double(v.at[0]), double(v.at[1]), double(v.at[2])});
    colour.insert(colour.end(), {step, 255 * rgb[0], 255 * rgb[1], 255 * rgb[2], 255});
  }
  file.numbers(group + "/voxel_time_stamp", events.time_s, {events.time_s.size()});
  file.numbers(group + "/voxel_removed", at, {events.voxels.size(), 4});
  file.numbers(group + "/voxel_color", colour, {events.voxels.size(), 5});
}

// What the recording has in each tick, and when tools were taken.
void write_ticks(DataFile& file, const session::Playback& playback) {
  const std::vector<haptics::ServoFrame>& frames = playback.frames();
  std::vector<double> time, wrench, pose;
  for (const haptics::ServoFrame& f : frames) {
    time.push_back(f.time_s);
    wrench.insert(wrench.end(), {f.force_n[0], f.force_n[1], f.force_n[2], 0, 0, 0});
    append(pose, tool_pose(f));
  }
  file.group("burr_change");
  std::vector<double> when, diameter;
  std::vector<std::int64_t> size;
  for (const session::Playback::ToolTaken& t : playback.tools_taken()) {
    when.push_back(t.time_s);
    diameter.push_back(t.tool.tool_diameter_mm);
    size.push_back(std::llround(t.tool.tool_diameter_mm));
  }
  file.numbers("burr_change/time_stamp", when, {when.size()});
  file.whole_numbers("burr_change/burr_size", size, {size.size()});
  file.numbers("burr_change/diameter_mm", diameter, {diameter.size()});
  file.group("drill_force_feedback");
  file.numbers("drill_force_feedback/time_stamp", time, {time.size()});
  file.numbers("drill_force_feedback/wrench", wrench, {time.size(), 6});
  file.group("high_frequency_poses");
  const std::string own = std::string("high_frequency_poses/") + drill;
  file.group(own);
  file.numbers(own + "/pose", pose, {time.size(), 7});
  file.numbers(own + "/time_stamp", time, {time.size()});
}

// Draws one picture, as OpenCV orders its bytes.
class Pictures {
 public:
  Pictures(render::Stage& stage, int width, int height) : stage_(stage), target_(width, height) {}
  std::vector<std::uint8_t> bgr(const scene::EyeView& eye, int width, int height) {
    stage_.renderer().draw(eye, stage_.state, width, height);
    target_.bind();
    stage_.renderer().present(0, 0, width, height);
    scene::Picture p = target_.read();
    for (std::size_t n = 0; n + 2 < p.rgb.size(); n += 3) std::swap(p.rgb[n], p.rgb[n + 2]);
    return std::move(p.rgb);
  }

 private:
  render::Stage& stage_;
  render::OffscreenPicture target_;
};

void write_labels(DataFile& file, std::uint64_t row, const render::LabelPicture& seen,
                  const std::vector<Bgr>& colours) {
  std::vector<double> depth(seen.depth_mm.begin(), seen.depth_mm.end());
  for (double& d : depth) d /= 1000;
  std::vector<std::uint8_t> bgr;
  bgr.reserve(3 * seen.label.size());
  for (const std::uint8_t label : seen.label) bgr.insert(bgr.end(), colours[label].begin(), colours[label].end());
  file.row("data/depth", row, depth);
  file.row("data/segm", row, bgr);
  file.row("data/label", row, seen.label);
}

}  // namespace

RecordingDataResult write_recording_data(session::Playback& playback, render::Stage& stage,
                                         const scene::OrbitCamera& camera, const RecordingDataOptions& o,
                                         const std::filesystem::path& target, const Progress& progress) {
  if (stage.scene().surfaces.size() > most_surfaces)
    throw Error(ExitCode::bad_input, "", "anatomies",
                "the case shows " + std::to_string(stage.scene().surfaces.size()) + ", and labels are numbers to 255");
  const scene::EyeView eye = camera.eye(o.width, o.height, stage.scene().bounds);
  const std::vector<Bgr> colours = label_colours(stage.scene());
  std::vector<std::string> names{"background"};
  for (const scene::SceneSurface& s : stage.scene().surfaces) names.push_back(s.name);
  names.emplace_back("tool");

  DataFile file;
  write_metadata(file, playback, eye, o, colours, names);
  const std::vector<session::Playback::VoxelChange> changes = playback.voxel_changes();
  const voxel::HapticVolume& volume = playback.loaded().haptic;
  const VoxelEvents removed = voxel_events(volume, changes, VoxelEvent::removed);
  write_voxels(file, playback, removed, "voxels_removed");
  write_voxels(file, playback, voxel_events(volume, changes, VoxelEvent::restored), "voxels_restored");
  write_ticks(file, playback);

  file.group("data");
  const std::uint64_t count = o.times_s.size(), h = std::uint64_t(o.height), w = std::uint64_t(o.width);
  const bool stereo = o.baseline_mm > 0;
  file.begin_bytes("data/l_img", {count, h, w, 3});
  if (stereo) file.begin_bytes("data/r_img", {count, h, w, 3});
  file.begin_numbers("data/depth", {count, h, w});
  file.begin_bytes("data/segm", {count, h, w, 3});
  file.begin_bytes("data/label", {count, h, w});
  file.attribute("data/depth", "units", "m");
  scene::EyeView left = eye, right = eye;
  left.eye_mm -= eye.right * (0.5 * o.baseline_mm);
  right.eye_mm += eye.right * (0.5 * o.baseline_mm);

  ShownRecording shown(playback, stage);
  Pictures pictures(stage, o.width, o.height);
  std::vector<double> time, tool, main_camera, patient;
  const grid::Lattice& lattice = volume.voxels;
  const Vec3 middle =
      lattice.to_world_mm({0.5 * (lattice.size[0] - 1), 0.5 * (lattice.size[1] - 1), 0.5 * (lattice.size[2] - 1)});
  Mat3 axes = lattice.direction;
  axes.column[2] = cross(axes.column[0], axes.column[1]);  // a quaternion has no mirror; voxel_to_world has
  for (std::uint64_t n = 0; n < count; ++n) {
    progress.check();
    progress.report(double(n) / double(count));
    shown.go_to(o.times_s[n]);
    stage.state.device_mm.reset();  // a camera sees neither of them
    stage.state.contact_mm.reset();
    file.row("data/l_img", n, pictures.bgr(left, o.width, o.height));
    if (stereo) file.row("data/r_img", n, pictures.bgr(right, o.width, o.height));
    write_labels(file, n, render::draw_labels(stage.renderer(), eye, stage.state, o.width, o.height), colours);
    time.push_back(o.times_s[n]);
    append(tool, tool_pose(playback.frame()));
    append(main_camera, pose_of(eye.eye_mm, {{eye.toward, eye.right, eye.up}}));
    append(patient, pose_of(middle, axes));
  }
  file.numbers("data/time", time, {count});
  file.numbers(std::string("data/pose_") + drill, tool, {count, 7});
  file.numbers("data/pose_main_camera", main_camera, {count, 7});
  file.numbers("data/pose_mastoidectomy_volume", patient, {count, 7});
  return {count, removed.voxels.size(), file.commit(target)};
}

}  // namespace trephine::dataset
