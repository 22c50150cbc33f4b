// SPDX-License-Identifier: GPL-3.0-or-later
#include "ambf/adf.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "ambf/tool_meshes.h"
#include "base/error.h"
#include "base/pi.h"
#include "base/text.h"
#include "voxel/drilled.h"

namespace trephine::ambf {
namespace {

constexpr int largest_texture = 2048;
constexpr double per_mm = 0.001, field_view_rad = 0.6, mark_mm = 3, beside_m = 0.02;
constexpr const char* origin_name = "case_anatomical_origin";

struct Angles {
  double r = 0, p = 0, y = 0;
};

// Of a rotation R = Rz(y) Ry(p) Rx(r).
Angles angles_of(const Mat3& m) {
  const auto at = [&](int row, int column) { return m.column[std::size_t(column)][row]; };
  const double p = std::asin(std::clamp(-at(2, 0), -1.0, 1.0));
  if (std::abs(at(2, 0)) < 1 - 1e-12) return {std::atan2(at(2, 1), at(2, 2)), p, std::atan2(at(1, 0), at(0, 0))};
  return {0, p, std::atan2(-at(0, 1), at(1, 1))};  // upright: roll and yaw are one
}

std::string number(double v) { return to_text(v + 0.0); }
std::string place(Vec3 v) { return "{x: " + number(v.x) + ", y: " + number(v.y) + ", z: " + number(v.z) + "}"; }
std::string turned(const Angles& a) {
  return "{r: " + number(a.r) + ", p: " + number(a.p) + ", y: " + number(a.y) + "}";
}
std::string location(Vec3 at, const Angles& angles) {
  return "  location:\n    position: " + place(at) + "\n    orientation: " + turned(angles) + "\n";
}

/// Where everything stands: the patient's frame in the world, in metres, and the volume in it.
struct Stage {
  Mat3 patient;           ///< directions of the patient's axes in the world
  Vec3 patient_m;         ///< its origin there
  Vec3 volume_m, size_m;  ///< of the volume's middle in the patient's frame
  Mat3 volume;
  double distance_m = 1;  ///< from the camera, which stands at the world's origin
  Vec3 in_world(Vec3 lps_mm) const { return patient_m + patient * (lps_mm * per_mm); }
};

// The patient's left, back and up as they lie in the world of a camera that looks along -x with z up.
Mat3 seen_from(View view) {
  Mat3 m;
  switch (view) {
    case View::anterior:
      m.column = {Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}};
      break;
    case View::posterior:
      m.column = {Vec3{0, -1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}};
      break;
    case View::left:
      m.column = {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
      break;
    case View::right:
      m.column = {Vec3{-1, 0, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}};
      break;
    case View::superior:  // the face up
      m.column = {Vec3{0, -1, 0}, Vec3{0, 0, -1}, Vec3{1, 0, 0}};
      break;
  }
  return m;
}

Stage stage_of(const grid::Lattice& l, View view) {
  Stage s;
  s.volume = l.direction;
  if (determinant(l.direction) < 0) s.volume.column[2] = -s.volume.column[2];
  Vec3 last;
  for (int a = 0; a < 3; ++a) {
    last[a] = l.size[std::size_t(a)] - 1.0;
    s.size_m[a] = l.size[std::size_t(a)] * l.spacing_mm[a] * per_mm;
  }
  s.volume_m = l.to_world_mm(last / 2) * per_mm;
  s.patient = seen_from(view);
  s.distance_m = 0.5 * norm(s.size_m) / std::sin(field_view_rad / 2);
  s.patient_m = Vec3{-s.distance_m, 0, 0} - s.patient * s.volume_m;
  return s;
}

const char* body_end =
    "  passive: true\n  publish children names: false\n  publish joint names: false\n  publish joint positions: "
    "false\n";

std::string mark_body(const std::string& name, Vec3 at_m, const char* rgb) {
  return "BODY " + name + ":\n  name: " + name +
         "\n  mesh: mark.obj\n  collision mesh: ''\n  mass: 0.0\n  scale: " + number(per_mm) + "\n" +
         location(at_m, {}) + body_end + "  visible: true\n  collision groups: []\n  use material: false\n" +
         "  color components:\n    ambient: {level: 1.0}\n    diffuse: " + rgb +
         "\n    specular: {r: 0.0, g: 0.0, b: 0.0}\n    transparency: 1.0\n";
}

struct Mark {
  std::string name;
  Vec3 at_mm;
  const char* rgb;
};
// Names of bodies are letters, digits and underscores, and each is there once.
std::vector<Mark> marks_of(const cases::CaseManifest& m) {
  std::vector<Mark> all;
  for (const auto& l : m.landmarks) all.push_back({"landmark_" + l.name, l.position_mm, "{r: 0.2, g: 0.7, b: 0.3}"});
  for (const auto& t : m.targets) all.push_back({"target_" + t.name, t.position_mm, "{r: 0.9, g: 0.3, b: 0.2}"});
  for (const auto& h : m.burr_holes) all.push_back({"hole_" + h.name, h.position_mm, "{r: 0.2, g: 0.6, b: 0.95}"});
  for (Mark& mark : all)
    for (char& c : mark.name)
      if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return all;
}

std::string head_text(const std::string& program, const std::string& what) {
  return "# AMBF Version: (0.1)\n# Made by " + program + ": " + what + ".\n";
}

std::string volume_text(const cases::LoadedCase& loaded, const Stage& s, const std::string& program) {
  const std::vector<Mark> marks = marks_of(loaded.manifest);
  std::string out =
      head_text(program, "the haptic volume of case " + loaded.manifest.case_token + ". Metres; the frame of " +
                             origin_name + " is the patient's: DICOM LPS, x to the left, y posterior, z superior");
  out += "bodies:\n- BODY " + std::string(origin_name) + "\n";
  for (const Mark& mark : marks) out += "- BODY " + mark.name + "\n";
  out +=
      "joints: []\nvolumes: [VOLUME mastoidectomy_volume]\nhigh resolution path: ./meshes/high_res/\nlow resolution "
      "path: ./meshes/low_res/\nignore inter-collision: true\nnamespace: /ambf/env/\n\n";
  out +=
      "VOLUME mastoidectomy_volume:\n  name: mastoidectomy_volume\n  parent: BODY " + std::string(origin_name) + "\n";
  out += location(s.volume_m, angles_of(s.volume)) + "  scale: 1.0\n  dimensions: " + place(s.size_m) +
         "\n  images:\n    path: ./" + stack_folder + "/\n    prefix: " + stack_prefix +
         "\n    format: png\n    count: " + std::to_string(loaded.haptic.voxels.size[2]) +
         "\n  shaders:\n    path: ../shaders/volume_matcap/\n    vertex: shader.vs\n    fragment: shader.fs\n\n";
  out += "BODY " + std::string(origin_name) + ":\n  name: " + origin_name + "\n  mesh: ''\n  mass: 0.0\n" +
         location(s.patient_m, angles_of(s.patient)) + "\n";
  out += marks.empty() ? "fiducial_locations: {}\n" : "fiducial_locations:\n";
  for (const Mark& mark : marks) out += "  " + mark.name + ": " + place(mark.at_mm * per_mm) + "\n";
  for (const Mark& mark : marks) out += "\n" + mark_body(mark.name, s.in_world(mark.at_mm), mark.rgb);
  return out;
}

std::string drill_body(const std::string& name, const std::string& mesh, Vec3 at_m, bool visible) {
  std::string out = "BODY " + name + ":\n  name: " + name + "\n  mesh: " + (mesh.empty() ? "''" : mesh) + "\n";
  out += mesh.empty() ? "  collision mesh: ''\n  collision mesh type: ''\n" : "  collision mesh type: CONCAVE_MESH\n";
  out += "  mass: 0.0\n  inertia: {ix: 0.0, iy: 0.0, iz: 0.0}\n  collision margin: 0.001\n  scale: " +
         (mesh.empty() ? std::string("1.0") : number(per_mm)) + "\n" + location(at_m, {});
  out += "  inertial offset:\n    position: {x: 0.0, y: 0.0, z: 0.0}\n    orientation: {r: 0, p: 0, y: 0}\n";
  if (mesh.empty())
    return out +
           "  passive: false\n  color: random\n  publish children names: false\n  publish joint names: false\n"
           "  publish joint positions: false\n";
  return out + body_end + "  friction: {rolling: 0.0, static: 0.5}\n  restitution: 0.1\n" +
         "  damping: {angular: 0.1, linear: 0.04}\n  visible: " + (visible ? "true" : "false") +
         "\n  collision groups: []\n  use material: false\n  color components:\n    ambient: {level: 1.0}\n" +
         "    diffuse: {r: 0.53162, g: 0.50121, b: 0.51455}\n    specular: {r: 0.42128, g: 0.39719, b: 0.39719}\n" +
         "    transparency: 1.0\n";
}

std::string drills_text(const Stage& s, const std::string& program) {
  const Vec3 at{-s.distance_m + 0.5 * norm(s.size_m) + beside_m, 0, 0};  // between the patient and the camera
  std::string out = head_text(program, "the burrs that volumetric_drilling knows, of these diameters") + "bodies:\n";
  for (const int mm : burrs_mm) out += "- BODY " + std::to_string(mm) + "mm\n";
  out +=
      "- BODY mastoidectomy_drill\njoints: []\nhigh resolution path: ./meshes/high_res/\nlow resolution path: "
      "./meshes/low_res/\nignore inter-collision: true\nnamespace: /ambf/env/\nshaders:\n  path: ../shaders/matcap/\n"
      "  vertex: shader.vs\n  fragment: shader.fs\n";
  for (const int mm : burrs_mm)
    out += drill_body(std::to_string(mm) + "mm", std::to_string(mm) + "mm.obj", at, mm == burrs_mm[2]);
  return out + drill_body("mastoidectomy_drill", "", at, false);
}

std::string world_text(const Stage& s, const std::string& program) {
  const double near = std::max(0.01, s.distance_m - norm(s.size_m));
  return head_text(program, "the camera, which sees the whole volume") +
         "enclosure size: {length: 10.0, width: 10.0, height: 3.0}\nlights: [light1]\ncameras: [main_camera]\n"
         "environment: ../world/checkered_floor.yaml\nnamespace: /ambf/env/\nmax iterations: 50\n"
         "gravity: {x: 0.0, y: 0.0, z: -0.0}\nconversion factor: 1.0\n\n"
         "light1:\n  namespace: lights/\n  name: light1\n  location: {x: 0.0, y: 0.0, z: 0.0025}\n"
         "  direction: {x: -1.0, y: 0.0, z: 0.0}\n  spot exponent: 0.3\n  shadow quality: 5\n  cutoff angle: 0.5\n"
         "  parent: main_camera\n\n"
         "main_camera:\n  namespace: cameras/\n  name: main_camera\n  location: {x: 0.0, y: 0.0, z: 0.0}\n  look at: " +
         place({-s.distance_m, 0, 0}) + "\n  up: {x: 0.0, y: 0.0, z: 1.0}\n  clipping plane: {near: " + number(near) +
         ", far: 50.0}\n  field view angle: " + number(field_view_rad) +
         "\n  monitor: 0\n  visible: true\n  publish image interval: 5\n"
         "  publish image resolution: {width: 640, height: 480}\n";
}

std::string launch_text(const std::string& program) {
  return head_text(program, "start with `ambf_simulator --launch_file ADF/FOLDER/launch.yaml -l 0,1`") +
         "world config: ./world.yaml\ncolor config: ../color/colors.yaml\n"
         "input devices config: ../input_devices/input_devices.yaml\nplugins: [\n  {\n    name: DRILLING_SIMULATOR,\n"
         "    filename: libvolumetric_drilling.so,\n    path: ../../build/\n  }\n]\nmultibody configs:\n"
         "  - \"./drills.yaml\" #0\n  - \"./volume.yaml\" #1\n";
}

}  // namespace

Palette palette_of(const cases::CaseManifest& manifest) {
  Palette all(1 + voxel::haptic_max_shapes, Rgb{});
  for (const cases::CaseShape& s : manifest.haptic.shapes) {
    const cases::CaseAnatomy* a = manifest.find_anatomy(s.name);
    const auto& rgb = a ? a->colour_rgb : s.material.colour_rgb;
    Rgb& own = all[std::size_t(s.number)];
    for (std::size_t c = 0; c < 3; ++c) own[c] = std::uint8_t(std::lround(255 * rgb[c]));
    if (s.cuttable) own = drilled_rgb;
  }
  return all;
}

std::vector<meshio::ExportFile> encode_adf(const cases::LoadedCase& loaded, const AdfParams& params,
                                           const std::string& program) {
  if (!loaded.has_haptic())
    throw Error(ExitCode::bad_input, "", "haptic",
                "the case holds no haptic volume, and nothing else can be drilled; run it again with a scene that says "
                "what is felt");
  const grid::Lattice& l = loaded.haptic.voxels;
  for (const int n : l.size)
    if (n > largest_texture)
      throw Error(ExitCode::bad_input, "", "haptic",
                  "has " + std::to_string(n) + " voxels along an axis, and a texture at most " +
                      std::to_string(largest_texture) + "; run the case again with a larger haptic.spacing_mm");
  const Stage stage = stage_of(l, params.ambf_view);
  std::vector<meshio::ExportFile> files{{"volume.yaml", volume_text(loaded, stage, program)},
                                        {"drills.yaml", drills_text(stage, program)},
                                        {"world.yaml", world_text(stage, program)},
                                        {"launch.yaml", launch_text(program)}};
  for (meshio::ExportFile& f : tool_meshes(mark_mm))
    for (const char* folder : {"meshes/high_res/", "meshes/low_res/"}) files.push_back({folder + f.name, f.bytes});
  for (meshio::ExportFile& f : encode_stack(voxel::shown_shapes(loaded.haptic), palette_of(loaded.manifest)))
    files.push_back({std::string(stack_folder) + "/" + f.name, std::move(f.bytes)});
  return files;
}

}  // namespace trephine::ambf
