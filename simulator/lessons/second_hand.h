// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/vec3.h"
#include "cases/case.h"
#include "haptics/frame.h"
#include "haptics/recording.h"
#include "lesson/rubric.h"

namespace trephine::lessons {

struct LessonFacts;
struct LessonScore;
struct LessonType;

/// What a lesson has for the other hand: kinds of tools, and the shapes of a case that it must spare. Without tools its
/// switch may still take X-rays, in a lesson whose pedal does.
struct SecondUse {
  std::vector<std::string> tools, spares;
};

/// A suction that ran in one place.
struct SuctionSpell {
  double begin_s = 0, end_s = 0;
  Vec3 tip_mm;
};

/// What the other hand did, and the suction of either.
struct SecondHandFacts {
  std::string tool;  ///< empty: a switch alone
  double switch_s = 0;
  double most_force_n = 0, most_force_s = 0;  ///< on what it must spare
  int pressed = 0;                            ///< the shape
  double entered_s = -1;                      ///< when its tip was first in that; -1: never
  int entered = 0;                            ///< the shape
  double most_may_n = 0;                      ///< no force of it may be larger, whatever it presses on
  double lost_s = -1;                         ///< when its device was lost for good; -1: never
  std::vector<SuctionSpell> suctions;
};

/// Notes what the other hand does, tick by tick.
class SecondHandWatch {
 public:
  /// `spared`: the shapes that it must spare, bit n for shape n.
  SecondHandWatch(const haptics::RecordedSecondHand& held, std::uint64_t spared);
  bool takes_xrays(const haptics::ServoFrame& second) const;
  /// `idle`: its belt waits, so that it feels nothing; then, as where it is lifted, it takes up nothing.
  void look(const haptics::ServoFrame& second, bool paused, bool idle, SecondHandFacts& facts);
  /// The suction of the first hand, at its tip.
  static void suck(double time_s, double dt_s, Vec3 tip_mm, SecondHandFacts& facts);

 private:
  const haptics::RecordedSecondHand held_;
  const std::uint64_t spared_;
  const bool takes_up_;
};
std::uint64_t spared_shapes(const SecondUse& use, const cases::CaseHaptic& haptic);

/// What the other hand holds in a lesson: the lesson's own tool of that name, the first that it has for that hand where
/// none is asked for; nothing where its switch takes X-rays. Throws Error 64 where the lesson has no use for it.
std::optional<haptics::BeltToolParams> second_tool_of(const LessonType& type, const std::string& asked);

/// Blood that wells up in a wound, and what suction leaves of it at the end, ml.
struct BloodLeft {
  bool bled = false;
  double left_ml = 0, suction_s = 0;  ///< suction_s: at a wound
};
BloodLeft blood_left(const LessonScore& score, const LessonFacts& facts);

/// The row "second_hand" beside the others, where there was a second hand with a tool and the rubric has its limits: by
/// the largest force on what it must spare, and by the blood that is left where a critical error bleeds; 1 where its
/// tip was in what it must spare.
void judge_second_hand(LessonScore& score, const LessonFacts& facts, const lesson::LessonRubric& rubric,
                       const cases::CaseHaptic& haptic);

}  // namespace trephine::lessons
