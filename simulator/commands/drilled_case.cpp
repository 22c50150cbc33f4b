// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/drilled_case.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/refusal.h"
#include "cases/new_case.h"
#include "haptics/recording.h"
#include "lessons/drilled_hole.h"
#include "session/playback.h"
#include "voxel/cut.h"
#include "voxel/haptic_file.h"

namespace trephine::commands {
namespace {

// "meshes/skull-0123456789abcdef.glb" is "meshes/skull" and ".glb".
cases::CaseFile copy_file(const std::filesystem::path& from, const cases::CaseFile& file,
                          const std::filesystem::path& out) {
  const std::size_t dash = file.name.rfind('-'), dot = file.name.rfind('.');
  if (dash == std::string::npos || dot == std::string::npos || dot < dash)
    throw Error(ExitCode::bad_input, from.string(), file.name, "is no name of a case's file");
  return cases::write_case_file(out, file.name.substr(0, dash), file.name.substr(dot),
                                cases::read_case_file(from, file));
}

// The way out of the bone, as the tool was held while it cut.
Vec3 held_axis(const std::vector<haptics::ServoFrame>& frames) {
  Vec3 sum;
  for (const haptics::ServoFrame& f : frames)
    if (f.buttons & haptics::Drilling::pedal) sum += {f.axis[0], f.axis[1], f.axis[2]};
  return sum;
}

// What was drilled through, so that whoever uses the case knows of it: a lesson does not score such a hole.
void add_hole(const voxel::HapticVolume& before, const voxel::HapticVolume& now, const cases::CaseShape& shape,
              Vec3 out, cases::CaseManifest& m) {
  if (!(norm(out) > 0)) return;
  lessons::HoleSearch search;
  search.bone = shape.number;
  search.out = out;
  const std::optional<lessons::BoneHole> found = lessons::find_drilled_hole(before, now, search);
  if (!found || !found->through) return;
  const double thick_mm = norm(found->outer_mm - found->inner_mm);
  if (!(thick_mm > 0)) return;
  cases::CaseBurrHole hole;
  const auto taken = [&](const std::string& name) {
    return std::any_of(m.burr_holes.begin(), m.burr_holes.end(), [&](const auto& b) { return b.name == name; });
  };
  for (int n = 1; hole.name.empty() || taken(hole.name); ++n) hole.name = "drilled_" + std::to_string(n);
  hole.position_mm = found->outer_mm;
  hole.direction = -found->out;
  hole.diameter_mm = 2 * std::sqrt(found->removed_mm3 / (M_PI * thick_mm));
  hole.cut = {shape.name};
  hole.figures = {{"bone_thickness_mm", thick_mm}, {shape.name + ".removed_haptic_mm3", found->removed_mm3}};
  m.burr_holes.push_back(std::move(hole));
}

// Removes what was begun and has not become a case.
struct Removed {
  const std::filesystem::path folder;  ///< empty: nothing
  ~Removed() {
    std::error_code ignored;
    if (!folder.empty()) std::filesystem::remove_all(folder, ignored);
  }
};

}  // namespace

std::string write_drilled_case(const std::filesystem::path& case_folder, const std::filesystem::path& file,
                               const std::filesystem::path& out, const std::vector<std::filesystem::path>& before) {
  const haptics::Recording recording = haptics::read_recording(file);
  const haptics::RecordingHeader& h = recording.header;
  if (!h.drilling.drill) throw Error(ExitCode::bad_input, file.string(), "drilling", "nothing was cut in this session");
  const std::shared_ptr<session::Patient> patient = session::patient_again(case_folder, file, h, h.contact, before);
  session::FeltCase& felt = patient->felt;
  const voxel::HapticVolume before_it = voxel::copy_without_hardness(felt.loaded.haptic);
  session::Rerun(felt, patient->contact, file.string(), h).run(recording.frames);
  const voxel::HapticVolume& volume = felt.loaded.haptic;
  if (h.outcome && haptics::volume_digest(volume) != h.outcome->volume_sha256)
    throw refusal("volume_sha256", "the volume differs when replayed",
                  {"replay it with the version of the program that recorded it, or record it anew with `servo`"})
        .in_file(file.string());

  const bool is_new = cases::is_free_for_case(out);
  const std::filesystem::path made_in = is_new ? cases::new_case_folder(out) : out;
  const Removed removed{is_new ? made_in : std::filesystem::path()};
  if (is_new) std::filesystem::remove_all(made_in);
  cases::CaseManifest m = felt.loaded.manifest;
  const std::string whole = m.haptic.file;
  m.case_token = m.case_token.substr(0, 56) + "-drilled";
  for (cases::CaseFile& f : m.files) {
    if (f.name != whole) {
      f = copy_file(case_folder, f, made_in);
      continue;
    }
    f = cases::write_case_file(made_in, "haptic", ".nrrd", voxel::encode_haptic(volume));
    m.haptic.file = f.name;
  }
  std::sort(m.files.begin(), m.files.end(),
            [](const cases::CaseFile& a, const cases::CaseFile& b) { return a.name < b.name; });
  for (cases::CaseShape& s : m.haptic.shapes) s.volume_ml = voxel::shape_volume_mm3(volume, s.number) / 1000;
  const std::uint64_t drilled = haptics::drilled_shapes(m.haptic);
  for (const cases::CaseShape& s : m.haptic.shapes)
    if (drilled >> s.number & 1) add_hole(before_it, volume, s, held_axis(recording.frames), m);
  m.parameters.emplace_back("drilled.recording_sha256", recording.sha256);
  cases::publish_case(made_in, m);
  if (is_new) cases::let_case_appear(made_in, out);
  return m.case_token;
}

}  // namespace trephine::commands
