// SPDX-License-Identifier: GPL-3.0-or-later
#include "window/lesson_controller.h"

#include <algorithm>

#include "base/error.h"
#include "fluoro/fluoroscope.h"
#include "lesson/approval.h"
#include "lessons/curriculum.h"
#include "lessons/lesson_guide.h"

namespace trephine::window {
namespace {

constexpr double dot_mm = 1;  // between dots of ink

std::vector<LessonStep> steps_of(const lessons::LessonType& module, const lessons::LessonFacts& facts,
                                 const std::vector<haptics::BeltToolParams>& tools) {
  std::vector<LessonStep> steps;
  for (const lessons::LessonGuide& g : lessons::guide_of(module, facts)) {
    LessonStep& step = steps.emplace_back();
    step.guide = g;
    for (std::size_t n = tools.size(); n-- > 0;)
      if (lessons::is_for_tool(g, tools[n].name)) {
        const bool usual = tools[n].name + "*" == g.tool;  // it is taken unless the participant chooses another
        step.choice_of_tools = step.tool >= 0 && !usual;
        step.tool = int(n);
      }
    for (int n = 1; n < haptics::belt_command::count; ++n)
      if (g.command == haptics::belt_command::names[n]) step.command = n;
  }
  return steps;
}

lesson::CompiledRubric rubric_of(const LessonPlay& p) {
  lesson::validate_token(p.participant, "--participant");
  lesson::CompiledRubric rubric = lessons::read_rubric_file(p.rubric);
  if (rubric.module != p.module)
    throw Error(ExitCode::bad_input, p.rubric.string(), "module", rubric.module + ", but the lesson is " + p.module);
  return rubric;
}

}  // namespace

LessonController::LessonController(const LessonPlay& play, const session::Patient& patient,
                                   const session::SessionOptions& o)
    : play_(play),
      case_folder_(o.case_folder),
      rate_hz_(o.servo.rate_hz),
      module_(lessons::lesson_type(play.module)),
      rubric_(rubric_of(play)),
      loaded_(patient.felt.loaded),
      manifest_(loaded_.manifest) {
  const cases::LoadedCase& loaded = patient.felt.loaded;
  if (!play.approved_sha256.empty())
    lessons::require_approved(case_folder_, patient.felt.case_sha256, play.approved_sha256);
  with_file((o.case_folder / "case.json").string(), [&] {
    before_ = voxel::copy_without_hardness(loaded.haptic);
    module_.require(loaded.manifest);
    if (module_.needs_pictures) fluoro::require_ct(loaded.ct);
    lesson_ = module_.begin(loaded.manifest, before_, loaded.haptic);
    task_ = lessons::task_or_usual(module_, loaded.manifest, play.task);
    lesson_->set_task(task_.name);
  });
  std::vector<lessons::OfferedQuestion> asked;
  if (play.questions) asked = lessons::questions_for(*rubric_.common, module_, manifest_, task_.name, play.participant);
  questions_ = std::make_unique<LessonQuestions>(lessons::as_asked(asked), *rubric_.common);
  belt_ = std::make_unique<haptics::ToolBelt>(patient.contact, patient.felt.feels, o.force, o.shaft, module_.tools(),
                                              nullptr);
  if (o.second && !o.second->switch_only)
    second_belt_ = std::make_unique<haptics::ToolBelt>(patient.contact, patient.felt.feels, o.second->force,
                                                       haptics::ShaftParams(),
                                                       std::vector<haptics::BeltToolParams>{o.second->tool}, nullptr);
  if (o.second)
    lesson_->set_second({o.second->device.name, o.second->switch_only, o.second->force, {}, o.second->tool},
                        lessons::spared_shapes(module_.second, manifest_.haptic));
  steps_ = steps_of(module_, lesson_->facts(), belt_->tools());
  tool_ = std::max(0, steps_.front().tool);
  press();
}

LessonController::~LessonController() {
  questions_->wait();  // for what looks at this lesson
  if (judging_.valid()) judging_.wait();
}

void LessonController::set_session(session::SessionOptions& o) const {
  o.tools = belt_->tools();
  o.lesson = play_.module;
  o.participant = play_.participant;
  o.task = task_.name;
  o.rubric_sha256 = rubric_.sha256;
  o.asked = questions_->asked();
  o.board = board_;
  o.record = play_.recording;
}

// Sets the board's buttons. A command stays until the servo has seen it, and is released before the next one.
void LessonController::press() {
  std::uint32_t buttons = pedal_ ? haptics::belt_button::pedal : 0;
  buttons |= std::uint32_t(tool_) << haptics::belt_button::tool_shift;
  if (resting_ && !commands_.empty())
    buttons |= std::uint32_t(commands_.front()) << haptics::belt_button::command_shift;
  board_->buttons.store(buttons, std::memory_order_relaxed);
}

void LessonController::set_pedal(bool down) {
  pedal_ = down;
  press();
}

// The step that begins with this tool or command, if the lesson has one.
void LessonController::note_step(int tool, int command) {
  for (std::size_t n = 0; n < steps_.size(); ++n)
    if (command != haptics::belt_command::none
            ? steps_[n].command == command
            : tool >= 0 && lessons::is_for_tool(steps_[n].guide, tools()[std::size_t(tool)].name)) {
      step_ = n;
      step_was_done_ = steps_[n].guide.done;
    }
}

texts::Answer LessonController::take(const std::string& name) {
  for (std::size_t n = 0; n < tools().size(); ++n)
    if (tools()[n].name == name) {
      tool_ = int(n);
      pedal_ = false;
      note_step(tool_, haptics::belt_command::none);
      press();
      return {};
    }
  return texts::Note{texts::NoteId::no_tool_of_lesson, {name}};
}

texts::Answer LessonController::give(const std::string& name) {
  for (int n = 1; n < haptics::belt_command::count; ++n)
    if (name == haptics::belt_command::names[n]) {
      if (belt_->paused() && n != haptics::belt_command::pause && n != haptics::belt_command::resume &&
          n != haptics::belt_command::finish)
        return texts::NoteId::lesson_is_paused;
      if (n == haptics::belt_command::finish) {
        if (questions_->asks_after_errors()) questions_->found(happened(facts()));  // also of the last second
        if (questions_->comes_before_end(facts())) return texts::NoteId::questions_first;
      }
      if (n == haptics::belt_command::incise && !belt_->has_mark()) return texts::NoteId::marker_untouched;
      commands_.push_back(n);
      note_step(-1, n);
      press();
      return {};
    }
  return texts::Note{texts::NoteId::no_lesson_command, {name}};
}

texts::Answer LessonController::answer(const std::string& choice) {
  const int command = questions_->answer(facts(), choice);
  if (command == haptics::belt_command::none) return texts::Note{texts::NoteId::no_answer, {choice}};
  commands_.push_back(command);
  press();
  return {};
}

std::size_t LessonController::step() const {
  std::size_t n = step_;
  while (n + 1 < steps_.size() && steps_[n].guide.done && !step_was_done_) ++n;
  return n;
}

texts::Answer LessonController::next() {
  const std::size_t n = std::max(step_ + 1, step());
  if (n >= steps_.size()) return texts::NoteId::last_step;
  const LessonStep& s = steps_[n];
  // A pedal pressed once too often must not end the lesson, which cannot be taken back.
  if (s.tool < 0 && s.command == haptics::belt_command::finish) return texts::NoteId::only_end_left;
  if (s.choice_of_tools) return texts::NoteId::choose_tool;
  return s.tool >= 0 ? take(tools()[std::size_t(s.tool)].name) : give(haptics::belt_command::names[s.command]);
}

texts::Answer LessonController::back() {
  for (std::size_t n = step_; n-- > 0;)
    if (steps_[n].tool >= 0) return take(tools()[std::size_t(steps_[n].tool)].name);
  return texts::NoteId::first_step;
}

void LessonController::watch(const std::vector<haptics::ServoFrame>& frames, const haptics::Drilling* drilling,
                             const std::vector<haptics::ServoFrame>& second) {
  belt_->watch(drilling);
  if (second_belt_) second_belt_->watch(drilling);
  if (!frames.empty()) inside_ = frames.back().inside;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    const haptics::ServoFrame& f = frames[n];
    belt_->follow(haptics::input_of(f, rate_hz_), haptics::state_of(f));
    if (second_belt_ && !second.empty()) {
      second_belt_->obey(belt_->paused(), belt_->takes_back());
      second_belt_->follow(haptics::input_of(second[n], rate_hz_), haptics::state_of(second[n]));
    }
    lesson_->watch(f, *belt_, second.empty() ? nullptr : &second[n], second_belt_.get());
    const int command = haptics::belt_button::command(f.buttons);
    if (resting_ && !commands_.empty() && command == commands_.front()) {
      commands_.pop_front();
      resting_ = false;
      press();
    } else if (!resting_ && command == haptics::belt_command::none) {
      resting_ = true;
      press();
    }
  }
  const std::vector<lessons::LessonGuide> guide = lessons::guide_of(module_, lesson_->facts());
  for (std::size_t n = 0; n < steps_.size(); ++n) steps_[n].guide.done = guide[n].done;
  if (questions_->wants_errors(facts()))
    questions_->ask([this, facts = lesson_->copy_of_facts()] { return happened(*facts); });
}

// As the lesson will be judged.
Happened LessonController::happened(const lessons::LessonFacts& facts) const {
  lessons::LessonScore score = module_.score(facts, loaded_, before_, rubric_.rubric);
  lessons::judge_decisions(score, facts, questions_->asked(), *rubric_.common, manifest_.case_token, true);
  Happened happened;
  for (const lessons::CriticalError& e : score.critical) happened.errors.insert(e.rule.error);
  happened.flows = lessons::flows_of(score);
  happened.answers_count = facts.answers.size();
  return happened;
}

std::vector<lessons::LessonStatus> LessonController::status() const {
  return module_.status ? module_.status(lesson_->facts()) : std::vector<lessons::LessonStatus>();
}

lessons::LessonField LessonController::field(Vec3 middle_mm) const {
  return module_.field ? module_.field(lesson_->facts(), manifest_)
                       : lessons::LessonField{middle_mm, 0, 220, {0, 1, 0}, {}};
}

LessonController::ToolFlow LessonController::tool_flow() const {
  for (const lessons::Flow& flow : flows())
    if (flow.seen.shape != 0 && flow.seen.shape == inside_ && flow.runs(facts().end_s))
      return {flow.fluid, flow.ml_per_min / 60};
  return {module_.fluid ? module_.fluid(facts(), manifest_) : lesson::Fluid::none, {}};
}

int LessonController::verdict() const {
  return module_.verdict ? module_.verdict(lesson_->facts(), rubric_.rubric) : 0;
}

bool LessonController::take_ink(std::vector<Vec3>& ink) {
  if (!module_.ink) return false;
  const std::vector<Vec3> all = module_.ink(lesson_->facts());
  if (all.size() == ink_points_) return false;
  ink_points_ = all.size();
  ink.clear();
  for (const Vec3 p : all)
    if (ink.empty() || norm(p - ink.back()) >= dot_mm) ink.push_back(p);
  return true;
}

void LessonController::judge(bool for_review, const std::atomic<bool>& stop) {
  judging_ = std::async(std::launch::async, [this, for_review, &stop] {
    JudgedLesson out;
    out.scored = lessons::score_recording(play_.recording, case_folder_, rubric_);
    out.scored.head.language = play_.language;
    // The report for programs is written last: where it exists, so do the other files.
    lessons::write_report(out.scored, case_folder_, {{}, play_.report.page, play_.report.log});
    lessons::write_report(out.scored, case_folder_, {play_.report.json, {}, {}});
    if (for_review)
      out.review =
          std::make_unique<session::Playback>(case_folder_, play_.recording, std::vector<std::filesystem::path>(),
                                              cases::LoadParts{true}, Progress({}, &stop));
    return out;
  });
}

bool LessonController::take_judged(bool wait) {
  if (!judging_.valid()) return false;
  if (!wait && judging_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
  judged_ = judging_.get();
  return true;
}

}  // namespace trephine::window
