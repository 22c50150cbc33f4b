// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "cases/pedicles.h"
#include "fluoro/carm.h"
#include "lessons/lesson.h"

namespace trephine::lessons {

using cases::CasePedicle;
using cases::pedicles_of;

/// The number of the shape named bone. Throws Error 65 where the case has none that is felt, or no pedicle.
int spine_bone_of(const cases::CaseManifest& manifest);

/// Where the C-arm stands, as commands move it: to a view, or by 5 degrees.
struct ArmPose {
  double orbit_deg = 0, tilt_deg = 0;
  /// Whether the command is one of the arm's.
  bool take(int command);
  const char* view() const;  ///< "ap", "lateral", "oblique" or "free"
};
/// The arm at that pose about the middle of the case's pedicles.
fluoro::CArmParams arm_of(const cases::CaseManifest& manifest, const ArmPose& pose);

/// X-rays that were on without a break.
struct FluoroShot {
  double begin_s = 0, end_s = 0, needle_mm = 0, length_mm = 0;
  ArmPose arm;        ///< at its end
  Vec3 tip_mm, axis;  ///< of the needle at its end; the axis from tip to tail
  fluoro::MetalRod metal() const { return {tip_mm, tip_mm + axis * length_mm, std::max(0.5, needle_mm)}; }
};

/// A moment of the needle's way.
struct NeedlePoint {
  double time_s = 0;
  Vec3 tip_mm, axis;
  int inside = 0;  ///< the shape
};

/// The needle in bone, or in the patient, from the moment it enters until it is drawn out behind that place.
struct NeedlePass {
  double begin_s = 0, end_s = 0;
  Vec3 entry_mm, axis;
  std::string tool;  ///< what it was
  double diameter_mm = 0, length_mm = 0;
  bool in_place = false;          ///< it was there at the lesson's end
  std::vector<NeedlePoint> path;  ///< each time the tip moved by 0.25 mm, or into another shape; the last is the end
  double depth_mm(const NeedlePoint& p) const { return dot(entry_mm - p.tip_mm, axis); }
  const NeedlePoint& deepest() const;  ///< the first of those that are deepest
};

struct SpineNeedleFacts : LessonFacts {
  std::vector<FluoroShot> shots;
  std::vector<NeedlePass> passes;     ///< in bone
  std::vector<NeedlePass> punctures;  ///< in whatever is felt of the patient: skin first, where the case has it
  double exposure_s() const;
  /// Punctures in which the needle came into no bone.
  int empty_punctures() const;
  /// When a pass was half way in without a picture since the pass before it (or the begin); nothing: each was seen.
  std::optional<double> blind_s() const;
  const NeedlePass* final_pass() const { return !passes.empty() && passes.back().in_place ? &passes.back() : nullptr; }
};

/// Watches a needle and a C-arm. The pedal is the arm's, with the needle in the picture at once.
class SpineNeedle : public Lesson {
 public:
  explicit SpineNeedle(const cases::CaseManifest& manifest);
  void close() override;
  const SpineNeedleFacts& facts() const override { return facts_; }
  std::shared_ptr<const LessonFacts> copy_of_facts() const override {
    return std::make_shared<SpineNeedleFacts>(facts_);
  }
  const ArmPose& arm() const { return arm_; }
  bool exposing() const { return exposing_; }

 protected:
  LessonFacts& noted() override { return facts_; }
  void tick(const haptics::ServoFrame& frame, const haptics::ToolBelt& belt, bool pedal) override;
  void command(int command, const haptics::ServoFrame& frame, const haptics::ToolBelt& belt) override;

 private:
  /// Passes of one kind, the last of which may go on.
  struct Way {
    std::vector<NeedlePass>& all;
    bool open = false;
  };
  void follow(Way& way, bool inside, const haptics::BeltToolParams& tool);
  void end(Way& way, double time_s, bool in_place);
  int bone_;
  SpineNeedleFacts facts_;
  ArmPose arm_;
  int in_hand_ = -1;
  Way in_bone_{facts_.passes}, in_patient_{facts_.punctures};
  bool exposing_ = false;
  NeedlePoint last_;
};

}  // namespace trephine::lessons
