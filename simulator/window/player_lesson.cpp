// SPDX-License-Identifier: GPL-3.0-or-later
// A lesson in the window: what its session shows, its end and its review; and what a marker draws.
#include <fmt/format.h>

#include "window/player.h"
#include "window/ways.h"

namespace trephine {
namespace {

constexpr double more_than_pierce = 1.25;
constexpr double press_mm = 1.5, near_mm = 20;  // how deep a marker is pressed to draw; within which it is led there

Vec3 vec(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace

std::vector<std::string> Player::tools() const {
  std::vector<std::string> names;
  if (desk_)
    for (const BeltToolParams& t : desk_->tools()) names.push_back(t.name);
  else
    for (const ToolKind& kind : all_tool_kinds()) names.push_back(kind.name);
  return names;
}

std::string Player::lesson_command(const std::string& name) {
  if (!desk_) return "this is no lesson";
  if (!session_) return "not now: the lesson waits for its device, or has ended";
  return name == "next" ? desk_->next() : name == "back" ? desk_->back() : desk_->give(name);
}

std::string Player::barred() const { return desk_ && !playback_ ? "not before the lesson's end" : ""; }

bool Player::draws() const {
  return by_screen() && (desk_ ? desk_->tool().marks : tool_kind(options_.session.tool.tool).marks);
}

void Player::draw_at(double x, double y, int width, int height) {
  const Contact c = seen(x, y, width, height);
  if (!c.hit) return;
  const Vec3 normal = norm(c.normal) > 0 ? normalized(c.normal) : camera.toward;
  if (norm(c.point_mm - vec(frame_.tip_mm)) > near_mm) {
    place_tool(c.point_mm + normal * press_mm, normal);
    return;
  }
  goal_.tip_mm = c.point_mm - normal * press_mm;
  goal_.axis = normal;
  aim();
}

// What a marker draws without a lesson.
void Player::ink(const ServoFrame& f) {
  const std::uint32_t before = std::exchange(seen_buttons_, f.buttons);
  if (!tool_kind(options_.session.tool.tool).marks || !(f.buttons & Drilling::pedal) || f.touched == 0) return;
  const Vec3 at = vec(f.proxy_mm);
  std::vector<Vec3>& dots = stage_->state.ink_mm;
  if (!(before & Drilling::pedal) || dots.empty()) {
    ink_mm_ = 0;
    dots.push_back(last_ink_mm_ = at);
  }
  const double step = norm(at - last_ink_mm_);
  if (step < 1) return;
  ink_mm_ += step;
  dots.push_back(last_ink_mm_ = at);
}

// Shows the tool in hand: in green where it succeeded, in red where it failed.
void Player::show_lesson_tool() {
  constexpr std::array<float, 3> green{0.10f, 0.75f, 0.35f}, red{0.90f, 0.15f, 0.10f};
  tool_name_ = desk_->tool().name;
  press_as_needed();
  verdict_ = desk_->verdict();
  std::optional<std::array<float, 3>> colour;
  if (verdict_ != 0) colour = verdict_ > 0 ? green : red;
  stage_->set_tool(whole_tool(desk_->tool()), colour);
}

// A hand of mouse and keyboard usually presses no harder than a burr needs, which would never pierce bone.
void Player::press_as_needed() {
  goal_.least_most_n = desk_ ? more_than_pierce * desk_->tool().pierce_n : 0;
  aim();
}

void Player::follow_lesson(const std::vector<ServoFrame>& frames) {
  desk_->watch(frames, session_->drilling());
  desk_->take_ink(stage_->state.ink_mm);
  if (desk_->tool().name != tool_name_ || desk_->verdict() != verdict_) show_lesson_tool();
  // A device's second pedal goes on to the next step.
  bool second = false;
  for (const ServoFrame& f : frames) {
    const std::uint32_t before = std::exchange(seen_buttons_, f.buttons);
    second = second || ((f.buttons & Drilling::mark) && !(before & Drilling::mark));
  }
  if (second) desk_->next();
  if (!desk_->ended()) {
    if (!session_->running()) quit_ = true;
    return;
  }
  end_session();
  judged_ = true;
  desk_->judge(true, stop_);
}

void Player::begin_review() {
  worked_on_ = patient_;
  playback_ = desk_->take_review();
  patient_ = playback_->patient();
  make_stage();
  Recording own;
  own.header = playback_->header();
  own.frames = playback_->frames();
  stage_->state.trace_mm = way_of(own);
  playback_->go_to(playback_->end_s());
  if (fluoro_) shots_taken_ = desk_->shots();
  paused_ = true;
  show_lesson_tool();
  const ScoreSum sum = sum_of(desk_->scored()->score);
  note(fmt::format("the lesson is judged: {} of {} points{}", sum.points, sum.most,
                   desk_->lesson().report.page.empty() ? "" : ", " + desk_->lesson().report.page.string()));
}

std::string Player::lesson_state() const {
  if (!desk_) return "error: this is no lesson";
  const LessonFacts& f = desk_->facts();
  std::string text = fmt::format("time {:.2f} tool {} step {}", f.procedure_s(), desk_->tool().name, desk_->step() + 1);
  for (const LessonStatus& s : desk_->status()) text += " " + s.name + " " + s.value;
  text += fmt::format(" end {}", desk_->ended() ? name_of(f.end) : "none");
  if (desk_->paused()) text += " paused";
  if (const int verdict = desk_->verdict(); verdict != 0) text += verdict > 0 ? " green" : " red";
  if (const ScoredLesson* s = desk_->scored())
    text += fmt::format(" points {} of {}", sum_of(s->score).points, sum_of(s->score).most);
  return text;
}

}  // namespace trephine
