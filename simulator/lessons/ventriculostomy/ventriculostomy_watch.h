// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cases/load_case.h"
#include "lessons/drilled_hole.h"
#include "lessons/lesson.h"
#include "lessons/ventriculostomy/dura_watch.h"
#include "lessons/ventriculostomy/head_frame.h"

namespace trephine::lessons {

/// The tools of the lesson [Rizzi, chapter 7.1]: a marker, a burr, and a catheter; burrs of other widths, which a
/// participant may take instead; and suction and saline, for what bleeds.
std::vector<haptics::BeltToolParams> ventriculostomy_tools();

/// The shapes of a case that the lesson knows, by number; 0 where there is none.
struct HeadShapes {
  int skin = 0, bone = 0, brain = 0, ventricles = 0;
};
/// Throws Error 65 where the case has no bone, brain or ventricles to be felt.
HeadShapes head_shapes_of(const cases::CaseManifest& manifest);

/// A line that the marker drew while its pedal was down and it touched.
struct MarkerTrace {
  double begin_s = 0, end_s = 0;
  double length_mm = 0;  ///< along the surface, over points that are at least trace_step_mm apart
  bool erased = false;
  std::vector<Vec3> points_mm;
};
constexpr double trace_step_mm = 0.5;
constexpr double scratch_mm3 = 10;  ///< of bone: less that was removed is no hole

struct LessonIncision {
  double time_s = 0;
  Vec3 at_mm;
};

/// A moment of the catheter's way.
struct PassPoint {
  double time_s = 0;
  Vec3 tip_mm;
  int inside = 0;  ///< the shape
};

/// The catheter in the brain, from the moment it enters it until it is drawn out of the place where it did.
struct CatheterPass {
  double begin_s = 0, end_s = 0;
  Vec3 entry_mm, out{0, 0, 1};  ///< where it entered, and the tool's axis there
  double csf_s = -1;            ///< when its tip entered the ventricles; -1: never
  bool in_place = false;        ///< it was there at the lesson's end
  std::vector<PassPoint> path;  ///< each time the tip moved by 0.25 mm or into another shape; the last is the end
};

/// All that happened in a lesson and may be scored. Times are of the recording, s; lengths along surfaces, mm.
struct VentriculostomyFacts : LessonFacts {
  bool drilled_beforehand = false;  ///< the case has a burr hole: the lesson begins at the catheter
  std::vector<MarkerTrace> traces;
  std::vector<LessonIncision> incisions;
  double drill_s = 0;            ///< how long the burr ran
  double burr_mm = 0;            ///< the widest burr that removed bone since all was last taken back; 0: none did
  double drill_begin_s = -1;     ///< when it first ran; -1: never
  double through_s = -1;         ///< when a ball as wide as the catheter first passed; -1: never
  std::optional<BoneHole> hole;  ///< the drilled one, or the case's
  std::vector<BoneHole>
      holes;                 ///< all that were ever drilled, also those that were taken back or became part of another
  double catheter_mm = 2.5;  ///< its width, which a hole must let through
  std::vector<CatheterPass> passes;
  std::optional<DuraFacts> dura;  ///< none where the case has no dura to be felt
};

enum class LessonPhase { marking, drilling, catheter, review };
const char* name_of(LessonPhase phase);

/// The lesson as a state machine over frames. It only watches: what the hand may do is decided by the tissue, so the
/// catheter may be tried without a hole, and the tools be changed in any order.
class Ventriculostomy : public Lesson {
 public:
  /// `manifest`, `before` (the volume as the lesson began) and `now` must outlive it. Throws as head_frame_of and
  /// head_shapes_of do.
  Ventriculostomy(const cases::CaseManifest& manifest, const voxel::HapticVolume& before,
                  const voxel::HapticVolume& now);

  void close() override;

  const VentriculostomyFacts& facts() const override { return facts_; }
  std::shared_ptr<const LessonFacts> copy_of_facts() const override {
    return std::make_shared<VentriculostomyFacts>(facts_);
  }
  const HeadFrame& frame() const { return frame_; }
  const HeadShapes& shapes() const { return shapes_; }
  LessonPhase phase() const;

 protected:
  LessonFacts& noted() override { return facts_; }
  void begin(const haptics::ServoFrame& frame, const haptics::ToolBelt& belt) override;
  void tick(const haptics::ServoFrame& frame, const haptics::ToolBelt& belt, bool pedal) override;
  void command(int command, const haptics::ServoFrame& frame, const haptics::ToolBelt& belt) override;

 private:
  void draw(const haptics::ServoFrame& f, bool pedal);
  void drill(const haptics::ServoFrame& f, const haptics::ToolBelt& belt, bool pedal);
  void look_for_hole(double time_s, double ball_mm);
  void note_holes();
  HoleSearch search() const;
  void note_site(const haptics::ServoFrame& f);
  void pass(const haptics::ServoFrame& f);
  void end_trace();
  void end_pass(double time_s, bool in_place);

  const cases::CaseManifest& manifest_;
  const voxel::HapticVolume& before_;
  const voxel::HapticVolume& now_;
  HeadFrame frame_;
  HeadShapes shapes_;
  VentriculostomyFacts facts_;
  DuraWatch dura_;
  bool drawing_ = false, drilling_ = false, in_brain_ = false;
  double last_touch_s_ = 0, looked_s_ = 0;
  std::int64_t removed_units_ = 0, looked_units_ = 0, removed_units_at_note_ = 0;
  grid::Box drilled_box_;
  std::vector<HoleSite> sites_;
  PassPoint last_tip_;
  Vec3 held_tip_;
};

}  // namespace trephine::lessons
