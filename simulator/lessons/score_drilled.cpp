// SPDX-License-Identifier: GPL-3.0-or-later
#include "lessons/score_drilled.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/log.h"
#include "cases/load_hashed.h"
#include "grid/bounded_read.h"
#include "lesson/approval.h"
#include "lessons/lesson_type.h"
#include "voxel/drilled.h"

namespace trephine::lessons {
namespace {

// Both have each voxel in the same place; directions that were written and read again may differ in the last digit.
bool are_alike(const grid::Lattice& a, const grid::Lattice& b) {
  constexpr double off_mm = 1e-3;
  if (a.size != b.size) return false;
  for (int corner = 0; corner < 4; ++corner) {
    Vec3 at;  // the first voxel, and the last along each axis
    if (corner > 0) at[corner - 1] = a.size[std::size_t(corner - 1)] - 1;
    if (norm(a.to_world_mm(at) - b.to_world_mm(at)) > off_mm) return false;
  }
  return true;
}

// What was removed; what was and what is left must be what the case shows, voxel by voxel.
grid::Mask removed_of(const grid::LabelFile& labels, const cases::LoadedCase& loaded) {
  const voxel::HapticVolume& volume = loaded.haptic;
  const auto refuse = [](const char* field, const std::string& what) {
    throw Error(ExitCode::bad_input, "", field, what + "; make the labels of this case by trephine drilled");
  };
  if (!are_alike(labels.lattice, volume.voxels)) refuse("lattice", "is not that of the case's haptic volume");
  grid::Mask removed(volume.voxels), all(volume.voxels);
  for (const cases::CaseShape& s : loaded.manifest.haptic.shapes)
    for (const bool is_left : {true, false}) {
      const std::string name = is_left ? s.name : s.name + voxel::removed_suffix;
      for (const grid::LabelSegment& segment : labels.segments) {
        if (segment.name != name) continue;
        const grid::PickedLabel picked = grid::pick_label(labels, name);
        for (std::size_t i = 0; i < all.voxels.size(); ++i) {
          if (!picked.mask.voxels[i]) continue;
          all.voxels[i] = std::uint8_t(s.number);
          removed.voxels[i] = std::uint8_t(!is_left);
        }
        if (!is_left && !s.cuttable)
          log_warning(fmt::format("{}: {:.1f} mm3 were removed, and no tool of the simulator removes it: not judged",
                                  s.name, double(picked.voxels) * volume.voxels.voxel_volume_mm3()));
      }
    }
  if (all.voxels != voxel::shown_shapes(volume).voxels) refuse("voxels", "are not those that the case shows");
  return removed;
}

}  // namespace

ScoredLesson score_drilled(const std::filesystem::path& file, const std::filesystem::path& case_folder,
                           const lesson::CompiledRubric& rubric, const std::string& participant,
                           const std::string& task) {
  lesson::validate_token(participant, "--participant");
  const LessonType& type = lesson_type(rubric.module);
  if (!type.facts_of_volume)
    throw Error(ExitCode::usage, "", "--rubric",
                "is of " + rubric.module + ", of which a drilled volume is not judged; give that of a ventriculostomy");
  const grid::LabelFile labels = grid::read_labels_bounded(file);
  cases::HashedCase read = cases::load_hashed_case(case_folder);
  with_file(case_folder.string(), [&] {
    if (!read.loaded.has_haptic()) throw Error(ExitCode::bad_input, "", "haptic", "the case holds no haptic volume");
    type.require(read.loaded.manifest);
  });
  const grid::Mask removed = with_file(file.string(), [&] { return removed_of(labels, read.loaded); });
  ScoredLesson s;
  const std::shared_ptr<LessonFacts> facts =
      type.facts_of_volume(read.loaded, voxel::drilled_volume(read.loaded.haptic, removed));
  if (!task.empty()) facts->task = task_of(type, read.loaded.manifest, task).name;
  s.facts = facts;
  s.score = type.score(*s.facts, read.loaded, read.loaded.haptic, rubric.rubric);
  for (ScoreRow& row : s.score.rows) row.decided_s.reset();  // it has no moments
  for (CriticalError& e : s.score.critical) e.at_s.reset();
  s.head.case_token = read.loaded.manifest.case_token;
  s.head.module = rubric.module;
  s.head.participant = participant;
  s.head.recording_sha256 = s.head.motion_sha256 = sha256_of_file(file);
  s.head.rubric_sha256 = rubric.sha256;
  s.head.case_sha256 = read.sha256;
  s.head.measured = true;
  return s;
}

}  // namespace trephine::lessons
