// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptics/frame.h"
#include "haptics/tool_belt.h"
#include "lesson/outcome_record.h"
#include "lessons/second_hand.h"

namespace trephine::lessons {

/// By the tool's pose, over so long: so a tool that gives way under a steady hand is not called fast.
constexpr double insertion_window_s = 0.1;
/// A tip that lies farther out than this before the place of entry, and in nothing, is out; one that a pause moved by
/// more was taken away.
constexpr double withdrawn_mm = 1;

enum class LessonEnd { running, finished, device_lost };
const char* name_of(LessonEnd end);

/// An answer to a question, by the numbers of the recording's list.
struct GivenAnswer {
  int question = 0, choice = 0;
  double time_s = 0;
};

/// What every lesson notes; a module's facts derive from it. Times are of the recording, s.
struct LessonFacts {
  virtual ~LessonFacts() = default;
  std::string task;  ///< LessonTask::name of what was asked for; empty: nothing was
  double begin_s = 0, end_s = 0, paused_s = 0;
  int pauses = 0;
  int undone = 0;  ///< how often the last stroke or incision was to be taken back, or all that was cut
  double max_bone_c = 0, heat_dose_min = 0;  ///< BoneHeat, where the one who watches cuts again; else 0
  /// What a CT after a procedure shows is all that is known: no times, forces, traces or passes.
  bool from_scan = false;
  /// It is no CT but the volume as it was drilled in another program, which shows what was removed and nothing else.
  bool from_volume = false;
  lesson::Sighting seen = lesson::Sighting::none;  ///< then: of the instrument that was put in
  LessonEnd end = LessonEnd::running;              ///< running: the recording ends before the lesson did
  double most_force_n = 0;
  std::vector<GivenAnswer> answers;       ///< the first to each question
  std::optional<SecondHandFacts> second;  ///< where there was another hand
  /// When the patient was first cut, drilled or entered by a tool; -1: never. Marks on the skin are no cut.
  double first_cut_s = -1;
  double fastest_mm_per_s = 0, fastest_s = 0;  ///< how fast a tool went forward in the patient at most, and when

  double procedure_s() const;  ///< to a microsecond: sums of steps are no exact multiples
};

/// A lesson as a state machine over frames. It only watches: what the hand may do is decided by the tissue.
class Lesson {
 public:
  virtual ~Lesson() = default;
  /// What was asked for: LessonTask::name.
  void set_task(const std::string& task) { noted().task = task; }
  /// There is another hand, which must spare these shapes (spared_shapes()).
  void set_second(const haptics::RecordedSecondHand& held, std::uint64_t spared);
  /// After each tick, with the tools as they are then. `second`: what the other hand did in it, where there is one, and
  /// its belt, where it holds a tool.
  void watch(const haptics::ServoFrame& frame, const haptics::ToolBelt& belt,
             const haptics::ServoFrame* second = nullptr, const haptics::ToolBelt* second_belt = nullptr);
  /// At the end of the frames: closes what is open. Nothing is watched afterwards.
  virtual void close() = 0;
  virtual const LessonFacts& facts() const = 0;
  virtual std::shared_ptr<const LessonFacts> copy_of_facts() const = 0;

 protected:
  /// Whether a tool that was in the patient at `last_mm` was taken away, and comes again from elsewhere: it was lifted,
  /// or moved by more than withdrawn_mm in a pause.
  static bool taken_away(const haptics::ServoFrame& frame, const haptics::ToolBelt& belt, Vec3 last_mm);
  virtual LessonFacts& noted() = 0;
  /// The first tick, before anything else of it.
  virtual void begin(const haptics::ServoFrame&, const haptics::ToolBelt&) {}
  /// A tick that the lesson's clock counts or, while paused, does not; `pedal`, or the other hand's switch where that
  /// takes X-rays, is never down while paused.
  virtual void tick(const haptics::ServoFrame& frame, const haptics::ToolBelt& belt, bool pedal) = 0;
  /// A command in the tick in which it is new, after that tick(); not while paused, and not `finish`.
  virtual void command(int, const haptics::ServoFrame&, const haptics::ToolBelt&) {}

 private:
  void look_at_speed(const haptics::ServoFrame& frame, const haptics::ToolBelt& belt);
  void look_for_cut(const haptics::ServoFrame& frame, const haptics::ToolBelt& belt, int command);
  struct Moment {
    double time_s;
    Vec3 tip_mm;
  };
  std::deque<Moment> moments_;  // of one window, with the same tool
  std::optional<SecondHandWatch> second_;
  int in_hand_ = -1;
  bool begun_ = false, was_paused_ = false;
  std::uint32_t buttons_ = 0;
};

}  // namespace trephine::lessons
