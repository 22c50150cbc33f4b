// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "lesson/rubric.h"
#include "lessons/lesson.h"
#include "lessons/subclavian/chest_frame.h"

namespace trephine::lessons {

/// The tool of the lesson [Rizzi, chapter 7.3]: a needle that collides with its whole length.
std::vector<haptics::BeltToolParams> subclavian_tools();

/// A moment of the needle's way.
struct VeinPassPoint {
  double time_s = 0;
  Vec3 tip_mm;
  int inside = 0;  ///< the shape
};

/// The needle in the patient, from the moment it enters the skin until it is drawn out of the place where it did.
struct VeinPass {
  double begin_s = 0, end_s = 0;
  Vec3 entry_mm, out{0, 0, 1};      ///< where it entered, and the tool's axis there
  Vec3 tip_mm;                      ///< where it was deepest
  bool in_place = false;            ///< it was there at the lesson's end
  std::vector<VeinPassPoint> path;  ///< each time the tip moved by 0.25 mm or into another shape; the last is the end
};

/// The command `aspirate`: what the syringe draws.
struct Aspiration {
  double time_s = 0;
  Vec3 tip_mm;
  int inside = 0;  ///< the shape in which the tip was
};

/// All that happened in a lesson and may be scored. A time of -1: never.
struct SubclavianFacts : LessonFacts {
  std::vector<VeinPass> passes;
  std::vector<Aspiration> aspirations;
  double vein_s = -1, artery_s = -1, pleura_s = -1, lung_s = -1;  ///< when the tip was there first
  double blood_s = -1;  ///< when blood of the vein was drawn last, with the tip still in it
  /// What is in the syringe: an artery's blood and a lung's air come by themselves, a vein's blood is drawn.
  lesson::Fluid syringe = lesson::Fluid::none;
  int inside = 0;                 ///< where the tip is
  Vec3 notch_mm, clavicle_mm[2];  ///< of the patient, between and about which drapes leave the skin open
};

/// The lesson as a state machine over frames.
class Subclavian : public Lesson {
 public:
  /// Throws as chest_shapes_of and chest_frame_of do.
  Subclavian(const cases::CaseManifest& manifest, const voxel::HapticVolume& before);
  void close() override { end_pass(facts_.end_s, true); }
  const SubclavianFacts& facts() const override { return facts_; }
  std::shared_ptr<const LessonFacts> copy_of_facts() const override {
    return std::make_shared<SubclavianFacts>(facts_);
  }

 protected:
  LessonFacts& noted() override { return facts_; }
  void tick(const haptics::ServoFrame& frame, const haptics::ToolBelt& belt, bool pedal) override;
  void command(int command, const haptics::ServoFrame& frame, const haptics::ToolBelt& belt) override;

 private:
  void end_pass(double time_s, bool in_place);
  ChestShapes shapes_;
  SubclavianFacts facts_;
  bool in_ = false;
  double deepest_mm_ = 0;
  Vec3 held_tip_;
  VeinPassPoint last_;
};

}  // namespace trephine::lessons
