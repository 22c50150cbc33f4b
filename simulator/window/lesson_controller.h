// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "lessons/lesson_type.h"
#include "lessons/score_recording.h"
#include "session/playback.h"
#include "window/lesson_questions.h"

namespace trephine::window {

/// A lesson that is done in the window: who does it, by what it is judged, and where recording and report go.
struct LessonPlay {
  std::string module, participant = "anonymous";
  std::string task;                                     ///< what is asked for; empty: what is usual in the case
  std::filesystem::path rubric;                         ///< as `trephine rubric` compiled it
  std::filesystem::path recording;                      ///< must not be there yet
  std::string approved_sha256;                          ///< of the case.json that is approved; empty: any case
  lessons::ReportFiles report;                          ///< what of it has no path is not written
  texts::Language language = texts::Language::english;  ///< of the report's page
  bool questions = true;                                ///< whether those of the rubric are asked
};

/// What a lesson leads through, in this order: a tool to be taken, or a command.
struct LessonStep {
  lessons::LessonGuide guide;
  int tool = -1;                 ///< the first that it is for
  bool choice_of_tools = false;  ///< one of several, which the participant chooses
  int command = haptics::belt_command::none;
};

/// A lesson that has ended. `review`: its recording, to be shown; null where nobody waits for it.
struct JudgedLesson {
  lessons::ScoredLesson scored;
  std::unique_ptr<session::Playback> review;
};

/// The lesson beside the session in which it is done: what the user presses goes to the session's board, what the
/// servo's frames tell is followed for the panel, and what was recorded is judged by itself. So the score is that of
/// `trephine-sim score`, and what the panel shows meanwhile changes nothing in it. In the window's thread.
class LessonController {
 public:
  /// `patient`, as its case is, must outlive it. Throws Error 65 where the case does not hold the lesson, as
  /// read_rubric_file does, and 64 for a participant that is no token.
  LessonController(const LessonPlay& lesson, const session::Patient& patient, const session::SessionOptions& session);
  ~LessonController();
  /// Tools, module, participant, board and recording.
  void set_session(session::SessionOptions& session) const;

  // What the hand does besides moving.
  texts::Answer take(const std::string& tool);
  texts::Answer give(const std::string& command);         ///< a name of belt_command
  bool commanding() const { return !commands_.empty(); }  ///< whether a command waits for the servo
  texts::Answer next();                                   ///< does the next step
  texts::Answer back();                                   ///< takes the tool of an earlier step: what was cut stays cut
  void set_pedal(bool down);

  texts::Answer answer(const std::string& choice);  ///< the question that is asked, by the answer's name

  /// What the servo did. `drilling`: the session's, null where nothing can be cut. `second`: of the other hand, as
  /// many.
  void watch(const std::vector<haptics::ServoFrame>& frames, const haptics::Drilling* drilling,
             const std::vector<haptics::ServoFrame>& second = {});
  bool ended() const { return lesson_->facts().end != lessons::LessonEnd::running; }  ///< as far as was watched
  bool paused() const { return belt_->paused(); }
  bool pedal() const { return pedal_; }
  const haptics::BeltToolParams& tool() const {
    return belt_->tools()[std::size_t(belt_->in_hand() < 0 ? tool_ : belt_->in_hand())];
  }
  const std::vector<haptics::BeltToolParams>& tools() const { return belt_->tools(); }
  const std::vector<LessonStep>& steps() const { return steps_; }
  const lessons::LessonTask& task() const { return task_; }  ///< what is asked for; without a name where nothing is
  std::size_t step() const;  ///< the one taken up last, or, where it was done since, the next that is not
  const LessonQuestions& questions() const { return *questions_; }
  const lessons::LessonFacts& facts() const { return lesson_->facts(); }
  std::vector<lessons::LessonStatus> status() const;
  int verdict() const;  ///< LessonType::verdict
  /// As lamp, drapes and what comes out of the tool show it, the lesson's own fluid or a critical error's; `middle_mm`:
  /// of what is shown.
  lessons::LessonField field(Vec3 middle_mm) const;
  struct ToolFlow {
    lesson::Fluid fluid = lesson::Fluid::none;
    std::optional<double> ml_per_s;  ///< none: as its pressure drives it
  };
  ToolFlow tool_flow() const;
  /// What critical errors led to.
  std::vector<lessons::Flow> flows() const {
    return judged_ ? lessons::flows_of(judged_->scored.score) : questions_->flows();
  }
  bool of_head() const { return module_.of_head; }
  bool has_arm() const { return bool(module_.xray); }
  lessons::LessonXray xray() const { return module_.xray(*lesson_, manifest_); }  ///< where it has one
  /// The X-rays of the lesson that was judged, for its review.
  std::vector<lessons::LessonShot> shots() const {
    return module_.shots && judged_ ? module_.shots(*judged_->scored.facts, manifest_)
                                    : std::vector<lessons::LessonShot>();
  }
  /// What the marker drew and nobody erased, as dots; true where it changed since the last call.
  bool take_ink(std::vector<Vec3>& ink_mm);

  /// Begins to judge the recording, which must be complete, and writes the report; in a thread. `for_review`: makes the
  /// playback as well.
  void judge(bool for_review, const std::atomic<bool>& stop);
  bool judging() const { return judging_.valid(); }
  /// Takes the result where it is there; with `wait`, waits for it. Throws what judging threw.
  bool take_judged(bool wait);
  const lessons::ScoredLesson* scored() const { return judged_ ? &judged_->scored : nullptr; }
  std::unique_ptr<session::Playback> take_review() { return judged_ ? std::move(judged_->review) : nullptr; }
  const LessonPlay& lesson() const { return play_; }

 private:
  void press();
  void note_step(int tool, int command);
  Happened happened(const lessons::LessonFacts& facts) const;

  const LessonPlay play_;
  const std::filesystem::path case_folder_;
  const double rate_hz_;
  const lessons::LessonType& module_;
  const lesson::CompiledRubric rubric_;
  const cases::LoadedCase& loaded_;  // of the patient; its haptic volume is cut meanwhile
  const cases::CaseManifest& manifest_;
  voxel::HapticVolume before_;
  std::unique_ptr<haptics::ToolBelt> belt_, second_belt_;  // follow the session's; the second is null without a tool
  std::unique_ptr<lessons::Lesson> lesson_;
  std::vector<LessonStep> steps_;
  lessons::LessonTask task_;
  std::size_t step_ = 0;
  bool step_was_done_ = false;  // before it was taken up
  std::shared_ptr<session::ButtonBoard> board_ = std::make_shared<session::ButtonBoard>();
  std::unique_ptr<LessonQuestions> questions_;
  std::deque<int> commands_;  // given, and not seen by the servo yet
  bool pedal_ = false, resting_ = true;
  int tool_ = 0, inside_ = 0;  // inside_: the shape in which the tip was last
  std::size_t ink_points_ = 0;
  std::future<JudgedLesson> judging_;
  std::optional<JudgedLesson> judged_;
};

}  // namespace trephine::window
